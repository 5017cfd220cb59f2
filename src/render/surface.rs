//! Surface points: eight hits with their normals, and offsets for the origins of new rays.

use glam::{Vec2, Vec3};

use super::lookup::on_surface;
use super::media::StackId;
use super::queue::{Chunk, Rgb8, Spawn8};
use super::relief::embossed;
use crate::geometry::{GeometryMask, Hit, Hit8, Shape, Spot};
use crate::math::{LaneMask, Real};
use crate::optics::consistent_normal;
use crate::scene::{Interface, Scene};
use crate::simd::{F32x8, Mask8, Vec3x8};

/// Eight surface points that rays hit. Lanes that are not `active` repeat an active one.
#[derive(Clone, Debug)]
pub struct Surface8 {
    /// Lanes in use.
    pub active: u8,
    /// Unit directions of the arriving rays.
    pub incident: Vec3x8,
    /// Surface points, accurate to within `reach`.
    pub point: Vec3x8,
    /// Unit geometric normals, on the side of arrival.
    pub normal: Vec3x8,
    /// Unit shading normals, on the side of arrival; the geometric ones where nothing is interpolated.
    pub shading: Vec3x8,
    /// Lanes whose shading normal is interpolated.
    pub interpolated: Mask8,
    /// Offset along the geometric normal, in scene units, at which a new ray cannot hit the surface it leaves.
    pub reach: F32x8,
    /// Lanes whose ray arrived from outside.
    pub front: Mask8,
    /// Hits.
    pub hit: [Hit; 8],
    /// Indices of the materials.
    pub material: [u32; 8],
    /// Throughputs of the rays, including absorption on the way here.
    pub weight: Rgb8,
    /// Indices of the pixels within the tile.
    pub pixel: [u32; 8],
    /// Media through which the rays arrived.
    pub stack: [StackId; 8],
    /// Numbers of consecutive surfaces passed.
    pub passes: [u32; 8],
    /// Initial `passes` of rays that continue behind the surface ([`super::queue::State8::passes`]): 0 unless surfaces
    /// touch here.
    pub onward: [u32; 8],
    /// Initial `passes` of rays that leave on the side of arrival.
    pub returning: [u32; 8],
    /// Index in the current stream, if rays carry extras or surfaces touch; else 0.
    pub place: u32,
    /// Lanes whose base is shaded: all active ones, except where the split stage passes the surface.
    pub base_lanes: u8,
    /// Throughputs of the bases: those of the rays, unless the split stage reduces them.
    pub base_weight: Rgb8,
}

/// Index of a hit in a chunk: packet times eight plus lane.
pub type HitRef = u32;

/// Function that fills the list with the surfaces of a stream of hits, whose indices ascend, eight per packet.
pub type GatherStage = fn(&Scene, &Chunk, &[Hit8], &[HitRef], &mut Vec<Surface8>);

/// Kinds of shape that occur in a stream of hits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shapes {
    /// Triangles without vertex normals.
    pub flat: bool,
    /// Triangles with vertex normals.
    pub smooth: bool,
    /// Spheres.
    pub spheres: bool,
    /// Planes.
    pub planes: bool,
    /// Meshes with a picture of normals.
    pub relief: bool,
}

impl Shapes {
    /// All kinds.
    pub const ALL: Self = Self { flat: true, smooth: true, spheres: true, planes: true, relief: true };

    /// Adds a shape's kind.
    pub fn add(&mut self, shape: &Shape) {
        match shape {
            Shape::Mesh(mesh) if mesh.normal_indices.is_empty() => self.flat = true,
            Shape::Mesh(_) => self.smooth = true,
            Shape::Sphere(_) => self.spheres = true,
            Shape::Plane(_) => self.planes = true,
        }
    }
}

/// Picks a gather stage that handles at least these shapes.
#[must_use]
pub fn pick(shapes: Shapes) -> GatherStage {
    if shapes.relief {
        return gather::<true, true, true, true, true>;
    }
    match (shapes.flat, shapes.smooth, shapes.spheres, shapes.planes) {
        (_, false, false, false) => gather::<true, false, false, false, false>,
        (_, true, false, false) => gather::<true, true, false, false, false>,
        (false, false, true, false) => gather::<false, false, true, false, false>,
        (false, false, false, true) => gather::<false, false, false, true, false>,
        (false, false, true, true) => gather::<false, false, true, true, false>,
        (_, false, _, _) => gather::<true, false, true, true, false>,
        // An unusual mix uses the stage that handles every kind.
        (_, true, _, _) => gather::<true, true, true, true, false>,
    }
}

fn gather<const MESHES: bool, const SMOOTH: bool, const SPHERES: bool, const PLANES: bool, const RELIEF: bool>(
    scene: &Scene,
    chunk: &Chunk,
    hits: &[Hit8],
    refs: &[HitRef],
    surfaces: &mut Vec<Surface8>,
) {
    debug_assert!(refs.is_sorted_by(|a, b| a < b), "places ascend");
    surfaces.clear();
    for eight in refs.chunks(8) {
        surfaces.push(Surface8::gather::<MESHES, SMOOTH, SPHERES, PLANES, RELIEF>(scene, chunk, hits, eight));
    }
}

/// Returns the packet if `refs` are all eight lanes of one packet, in order; else `None`.
#[inline(always)]
fn whole_packet(refs: &[HitRef]) -> Option<usize> {
    // Indices ascend, so none can lie between the first and the last of eight.
    let &[first, .., last] = refs else { return None };
    (refs.len() == 8 && first % 8 == 0 && last == first + 7).then_some(first as usize / 8)
}

impl Surface8 {
    /// Gathers up to eight hits (at least one) of a chunk.
    #[inline(always)]
    fn gather<const MESHES: bool, const SMOOTH: bool, const SPHERES: bool, const PLANES: bool, const RELIEF: bool>(
        scene: &Scene,
        chunk: &Chunk,
        hits: &[Hit8],
        refs: &[HitRef],
    ) -> Self {
        let mut incident = Vec3x8::splat(Vec3::Z);
        let (mut origin, mut weight, mut t) = (incident, incident, F32x8::ZERO);
        let (mut hit, mut pixel) = ([Hit::MISS; 8], [0; 8]);
        let (mut stack, mut passes) = ([StackId::default(); 8], [0; 8]);
        if let Some(packet) = whole_packet(refs) {
            let (ray, state) = (&chunk.rays[packet], &chunk.states[packet]);
            (incident, origin, weight, t) = (ray.dir, ray.origin, state.weight, hits[packet].t);
            (pixel, stack, passes) = (state.pixel, state.stack, state.passes);
            hit = std::array::from_fn(|k| hits[packet].lane(k));
        } else {
            for k in 0..8 {
                let r = refs[k.min(refs.len() - 1)] as usize;
                let (packet, lane) = (r >> 3, r & 7);
                let (ray, state) = (&chunk.rays[packet], &chunk.states[packet]);
                incident.set_lane(k, ray.dir.lane(lane));
                origin.set_lane(k, ray.origin.lane(lane));
                weight.set_lane(k, state.weight.lane(lane));
                (pixel[k], stack[k], passes[k]) = (state.pixel[lane], state.stack[lane], state.passes[lane]);
                hit[k] = hits[packet].lane(lane);
                t.set_lane(k, hit[k].t);
            }
        }
        let material = hit.map(|hit| scene.objects[hit.geometry as usize].material);
        let mut raw = RawSurface8::of::<MESHES, SMOOTH, SPHERES, PLANES>(scene, &hit, origin, incident, t);
        if RELIEF {
            raw.emboss(scene, &hit);
        }

        // The geometric normal decides the side; both normals then face the ray.
        let facing = incident.dot(raw.outward);
        let front = facing.lt(F32x8::ZERO);
        let normal = Vec3x8::select(front, raw.outward, -raw.outward);
        let shading = if SMOOTH && raw.interpolated.any() {
            let towards = raw.shading.dot(normal).lt(F32x8::ZERO);
            let faced = Vec3x8::select(towards, -raw.shading, raw.shading);
            Vec3x8::select(raw.interpolated, consistent_normal(incident, normal, faced), normal)
        } else {
            normal
        };
        let active = ((1_u32 << refs.len()) - 1) as u8;
        Self {
            active,
            incident,
            point: raw.point,
            normal,
            shading,
            interpolated: raw.interpolated,
            reach: raw.reach,
            front,
            hit,
            material,
            weight,
            pixel,
            stack,
            passes,
            onward: [0; 8],
            returning: [0; 8],
            place: 0,
            base_lanes: active,
            base_weight: weight,
        }
    }

    /// Gathers the surface that the first lane of a chunk hit, whatever its shape.
    #[must_use]
    pub fn one(scene: &Scene, chunk: &Chunk, hits: &[Hit8]) -> Self {
        Self::gather::<true, true, true, true, true>(scene, chunk, hits, &[0])
    }

    /// Returns the origins of rays that leave on the side of arrival.
    #[inline]
    #[must_use]
    pub fn above(&self) -> Vec3x8 {
        self.normal.fma(self.reach, self.point)
    }

    /// Returns the origins of rays that leave on the far side.
    #[inline]
    #[must_use]
    pub fn below(&self) -> Vec3x8 {
        self.normal.fma(-self.reach, self.point)
    }

    /// Returns rays that leave on the arriving side in directions `dir`: any surface may be hit, at any distance.
    #[inline(always)]
    #[must_use]
    pub fn reflected(&self, dir: Vec3x8, weight: Rgb8) -> Spawn8<'_> {
        Spawn8 {
            origin: self.above(),
            dir,
            t_max: F32x8::INFINITY,
            admits: GeometryMask::ALL,
            weight,
            pixel: &self.pixel,
            stack: &self.stack,
            lead: self.lead(dir),
            passes: &self.returning,
            place: self.place,
            extra: None,
        }
    }

    /// Returns rays that leave on the far side in directions `dir`, in the media around the arriving rays.
    #[inline(always)]
    #[must_use]
    pub fn transmitted(&self, dir: Vec3x8, weight: Rgb8) -> Spawn8<'_> {
        Spawn8 { origin: self.below(), passes: &self.onward, ..self.reflected(dir, weight) }
    }

    /// Returns the distance along `dir` between the surface and a ray's origin, on either side.
    #[inline]
    #[must_use]
    pub fn lead(&self, dir: Vec3x8) -> F32x8 {
        self.reach * dir.dot(self.normal).abs()
    }

    /// Returns the share of lane `k` that its surface covers: below 1 only for [`Interface::Alpha`].
    #[inline(always)]
    #[must_use]
    pub fn opacity(&self, scene: &Scene, k: usize) -> f32 {
        match scene.materials[self.material[k] as usize].interface {
            Interface::Alpha { opacity, mask: None } => opacity,
            Interface::Alpha { opacity, mask: Some(mask) } => {
                opacity * on_surface(&scene.textures[mask as usize], self.uv(scene, k)).x
            }
            _ => 1.0,
        }
    }

    /// Returns the colour of lane `k` between the corners of its triangle; white if the shape has none.
    #[must_use]
    pub fn corner_colour(&self, scene: &Scene, k: usize) -> Vec3 {
        let hit = &self.hit[k];
        match &scene.geometry[hit.geometry as usize].shape {
            Shape::Mesh(mesh) => mesh
                .corner_colours(hit.primitive as usize)
                .map_or(Vec3::ONE, |[a, b, c]| a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v),
            Shape::Sphere(_) | Shape::Plane(_) => Vec3::ONE,
        }
    }

    /// Returns the texture coordinates of lane `k`, as [`crate::scene::Colour::Image`] defines them.
    #[must_use]
    pub fn uv(&self, scene: &Scene, k: usize) -> Vec2 {
        let hit = &self.hit[k];
        match &scene.geometry[hit.geometry as usize].shape {
            Shape::Mesh(mesh) => mesh
                .corner_uvs(hit.primitive as usize)
                .map_or(Vec2::ZERO, |[a, b, c]| a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v),
            Shape::Sphere(_) => {
                let n = if self.front.lane(k) { self.normal.lane(k) } else { -self.normal.lane(k) };
                Vec2::new(
                    0.5 + n.x.atan2(-n.z) / std::f32::consts::TAU,
                    1.0 - n.y.clamp(-1.0, 1.0).acos() / std::f32::consts::PI,
                )
            }
            Shape::Plane(_) => Vec2::ZERO,
        }
    }
}

/// Eight surface points with outward normals, before the side of arrival is known.
struct RawSurface8 {
    point: Vec3x8,
    outward: Vec3x8,
    /// Interpolated unit normals; meaningless in lanes that are not `interpolated`.
    shading: Vec3x8,
    interpolated: Mask8,
    reach: F32x8,
}

impl RawSurface8 {
    fn flat(Spot { point, outward, reach }: Spot<F32x8>) -> Self {
        Self { point, outward, shading: outward, interpolated: Mask8::NONE, reach }
    }

    #[inline(always)]
    fn of<const MESHES: bool, const SMOOTH: bool, const SPHERES: bool, const PLANES: bool>(
        scene: &Scene,
        hit: &[Hit; 8],
        origin: Vec3x8,
        dir: Vec3x8,
        t: F32x8,
    ) -> Self {
        let mut corners = [Vec3x8::splat(Vec3::ZERO), Vec3x8::splat(Vec3::X), Vec3x8::splat(Vec3::Y)];
        let mut corner_normals = [Vec3x8::splat(Vec3::Z); 3];
        let (mut smooth, mut spheres, mut planes) = (0_u8, 0_u8, 0_u8);
        let mut anchor = Vec3x8::splat(Vec3::ZERO);
        let mut axis = Vec3x8::splat(Vec3::Y);
        let mut radius = F32x8::ONE;
        let (mut u, mut v) = (F32x8::ZERO, F32x8::ZERO);
        for (k, h) in hit.iter().enumerate() {
            match &scene.geometry[h.geometry as usize].shape {
                Shape::Mesh(mesh) if MESHES => {
                    let i = h.primitive as usize;
                    for (eight, one) in corners.iter_mut().zip(mesh.corners(i)) {
                        eight.set_lane(k, one);
                    }
                    u.set_lane(k, h.u);
                    v.set_lane(k, h.v);
                    if let (true, Some(normals)) = (SMOOTH, mesh.corner_normals(i)) {
                        smooth |= 1 << k;
                        for (eight, one) in corner_normals.iter_mut().zip(normals) {
                            eight.set_lane(k, one);
                        }
                    }
                }
                Shape::Sphere(s) if SPHERES => {
                    spheres |= 1 << k;
                    anchor.set_lane(k, s.centre);
                    radius.set_lane(k, s.radius);
                }
                Shape::Plane(p) if PLANES => {
                    planes |= 1 << k;
                    anchor.set_lane(k, p.point);
                    axis.set_lane(k, p.normal);
                }
                _ => debug_assert!(false, "a stage met a shape that it was not picked for"),
            }
        }

        let on_sphere = || Spot::on_sphere(anchor, radius, origin, dir, t);
        let on_plane = || Spot::on_plane(anchor, axis, dir.fma(t, origin));
        let mut raw = Self::flat(if MESHES {
            Spot::on_triangle(corners, u, v)
        } else if SPHERES {
            on_sphere()
        } else {
            on_plane()
        });
        if SMOOTH && smooth != 0 {
            let mixed = corner_normals[0] * (F32x8::ONE - u - v) + corner_normals[1] * u + corner_normals[2] * v;
            // Opposed vertex normals can cancel. The geometric normal replaces the result there.
            let usable = Mask8::from_bits(smooth) & mixed.length_squared().gt(F32x8::from(1e-12));
            raw.shading = Vec3x8::select(usable, mixed.normalized(), raw.outward);
            raw.interpolated = usable;
        }
        if MESHES && SPHERES && spheres != 0 {
            raw.replace(Mask8::from_bits(spheres), &on_sphere());
        }
        if (MESHES || SPHERES) && PLANES && planes != 0 {
            raw.replace(Mask8::from_bits(planes), &on_plane());
        }
        raw
    }

    /// Replaces the normals of meshes with a picture of normals.
    #[inline(never)]
    fn emboss(&mut self, scene: &Scene, hit: &[Hit; 8]) {
        let mut changed = 0;
        for (k, h) in hit.iter().enumerate() {
            let plain = if self.interpolated.lane(k) { self.shading.lane(k) } else { self.outward.lane(k) };
            let weights = [h.u, h.v].map(f64::from);
            if let Some(normal) = embossed(scene, h.geometry, h.primitive, weights, plain.as_dvec3()) {
                self.shading.set_lane(k, normal.as_vec3());
                changed |= 1 << k;
            }
        }
        self.interpolated |= Mask8::from_bits(changed);
    }

    fn replace(&mut self, lanes: Mask8, other: &Spot<F32x8>) {
        self.point = Vec3x8::select(lanes, other.point, self.point);
        self.outward = Vec3x8::select(lanes, other.outward, self.outward);
        self.reach = Real::select(lanes, other.reach, self.reach);
    }
}
