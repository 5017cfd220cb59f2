//! Reader of `[environment]`.

use super::Reader;
use super::table::{Table, Value};
use crate::Result;
use crate::load::assembly::Assembly;
use crate::scene::{Environment, MapKind, Rgb, Texture};

#[derive(Clone, Copy)]
enum Kind {
    Constant,
    Gradient,
    Image,
    Map(MapKind),
}

/// Reads `[environment]` into the scene.
pub(super) fn environment<'d>(reader: &Reader<'d>, table: &Table<'d>, assembly: &mut Assembly<'_>) -> Result<()> {
    let kinds = [
        ("constant", Kind::Constant),
        ("gradient", Kind::Gradient),
        ("image", Kind::Image),
        ("latlong", Kind::Map(MapKind::LatLong)),
        ("cube", Kind::Map(MapKind::Cube)),
        ("sphere", Kind::Map(MapKind::Sphere)),
    ];
    assembly.scene.ambient = table.or("ambient", Rgb::ZERO, Value::colour)?;
    assembly.scene.environment = match table.or("type", Kind::Constant, |v| v.choice(&kinds))? {
        Kind::Constant => Environment::Constant(table.or("color", Rgb::ZERO, Value::colour)?),
        Kind::Gradient => Environment::Gradient {
            nadir: table.need("nadir")?.colour()?,
            horizon: table.need("horizon")?.colour()?,
            zenith: table.need("zenith")?.colour()?,
        },
        Kind::Map(kind) => {
            let file = table.need("file")?;
            let path = reader.path(&file, assembly)?;
            let texture = assembly.picture(&path)?;
            let Texture { width, height, name, .. } = &assembly.scene.textures[texture as usize];
            if !kind.fits(*width, *height) {
                let [columns, rows] = kind.shape(*height);
                return Err(file.error(format!(
                    "`{name}` has {width} by {height} pixels; a {} map of {height} rows has {columns} by {rows}: name one \
                     that `vitrum map --kind {}` wrote, or take another type",
                    kind.name(),
                    kind.name()
                )));
            }
            let scale = table.or("scale", Rgb::ONE, Value::colour)?;
            let rotation = table.or("rotation", 0.0, Value::number)?.rem_euclid(360.0).to_radians() as f32;
            match kind {
                MapKind::LatLong => Environment::LatLong { texture, scale, rotation },
                MapKind::Cube | MapKind::Sphere => Environment::Map { kind, texture, scale, rotation },
            }
        }
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
