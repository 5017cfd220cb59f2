//! Colour lookup by direction and by position: pictures and checkers.

use glam::{Vec2, Vec3};

use crate::scene::{Rgb, Texture, Wrap};

/// Returns the texture coordinates of a unit direction in an equirectangular picture. The picture is turned by
/// `rotation` radians about +y: `u = 1/2 + (atan2(x, -z) - rotation) / 2 pi`, `v = 1 - acos(y) / pi`.
#[must_use]
pub fn lat_long(dir: Vec3, rotation: f32) -> Vec2 {
    use std::f32::consts::{PI, TAU};
    Vec2::new(0.5 + (dir.x.atan2(-dir.z) - rotation) / TAU, 1.0 - dir.y.clamp(-1.0, 1.0).acos() / PI)
}

/// Continuation of a picture beyond its upper and lower edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// Repeats the picture.
    Repeat,
    /// Repeats the edge row.
    Clamp,
}

/// Returns the colour of `picture` at `uv`, interpolated bilinearly between texel centres, which lie at `(i + 0.5) /
/// width`. `v` = 1 is the top. The picture repeats in `u`, and continues in `v` as `vertical` says. Coordinates that
/// are not finite count as 0.
#[must_use]
pub fn bilinear(picture: &Texture, uv: Vec2, vertical: Edge) -> Rgb {
    let (w, h) = (picture.width as i64, picture.height as i64);
    let place = |t: f32, n: i64| {
        let t = if t.is_finite() { t - t.floor() } else { 0.0 };
        let x = t * n as f32 - 0.5;
        (x.floor() as i64, x - x.floor())
    };
    let (x, fx) = place(uv.x, w);
    let (y, fy) = match vertical {
        Edge::Repeat => place(1.0 - uv.y, h),
        Edge::Clamp => {
            let y = (1.0 - uv.y).clamp(0.0, 1.0) * h as f32 - 0.5;
            (y.floor() as i64, y - y.floor())
        }
    };
    let texel = |x: i64, y: i64| {
        let y = match vertical {
            Edge::Repeat => y.rem_euclid(h),
            Edge::Clamp => y.clamp(0, h - 1),
        };
        picture.pixels.get((y * w + x.rem_euclid(w)) as usize)
    };
    let row = |y: i64| texel(x, y).lerp(texel(x + 1, y), fx);
    row(y).lerp(row(y + 1), fy)
}

/// Returns the colour of `picture` on a surface at `uv`, continued as its `wrap` says.
#[inline]
#[must_use]
pub fn on_surface(picture: &Texture, uv: Vec2) -> Rgb {
    if picture.wrap == [Wrap::Repeat; 2] {
        bilinear(picture, uv, Edge::Repeat)
    } else {
        picture.on_surface(f64::from(uv.x), f64::from(uv.y)).as_vec3()
    }
}

/// Returns true if a point lies in an even cube of a checker.
#[inline]
#[must_use]
pub fn checker_is_even(point: Vec3, size: f32, offset: Vec3) -> bool {
    let cell = ((point - offset) / size).floor();
    // Halving and comparing stays exact for far cells, where an integer would overflow.
    let sum = cell.x + cell.y + cell.z;
    (sum * 0.5).floor() * 2.0 == sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_by_two() -> Texture {
        let pixels = vec![Rgb::X, Rgb::Y, Rgb::Z, Rgb::ONE];
        Texture::new("", 2, 2, pixels)
    }

    #[test]
    fn texel_centres_give_texels_and_the_first_row_is_on_top() {
        let t = two_by_two();
        assert_eq!(bilinear(&t, Vec2::new(0.25, 0.75), Edge::Repeat), Rgb::X);
        assert_eq!(bilinear(&t, Vec2::new(0.75, 0.75), Edge::Repeat), Rgb::Y);
        assert_eq!(bilinear(&t, Vec2::new(0.25, 0.25), Edge::Repeat), Rgb::Z);
        assert_eq!(bilinear(&t, Vec2::new(1.25, -0.75), Edge::Repeat), Rgb::Z);
        assert_eq!(bilinear(&t, Vec2::new(0.5, 0.75), Edge::Repeat), (Rgb::X + Rgb::Y) * 0.5);
        assert_eq!(bilinear(&t, Vec2::new(0.25, 1.0), Edge::Clamp), Rgb::X);
        assert!(bilinear(&t, Vec2::new(f32::NAN, f32::INFINITY), Edge::Repeat).is_finite());
    }

    #[test]
    fn a_lat_long_picture_has_up_on_top_and_minus_z_in_the_middle() {
        assert!((lat_long(Vec3::NEG_Z, 0.0) - Vec2::new(0.5, 0.5)).length() < 1e-6);
        assert!((lat_long(Vec3::X, 0.0) - Vec2::new(0.75, 0.5)).length() < 1e-6);
        assert!((lat_long(Vec3::Y, 0.0).y - 1.0).abs() < 1e-6);
    }

    #[test]
    fn checker_cubes_alternate_in_all_three_directions() {
        let even = |x: f32, y: f32, z: f32| checker_is_even(Vec3::new(x, y, z), 1.0, Vec3::ZERO);
        assert!(even(0.5, 0.5, 0.5));
        assert!(!even(1.5, 0.5, 0.5) && !even(0.5, -0.5, 0.5) && !even(0.5, 0.5, 7.5));
        assert!(even(-0.5, -0.5, 0.5) && even(1.5, 0.5, -0.5));
    }
}
