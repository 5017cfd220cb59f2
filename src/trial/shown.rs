//! Rays in words and as arguments, with the command that repeats one.
//!
//! Numbers are the shortest decimals that parse to the same `f32`, so that a ray is repeated exactly.

use glam::Vec3;

pub use crate::geometry::Ray;
use crate::measure::shell::quoted;

/// Returns origin, direction and interval in words.
#[must_use]
pub fn ray(ray: &Ray) -> String {
    let Ray { origin, dir, t_min, t_max, .. } = ray;
    format!("from ({}) along ({}), t from {} to {}", list(*origin, ", "), list(*dir, ", "), of(*t_min), of(*t_max))
}

/// Returns the value of `--ray`: origin, direction and interval, separated by commas.
#[must_use]
pub fn argument(ray: &Ray) -> String {
    format!("{},{},{},{}", list(ray.origin, ","), list(ray.dir, ","), of(ray.t_min), of(ray.t_max))
}

/// Parses the ray of an [`argument`]. The interval may be left out.
///
/// # Errors
/// The fault of the text.
pub fn read(text: &str) -> Result<Ray, String> {
    let numbers = text.split(',').map(|x| x.trim().parse::<f32>()).collect::<Result<Vec<_>, _>>();
    let numbers = numbers.map_err(|_| String::from("not numbers with commas between them"))?;
    let (&[x, y, z, dx, dy, dz], ends) = numbers.split_first_chunk().ok_or("not six or eight numbers")?;
    let mut ray = Ray::new(Vec3::new(x, y, z), Vec3::new(dx, dy, dz));
    match *ends {
        [] => {}
        [t_min, t_max] => (ray.t_min, ray.t_max) = (t_min, t_max),
        _ => return Err(String::from("not six or eight numbers")),
    }
    if !ray.origin.is_finite() || !ray.dir.is_finite() || ray.dir == Vec3::ZERO {
        return Err(String::from("start and direction must be finite, and the direction not 0,0,0"));
    }
    if ray.t_min < ray.t_max { Ok(ray) } else { Err(String::from("t must begin before it ends")) }
}

/// Returns the command that sends the same ray through every path. `scene` is the file as typed.
#[must_use]
pub fn command(scene: &str, ray: &Ray) -> String {
    format!("vitrum parity {} --ray={}", quoted(scene), argument(ray))
}

fn list(v: Vec3, between: &str) -> String {
    v.to_array().map(of).join(between)
}

/// Returns the shortest decimal that parses to the same number, with an exponent if that is shorter.
fn of(x: f32) -> String {
    let (plain, scientific) = (format!("{x}"), format!("{x:e}"));
    if scientific.len() < plain.len() { scientific } else { plain }
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
    fn a_ray_has_six_numbers_or_eight() {
        let sent = read("1,-2,3e-5,0,0,-1").expect("a ray");
        assert_eq!((sent.origin, sent.dir), (Vec3::new(1.0, -2.0, 3e-5), -Vec3::Z));
        assert_eq!((sent.t_min, sent.t_max), (0.0, f32::INFINITY));
        let sent = read("0,0,0, 0,0,1, 0.5,inf").expect("a ray");
        assert_eq!((sent.t_min, sent.t_max), (0.5, f32::INFINITY));
        for text in ["", "1,2,3", "1,2,3,4,5,6,7", "a,0,0,0,0,1", "0,0,0,0,0,0", "0,0,nan,0,0,1", "0,0,0,0,0,1,2,1"] {
            assert!(read(text).is_err(), "{text}");
        }
    }

    #[test]
    fn names_with_blanks_and_quotes_stay_one_word() {
        let ray = Ray::new(Vec3::ZERO, Vec3::Z);
        assert_eq!(command("a/b.obj", &ray), "vitrum parity a/b.obj --ray=0,0,0,0,0,1,0,inf");
        assert_eq!(command("it's a.obj", &ray), "vitrum parity 'it'\\''s a.obj' --ray=0,0,0,0,0,1,0,inf");
    }
}
