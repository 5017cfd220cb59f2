//! Reader of scene files.

mod camera;
mod environment;
mod light;
mod material;
mod mesh;
mod refraction;
mod table;

use std::cell::Cell;
use std::collections::HashMap;
use std::path::Path;

use toml::de::DeTable;

use self::table::{Source, Table, Value};
use super::assembly::Assembly;
use super::source::{folder_of, read_text};
use super::suggest::hint;
use super::{LoadOptions, Loaded};
use crate::scene::Interface;
use crate::{Error, Result};

/// Reads a scene file.
pub(super) fn load(path: &Path, options: &LoadOptions) -> Result<Loaded> {
    let text = read_text(path, options.limits.file_bytes)?;
    let source = Source::new(path, &text);
    let tree = DeTable::parse(&text).map_err(|e| {
        let message = e.message().lines().collect::<Vec<_>>().join("; ");
        source.error(&e.span().unwrap_or(0..0), message)
    })?;
    let top = Table::new(&source, "a scene", tree.get_ref(), 0..0);
    let mut assembly = Assembly::new(path, options)?;
    let reader = Reader { source: &source };

    if let Some(table) = top.table("files")? {
        for root in table.opt("roots", Value::list)?.unwrap_or_default() {
            let folder = folder_of(path).join(root.text()?);
            assembly.root.allow(&folder).map_err(|e| root.error(e.to_string()))?;
        }
        table.finish()?;
    }
    let names = reader.materials(&top, &mut assembly)?;
    let camera = top.table("camera")?;
    if camera.is_none() {
        assembly.reporter.default_used("no [camera]: it stands at 0, 1, 5 and looks at the origin");
    }
    if let Some(table) = top.table("render")? {
        assembly.scene.settings = camera::settings(&table, options)?;
    }
    match top.table("environment")? {
        Some(table) => environment::environment(&reader, &table, &mut assembly)?,
        None => assembly.reporter.default_used("no [environment]: everything around is black"),
    }
    let lights = top.list("light")?;
    if lights.len() > options.limits.objects {
        return Err(Error::Limit(format!("the scene has more than {} lights; leave some out", options.limits.objects)));
    }
    for (i, table) in top.list("mesh")?.iter().enumerate() {
        mesh::mesh(&reader, table, i, &names, &mut assembly)?;
    }
    // Parts with positions wait until the origin is known.
    let frame = assembly.settle(Some(camera::line_of_sight(camera.as_ref())?))?;
    for (i, table) in lights.iter().enumerate() {
        assembly.scene.lights.push(light::light(table, i, frame)?);
    }
    assembly.scene.camera = camera::camera(camera.as_ref(), frame, &names, &mut assembly)?;
    top.finish()?;
    names.report_unused(&mut assembly);
    if assembly.scene.objects.is_empty() {
        assembly.reporter.warn(
            path,
            0,
            "the scene has no [[mesh]]: the picture shows only the environment",
            String::new,
        )?;
    }
    Ok(assembly.finish())
}

/// State for reading the parts of one scene file.
struct Reader<'d> {
    source: &'d Source<'d>,
}

impl<'d> Reader<'d> {
    /// Resolves a file name given as a value.
    fn path(&self, value: &Value<'d>, assembly: &Assembly<'_>) -> Result<std::path::PathBuf> {
        assembly.root.resolve(folder_of(self.source.file), value.text()?).map_err(|e| value.error(e))
    }

    fn materials(&self, top: &Table<'d>, assembly: &mut Assembly<'_>) -> Result<Names> {
        let mut names = Names::default();
        for table in top.list("material")? {
            let value = table.need("name")?;
            let name = value.text()?;
            if name.is_empty() {
                return Err(value.error("a material's name must not be empty; give it a name"));
            }
            if names.0.contains_key(name) {
                return Err(
                    value.error(format!("there is a material called `{name}` already; give this one another name"))
                );
            }
            let material = material::material(self, &table, name, assembly)?;
            let line = self.source.line(table.span.start) as u32;
            let place = assembly.add_material(material)?;
            names.0.insert(name.to_owned(), Entry { place, line, used: Cell::new(false) });
        }
        Ok(names)
    }
}

/// Materials of the scene file, by name.
#[derive(Default)]
struct Names(HashMap<String, Entry>);

/// Material of the scene file.
struct Entry {
    /// Index into `Scene::materials`.
    place: u32,
    /// Line of its table.
    line: u32,
    /// True once a mesh or the camera uses it.
    used: Cell<bool>,
}

impl Names {
    /// Returns the index of the material that a value names.
    fn material(&self, value: &Value<'_>) -> Result<u32> {
        let name = value.text()?;
        let entry = self.0.get(name).inspect(|entry| entry.used.set(true));
        entry.map(|entry| entry.place).ok_or_else(|| {
            let mut known: Vec<&str> = self.0.keys().map(String::as_str).collect();
            known.sort_unstable();
            let short: String = name.chars().take(80).collect();
            value.error(format!("no material is called `{short}`{}", hint(&short, known)))
        })
    }

    /// Reports the unused materials, in the order of the file.
    fn report_unused(self, assembly: &mut Assembly<'_>) {
        let mut unused: Vec<_> = self.0.into_iter().filter(|(_, entry)| !entry.used.get()).collect();
        unused.sort_unstable_by_key(|(_, entry)| entry.place);
        unused.into_iter().for_each(|(name, entry)| assembly.reporter.unused_material(name, entry.line));
    }

    /// Returns the index of the medium inside the dielectric that a value names.
    fn medium(&self, value: &Value<'_>, assembly: &Assembly<'_>) -> Result<u32> {
        match assembly.scene.materials[self.material(value)? as usize].interface {
            Interface::Dielectric { medium, .. } => Ok(medium),
            _ => Err(value.error(format!(
                "`{}` is no dielectric, so the eye cannot be inside it; name a material of `type = \"dielectric\"`",
                value.text()?
            ))),
        }
    }
}
