//! Reader of `[[mesh]]`.

use glam::{DMat4, DVec3};

use super::table::{Table, Value};
use super::{Names, Reader};
use crate::geometry::{COORDINATE_LIMIT, TriMesh};
use crate::load::assembly::{Assembly, Pending};
use crate::load::draft::{Ball, Draft, MeshDraft};
use crate::load::format::Format;
use crate::load::request::Request;
use crate::load::shapes::{self, Wave};
use crate::load::transform::{Transform, facing, flip, within_limit};
use crate::scene::Origin;
use crate::system::memory;
use crate::{Error, Result};

/// Finest tessellation; a finer shape would have more triangles than a scene may.
const FINEST: u32 = 16_384;
/// Peak bytes per triangle of a shape: indices of corners, normals and texture coordinates, and up to one of each, in
/// lists that grow by doubling.
const BYTES_A_TRIANGLE: u64 = 2 * (3 * 12 + 12 + 12 + 8);
/// Largest number of waves of a height field; each costs one sine per corner.
const MOST_WAVES: usize = 256;
/// Default angle in degrees below which a lathe's profile is shaded smoothly.
const LATHE_CREASE: f64 = 50.0;

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Sphere,
    Plane,
    Box,
    Disc,
    Torus,
    Cylinder,
    Cone,
    Capsule,
    Lathe,
    Heightfield,
    Grid,
}

const KINDS: [(&str, Kind); 11] = [
    ("sphere", Kind::Sphere),
    ("plane", Kind::Plane),
    ("box", Kind::Box),
    ("disc", Kind::Disc),
    ("torus", Kind::Torus),
    ("cylinder", Kind::Cylinder),
    ("cone", Kind::Cone),
    ("capsule", Kind::Capsule),
    ("lathe", Kind::Lathe),
    ("heightfield", Kind::Heightfield),
    ("grid", Kind::Grid),
];

/// Reads the `i`th mesh into the scene.
pub(super) fn mesh<'d>(
    reader: &Reader<'d>,
    table: &Table<'d>,
    i: usize,
    names: &Names,
    assembly: &mut Assembly<'_>,
) -> Result<()> {
    let given = table.opt("name", |v| v.text().map(str::to_owned))?;
    let transform = table.opt("transform", |v| transform(v, given.as_deref(), i))?.unwrap_or(Transform::IDENTITY);
    let flipped = table.or("flip", false, Value::boolean)?;
    let place = table.get("transform").map_or(table.span.clone(), |v| v.span());
    match (table.get("file"), table.get("shape")) {
        (Some(file), None) => {
            let path = reader.path(&file, assembly)?;
            let name = given
                .unwrap_or_else(|| path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned()));
            let wrong = |e: String| reader.source.error(&place, format!("the transform of `{name}` {e}"));
            let pairs = table.opt("materials", |v| v.table("materials")?.pairs())?.unwrap_or_default();
            if let (Some(_), Some(value)) = (table.get("material"), table.get("materials")) {
                return Err(
                    value.error("a mesh has either a `material` for all of it, or `materials` by name, not both")
                );
            }
            let mut replace = Vec::with_capacity(pairs.len());
            for (name, value) in &pairs {
                replace.push((name.clone(), names.material(value)?));
            }
            let request = Request {
                name: name.clone(),
                material: table.opt("material", |v| names.material(v))?,
                replace: &replace,
                smooth: table.opt("smooth", |v| {
                    v.number_where("an angle above 0 and up to 180 degrees", |x| x > 0.0 && x <= 180.0)
                })?,
                flip: flipped,
                transform,
                limit: f64::from(COORDINATE_LIMIT),
                wrong_transform: &wrong,
            };
            table.finish()?;
            let extras = Format::of(&path).unwrap_or(Format::Obj).load(&path, &request, assembly)?;
            if let (Some(fault), Some(value)) = (request.not_replaced(&extras.names), table.get("materials")) {
                return Err(value.error(fault));
            }
            if extras.view.is_some() || !extras.lamps.is_empty() {
                let lights = extras.lamps.len();
                let what = format!("`{name}` without the camera and the lights ({lights}) of its file");
                assembly.reporter.default_used(what);
            }
            Ok(())
        }
        (None, Some(value)) => {
            let kind = value.choice(&KINDS)?;
            let name = given.unwrap_or_else(|| format!("{} {}", value.text().unwrap_or_default(), i + 1));
            let material = names.material(&table.need("material")?)?;
            let wrong = |e: String| reader.source.error(&place, format!("the transform of `{name}` {e}"));
            let shape = shape(kind, table, assembly, &name)?;
            table.finish()?;
            let draft = match shape {
                Unplaced::Mesh(mut mesh) => {
                    transform.mesh(&mut mesh).map_err(wrong)?;
                    if flipped {
                        flip(&mut mesh.mesh);
                    }
                    Draft::Mesh(mesh)
                }
                Unplaced::Ball(_) if flipped => {
                    return Err(table.error(format!(
                        "`{name}` is an exact sphere, whose outside is fixed; give it a tessellation to flip it"
                    )));
                }
                Unplaced::Ball(ball) => Draft::Ball(transform.ball(&ball).map_err(wrong)?),
                Unplaced::Plane { point, normal } => {
                    let flat = transform.plane(point, normal).map_err(wrong)?;
                    Draft::Flat(if flipped { flat.flipped() } else { flat })
                }
            };
            let file = reader.source.file.display().to_string();
            let line = reader.source.line(table.span.start) as u32;
            let origin = Origin { file, line, triangle_lines: Vec::new() };
            assembly.add(Pending { name, draft, material, origin, smooth: None, flip: false })
        }
        (Some(_), Some(value)) => Err(value.error("a mesh has either a `file` or a `shape`, not both")),
        (None, None) => Err(table.error("[[mesh]] needs a `file` or a `shape`")),
    }
}

/// Reads `{ scale, rotate, translate }` or `{ matrix }`.
fn transform(value: &Value<'_>, name: Option<&str>, i: usize) -> Result<Transform> {
    let table = value.table("transform")?;
    let made = if let Some(matrix) = table.get("matrix") {
        let rows = matrix.numbers::<16>()?;
        Transform::new(DMat4::from_cols_array(&rows).transpose())
    } else {
        let scale = table.or("scale", DVec3::ONE, Value::one_or_three)?;
        let rotate = table.or("rotate", DVec3::ZERO, Value::triple)?;
        let translate = table.or("translate", DVec3::ZERO, Value::triple)?;
        Transform::from_parts(scale, rotate, translate)
    };
    table.finish()?;
    let name = name.map_or_else(|| format!("mesh {}", i + 1), |n| format!("`{n}`"));
    made.map_err(|e| value.error(format!("the transform of {name} {e}")))
}

/// Shape before its transform.
enum Unplaced {
    Mesh(MeshDraft),
    Ball(Ball),
    Plane { point: DVec3, normal: DVec3 },
}

fn shape(kind: Kind, table: &Table<'_>, assembly: &mut Assembly<'_>, name: &str) -> Result<Unplaced> {
    let fail = |e: String| table.error(format!("`{name}`: {e}"));
    let mut steps = |default: Option<u32>, triangles: fn(u64) -> u64| -> Result<Option<u32>> {
        let steps = table.opt("tessellation", |v| v.whole(1..=FINEST))?.or(default);
        if let Some(n) = steps {
            let count = triangles(u64::from(n));
            assembly.take_triangles(count)?;
            let what = format!("`{name}` of {count} triangles");
            memory::need(&what, count.saturating_mul(BYTES_A_TRIANGLE), "take a coarser tessellation")?;
        }
        Ok(steps)
    };
    let centre = || table.or("center", DVec3::ZERO, Value::place);
    let radius = || table.or("radius", 1.0, Value::positive);
    let place = |mesh: TriMesh, t: std::result::Result<Transform, String>| {
        let mut draft = MeshDraft::from(mesh);
        t.and_then(|t| t.mesh(&mut draft)).map_err(fail)?;
        draft.round_unless_far();
        Ok::<_, Error>(draft)
    };
    let flat = |mesh: &mut TriMesh| -> Result<()> {
        if !table.or("smooth", true, Value::boolean)? {
            shapes::make_flat(mesh);
        }
        Ok(())
    };
    let mesh = match kind {
        Kind::Sphere => {
            let (centre, radius) = (centre()?, radius()?);
            let Some(n) = steps(None, |n| 4 * n * n)? else {
                return Ok(Unplaced::Ball(Ball::new(centre, radius)));
            };
            let mut mesh = shapes::sphere(n);
            flat(&mut mesh)?;
            place(mesh, Transform::from_parts(DVec3::splat(radius), DVec3::ZERO, centre))?
        }
        Kind::Plane => {
            let point = table.or("point", DVec3::ZERO, Value::place)?;
            let normal = table.or("normal", DVec3::Y, Value::direction)?;
            return Ok(Unplaced::Plane { point, normal });
        }
        Kind::Box => {
            let n = steps(Some(1), |n| 12 * n * n)?.unwrap_or(1);
            let size = table.or("size", DVec3::ONE, Value::extent)?;
            place(shapes::cuboid(n), Transform::from_parts(size, DVec3::ZERO, centre()?))?
        }
        Kind::Disc => {
            let n = steps(Some(64), |n| n)?.unwrap_or(64);
            let normal = table.or("normal", DVec3::Y, Value::direction)?;
            place(shapes::disc(n), facing(normal, radius()?, centre()?))?
        }
        Kind::Torus => {
            let major = table.or("major", 1.0, Value::positive)?;
            let minor = table.or("minor", 0.25, Value::positive)?;
            if minor as f32 >= major as f32 {
                return Err(table.error(format!("`{name}`: `minor` is {minor}; it must be below `major`, {major}")));
            }
            let n = steps(Some(64), |n| n * n.max(6))?.unwrap_or(64);
            let mut mesh = shapes::torus(major, minor, n);
            flat(&mut mesh)?;
            mesh.into()
        }
        Kind::Cylinder | Kind::Cone | Kind::Capsule => {
            let (centre, radius) = (centre()?, radius()?);
            let height = table.or("height", 1.0, Value::positive)?;
            let n = steps(Some(64), |n| 4 * n)?.unwrap_or(64);
            let profile = match kind {
                Kind::Cylinder => shapes::cylinder(radius, height),
                Kind::Cone => shapes::cone(radius, height),
                _ => shapes::capsule(radius, height, n),
            };
            let more = (2 * u64::from(n)).saturating_mul(profile.len() as u64);
            assembly.take_triangles(more)?;
            let what = format!("`{name}` of up to {more} triangles");
            memory::need(&what, more.saturating_mul(BYTES_A_TRIANGLE), "take a coarser tessellation")?;
            let mut mesh = shapes::lathe(&profile, n, LATHE_CREASE).map_err(fail)?;
            flat(&mut mesh)?;
            place(mesh, Transform::from_parts(DVec3::ONE, DVec3::ZERO, centre))?
        }
        Kind::Lathe => {
            let value = table.need("profile")?;
            let profile = value.list()?.iter().map(Value::numbers::<2>).collect::<Result<Vec<_>>>()?;
            let crease = table.or("smooth", LATHE_CREASE, |v| {
                if v.is_boolean() {
                    Ok(if v.boolean()? { LATHE_CREASE } else { 0.0 })
                } else {
                    v.number_where("true, false or an angle from 0 to 180 degrees", |x| (0.0..=180.0).contains(&x))
                }
            })?;
            let n = steps(Some(64), |n| 2 * n)?.unwrap_or(64);
            let count = (2 * u64::from(n)).saturating_mul(profile.len() as u64);
            assembly.take_triangles(count)?;
            let what = format!("`{name}` of up to {count} triangles");
            memory::need(&what, count.saturating_mul(BYTES_A_TRIANGLE), "take a coarser tessellation")?;
            shapes::lathe(&profile, n, crease).map_err(|e| value.error(e))?.into()
        }
        Kind::Heightfield => {
            let size = table.need("size")?;
            let extent = size.numbers::<2>()?;
            if extent.iter().any(|&e| e as f32 <= 0.0) {
                return Err(size.error(format!("`size` is {extent:?}; it must be above 0")));
            }
            let waves = table.or("waves", Vec::new(), |v| v.list()?.iter().map(wave).collect())?;
            if waves.len() > MOST_WAVES {
                return Err(table.error(format!("`{name}` has {} waves; at most {MOST_WAVES} are summed", waves.len())));
            }
            let level = table.or("level", 0.0, Value::number)?;
            let depth = table.opt("depth", Value::positive)?;
            let n = steps(Some(64), |n| 2 * n * n + 12 * n)?.unwrap_or(64);
            let mut mesh = shapes::heightfield(extent, &waves, level, depth, n).map_err(fail)?;
            flat(&mut mesh)?;
            mesh.into()
        }
        Kind::Grid => {
            let size = table.or("size", [1.0; 2], Value::numbers::<2>)?;
            if size.iter().any(|&e| e as f32 <= 0.0) {
                return Err(table.error(format!("`{name}`: `size` is {size:?}; it must be above 0")));
            }
            let n = steps(Some(1), |n| 2 * n * n)?.unwrap_or(1);
            let scale = DVec3::new(size[0], 1.0, size[1]);
            place(shapes::grid(n), Transform::from_parts(scale, DVec3::ZERO, DVec3::ZERO))?
        }
    };
    if let Some(p) = mesh.corners.iter().find(|&&p| !within_limit(p)) {
        return Err(table.error(format!("`{name}` reaches to {}, beyond 1.844e18", p.as_vec3())));
    }
    Ok(Unplaced::Mesh(mesh))
}

fn wave(value: &Value<'_>) -> Result<Wave> {
    let table = value.table("a wave")?;
    let wave = Wave {
        amplitude: table.need("amplitude")?.not_negative()?,
        wavelength: table.need("wavelength")?.positive()?,
        direction: table.or("direction", 0.0, Value::number)?,
        phase: table.or("phase", 0.0, Value::number)?,
    };
    table.finish()?;
    Ok(wave)
}
