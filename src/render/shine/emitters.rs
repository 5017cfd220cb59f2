//! Light of emissive shapes and sampled lamps: a triangle of a mesh, a sphere or a lamp is picked, and a point on it.
//!
//! A point of a sphere is picked by solid angle, as on a spherical lamp, and one of a triangle by area. A triangle that is
//! large as seen from the shaded point is first divided into quarters, of which one is picked like a child of the tree.

use glam::DVec3;

use super::tree::{Bounds, Tree, choose};
use crate::geometry::topology::{Edges, weld};
use crate::geometry::{Shape, TriMesh};
use crate::math::{Real, Vector3, gamma};
use crate::optics::{Boundary, Exact, FresnelFormula};
use crate::render::extent::{Ball, Extent};
use crate::render::light::within_cone;
use crate::scene::{Interface, Light, LightKind, Rgb, Scene, Texture};

/// Largest number of times that a triangle is divided into quarters.
const MOST_DIVISIONS: u32 = 8;

/// Radiance of an emitter by angle.
#[derive(Clone, Copy, Debug)]
struct Radiance {
    /// Radiance along the normal, or everywhere without a coat; the intensity of a lamp.
    colour: Rgb,
    /// Refractive index of a clear coat relative to what surrounds the scene.
    coat: Option<f64>,
}

#[derive(Clone, Copy, Debug)]
enum Place {
    Triangle { corners: [DVec3; 3] },
    Sphere { centre: DVec3, radius: f64 },
    Lamp { position: DVec3, cone: Option<Cone> },
}

/// Cone of a spot lamp.
#[derive(Clone, Copy, Debug)]
struct Cone {
    axis: DVec3,
    cos_inner: f64,
    cos_outer: f64,
}

/// Emissive sphere, triangle of an emissive mesh, or lamp.
#[derive(Clone, Copy, Debug)]
struct Emitter {
    place: Place,
    bounds: Bounds,
    /// Index into the list of radiances.
    radiance: u32,
}

/// Light from a sampled point of an emitter.
#[derive(Clone, Copy, Debug)]
pub struct Glint<R> {
    /// Unit direction to the point.
    pub dir: Vector3<R>,
    /// Distance to the point, less what keeps the shadow ray from hitting the emitter itself.
    pub distance: R,
    /// Radiance times the solid angle that the point stands for, if it were the only one.
    pub light: Vector3<R>,
}

/// All emissive shapes of a scene that light surfaces, and its sampled lamps.
#[derive(Debug)]
pub struct Emitters {
    emitters: Vec<Emitter>,
    radiances: Vec<Radiance>,
    tree: Tree,
}

impl Emitters {
    /// Collects the shapes and lamps that light surfaces by samples. Returns `None` if there are none.
    #[must_use]
    pub fn of(scene: &Scene) -> Option<Self> {
        let (mut emitters, mut radiances) = (Vec::new(), Vec::new());
        let admitted = scene.admitted().emissive;
        for object in (0..scene.objects.len()).filter(|&o| admitted && scene.can_light(o)) {
            let radiance = radiance(scene, object);
            let number = radiances.len() as u32;
            radiances.push(radiance);
            let bright = f64::from(radiance.colour.abs().max_element());
            match &scene.geometry[object].shape {
                Shape::Sphere(sphere) if sphere.is_usable() => {
                    let (centre, radius) = (sphere.centre.as_dvec3(), f64::from(sphere.radius));
                    let power = bright * 4.0 * std::f64::consts::PI * radius * radius;
                    // The side that a point sees has a quarter of the area as its projection.
                    let bounds =
                        Bounds { centre, radius, power: 0.25 * power, axis: DVec3::ZERO, cos_cone: -1.0, hull: None };
                    emitters.push(Emitter { place: Place::Sphere { centre, radius }, bounds, radiance: number });
                }
                Shape::Mesh(mesh) => triangles(scene, object, mesh, bright, number, &mut emitters),
                Shape::Sphere(_) | Shape::Plane(_) => {}
            }
        }
        for light in scene.lights.iter().filter(|light| scene.is_sampled(light)) {
            emitters.extend(lamp(light, radiances.len() as u32));
            radiances.push(Radiance { colour: light.intensity, coat: None });
        }
        let bounds: Vec<Bounds> = emitters.iter().map(|e| e.bounds).collect();
        (!bounds.is_empty()).then(|| Self { tree: Tree::new(&bounds), emitters, radiances })
    }

    /// Returns the light from the sample `at` of the unit cube that arrives, unoccluded, at a point with a unit normal.
    /// Returns `None` if none does.
    #[must_use]
    pub fn sample<R: Real<Mask = bool>>(
        &self,
        from: Vector3<R>,
        seen: (DVec3, DVec3),
        at: [f32; 3],
    ) -> Option<Glint<R>> {
        let (point, normal) = seen;
        let mut left = f64::from(at[2]);
        let (picked, probability) = self.tree.pick(point, normal, &mut left)?;
        let Emitter { place, bounds, radiance } = &self.emitters[picked as usize];
        let across = [at[0], at[1]].map(|x| R::splat(f64::from(x)));
        let spot = match *place {
            Place::Sphere { centre, radius } => on_sphere(from, centre, radius, across),
            Place::Lamp { position, cone } => at_lamp(from, position, cone),
            Place::Triangle { corners } => {
                let (corners, share) = near_part(corners, bounds, point, normal, &mut left)?;
                let spot = on_triangle(from, corners, bounds.shows_fronts(point), across)?;
                Spot { solid: spot.solid * R::splat(1.0 / share), ..spot }
            }
        };
        if !(spot.solid.gt(R::zero())) {
            return None;
        }
        let Radiance { colour, coat } = self.radiances[*radiance as usize];
        let passing = coat.map_or(R::one(), |ior| {
            let boundary = Boundary::<R>::new(1.0, ior);
            R::one() - Exact::dielectric(&boundary, &boundary.cross(spot.cos))
        });
        let solid = spot.solid * passing * R::splat(1.0 / probability);
        let scaled = |channel: f32| R::splat(f64::from(channel)) * solid;
        let light = Vector3::new(scaled(colour.x), scaled(colour.y), scaled(colour.z));
        Some(Glint { dir: spot.dir, distance: spot.distance, light })
    }
}

/// Sampled point of an emitter.
struct Spot<R> {
    dir: Vector3<R>,
    distance: R,
    /// Cosine of the angle to the emitter's normal.
    cos: R,
    /// Solid angle that the point stands for. Not above 0 if it sends nothing.
    solid: R,
}

fn lamp(light: &Light, radiance: u32) -> Option<Emitter> {
    let (position, cone) = match light.kind {
        LightKind::Point { position } => (position, None),
        LightKind::Spot { position, direction, cos_inner, cos_outer } => {
            let axis = direction.as_dvec3().normalize();
            (position, Some(Cone { axis, cos_inner: f64::from(cos_inner), cos_outer: f64::from(cos_outer) }))
        }
        _ => return None,
    };
    let (centre, power) = (position.as_dvec3(), f64::from(light.intensity.abs().max_element()));
    let bounds = Bounds { centre, radius: 0.0, power, axis: DVec3::ZERO, cos_cone: -1.0, hull: None };
    Some(Emitter { place: Place::Lamp { position: centre, cone }, bounds, radiance })
}

fn at_lamp<R: Real<Mask = bool>>(from: Vector3<R>, position: DVec3, cone: Option<Cone>) -> Spot<R> {
    let way = vector(position) - from;
    let squared = way.length_squared();
    let distance = squared.sqrt();
    let dir = way * (R::one() / distance);
    let share = cone.map_or(R::one(), |cone| {
        let [inner, outer] = [cone.cos_inner, cone.cos_outer].map(R::splat);
        within_cone(-dir.dot(vector(cone.axis)), inner, outer)
    });
    Spot { dir, distance, cos: R::one(), solid: share / squared }
}

fn vector<R: Real>(v: DVec3) -> Vector3<R> {
    Vector3::new(R::splat(v.x), R::splat(v.y), R::splat(v.z))
}

fn radiance(scene: &Scene, object: usize) -> Radiance {
    let material = &scene.materials[scene.objects[object].material as usize];
    let share = match material.interface {
        Interface::Alpha { opacity, mask } => {
            opacity * mask.map_or(1.0, |mask| mean_red(&scene.textures[mask as usize]))
        }
        _ => 1.0,
    };
    let coat = match material.interface {
        Interface::Coated { ior } => Some(f64::from(ior) / scene.media[0].ior),
        _ => None,
    };
    Radiance { colour: material.emission * share, coat }
}

/// Returns the mean of a picture's red channel.
fn mean_red(picture: &Texture) -> f32 {
    let sum: f64 = picture.pixels.iter().map(|texel| f64::from(texel.x)).sum();
    (sum / picture.pixels.len().max(1) as f64) as f32
}

fn triangles(scene: &Scene, object: usize, mesh: &TriMesh, bright: f64, radiance: u32, emitters: &mut Vec<Emitter>) {
    let material = &scene.materials[scene.objects[object].material as usize];
    let outwards = if material.is_transmissive() { None } else { outward_sign(mesh) };
    let hull = outwards.map(|_| mesh.bounds());
    for i in (0..mesh.triangles.len()).filter(|&i| mesh.is_usable(i)) {
        let corners = mesh.corners(i).map(|p| p.as_dvec3());
        let [a, b, c] = if outwards == Some(false) { [corners[0], corners[2], corners[1]] } else { corners };
        let across = (b - a).cross(c - a);
        let twice = across.length();
        if !(twice > 0.0 && twice.is_finite()) {
            continue;
        }
        let (centre, radius) = around([a, b, c]);
        let bounds = Bounds { centre, radius, power: bright * 0.5 * twice, axis: across / twice, cos_cone: 1.0, hull };
        emitters.push(Emitter { place: Place::Triangle { corners: [a, b, c] }, bounds, radiance });
    }
}

/// Returns true for a closed mesh whose triangles face outwards, false if they face inwards, and `None` if it is open.
fn outward_sign(mesh: &TriMesh) -> Option<bool> {
    let closed = (0..mesh.triangles.len()).all(|i| mesh.is_usable(i))
        && Edges::new(&mesh.triangles, &weld(&mesh.positions)).manifold();
    let six_volumes = || -> f64 {
        let middle = mesh.bounds().centre().as_dvec3();
        let of = |i| {
            let [a, b, c] = mesh.corners(i).map(|p| p.as_dvec3() - middle);
            a.dot(b.cross(c))
        };
        (0..mesh.triangles.len()).map(of).sum()
    };
    (closed && !mesh.triangles.is_empty()).then(|| six_volumes() > 0.0)
}

/// Returns centre and radius of a ball around a triangle.
fn around(corners: [DVec3; 3]) -> (DVec3, f64) {
    let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
    (centre, corners.iter().map(|p| p.distance(centre)).fold(0.0, f64::max))
}

/// Returns the part of a triangle to sample, which is small as seen from `from`, and the probability of having chosen it.
fn near_part(
    mut corners: [DVec3; 3],
    bounds: &Bounds,
    from: DVec3,
    normal: DVec3,
    at: &mut f64,
) -> Option<([DVec3; 3], f64)> {
    let mut probability = 1.0;
    for _ in 0..MOST_DIVISIONS {
        let (centre, radius) = around(corners);
        if centre.distance(from) > 2.0 * radius {
            break;
        }
        let [a, b, c] = corners;
        let [ab, bc, ca] = [(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5];
        let quarters = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
        let light = quarters.map(|quarter| {
            let (centre, radius) = around(quarter);
            Bounds { centre, radius, ..*bounds }.importance(from, normal)
        });
        let (chosen, share) = choose(&light, at)?;
        corners = quarters[chosen];
        probability *= share;
    }
    Some((corners, probability))
}

fn on_triangle<R: Real<Mask = bool>>(
    from: Vector3<R>,
    corners: [DVec3; 3],
    fronts: bool,
    at: [R; 2],
) -> Option<Spot<R>> {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a);
    let area = 0.5 * normal.length();
    // Halves of the square are folded onto the triangle, so that neighbours stay neighbours (Heitz 2019, "A Low-Distortion
    // Map Between Triangle and Square").
    let half = R::splat(0.5);
    let (u, v) =
        if at[1].gt(at[0]) { (at[0] * half, at[1] - at[0] * half) } else { (at[0] - at[1] * half, at[1] * half) };
    let point = vector(c - a).fma(v, vector(b - a).fma(u, vector(a)));
    let way = point - from;
    let squared = way.length_squared();
    let distance = squared.sqrt();
    let dir = way * (R::one() / distance);
    let facing = -dir.dot(vector(normal / (2.0 * area)));
    if fronts && !facing.gt(R::zero()) {
        return None;
    }
    let cos = facing.abs();
    let solid = R::splat(area) * cos / squared;
    Some(Spot { dir, distance: short_of(from, dir, distance, cos, distance), cos, solid })
}

fn on_sphere<R: Real<Mask = bool>>(from: Vector3<R>, centre: DVec3, radius: f64, at: [R; 2]) -> Spot<R> {
    let middle = vector(centre);
    let size = R::splat(radius);
    let way = middle - from;
    let squared = way.length_squared();
    if squared.gt(size * size) {
        let ball = Ball { centre: middle, radius: size };
        let seen = ball.point::<true>(from, at);
        // The share is that of the intensity, which is the radiance times the disc.
        let solid = seen.share * R::splat(std::f64::consts::PI) * size * size;
        let out = seen.dir.fma(seen.distance, from) - middle;
        let cos = (-(out.dot(seen.dir)) / size).max(R::zero()).min(R::one());
        return Spot { distance: short_of(from, seen.dir, seen.distance, cos, size), dir: seen.dir, cos, solid };
    }
    // From inside all directions see the sphere.
    let (one, two) = (R::one(), R::splat(2.0));
    let z = one - two * at[0];
    // The angle around is twice one of at most a quarter turn, for which sine and cosine are exact in `f32`, too.
    let (s, c) = (R::splat(std::f64::consts::PI) * (at[1] - R::splat(0.5))).sin_cos();
    let (sin, cos) = (two * s * c, (c - s) * (c + s));
    let level = (one - z * z).safe_sqrt();
    let dir = Vector3::new(level * cos, level * sin, z);
    let along = way.dot(dir);
    let distance = along + (along * along + (size * size - squared)).safe_sqrt();
    let out = dir.fma(distance, from) - middle;
    let cos = (out.dot(dir) / size).max(R::zero()).min(R::one());
    let solid = R::splat(4.0 * std::f64::consts::PI);
    Spot { distance: short_of(from, dir, distance, cos, size), dir, cos, solid }
}

/// Returns the length of a shadow ray to an emitter that it meets at an angle of cosine `cos`, shortened so that rounding
/// does not make it hit the emitter. [`crate::render::lamp::before_lamp`] does this for cosines from a quarter up. Below, the
/// error of a place along the ray grows by one over the cosine, and on a curved surface of size `size` up to the root of the
/// error.
fn short_of<R: Real<Mask = bool>>(from: Vector3<R>, dir: Vector3<R>, distance: R, cos: R, size: R) -> R {
    let there = dir.fma(distance, from);
    let most = from.abs().max_component().max(there.abs().max_component());
    let error = (distance + most) * R::splat(f64::from(gamma(32)));
    let steep = error * R::splat(0.25) / cos.max(R::splat(1e-6));
    let curved = (error * size).sqrt();
    let less = steep.min(curved).min(distance * R::splat(0.01));
    if cos.lt(R::splat(0.25)) { distance - less } else { distance }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Sphere;
    use crate::scene::Material;

    fn shining(shape: impl Into<Shape>) -> Emitters {
        let mut scene = Scene::default();
        let material = scene.add_material(Material { emission: Rgb::new(2.0, 1.0, 0.5), ..Material::black("lamp") });
        scene.add_object("lamp", shape, material);
        Emitters::of(&scene).expect("it shines")
    }

    /// A grid of places, each with numbers that pick emitters; as many numbers as places, for the shares of many small ones.
    fn cube_samples(n: u32) -> impl Iterator<Item = [f32; 3]> {
        let middle = move |k: u32| (k as f32 + 0.5) / n as f32;
        let picks = |i: u32| (f64::from(i) * 0.618_033_988_749_894_9).fract() as f32;
        (0..n * n * n).map(move |i| [middle(i % n), middle(i / n % n), picks(i)])
    }

    /// Mean irradiance on a point with normal +y, by samples of the cube.
    fn irradiance(emitters: &Emitters, from: DVec3, n: u32) -> f64 {
        let sum: f64 = cube_samples(n)
            .filter_map(|at| emitters.sample::<f64>(from.into(), (from, DVec3::Y), at))
            .map(|glint| glint.light.y * glint.dir.y.max(0.0))
            .sum();
        sum / f64::from(n).powi(3)
    }

    #[test]
    fn a_sphere_lights_as_its_configuration_factor_says() {
        let sphere = shining(Sphere { centre: glam::Vec3::new(0.0, 3.0, 0.0), radius: 1.0 });
        for from in [DVec3::ZERO, DVec3::new(0.0, 1.0, 0.0), DVec3::new(2.0, 0.0, 1.0)] {
            let way = DVec3::new(0.0, 3.0, 0.0) - from;
            // Wholly above the horizon: pi (r / d)^2 cos.
            let want = std::f64::consts::PI / way.length_squared() * way.normalize().y;
            let got = irradiance(&sphere, from, 24);
            assert!((got / want - 1.0).abs() < 1e-3, "{from}: {got} {want}");
        }
        let inside =
            irradiance(&shining(Sphere { centre: glam::Vec3::ZERO, radius: 2.0 }), DVec3::new(0.5, 0.3, 0.1), 48);
        assert!((inside / std::f64::consts::PI - 1.0).abs() < 5e-3, "pi times the radiance: {inside}");
    }

    #[test]
    fn a_rectangle_lights_as_its_configuration_factor_says_from_far_and_from_near() {
        for h in [8.0, 1.5, 0.2] {
            let (a, b) = (2.0_f64, 3.0);
            let corner = |x: f64, z: f64| DVec3::new(x, h, z).as_vec3();
            let mesh = TriMesh::new(
                vec![corner(0.0, 0.0), corner(a, 0.0), corner(a, b), corner(0.0, b)],
                vec![[0, 1, 2], [0, 2, 3]],
            );
            // Howell's C-10: a rectangle above a point below its corner.
            let (x, y) = (a / h, b / h);
            let side = |p: f64, q: f64| p / (1.0 + p * p).sqrt() * (q / (1.0 + p * p).sqrt()).atan();
            let want = 0.5 * (side(x, y) + side(y, x));
            let got = irradiance(&shining(mesh), DVec3::ZERO, 40);
            assert!((got / want - 1.0).abs() < 5e-3, "{h}: {got} {want}");
        }
    }

    #[test]
    fn a_closed_mesh_sends_nothing_from_the_backs_of_its_faces() {
        let corner = |k: usize| glam::Vec3::new((k & 1) as f32, 2.0 + (k >> 1 & 1) as f32, (k >> 2) as f32);
        let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let triangles = quads.iter().flat_map(|q: &[u32; 4]| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
        let positions: Vec<_> = (0..8).map(corner).collect();
        let outwards = TriMesh::new(positions, triangles);
        let inwards =
            TriMesh { triangles: outwards.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(), ..outwards.clone() };
        let from = DVec3::new(0.5, 0.0, 0.5);
        for mesh in [outwards, inwards] {
            let emitters = shining(mesh);
            let below: Vec<_> =
                cube_samples(8).filter_map(|at| emitters.sample::<f64>(from.into(), (from, DVec3::Y), at)).collect();
            assert!(!below.is_empty());
            for glint in below {
                let there = glint.dir.fma(glint.distance, from.into());
                assert!((there.y - 2.0).abs() < 1e-4, "the lower face alone: {there:?}");
            }
        }
    }
}
