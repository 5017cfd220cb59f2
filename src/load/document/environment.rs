//! Reader of `[environment]`.

use super::Reader;
use super::table::{Table, Value};
use crate::Result;
use crate::load::assembly::Assembly;
use crate::scene::{Environment, Rgb};

#[derive(Clone, Copy)]
enum Kind {
    Constant,
    Gradient,
    Image,
}

/// Reads `[environment]` into the scene.
pub(super) fn environment<'d>(reader: &Reader<'d>, table: &Table<'d>, assembly: &mut Assembly<'_>) -> Result<()> {
    let kinds = [("constant", Kind::Constant), ("gradient", Kind::Gradient), ("image", Kind::Image)];
    assembly.scene.ambient = table.or("ambient", Rgb::ZERO, Value::colour)?;
    assembly.scene.environment = match table.or("type", Kind::Constant, |v| v.choice(&kinds))? {
        Kind::Constant => Environment::Constant(table.or("color", Rgb::ZERO, Value::colour)?),
        Kind::Gradient => Environment::Gradient {
            nadir: table.need("nadir")?.colour()?,
            horizon: table.need("horizon")?.colour()?,
            zenith: table.need("zenith")?.colour()?,
        },
        Kind::Image => {
            let path = reader.path(&table.need("file")?, assembly)?;
            Environment::LatLong {
                texture: assembly.picture(&path)?,
                scale: table.or("scale", Rgb::ONE, Value::colour)?,
                rotation: table.or("rotation", 0.0, Value::number)?.rem_euclid(360.0).to_radians() as f32,
            }
        }
    };
    table.finish()
}
