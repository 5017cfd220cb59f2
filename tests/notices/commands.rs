//! All commands say the same.

use std::collections::BTreeSet;
use std::process::Output;
use std::time::Duration;

use assert_cmd::Command;

use super::support::Folder;

const DARK: &str = r#"
[render]
width = 16
height = 12
lights_from = "lamps"
[environment]
type = "constant"
color = 1
[[material]]
name = "matt"
type = "diffuse"
[[material]]
name = "spare"
type = "diffuse"
[[mesh]]
name = "ball"
shape = "sphere"
material = "matt"
"#;

const LAMP: &str = "[[light]]\ntype = \"directional\"\ndirection = [0, -1, -1]\nintensity = 1\n";

fn run(folder: &Folder, line: &str) -> Output {
    let mut command = Command::cargo_bin("vitrum").expect("the program is built");
    command.current_dir(folder.path("")).args(line.split_whitespace()).timeout(Duration::from_secs(120));
    command.output().expect("it runs")
}

fn warnings(output: &Output) -> BTreeSet<String> {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    text.lines().filter(|line| line.starts_with("warning: ")).map(str::to_owned).collect()
}

const COMMANDS: [&str; 5] = [
    "render a.toml -o a.png --backend native",
    "render a.toml -o a.png --backend reference",
    "explain a.toml",
    "verify a.toml --group self-hits",
    "parity a.toml --rays 8",
];

#[test]
fn render_explain_verify_and_parity_report_the_same_facts_in_the_same_words() {
    let folder = Folder::with(&[("a.toml", DARK)]);
    let said: Vec<_> = COMMANDS.iter().map(|line| warnings(&run(&folder, line))).collect();
    assert_eq!(said[0].len(), 2, "{said:?}");
    assert!(said[0].iter().any(|line| line.starts_with("warning: a.toml:12: the [[material]] `spare`")), "{said:?}");
    assert!(said[0].iter().any(|line| line.starts_with("warning: a.toml:15: no light reaches `ball`")), "{said:?}");
    assert!(said.iter().all(|others| *others == said[0]), "{said:?}");
}

#[test]
fn json_has_every_warning_as_text_and_every_notice_in_parts() {
    let folder = Folder::with(&[("a.toml", DARK)]);
    for line in COMMANDS {
        let output = run(&folder, &format!("{line} --json"));
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(json["warnings"].as_array().map(Vec::len), Some(2), "{line}");
        let [spare, dark] = [&json["notices"][0], &json["notices"][1]];
        assert_eq!((&spare["id"], &spare["line"]), (&"unused-material".into(), &12.into()), "{line}");
        assert_eq!((&dark["id"], &dark["line"], &dark["file"]), (&"unlit".into(), &15.into(), &"a.toml".into()));
        let text = json["warnings"][1].as_str().expect("text");
        for part in ["wrong", "because", "cure"] {
            assert!(text.contains(dark[part].as_str().expect("text")), "{line}: {part}");
        }
    }
}

#[test]
fn under_strict_each_is_an_error_and_no_picture_is_written() {
    let used = DARK.replace("[[material]]\nname = \"spare\"\ntype = \"diffuse\"\n", "");
    for (text, fault) in [
        (DARK.to_owned() + LAMP, Some("the [[material]] `spare` is not used")),
        (used.clone(), Some("no light reaches `ball`")),
        (lit_and_used(), None),
    ] {
        let folder = Folder::with(&[("a.toml", &text)]);
        for backend in ["native", "reference"] {
            let output = run(&folder, &format!("render a.toml -o {backend}.png --strict --backend {backend}"));
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(if fault.is_some() { 2 } else { 0 }), "{said}");
            assert_eq!(folder.path(&format!("{backend}.png")).exists(), fault.is_none());
            if let Some(fault) = fault {
                assert!(
                    said.starts_with("error: a.toml:") && said.contains(fault) && said.lines().count() == 1,
                    "{said}"
                );
            }
        }
    }
}

#[test]
fn under_strict_the_commands_that_make_no_picture_end_as_render_does() {
    let dropped = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 9\n";
    let folder = Folder::with(&[("a.toml", DARK), ("b.obj", dropped), ("c.toml", &lit_and_used())]);
    for (file, code) in [("a.toml", 2), ("b.obj", 2), ("c.toml", 0)] {
        let said = COMMANDS.map(|line| {
            let line = line.replace("a.toml", file);
            let output = run(&folder, &format!("{line} --strict"));
            assert_eq!(output.status.code(), Some(code), "{line}: {}", String::from_utf8_lossy(&output.stderr));
            let text = String::from_utf8_lossy(&output.stderr).into_owned();
            text.lines().filter(|line| line.starts_with("error: ")).map(str::to_owned).collect::<Vec<_>>()
        });
        assert_eq!(said[0].len(), usize::from(code > 0), "{said:?}");
        assert!(said.iter().all(|others| *others == said[0]), "{said:?}");
    }
}

/// [`DARK`] without its faults.
fn lit_and_used() -> String {
    DARK.replace("[[material]]\nname = \"spare\"\ntype = \"diffuse\"\n", "") + LAMP
}

#[test]
fn effects_that_are_left_out_on_request_are_no_fault() {
    let folder = Folder::with(&[("a.toml", &DARK.replace("[[material]]\nname = \"spare\"\ntype = \"diffuse\"\n", ""))]);
    let output = run(&folder, "render a.toml -o a.png --no-environment");
    assert!(output.status.success() && warnings(&output).is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
}
