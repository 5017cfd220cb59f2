//! Origin of the scene: the world position at which its `f32` coordinates are 0.

use glam::DVec3;

use super::extent::Extent;
use crate::math::ulp;

/// Share of a shape's size above which rounding causes a warning.
const TOLERABLE: f64 = 1e-3;

/// Rounding of a shape's coordinates compared with its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Loss {
    /// Largest rounding error of a coordinate.
    pub rounding: f64,
    /// Longest side of the shape.
    pub size: f64,
    /// Largest coordinate relative to the scene's origin.
    pub reach: f64,
    /// True if rounding to `f64` loses more than rounding to `f32` afterwards.
    pub as_read: bool,
}

impl Loss {
    /// Returns the loss of a shape with the bounding box `extent` in `frame`, or `None` for planes.
    pub(super) fn of(extent: &Extent, frame: Frame) -> Option<Self> {
        if extent.is_empty() {
            return None;
        }
        let (reach, unit) = (extent.reach(frame.origin), frame.unit());
        let narrow = f64::from(ulp((reach / unit) as f32)) * unit * 0.5;
        // The numbers of the file were read as f64.
        let wide = extent.reach(DVec3::ZERO) * (f64::EPSILON * 0.5);
        Some(Self { rounding: narrow + wide, size: extent.size(), reach, as_read: wide > narrow })
    }

    /// Returns the rounding error relative to the size.
    pub(super) fn share(&self) -> f64 {
        self.rounding / self.size
    }

    /// Returns true if the loss deserves a warning.
    pub(super) fn is_large(&self) -> bool {
        self.rounding > TOLERABLE * self.size
    }
}

/// Chooses the origin of a scene of shapes with boxes `extents`, most of each in one of `bulks`. It is 0, with two
/// exceptions: a coordinate exceeds 64 times the extent of all shapes, or another origin spares every shape a loss that
/// deserves a warning.
///
/// It is then the middle of all shapes or, if only that spares the loss, of the shape that loses most. It is rounded to
/// a multiple of the largest power of two within the extent. So it has few digits, no coordinate relative to it exceeds
/// the extent, and subtracting it in `f64` is exact.
pub(super) fn choose(extents: &[Extent], bulks: &[Extent]) -> DVec3 {
    let whole = extents.iter().fold(Extent::EMPTY, |all, e| all.union(*e));
    if whole.is_empty() {
        return DVec3::ZERO;
    }
    let middle = middle(&whole);
    let losses = |origin| bulks.iter().filter_map(move |e| Some((e, Loss::of(e, Frame::at(origin))?)));
    let spares_all = |origin: &DVec3| !losses(*origin).any(|(_, loss)| loss.is_large());
    if whole.is_far() {
        return middle;
    }
    let worst = losses(DVec3::ZERO).filter(|(_, l)| l.is_large()).max_by(|a, b| a.1.share().total_cmp(&b.1.share()));
    let Some((worst, _)) = worst else { return DVec3::ZERO };
    [middle, self::middle(worst)].into_iter().find(spares_all).unwrap_or(DVec3::ZERO)
}

/// Returns the middle of a box, rounded to a multiple of the largest power of two within its longest side.
fn middle(extent: &Extent) -> DVec3 {
    let middle = extent.centre();
    if extent.size() <= 0.0 {
        return middle;
    }
    let step = extent.size().log2().floor().exp2();
    // Beyond the digits of f64 it already is a multiple.
    let round = |x: f64| if x.abs() < step * 2f64.powi(52) { (x / step).round() * step } else { x };
    DVec3::new(round(middle.x), round(middle.y), round(middle.z))
}

/// Returns the exponent of the unit for a single model, whose lengths may all be scaled alike. It is 0 for models of ordinary
/// size. It is the exponent of the model's extent if areas or volumes in the world's unit would leave the range of `f32`. It
/// is so, too, if lengths would leave the range in which Embree finds hits and keeps their digits.
pub(super) fn unit_exponent(extents: &[Extent]) -> i32 {
    let size = extents.iter().fold(Extent::EMPTY, |all, e| all.union(*e)).size();
    let exponent = if size > 0.0 { size.log2().floor() as i32 } else { 0 };
    if (-18..=36).contains(&exponent) { 0 } else { exponent }
}

/// Conversion between world coordinates and those of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub origin: DVec3,
    /// Exponent of the unit: a length of 1 in the scene is 2 to this power in the world.
    pub unit_exponent: i32,
}

impl Frame {
    /// Returns the frame of an origin, in the world's unit.
    pub(super) fn at(origin: DVec3) -> Self {
        Self { origin, unit_exponent: 0 }
    }

    /// Returns the length in the world of 1 in the frame.
    pub(super) fn unit(self) -> f64 {
        f64::from(self.unit_exponent).exp2()
    }

    /// Converts a position to the frame. Rounds it to `f32` if the frame is the world.
    pub(super) fn local(self, place: DVec3) -> DVec3 {
        let near = self.origin == DVec3::ZERO && self.unit_exponent == 0;
        if near { place.as_vec3().as_dvec3() } else { self.shifted(place) }
    }

    /// Converts a position to the frame.
    pub(super) fn shifted(self, place: DVec3) -> DVec3 {
        // Scaling by a power of two is exact.
        (place - self.origin) * f64::from(-self.unit_exponent).exp2()
    }

    /// Converts a position in the frame to world coordinates.
    pub(super) fn world(self, local: DVec3) -> DVec3 {
        local * self.unit() + self.origin
    }

    /// Returns, in the frame, a checker corner near the origin that gives the same pattern. `size` is the edge of a
    /// cube.
    pub(super) fn checker_corner(self, corner: DVec3, size: f64) -> DVec3 {
        if self.origin == DVec3::ZERO {
            return corner;
        }
        // The pattern repeats after two cubes along each axis.
        let near = |x: f64| (x + size).rem_euclid(2.0 * size) - size;
        let corner = self.shifted(corner);
        DVec3::new(near(corner.x), near(corner.y), near(corner.z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn origin(extents: &[Extent]) -> DVec3 {
        choose(extents, extents)
    }

    fn cube(centre: DVec3, size: f64) -> Extent {
        Extent::around([centre - size * 0.5, centre + size * 0.5].into_iter())
    }

    #[test]
    fn near_scenes_keep_the_worlds_own_origin() {
        assert_eq!(origin(&[]), DVec3::ZERO);
        assert_eq!(origin(&[cube(DVec3::new(60.0, 0.0, -63.0), 1.0)]), DVec3::ZERO);
        assert_eq!(origin(&[cube(DVec3::splat(1e6), 1.0), cube(DVec3::ZERO, 1.0)]), DVec3::ZERO);
    }

    #[test]
    fn a_far_origin_has_few_digits_and_leaves_no_coordinate_beyond_the_extent() {
        let place = DVec3::new(451234.5, 32.3, 5411234.25);
        assert_eq!(origin(&[cube(place, 2.2)]), DVec3::new(451234.0, 32.0, 5411234.0));
        for size in [1e-3, 0.7, 3.0, 40.0, 1000.0] {
            let extent = cube(place, size);
            let middle = origin(&[extent]);
            assert!(middle != DVec3::ZERO && extent.reach(middle) <= size, "{size}: {middle}");
        }
    }

    #[test]
    fn a_house_on_wide_ground_far_away_moves_the_origin_though_the_ground_alone_would_not() {
        let place = DVec3::new(451234.5, 32.3, 5411234.25);
        let ground = cube(place, 1e5);
        assert_eq!(origin(&[ground]), DVec3::ZERO);
        let middle = origin(&[ground, cube(place, 10.0)]);
        assert!((middle - place).abs().max_element() <= 32768.0, "{middle}");
    }

    #[test]
    fn a_stray_face_at_the_worlds_origin_does_not_cost_a_far_house_its_digits() {
        let house = cube(DVec3::new(451234.5, 32.3, 5411234.25), 12.0);
        let all = house.union(cube(DVec3::ZERO, 1.0));
        assert_eq!(choose(&[all], &[all]), DVec3::ZERO);
        assert_eq!(choose(&[all], &[house]), DVec3::new(451232.0, 32.0, 5411232.0));
    }

    #[test]
    fn a_checker_keeps_its_pattern_whatever_the_origin() {
        let (size, corner) = (0.7, DVec3::new(451234.5, 32.0, -1.0));
        let even = |p: DVec3, corner: DVec3| ((p - corner) / size).floor().element_sum().rem_euclid(2.0) == 0.0;
        let frame = Frame::at(DVec3::new(451230.0, 32.0, 5411234.0));
        let near = frame.checker_corner(corner, size);
        assert!(near.abs().max_element() <= size, "{near}");
        for i in 0..1000 {
            let p = frame.origin + DVec3::new(0.0131, 0.0272, 0.0313) * f64::from(i) + 0.0037;
            assert_eq!(even(p, corner), even(frame.shifted(p), near), "{p}");
        }
    }
}
