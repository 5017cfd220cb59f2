//! What the path of a ray does to polarised light, per channel: see [`crate::optics::Diattenuation`].

use glam::DVec3;

use crate::math::Vector3;
use crate::optics::{Diattenuation, Mueller, PlaneOfIncidence, any_across, made_across};

/// What a ray carries beside its weight. Metals reflect each channel its own way, so that the channels part.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polarisation {
    /// The frame's first axis, unit, across the ray.
    axis: Vector3<f64>,
    rgb: [Diattenuation<f64>; 3],
}

impl Polarisation {
    /// Of a ray into `dir` that starts at the camera, or at a surface that depolarises.
    pub fn none(dir: DVec3) -> Self {
        Self { axis: any_across(dir.into()), rgb: [Diattenuation::none(); 3] }
    }

    /// In the frame of the plane of incidence at a surface with this normal.
    pub fn facing(&self, dir: DVec3, normal: DVec3) -> Self {
        let plane = PlaneOfIncidence::of_incidence(dir.into(), self.axis, normal.into());
        Self { axis: plane.s, rgb: self.rgb.map(|channel| channel.in_plane(&plane)) }
    }

    /// The factors that a surface puts on the weights.
    pub fn gain(&self, surface: &[Mueller<f64>; 3]) -> DVec3 {
        let [r, g, b] = std::array::from_fn(|c| self.rgb[c].gain(&surface[c]));
        DVec3::new(r, g, b)
    }

    /// With a surface added to the path; in its frame.
    pub fn then(&self, surface: &[Mueller<f64>; 3]) -> Self {
        Self { axis: self.axis, rgb: std::array::from_fn(|c| self.rgb[c].then(&surface[c])) }
    }

    /// Of the ray that leaves into `dir`.
    pub fn along(self, dir: DVec3) -> Self {
        Self { axis: made_across(self.axis, dir.into()), ..self }
    }
}
