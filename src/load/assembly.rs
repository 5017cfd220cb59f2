//! A scene while it is being put together.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::report::Reporter;
use super::source::Root;
use super::{LoadOptions, Loaded, texture};
use crate::geometry::topology::{Edges, weld};
use crate::geometry::{Geometry, GeometryMask, Shape};
use crate::scene::{Colour, Interface, Material, Medium, Object, Origin, Rgb, Scene};
use crate::{Error, Result};

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
        if let (Shape::Mesh(mesh), true) = (&shape, dielectric)
            && let Some((edges, triangle)) = Edges::new(&mesh.triangles, &weld(&mesh.positions)).open()
        {
            let line = origin.triangle_lines.get(triangle as usize).copied().unwrap_or(origin.line);
            let kind = format!(
                "`{name}` is transparent but not closed ({edges} open edges): light that enters it may never leave; \
                 close it, or use a thin material"
            );
            self.reporter.warn(&file, line as usize, &kind, String::new)?;
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

    /// The scene and its report.
    pub(super) fn finish(self) -> Loaded {
        Loaded { scene: self.scene, report: self.reporter.finish() }
    }
}
