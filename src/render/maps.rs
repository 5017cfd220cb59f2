//! Capture of the environment maps of reflectors by the renderer itself.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::{Mat3, Vec3};

use super::options::{Options, Reflection};
use super::outcome::MapsReport;
use crate::image::Film;
use crate::optics::RefractionModel;
use crate::scene::{Camera, MapKind, Projection, Scene, Texture};
use crate::systems::maps::{Maps, ReflectorMap, Surroundings, Wanted, directions};
use crate::{Error, Result};

/// Directions per side of a cube's face along which the distance of the surroundings is measured.
const LOOKS: u32 = 16;

/// A renderer and its hierarchy, which capture maps.
pub(super) trait Taker {
    /// Renders a view in which camera rays pass through an object as if it were not there.
    fn picture(&self, view: &Scene, options: &Options) -> Result<Film>;

    /// Returns the distances of the closest hits on anything but an object along unit directions; infinite for a miss.
    fn distances(&self, from: Vec3, dirs: &[Vec3], object: u32) -> Vec<f32>;
}

/// Captured maps, and the time of their capture.
#[derive(Debug)]
pub(super) struct Taken {
    pub maps: Arc<Maps>,
    time: Duration,
}

impl Taken {
    /// Captures the maps for `options.reflection`, unless `options.maps` has them. Returns none if no maps are needed.
    ///
    /// # Errors
    /// - [`Error::Usage`] if `options.maps` are of the other kind.
    /// - Errors of the renderer.
    pub fn of(scene: &Scene, options: &Options, taker: &impl Taker) -> Result<Option<Self>> {
        let kind = match options.reflection {
            Reflection::CubeMap => MapKind::Cube,
            Reflection::SphereMap => MapKind::Sphere,
            _ => return Ok(None),
        };
        if let Some(maps) = &options.maps {
            if maps.kind == kind {
                return Ok(Some(Self { maps: maps.clone(), time: Duration::ZERO }));
            }
            return Err(Error::Usage(format!(
                "--reflection: the maps at hand are {} maps and not {} maps; take new ones",
                maps.kind.name(),
                kind.name()
            )));
        }
        let start = Instant::now();
        let maps = take(scene, kind, Maps::wanted(scene, kind), options, taker)?;
        Ok(Some(Self { maps: Arc::new(maps), time: start.elapsed() }))
    }

    /// Captures the maps for `options.refraction`. Returns none if it looks nothing up.
    ///
    /// # Errors
    /// - [`Error::Usage`] if there are bodies that bend light and none has a map.
    /// - Errors of the renderer.
    pub fn of_bodies(scene: &Scene, options: &Options, taker: &impl Taker) -> Result<Option<Self>> {
        if !options.bending().is_mapped() {
            return Ok(None);
        }
        let start = Instant::now();
        let wanted = Maps::wanted_by_bodies(scene);
        if let (true, Some((object, why))) = (wanted.0.is_empty(), wanted.1.first()) {
            return Err(Error::Usage(format!(
                "--refraction {}: `{}` {why}, and no other body has a map; take a bounded body of a medium without \
                 dispersion, or --refraction stable",
                options.refraction.name(),
                scene.objects[*object as usize].name
            )));
        }
        let maps = take(scene, MapKind::Cube, wanted, options, taker)?;
        Ok(Some(Self { maps: Arc::new(maps), time: start.elapsed() }))
    }

    /// Returns the report on the maps. `traced` is the number of reflections that had no map and were traced.
    pub fn report(&self, traced: u64) -> MapsReport {
        MapsReport { maps: self.maps.clone(), time: self.time, traced }
    }
}

fn take(
    scene: &Scene,
    kind: MapKind,
    (wanted, without): (Vec<Wanted>, Vec<(u32, &'static str)>),
    options: &Options,
    taker: &impl Taker,
) -> Result<Maps> {
    let refraction = match options.refraction {
        mapped if mapped.is_mapped() => RefractionModel::Stable,
        other => other,
    };
    let mut view = scene.clone();
    let looks = directions(LOOKS);
    let mut list = Vec::new();
    for Wanted { object, centre, size } in wanted {
        // The singular direction of a sphere map is then the one farthest from what the camera sees mirrored.
        let towards = (scene.camera.eye - centre).try_normalize().unwrap_or(Vec3::Z);
        let (target, up) = match kind {
            MapKind::Sphere => (centre - towards, scene.camera.up),
            MapKind::Cube | MapKind::LatLong => (centre + Vec3::NEG_Z, Vec3::Y),
        };
        let up = if up.cross(towards).length() < 1e-3 && kind == MapKind::Sphere {
            towards.any_orthonormal_vector()
        } else {
            up
        };
        view.camera = Camera { eye: centre, target, up, projection: Projection::Map(kind), medium: None };
        [view.settings.width, view.settings.height] = kind.shape(size);
        let reflection = Reflection::Traced;
        let options = Options { reflection, refraction, past: Some(object), maps: None, ..options.clone() };
        let film = taker.picture(&view, &options)?;
        let distances = taker.distances(centre, &looks, object);
        list.push(ReflectorMap {
            object,
            centre,
            frame: axes(&view.camera),
            picture: texture(&scene.objects[object as usize].name, film),
            surroundings: Surroundings::of(looks.iter().copied().zip(distances)),
        });
    }
    Ok(Maps::new(scene, kind, list, without))
}

/// Returns the rotation from the scene's axes to those of a camera's map: x right, y up, z backwards.
fn axes(camera: &Camera) -> Mat3 {
    let [right, up, forward] = camera.frame();
    Mat3::from_cols(right.as_vec3(), up.as_vec3(), -forward.as_vec3()).transpose()
}

fn texture(name: &str, film: Film) -> Texture {
    let pixels = film.pixels.into_iter().map(Vec3::from).collect::<Vec<_>>();
    Texture::new(name, film.width, film.height, pixels)
}
