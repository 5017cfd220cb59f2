//! A scene while it is being put together.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::report::{Hull, Reporter};
use super::source::Root;
use super::topology::{Edges, weld};
use super::winding::{InsideOut, inside_out};
use super::{LoadOptions, Loaded, texture};
use crate::geometry::{Geometry, GeometryMask, Shape};
use crate::scene::{Colour, Interface, Material, Medium, Object, Origin, Rgb, Scene};
use crate::{Error, Result};

/// Most objects that are inside out by themselves of which each is held against all others.
const MOST_COMPARED: usize = 1000;

/// A scene in the making, with what its parts share.
pub(super) struct Assembly<'a> {
    pub(super) scene: Scene,
    pub(super) reporter: Reporter,
    pub(super) options: &'a LoadOptions,
    pub(super) root: Root,
    /// Pictures already read, by path.
    pictures: HashMap<PathBuf, u32>,
    picture_bytes: u64,
    triangles: u64,
    /// Objects whose dielectric is inside out by itself.
    inside_out: Vec<(usize, InsideOut)>,
}

impl<'a> Assembly<'a> {
    /// An empty scene for the file `path`, with air around it.
    pub(super) fn new(path: &Path, options: &'a LoadOptions) -> Result<Self> {
        // So that a scene that is not there is named itself and not its folder.
        std::fs::metadata(path).map_err(|e| Error::io(path, "read", e))?;
        let folder = options.root.as_deref().unwrap_or_else(|| super::source::folder_of(path));
        Ok(Self {
            scene: Scene { media: vec![Medium::air()], ..Scene::default() },
            reporter: Reporter::new(options.strict),
            options,
            root: Root::new(folder)?,
            pictures: HashMap::new(),
            picture_bytes: 0,
            triangles: 0,
            inside_out: Vec::new(),
        })
    }

    /// Adds a medium and gives its place.
    pub(super) fn add_medium(&mut self, medium: Medium) -> u32 {
        self.scene.media.push(medium);
        self.scene.media.len() as u32 - 1
    }

    /// Adds a material and gives its place.
    pub(super) fn add_material(&mut self, material: Material) -> Result<u32> {
        if self.scene.materials.len() >= self.options.limits.objects {
            return Err(Error::Limit(format!("the scene has more than {} materials", self.options.limits.objects)));
        }
        self.scene.materials.push(material);
        Ok(self.scene.materials.len() as u32 - 1)
    }

    /// Reads a picture once and gives its place.
    pub(super) fn picture(&mut self, path: &Path) -> Result<u32> {
        if let Some(&place) = self.pictures.get(path) {
            return Ok(place);
        }
        let mut limits = self.options.limits;
        limits.texture_bytes = limits.texture_bytes.saturating_sub(self.picture_bytes);
        let reading = texture::read(path, &limits)?;
        let pixels = reading.texture.pixels.len() as u64;
        self.picture_bytes += pixels * size_of::<Rgb>() as u64;
        if reading.repaired > 0 {
            let kind = "pixels that are not finite or below zero count as black in those channels";
            self.reporter.warn(path, 0, kind, || format!(" ({} of {pixels})", reading.repaired))?;
        }
        if reading.alpha_dropped {
            self.reporter.warn(path, 0, "the picture's alpha channel is left out", String::new)?;
        }
        let place = self.scene.textures.len() as u32;
        self.scene.textures.push(reading.texture);
        self.pictures.insert(path.to_owned(), place);
        Ok(place)
    }

    /// Takes `count` more triangles on.
    ///
    /// # Errors
    /// `Limit`, where that is too many.
    pub(super) fn take_triangles(&mut self, count: u64) -> Result<()> {
        self.triangles = self.triangles.saturating_add(count);
        let limit = self.options.limits.triangles;
        if self.triangles > limit {
            return Err(Error::Limit(format!("the scene has more than {limit} triangles")));
        }
        Ok(())
    }

    /// Adds a shape, and warns of what its material asks of it in vain.
    pub(super) fn add(&mut self, name: String, shape: Shape, material: u32, origin: Origin) -> Result<()> {
        if self.scene.objects.len() >= self.options.limits.objects {
            return Err(Error::Limit(format!("the scene has more than {} shapes", self.options.limits.objects)));
        }
        let surface = &self.scene.materials[material as usize];
        let mask = if surface.is_transmissive() { GeometryMask::TRANSMISSIVE } else { GeometryMask::OPAQUE };
        let dielectric = matches!(surface.interface, Interface::Dielectric { .. });
        let pictured = matches!(surface.diffuse, Colour::Image { .. });
        let file = PathBuf::from(&origin.file);
        if let (Shape::Mesh(mesh), true) = (&shape, dielectric) {
            let object = self.scene.objects.len();
            let weld = weld(&mesh.positions);
            if let Some((edges, triangle)) = Edges::new(&mesh.triangles, &weld).open() {
                let line = origin.triangle_lines.get(triangle as usize).copied().unwrap_or(origin.line);
                let kind = format!(
                    "`{name}` is transparent but not closed ({edges} open edges): light that enters it may never \
                     leave; close it, or use a thin material"
                );
                self.reporter.warn(&file, line as usize, &kind, String::new)?;
                self.reporter.hull(object, Hull::Open);
            } else {
                self.reporter.hull(object, Hull::Closed);
                self.inside_out.extend(inside_out(mesh, &weld).map(|found| (object, found)));
            }
        }
        let mapped = match &shape {
            Shape::Mesh(mesh) => !mesh.uvs.is_empty(),
            Shape::Sphere(_) => true,
            Shape::Plane(_) => false,
        };
        if pictured && !mapped {
            let kind = format!("`{name}` has a picture but no texture coordinates: it shows one pixel of it");
            self.reporter.warn(&file, origin.line as usize, &kind, String::new)?;
        }
        self.scene.geometry.push(Geometry { shape, mask });
        self.scene.objects.push(Object { name, material, origin });
        Ok(())
    }

    /// Settles which closed dielectrics are inside out, as only the whole scene shows.
    fn settle_hulls(&mut self) {
        let found = std::mem::take(&mut self.inside_out);
        let turned: HashSet<usize> = found.iter().map(|&(object, _)| object).collect();
        for &(object, InsideOut { parts, of }) in &found {
            if found.len() > MOST_COMPARED || !self.is_hollow(object, &turned) {
                self.reporter.hull(object, Hull::InsideOut { parts, of });
            }
        }
    }

    /// Returns true if an object lies within another one of the same medium: it is the wall of a hollow in it, and its
    /// faces rightly point inwards. Objects of the list `turned` do not count as the other one.
    fn is_hollow(&self, object: usize, turned: &HashSet<usize>) -> bool {
        let medium = |o: usize| match self.scene.materials[self.scene.objects[o].material as usize].interface {
            Interface::Dielectric { medium, .. } => Some(&self.scene.media[medium as usize]),
            _ => None,
        };
        let bounds = |o: usize| match &self.scene.geometry[o].shape {
            Shape::Mesh(mesh) => Some(mesh.bounds()),
            Shape::Sphere(sphere) => Some(sphere.bounds()),
            Shape::Plane(_) => None,
        };
        let (Some(inner), Some(hollow)) = (medium(object), bounds(object)) else { return false };
        let same = |m: &Medium| (m.ior, m.dispersion, m.absorption) == (inner.ior, inner.dispersion, inner.absorption);
        (0..self.scene.objects.len()).any(|o| {
            !turned.contains(&o)
                && medium(o).is_some_and(same)
                && bounds(o).is_some_and(|outer| outer.contains(&hollow))
        })
    }

    /// The scene and its report.
    pub(super) fn finish(mut self) -> Loaded {
        self.settle_hulls();
        Loaded { scene: self.scene, report: self.reporter.finish() }
    }
}
