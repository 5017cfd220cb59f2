//! Tests of shafts against all shapes of a scene, with any back end.

use std::borrow::Cow;

use super::native::Native;
use super::{BuildQuality, Intersector};
use crate::Result;
use crate::geometry::{Content, Geometry, GeometryMask, Plane, Shaft, Shape};

/// Shapes that shafts are tested against: a native hierarchy, which is the back end's own if it has one, and the
/// infinite planes.
#[derive(Debug)]
pub struct Shafts<'a> {
    native: Cow<'a, Native>,
    planes: Vec<(Plane, GeometryMask)>,
}

impl<'a> Shafts<'a> {
    /// Creates the tests for `accel`, which was built over `geometry`. Builds a native hierarchy if `accel` has none.
    ///
    /// # Errors
    /// [`Error::Limit`](crate::Error::Limit) if there is not enough memory for that hierarchy.
    pub fn new<I: Intersector>(accel: &'a I, geometry: &[Geometry]) -> Result<Self> {
        let native = match accel.native() {
            Some(native) => Cow::Borrowed(native),
            None => Cow::Owned(Native::try_build_as(geometry, BuildQuality::Default)?),
        };
        let plane = |g: &Geometry| match g.shape {
            Shape::Plane(plane) if plane.is_usable() => Some((plane, g.mask)),
            _ => None,
        };
        Ok(Self { native, planes: geometry.iter().filter_map(plane).collect() })
    }

    /// Returns the content of a shaft. Shapes with a mask in `blocks` block light.
    #[must_use]
    pub fn content(&self, shaft: &Shaft, blocks: GeometryMask) -> Content {
        let mut found = Content::Empty;
        for (plane, mask) in &self.planes {
            match shaft.plane(plane, mask.meets(blocks)) {
                Content::Covered => return Content::Covered,
                Content::Mixed => found = Content::Mixed,
                Content::Empty => {}
            }
        }
        match self.native.content(shaft, blocks) {
            Content::Empty => found,
            other => other,
        }
    }
}
