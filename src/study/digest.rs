//! Digest of a study, which decides if a journal can be continued.

use std::fs::File;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::io::Read as _;

use super::subject::Subject;
use crate::geometry::{Shape, TriMesh};
use crate::scene::Scene;

/// Computes the digest of the scene, the default choices, the requested size, the threads, the program and the machine.
/// Axes and time limit are not part of it, since measurements also serve other values of these.
#[must_use]
pub fn of(subject: &Subject) -> String {
    let mut hasher = DefaultHasher::new();
    scene(subject.scene, &mut hasher);
    format!("{:?}", subject.default).hash(&mut hasher);
    (subject.size, subject.threads, &subject.machine.cpu, subject.machine.processors).hash(&mut hasher);
    subject.machine.embree.as_ref().map(|e| (&e.version, &e.file)).hash(&mut hasher);
    (subject.machine.vitrum, subject.machine.simd).hash(&mut hasher);
    program().hash(&mut hasher);
    format!("{:016x}", hasher.finish())
}

/// Hashes the program's own bytes, since its version does not identify a build.
fn program() -> u64 {
    let mut hasher = DefaultHasher::new();
    // In pieces, since a build with debug information has a hundred megabytes. One that cannot be read counts as empty.
    let _ = std::env::current_exe().and_then(File::open).and_then(|mut file| {
        let mut piece = [0; 16 << 10];
        loop {
            match file.read(&mut piece)? {
                0 => return Ok(()),
                n => hasher.write(&piece[..n]),
            }
        }
    });
    hasher.finish()
}

fn scene(scene: &Scene, hasher: &mut DefaultHasher) {
    for geometry in &scene.geometry {
        geometry.mask.hash(hasher);
        match &geometry.shape {
            Shape::Mesh(m) => mesh(m, hasher),
            other => format!("{other:?}").hash(hasher),
        }
    }
    let materials: Vec<u32> = scene.objects.iter().map(|o| o.material).collect();
    materials.hash(hasher);
    for texture in &scene.textures {
        (texture.width, texture.height, texture.wrap).hash(hasher);
        texture.pixels.iter().for_each(|p| p.to_array().map(f32::to_bits).hash(hasher));
    }
    // Plain data of a few lines each.
    let plain = format!(
        "{:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {}",
        scene.materials,
        scene.media,
        scene.lights,
        scene.environment,
        scene.ambient,
        scene.camera,
        scene.settings,
        scene.origin,
        scene.unit_exponent
    );
    plain.hash(hasher);
}

fn mesh(mesh: &TriMesh, hasher: &mut DefaultHasher) {
    for list in [&mesh.positions, &mesh.normals, &mesh.colours] {
        list.iter().for_each(|p| p.to_array().map(f32::to_bits).hash(hasher));
    }
    mesh.uvs.iter().for_each(|p| p.to_array().map(f32::to_bits).hash(hasher));
    (&mesh.triangles, &mesh.normal_indices, &mesh.uv_indices).hash(hasher);
}
