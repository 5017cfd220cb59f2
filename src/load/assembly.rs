//! Assembly of a scene from the parts of its file.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::draft::Draft;
use super::extent::Extent;
use super::origin::{self, Frame, Loss};
use super::pictures::Pictures;
use super::report::{Hull, Reporter};
use super::smooth::{Rule, smooth};
use super::source::Root;
use super::transform::flip;
use super::winding::{InsideOut, inside_out};
use super::{LoadOptions, Loaded};
use crate::geometry::topology::{self, Edges, weld};
use crate::geometry::{Geometry, Shape};
use crate::scene::{Colour, Interface, Material, Medium, Object, Origin, Scene};
use crate::system::memory;
use crate::{Error, Result};

/// Number of inside-out objects above which they are not compared with all others.
const MOST_COMPARED: usize = 1000;

/// Scene under construction, with state shared by its parts.
pub(super) struct Assembly<'a> {
    pub(super) scene: Scene,
    pub(super) reporter: Reporter,
    pub(super) options: &'a LoadOptions,
    pub(super) root: Root,
    pub(super) pictures: Pictures,
    triangles: u64,
    /// Objects whose dielectric mesh is inside out on its own.
    inside_out: Vec<(usize, InsideOut)>,
    /// Shapes in world coordinates.
    pending: Vec<Pending>,
    /// Materials with a checker, with its corner in world coordinates and the edge of its cubes.
    checkers: Vec<(usize, DVec3, f64)>,
}

/// Shape that waits for the scene's origin.
pub(super) struct Pending {
    pub name: String,
    pub draft: Draft,
    /// Index into `Scene::materials`.
    pub material: u32,
    pub origin: Origin,
    /// Largest angle in degrees between faces without normals that are shaded smoothly.
    pub smooth: Option<f64>,
    /// True if the shape is to be turned inside out.
    pub flip: bool,
}

impl<'a> Assembly<'a> {
    /// Creates an empty scene for the file `path`, surrounded by air.
    pub(super) fn new(path: &Path, options: &'a LoadOptions) -> Result<Self> {
        // Checked first, so that an error for a missing scene names the scene and not its folder.
        std::fs::metadata(path).map_err(|e| Error::io(path, "read", e))?;
        let folder = options.root.as_deref().unwrap_or_else(|| super::source::folder_of(path));
        let mut root = Root::new(folder)?;
        options.allow_outside.iter().try_for_each(|folder| root.allow(folder))?;
        Ok(Self {
            scene: Scene { media: vec![Medium::air()], ..Scene::default() },
            reporter: Reporter::new(options.strict),
            options,
            root,
            pictures: Pictures::default(),
            triangles: 0,
            inside_out: Vec::new(),
            pending: Vec::new(),
            checkers: Vec::new(),
        })
    }

    /// Adds a medium and returns its index.
    pub(super) fn add_medium(&mut self, medium: Medium) -> u32 {
        self.scene.media.push(medium);
        self.scene.media.len() as u32 - 1
    }

    /// Adds a material and returns its index.
    pub(super) fn add_material(&mut self, material: Material) -> Result<u32> {
        if self.scene.materials.len() >= self.options.limits.objects {
            return Err(Error::Limit(format!(
                "the scene has more than {} materials; leave out those that nothing uses",
                self.options.limits.objects
            )));
        }
        self.scene.materials.push(material);
        Ok(self.scene.materials.len() as u32 - 1)
    }

    /// Reserves `count` more triangles.
    ///
    /// # Errors
    /// Returns [`Error::Limit`] if the scene gets too many.
    pub(super) fn take_triangles(&mut self, count: u64) -> Result<()> {
        self.triangles = self.triangles.saturating_add(count);
        let limit = self.options.limits.triangles;
        if self.triangles > limit {
            return Err(Error::Limit(format!(
                "the scene has more than {limit} triangles; take coarser models or shapes"
            )));
        }
        Ok(())
    }

    /// Records that the next material has a checker with this corner and edge.
    pub(super) fn add_checker(&mut self, corner: DVec3, size: f64) {
        self.checkers.push((self.scene.materials.len(), corner, size));
    }

    /// Adds a shape, which becomes part of the scene in [`Self::settle`].
    pub(super) fn add(&mut self, shape: Pending) -> Result<()> {
        if self.pending.len() >= self.options.limits.objects {
            return Err(Error::Limit(format!(
                "the scene has more than {} shapes; join them into fewer models",
                self.options.limits.objects
            )));
        }
        self.pending.push(shape);
        Ok(())
    }

    /// Chooses the scene's origin and moves all shapes relative to it. `sight` is the camera's eye and target, which
    /// decide if all shapes are planes. Without it the scene is a single model, whose unit may be changed.
    pub(super) fn settle(&mut self, sight: Option<[DVec3; 2]>) -> Result<Frame> {
        let shapes = std::mem::take(&mut self.pending);
        let mut extents: Vec<Extent> = shapes.iter().map(|s| s.draft.extent()).collect();
        if let (Some([eye, target]), true) = (sight, extents.iter().all(Extent::is_empty)) {
            let feet = shapes.iter().filter_map(|s| match &s.draft {
                Draft::Flat(plane) => Some(plane.foot(eye)),
                Draft::Mesh(_) | Draft::Ball(_) => None,
            });
            extents.push(Extent::around(feet.chain([eye, target])));
        }
        let unit_exponent = if sight.is_none() { origin::unit_exponent(&extents) } else { 0 };
        let bulks: Vec<Extent> = shapes.iter().map(|s| s.draft.bulk()).collect();
        let frame = Frame { origin: origin::choose(&extents, &bulks), unit_exponent };
        (self.scene.origin, self.scene.unit_exponent) = (frame.origin, unit_exponent);
        if unit_exponent != 0 {
            self.scene.media.iter_mut().for_each(|m| m.absorption *= frame.unit() as f32);
        }
        self.warn_of_losses(&shapes, &bulks, frame)?;
        for &(material, corner, size) in &self.checkers {
            if let Some(Colour::Checker { offset, .. }) = self.scene.materials.get_mut(material).map(|m| &mut m.diffuse)
            {
                // A single model has no checker, so the unit is the world's.
                *offset = frame.checker_corner(corner, size).as_vec3();
            }
        }
        for Pending { name, mut draft, material, origin, smooth: crease, flip: flipped } in shapes {
            let groups =
                if let Draft::Mesh(mesh) = &mut draft { std::mem::take(&mut mesh.smoothing) } else { Vec::new() };
            let mut shape = draft.settle(frame);
            if let Shape::Mesh(mesh) = &mut shape {
                match crease {
                    _ if !mesh.normals.is_empty() => {}
                    Some(crease) => smooth(mesh, Rule::Crease(crease))?,
                    None if !groups.is_empty() => smooth(mesh, Rule::Groups(&groups))?,
                    None => {}
                }
                if flipped {
                    flip(mesh);
                }
            }
            self.place(name, shape, material, origin)?;
        }
        Ok(frame)
    }

    /// Warns about shapes that lose too much of their size to rounding, the worst first.
    fn warn_of_losses(&mut self, shapes: &[Pending], bulks: &[Extent], frame: Frame) -> Result<()> {
        let losses = shapes.iter().zip(bulks).filter_map(|(s, e)| Some((s, Loss::of(e, frame)?)));
        let mut large: Vec<(&Pending, Loss)> = losses.filter(|(_, loss)| loss.is_large()).collect();
        large.sort_by(|a, b| b.1.share().total_cmp(&a.1.share()));
        for (shape, loss) in large {
            let (file, line) = (PathBuf::from(&shape.origin.file), shape.origin.line as usize);
            let kind = if loss.as_read {
                "a shape lies too far from 0 for 64-bit coordinates; move it nearer"
            } else {
                "shapes lie too far apart for 32-bit coordinates; make scenes of their own of them"
            };
            self.reporter.warn(&file, line, kind, || {
                format!(
                    ": `{}`, {} across, lies {} from the scene's origin, where coordinates are rounded by up to {} \
                     ({} % of its size)",
                    shape.name,
                    few_digits(loss.size),
                    few_digits(loss.reach),
                    few_digits(loss.rounding),
                    few_digits(loss.share() * 100.0)
                )
            })?;
        }
        Ok(())
    }

    /// Adds a shape to the scene, and warns if its material needs data that the shape lacks.
    fn place(&mut self, name: String, shape: Shape, material: u32, origin: Origin) -> Result<()> {
        let surface = &self.scene.materials[material as usize];
        let mask = surface.mask();
        let dielectric = matches!(surface.interface, Interface::Dielectric { .. });
        let pictured = matches!(surface.diffuse, Colour::Image { .. });
        let file = PathBuf::from(&origin.file);
        if let (Shape::Mesh(mesh), true) = (&shape, dielectric) {
            let object = self.scene.objects.len();
            let what = format!("the edges of `{name}`");
            memory::need(&what, topology::bytes(mesh), "take fewer triangles")?;
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

    /// Decides which closed dielectrics are inside out, once the whole scene is known.
    fn settle_hulls(&mut self) {
        let found = std::mem::take(&mut self.inside_out);
        let turned: HashSet<usize> = found.iter().map(|&(object, _)| object).collect();
        for &(object, InsideOut { parts, of }) in &found {
            if found.len() > MOST_COMPARED || !self.is_hollow(object, &turned) {
                self.reporter.hull(object, Hull::InsideOut { parts, of });
            }
        }
    }

    /// Returns true if an object lies within another one of the same medium. It is then the wall of a hollow, and its
    /// faces rightly point inwards. Objects in `turned` do not count as the other one.
    fn is_hollow(&self, object: usize, turned: &HashSet<usize>) -> bool {
        let medium = |o: usize| self.scene.medium_of(o).map(|m| &self.scene.media[m as usize]);
        let bounds = |o: usize| match &self.scene.geometry[o].shape {
            Shape::Mesh(mesh) => Some(mesh.bounds()),
            Shape::Sphere(sphere) => Some(sphere.bounds()),
            Shape::Plane(_) => None,
        };
        let (Some(inner), Some(hollow)) = (medium(object), bounds(object)) else { return false };
        let same = |m: &Medium| m.is_like(inner);
        (0..self.scene.objects.len()).any(|o| {
            !turned.contains(&o)
                && medium(o).is_some_and(same)
                && bounds(o).is_some_and(|outer| outer.contains(&hollow))
        })
    }

    /// Returns the scene and its report.
    pub(super) fn finish(mut self) -> Loaded {
        self.settle_hulls();
        Loaded { scene: self.scene, report: self.reporter.finish() }
    }
}

/// Formats a number with three digits.
fn few_digits(x: f64) -> String {
    if x == 0.0 || (1e-3..1e5).contains(&x.abs()) {
        let places = (2 - x.abs().max(1e-3).log10().floor() as i32).max(0) as usize;
        let text = format!("{x:.places$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{x:.2e}")
    }
}
