//! Rays in words and as arguments, with the command that repeats one.
//!
//! Numbers are the shortest decimals that read back as the same `f32`, so that a ray is repeated exactly.

use glam::Vec3;

use crate::geometry::Ray;

/// Start, direction and interval, for people.
#[must_use]
pub fn ray(ray: &Ray) -> String {
    let Ray { origin, dir, t_min, t_max, .. } = ray;
    format!("from ({}) along ({}), t from {} to {}", list(*origin, ", "), list(*dir, ", "), of(*t_min), of(*t_max))
}

/// The value of `--ray`: start, direction and interval, by commas.
#[must_use]
pub fn argument(ray: &Ray) -> String {
    format!("{},{},{},{}", list(ray.origin, ","), list(ray.dir, ","), of(ray.t_min), of(ray.t_max))
}

/// The command line that sends the same ray through every path again. `scene` is the file as it was typed.
#[must_use]
pub fn command(scene: &str, ray: &Ray) -> String {
    format!("vitrum parity {} --ray={}", quoted(scene), argument(ray))
}

fn list(v: Vec3, between: &str) -> String {
    v.to_array().map(of).join(between)
}

/// The shortest decimal that reads back the same, with an exponent where that is shorter.
fn of(x: f32) -> String {
    let (plain, scientific) = (format!("{x}"), format!("{x:e}"));
    if scientific.len() < plain.len() { scientific } else { plain }
}

/// The text as one word of a POSIX shell.
fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "/._-+:@%".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_is_told_in_numbers_that_read_back_the_same() {
        let sent =
            Ray { t_max: 1e30, ..Ray::new(Vec3::new(0.1, -1e-42, 16_777_216.0), Vec3::new(1.0 / 3.0, -0.0, 1.0)) };
        let back: Vec<f32> = argument(&sent).split(',').map(|x| x.parse().expect("a number")).collect();
        let want = [sent.origin.to_array(), sent.dir.to_array(), [sent.t_min, sent.t_max, 0.0]].concat();
        assert_eq!(
            back.iter().map(|x| x.to_bits()).collect::<Vec<_>>(),
            want[..8].iter().map(|x| x.to_bits()).collect::<Vec<_>>()
        );
        assert_eq!(ray(&Ray::new(Vec3::X, Vec3::Y)), "from (1, 0, 0) along (0, 1, 0), t from 0 to inf");
    }

    #[test]
    fn names_with_blanks_and_quotes_stay_one_word() {
        let ray = Ray::new(Vec3::ZERO, Vec3::Z);
        assert_eq!(command("a/b.obj", &ray), "vitrum parity a/b.obj --ray=0,0,0,0,0,1,0,inf");
        assert_eq!(command("it's a.obj", &ray), "vitrum parity 'it'\\''s a.obj' --ray=0,0,0,0,0,1,0,inf");
    }
}
