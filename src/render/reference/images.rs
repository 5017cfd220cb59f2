//! Virtual scenes in `f64`.

use crate::Result;
use crate::accel::reference::Reference;
use crate::render::{ImagesReport, images};
use crate::scene::Scene;
use crate::systems::images::{Image, Images};

/// Virtual scenes of reflectors, and hierarchies over them.
#[derive(Debug)]
pub(super) struct Virtual64 {
    images: Images,
    accels: Vec<Reference>,
}

impl Virtual64 {
    /// Makes the virtual scenes of a scene's reflectors.
    ///
    /// # Errors
    /// As [`images::checked`].
    pub fn of(scene: &Scene) -> Result<Self> {
        let images = images::checked(scene)?;
        let accels = images.list.iter().map(|image| Reference::build(&image.geometry)).collect();
        Ok(Self { images, accels })
    }

    /// Returns the virtual scene of one side of an object.
    pub fn at(&self, object: u32, front: bool) -> Option<(&Image, &Reference)> {
        let place = self.images.at(object, front)?;
        Some((&self.images.list[place], &self.accels[place]))
    }

    /// Returns the report, as [`images::report`] does.
    pub fn report(&self, traced: u64) -> ImagesReport {
        images::report(&self.images, traced)
    }
}
