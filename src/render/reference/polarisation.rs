//! Polarisation of a ray's path, per channel; see [`crate::optics::Diattenuation`].

use glam::DVec3;

use crate::math::Vector3;
use crate::optics::{Diattenuation, Mueller, PlaneOfIncidence, any_across, made_across};

/// Polarisation that a ray carries beside its weight. Metals reflect each channel differently, so the channels are
/// separate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polarisation {
    /// First axis of the frame: a unit vector across the ray.
    axis: Vector3<f64>,
    rgb: [Diattenuation<f64>; 3],
}

impl Polarisation {
    /// Returns the polarisation of a ray in `dir` that starts at the camera or at a depolarising surface.
    pub fn none(dir: DVec3) -> Self {
        Self { axis: any_across(dir.into()), rgb: [Diattenuation::none(); 3] }
    }

    /// Returns the polarisation in the frame of the plane of incidence at a surface with this normal.
    pub fn facing(&self, dir: DVec3, normal: DVec3) -> Self {
        let plane = PlaneOfIncidence::of_incidence(dir.into(), self.axis, normal.into());
        Self { axis: plane.s, rgb: self.rgb.map(|channel| channel.in_plane(&plane)) }
    }

    /// Returns the factors by which a surface multiplies the weights.
    pub fn gain(&self, surface: &[Mueller<f64>; 3]) -> DVec3 {
        let [r, g, b] = std::array::from_fn(|c| self.rgb[c].gain(&surface[c]));
        DVec3::new(r, g, b)
    }

    /// Returns the polarisation after a surface, in the surface's frame.
    pub fn then(&self, surface: &[Mueller<f64>; 3]) -> Self {
        Self { axis: self.axis, rgb: std::array::from_fn(|c| self.rgb[c].then(&surface[c])) }
    }

    /// Returns the polarisation of the ray that leaves in `dir`.
    pub fn along(self, dir: DVec3) -> Self {
        Self { axis: made_across(self.axis, dir.into()), ..self }
    }
}
