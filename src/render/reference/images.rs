//! Virtual scenes in `f64`.

use crate::Result;
use crate::accel::reference::Reference;
use crate::render::ImagesReport;
use crate::render::images::Virtual;
use crate::scene::Scene;
use crate::systems::images::Image;

/// Virtual scenes of reflectors, and hierarchies over them.
#[derive(Debug)]
pub(super) struct Virtual64 {
    scenes: Virtual,
    accels: Vec<Reference>,
}

impl Virtual64 {
    /// Of a scene whose reflectors are balls.
    ///
    /// # Errors
    /// As [`Virtual::of`].
    pub fn of(scene: &Scene) -> Result<Self> {
        let scenes = Virtual::of(scene)?;
        let accels = scenes.images.list.iter().map(|image| Reference::build(&image.geometry)).collect();
        Ok(Self { scenes, accels })
    }

    /// Returns the virtual scene of one side of an object.
    pub fn at(&self, object: u32, front: bool) -> Option<(&Image, &Reference)> {
        let place = self.scenes.images.at(object, front)?;
        Some((&self.scenes.images.list[place], &self.accels[place]))
    }

    /// Returns the report, as [`Virtual::report`] does.
    pub fn report(&self, traced: u64) -> ImagesReport {
        self.scenes.report(traced)
    }
}
