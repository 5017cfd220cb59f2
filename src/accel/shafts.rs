//! Shafts against all shapes of a scene, whichever back end traces its rays.

use std::borrow::Cow;

use super::Intersector;
use super::native::Native;
use crate::geometry::{Content, Geometry, GeometryMask, Plane, Shaft, Shape};

/// Shapes that shafts are searched for: native's hierarchy, the back end's own if it has one, and the infinite planes.
#[derive(Debug)]
pub struct Shafts<'a> {
    native: Cow<'a, Native>,
    planes: Vec<(Plane, GeometryMask)>,
}

impl<'a> Shafts<'a> {
    /// For `accel`, which was built over `geometry`. Builds a hierarchy where it has none of native's.
    #[must_use]
    pub fn new<I: Intersector>(accel: &'a I, geometry: &[Geometry]) -> Self {
        let native = accel.native().map_or_else(|| Cow::Owned(Native::build(geometry)), Cow::Borrowed);
        let plane = |g: &Geometry| match g.shape {
            Shape::Plane(plane) if plane.is_usable() => Some((plane, g.mask)),
            _ => None,
        };
        Self { native, planes: geometry.iter().filter_map(plane).collect() }
    }

    /// The content of a shaft; shapes that `blocks` meets stop light.
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
