//! Reflection systems of the lecture notes, which trace no reflected rays: their facts of a scene and their arithmetic.
//!
//! [`planar`] finds the mirrors that a matrix serves, [`maps`] holds the environment maps of reflectors, and [`images`] the
//! virtual scenes of curved reflectors. `render` shades their results by the stages of any other picture. So a picture
//! differs from the traced one by the error of the system alone.

pub mod alhazen;
pub mod bent;
pub mod explosion;
pub mod images;
pub mod maps;
pub mod planar;
mod reflector;
mod tessellate;
