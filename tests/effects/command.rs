//! Effects on the command line, and `vitrum explain`.

use std::path::Path;

use assert_cmd::Command;
use vitrum::effects::Effect;

use super::small;

fn fails(arguments: &str) -> String {
    let output = Command::cargo_bin("vitrum").expect("built").args(arguments.split(' ')).output().expect("runs");
    assert_eq!(output.status.code(), Some(2), "{arguments}");
    let text = String::from_utf8(output.stderr).expect("text");
    assert_eq!(text.trim_end().lines().count(), 1, "{text}");
    text
}

#[test]
fn slips_and_contradictions_on_the_command_line_get_one_line() {
    let unknown = fails("render scenes/glass.toml -o /tmp/none.png --effects refracton");
    assert!(unknown.contains("no effect is called `refracton`; did you mean `refraction`?"), "{unknown}");
    let both = fails("explain scenes/glass.toml --effects mirror --no-mirror");
    assert!(both.contains("--effects mirror and --no-mirror contradict each other"), "{both}");
    let bent = fails("render scenes/glass.toml -o /tmp/none.png --no-refraction --refraction bec");
    assert!(bent.contains("--refraction chooses how `refraction` is done, which is left out"), "{bent}");
}

#[test]
fn explain_tells_every_effect_within_eighty_columns_and_as_json() {
    let run = |arguments: &str| {
        let output = Command::cargo_bin("vitrum").expect("built").args(arguments.split(' ')).output().expect("runs");
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).expect("text")
    };
    let text = run("explain scenes/absorption.toml --measure --rounds 1 --width 24 -q");
    assert!(text.ends_with('\n') && text.lines().all(|line| line.chars().count() <= 80), "{text}");
    for effect in Effect::ALL {
        assert!(text.contains(effect.name()), "{effect}");
    }
    let json: serde_json::Value =
        serde_json::from_str(&run("explain scenes/absorption.toml --measure --rounds 1 --width 24 -q --json"))
            .expect("JSON");
    let rows = json["effects"].as_array().expect("rows");
    assert_eq!(rows.len(), Effect::ALL.len());
    for row in rows {
        assert_eq!(row["on"].as_bool(), Some(row.get("worth").is_some()), "{row}");
    }
    assert!(text.contains("shaded together: `slab 1`, `slab 2`"), "{text}");
    let shared = json["shared"].as_array().expect("groups");
    let objects: usize = shared.iter().map(|group| group["objects"].as_array().expect("names").len()).sum();
    let scene = small(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/absorption.toml"));
    assert_eq!(objects, scene.objects.len(), "{shared:?}");
    let (most, mean) = (json["rays"]["most_per_pixel"].as_f64(), json["rays"]["mean_per_pixel"].as_f64());
    assert!(mean.expect("measured") > 1.0 && mean < most, "{mean:?} {most:?}");
}
