//! Numbers within their ranges.

use glam::Vec3;

use crate::geometry::Ray;

fn parsed<T: std::str::FromStr>(text: &str) -> Result<T, String> {
    text.trim().parse().map_err(|_| String::from("not a number"))
}

/// A number, or a fraction of two.
fn number(text: &str) -> Result<f64, String> {
    match text.split_once('/') {
        Some((above, below)) => Ok(parsed::<f64>(above)? / parsed::<f64>(below)?),
        None => parsed(text),
    }
}

/// [`number`], rounded once.
fn number32(text: &str) -> Result<f32, String> {
    if text.contains('/') { Ok(number(text)? as f32) } else { parsed(text) }
}

/// A difference of a channel.
pub(super) fn bound(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(String::from("not a number above 0; write 1/512 or 0.002"))
    }
}

pub(super) fn cutoff(text: &str) -> Result<f32, String> {
    let x = number32(text)?;
    if (0.0..=1.0).contains(&x) { Ok(x) } else { Err(String::from("not in 0 to 1")) }
}

pub(super) fn above_minus_one(text: &str) -> Result<f64, String> {
    let x = number(text)?;
    if x > -1.0 && x.is_finite() { Ok(x) } else { Err(String::from("not a finite number above -1")) }
}

pub(super) fn above_zero(text: &str) -> Result<f32, String> {
    let x = number32(text)?;
    if x > 0.0 && x.is_finite() { Ok(x) } else { Err(String::from("not a finite number above 0")) }
}

pub(super) fn exposure(text: &str) -> Result<f32, String> {
    let x = number32(text)?;
    if (-64.0..=64.0).contains(&x) { Ok(x) } else { Err(String::from("not in -64 to 64")) }
}

pub(super) fn share(text: &str) -> Result<f64, String> {
    let x = number(text)?;
    if (0.0..=1.0).contains(&x) { Ok(x) } else { Err(String::from("not in 0 to 1")) }
}

pub(super) fn not_negative(text: &str) -> Result<f64, String> {
    let x = number(text)?;
    if x >= 0.0 && x.is_finite() { Ok(x) } else { Err(String::from("not a finite number of at least 0")) }
}

/// A ray: start, direction and, where given, the interval of `t`.
pub(super) fn ray(text: &str) -> Result<Ray, String> {
    let numbers = text.split(',').map(parsed::<f32>).collect::<Result<Vec<_>, _>>();
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fraction_is_a_number_wherever_one_may_stand() {
        let fraction = Ok(1.0 / 512.0);
        assert_eq!(
            (bound("1/512"), not_negative("1/512"), share("1/512"), above_minus_one("1/512")),
            (fraction.clone(), fraction.clone(), fraction.clone(), fraction)
        );
        assert_eq!(
            (cutoff("1/512"), above_zero("1/512"), exposure("-3/2")),
            (Ok(1.0 / 512.0), Ok(1.0 / 512.0), Ok(-1.5))
        );
        for text in ["1/0", "0/0", "1/", "/2", "1/2/3", "a/b"] {
            assert!(bound(text).is_err() && cutoff(text).is_err() && not_negative(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_ray_has_six_numbers_or_eight() {
        let read = ray("1,-2,3e-5,0,0,-1").expect("a ray");
        assert_eq!((read.origin, read.dir), (Vec3::new(1.0, -2.0, 3e-5), -Vec3::Z));
        assert_eq!((read.t_min, read.t_max), (0.0, f32::INFINITY));
        let read = ray("0,0,0, 0,0,1, 0.5,inf").expect("a ray");
        assert_eq!((read.t_min, read.t_max), (0.5, f32::INFINITY));
        for text in ["", "1,2,3", "1,2,3,4,5,6,7", "a,0,0,0,0,1", "0,0,0,0,0,0", "0,0,nan,0,0,1", "0,0,0,0,0,1,2,1"] {
            assert!(ray(text).is_err(), "{text}");
        }
    }

    #[test]
    fn numbers_that_are_none_are_refused() {
        for text in ["nan", "inf", "-0.1", "1.5", "", "a"] {
            assert!(cutoff(text).is_err(), "{text}");
            assert!(share(text).is_err(), "{text}");
        }
        assert!(exposure("nan").is_err() && exposure("65").is_err());
        assert!(not_negative("inf").is_err() && not_negative("-1e-9").is_err());
        assert_eq!((cutoff("0"), exposure("-2"), not_negative("5e-4")), (Ok(0.0), Ok(-2.0), Ok(5e-4)));
    }
}
