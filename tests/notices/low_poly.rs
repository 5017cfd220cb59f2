//! Light that a coarse mesh with smooth normals never lets out.

use super::support::{kinds, only_notice};

/// A ball of glass in even light, in which nothing should be seen.
fn ball(shape: &str) -> String {
    format!(
        r#"
[camera]
eye = [0, 0.4, 4]
target = [0, 0, 0]
fov = 32
[render]
width = 60
height = 45
depth = 64
cutoff = 1e-5
[environment]
type = "constant"
color = 1
[[material]]
name = "glass"
type = "dielectric"
ior = 1.5
[[mesh]]
name = "ball"
shape = "sphere"
material = "glass"
{shape}
"#
    )
}

#[test]
fn a_coarse_ball_with_smooth_normals_is_named_whatever_the_depth() {
    for depth in ["depth = 16", "depth = 64", "depth = 300"] {
        let notice = only_notice(&ball("tessellation = 10").replace("depth = 64", depth));
        assert_eq!(notice.id, "low-poly");
        assert!(notice.finding.wrong.contains("`ball` loses light"), "{notice}");
    }
}

#[test]
fn flat_faces_fine_meshes_and_exact_balls_let_all_light_out() {
    for shape in ["", "tessellation = 10\nsmooth = false", "tessellation = 60"] {
        assert!(!kinds(&ball(shape)).contains(&"low-poly"), "{shape}");
    }
}
