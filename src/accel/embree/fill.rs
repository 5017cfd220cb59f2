//! Transfer of shapes into Embree's scenes.

use glam::Vec4;
use rayon::prelude::*;

use super::options::{Options, Spheres};
use super::scene::SceneBuilder;
use super::sphere::SphereGroup;
use crate::accel::BuildStats;
use crate::error::Result;
use crate::geometry::{Geometry, GeometryMask, Shape, TriMesh};

/// Geometry id of Embree whose primitives have other ids in hits.
pub struct Renamed {
    pub id: u32,
    /// (geometry, primitive) for each of Embree's primitives.
    pub names: Vec<(u32, u32)>,
}

/// Counts and names collected while scenes are filled.
pub struct Filling<'a> {
    pub options: &'a Options,
    pub stats: BuildStats,
    pub renamed: Vec<Renamed>,
    /// Bytes of coordinates and indices copied to Embree.
    pub copied: usize,
}

impl Filling<'_> {
    /// Adds the shapes with mask `kind` to `scene`, all spheres together as geometry `group`.
    pub fn fill(
        &mut self,
        scene: &mut SceneBuilder,
        geometry: &[Geometry],
        kind: GeometryMask,
        group: u32,
    ) -> Result<()> {
        let mut spheres = Vec::new();
        for (id, g) in (0_u32..).zip(geometry).filter(|(_, g)| g.mask == kind) {
            match &g.shape {
                Shape::Mesh(mesh) => self.mesh(scene, id, kind, mesh)?,
                Shape::Sphere(sphere) if sphere.is_usable() => spheres.push((*sphere, id)),
                Shape::Sphere(_) => self.stats.dropped += 1,
                Shape::Plane(_) => {}
            }
        }
        self.stats.spheres += spheres.len();
        if spheres.is_empty() {
            return Ok(());
        }
        match self.options.spheres {
            Spheres::Native => scene.user(group, kind.0.into(), SphereGroup::new(spheres, self.options.mode)),
            Spheres::Points => {
                let points: Vec<Vec4> = spheres.iter().map(|(s, _)| s.centre.extend(s.radius)).collect();
                self.copied += size_of_val(points.as_slice());
                self.renamed.push(Renamed { id: group, names: spheres.iter().map(|&(_, id)| (id, 0)).collect() });
                scene.sphere_points(group, kind.0.into(), &points)
            }
        }
    }

    /// Adds the usable triangles of `mesh` to `scene`.
    fn mesh(&mut self, scene: &mut SceneBuilder, id: u32, kind: GeometryMask, mesh: &TriMesh) -> Result<()> {
        let all = mesh.triangles.len();
        let usable = (0..all).into_par_iter().filter(|&i| mesh.is_usable(i)).map(|i| i as u32);
        let count = usable.clone().count();
        self.stats.triangles += count;
        self.stats.dropped += all - count;
        if count == 0 {
            return Ok(());
        }
        self.copied += size_of_val(mesh.positions.as_slice()) + count * size_of::<[u32; 3]>();
        if count == all {
            return scene.triangles(id, kind.0.into(), &mesh.positions, &mesh.triangles);
        }
        let usable: Vec<u32> = usable.collect();
        let triangles: Vec<[u32; 3]> = usable.iter().map(|&i| mesh.triangles[i as usize]).collect();
        scene.triangles(id, kind.0.into(), &mesh.positions, &triangles)?;
        self.renamed.push(Renamed { id, names: usable.into_iter().map(|i| (id, i)).collect() });
        Ok(())
    }
}
