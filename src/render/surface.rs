//! From hits to places: eight surface points with their normals, and how far off them a new ray must start.

use glam::{Vec2, Vec3};

use super::media::StackId;
use super::queue::{Chunk, Rgb8};
use crate::geometry::{Hit, Hit8, Shape};
use crate::math::{LaneMask, Real, gamma};
use crate::optics::consistent_normal;
use crate::scene::Scene;
use crate::simd::{F32x8, Mask8, Vec3x8};

/// Eight places where rays met surfaces. Lanes that are not `active` repeat an active one.
#[derive(Clone, Debug)]
pub struct Surface8 {
    /// Lanes in use.
    pub active: u8,
    /// Direction of travel of the rays that arrived, of unit length.
    pub incident: Vec3x8,
    /// The place, on the surface to within `reach`.
    pub point: Vec3x8,
    /// Unit geometric normal, on the side the ray arrived from.
    pub normal: Vec3x8,
    /// Unit shading normal, on the same side; the geometric one where nothing is interpolated.
    pub shading: Vec3x8,
    /// Where the shading normal is not the geometric one.
    pub interpolated: Mask8,
    /// How far along the geometric normal a new ray must start, so that it cannot meet the surface it leaves.
    pub reach: F32x8,
    /// Whether the ray came from outside.
    pub front: Mask8,
    /// The hits themselves.
    pub hit: [Hit; 8],
    /// Material of each.
    pub material: [u32; 8],
    /// Weight of each ray, absorption on the way here included.
    pub weight: Rgb8,
    /// Pixel of each.
    pub pixel: [u32; 8],
    /// The media each arrived through.
    pub stack: [StackId; 8],
    /// Surfaces passed that were not there.
    pub passes: [u16; 8],
}

/// Place of a hit in a chunk: packet times eight plus lane.
pub type HitRef = u32;

impl Surface8 {
    /// Gathers up to eight hits (at least one) of a chunk.
    #[must_use]
    pub fn gather(scene: &Scene, chunk: &Chunk, hits: &[Hit8], refs: &[HitRef]) -> Self {
        let mut incident = Vec3x8::splat(Vec3::Z);
        let (mut origin, mut weight, mut t) = (incident, incident, F32x8::ZERO);
        let (mut hit, mut material, mut pixel) = ([Hit::MISS; 8], [0; 8], [0; 8]);
        let (mut stack, mut passes) = ([StackId::default(); 8], [0; 8]);
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
            material[k] = scene.objects[hit[k].geometry as usize].material;
        }
        let place = Place::of(scene, &hit, origin, incident, t);

        // The geometric normal decides the side; both normals then face the ray.
        let facing = incident.dot(place.outward);
        let front = facing.lt(F32x8::ZERO);
        let normal = Vec3x8::select(front, place.outward, -place.outward);
        let shading = if place.interpolated.any() {
            let towards = place.shading.dot(normal).lt(F32x8::ZERO);
            let faced = Vec3x8::select(towards, -place.shading, place.shading);
            Vec3x8::select(place.interpolated, consistent_normal(incident, normal, faced), normal)
        } else {
            normal
        };
        Self {
            active: ((1_u32 << refs.len()) - 1) as u8,
            incident,
            point: place.point,
            normal,
            shading,
            interpolated: place.interpolated,
            reach: place.reach,
            front,
            hit,
            material,
            weight,
            pixel,
            stack,
            passes,
        }
    }

    /// Starts of rays that leave on the side the ray arrived from.
    #[inline]
    #[must_use]
    pub fn above(&self) -> Vec3x8 {
        self.normal.fma(self.reach, self.point)
    }

    /// Starts of rays that leave on the far side.
    #[inline]
    #[must_use]
    pub fn below(&self) -> Vec3x8 {
        self.normal.fma(-self.reach, self.point)
    }

    /// How far along `dir` a ray's start lies from the surface, on either side.
    #[inline]
    #[must_use]
    pub fn lead(&self, dir: Vec3x8) -> F32x8 {
        self.reach * dir.dot(self.normal).abs()
    }

    /// Texture coordinates of lane `k`, as [`crate::scene::Colour::Image`] has them.
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

/// Eight places before their sides are settled.
struct Place {
    point: Vec3x8,
    outward: Vec3x8,
    /// Interpolated normals, unit; anything where not `interpolated`.
    shading: Vec3x8,
    interpolated: Mask8,
    reach: F32x8,
}

impl Place {
    fn of(scene: &Scene, hit: &[Hit; 8], origin: Vec3x8, dir: Vec3x8, t: F32x8) -> Self {
        let mut corners = [Vec3x8::splat(Vec3::ZERO), Vec3x8::splat(Vec3::X), Vec3x8::splat(Vec3::Y)];
        let mut corner_normals = [Vec3x8::splat(Vec3::Z); 3];
        let (mut smooth, mut spheres, mut planes) = (0_u8, 0_u8, 0_u8);
        let mut anchor = Vec3x8::splat(Vec3::ZERO);
        let mut axis = Vec3x8::splat(Vec3::Y);
        let mut radius = F32x8::ONE;
        let (mut u, mut v) = (F32x8::ZERO, F32x8::ZERO);
        for (k, h) in hit.iter().enumerate() {
            match &scene.geometry[h.geometry as usize].shape {
                Shape::Mesh(mesh) => {
                    let i = h.primitive as usize;
                    for (eight, one) in corners.iter_mut().zip(mesh.corners(i)) {
                        eight.set_lane(k, one);
                    }
                    u.set_lane(k, h.u);
                    v.set_lane(k, h.v);
                    if let Some(normals) = mesh.corner_normals(i) {
                        smooth |= 1 << k;
                        for (eight, one) in corner_normals.iter_mut().zip(normals) {
                            eight.set_lane(k, one);
                        }
                    }
                }
                Shape::Sphere(s) => {
                    spheres |= 1 << k;
                    anchor.set_lane(k, s.centre);
                    radius.set_lane(k, s.radius);
                }
                Shape::Plane(p) => {
                    planes |= 1 << k;
                    anchor.set_lane(k, p.point);
                    axis.set_lane(k, p.normal);
                }
            }
        }

        let mut place = on_triangles(corners, u, v);
        if smooth != 0 {
            let mixed = corner_normals[0] * (F32x8::ONE - u - v) + corner_normals[1] * u + corner_normals[2] * v;
            // Opposed corner normals can cancel; the geometric one stands in there.
            let usable = Mask8::from_bits(smooth) & mixed.length_squared().gt(F32x8::from(1e-12));
            place.shading = Vec3x8::select(usable, mixed.normalized(), place.outward);
            place.interpolated = usable;
        }
        if spheres != 0 {
            place.replace(Mask8::from_bits(spheres), on_spheres(anchor, radius, dir.fma(t, origin)));
        }
        if planes != 0 {
            place.replace(Mask8::from_bits(planes), on_planes(anchor, axis, dir.fma(t, origin)));
        }
        place
    }

    fn replace(&mut self, lanes: Mask8, other: Self) {
        self.point = Vec3x8::select(lanes, other.point, self.point);
        self.outward = Vec3x8::select(lanes, other.outward, self.outward);
        self.reach = Real::select(lanes, other.reach, self.reach);
    }
}

/// Points from barycentrics. `reach` covers both what rounding can put the point off the plane (seven operations,
/// pbrt section 6.8.4, and two for the offset itself) and what rounding in the intersection test can move a triangle
/// of this size: four units of the longest edge, as many times more as the triangle is longer than high, because the
/// test's weights are quotients by its area.
fn on_triangles([a, b, c]: [Vec3x8; 3], u: F32x8, v: F32x8) -> Place {
    let w = F32x8::ONE - u - v;
    let point = c.fma(v, b.fma(u, a * w));
    let magnitude = c.abs().fma(v, b.abs().fma(u, a.abs() * w));
    let (e1, e2) = (b - a, c - a);
    let size = e1.abs().max_component().max(e2.abs().max_component());
    // Scaled to size 1, so that the product of tiny edges does not underflow.
    let scale = F32x8::ONE / size;
    let spanned = (e1 * scale).cross(e2 * scale);
    let thickness = spanned.length();
    let outward = spanned * (F32x8::ONE / thickness);
    let reach = outward.abs().dot(magnitude) * F32x8::from(gamma(9)) + size * F32x8::from(gamma(4)) / thickness;
    Place { point, outward, shading: outward, interpolated: Mask8::NONE, reach }
}

/// Points pulled back onto the sphere: centre plus radius times unit normal.
fn on_spheres(centre: Vec3x8, radius: F32x8, near: Vec3x8) -> Place {
    let outward = (near - centre).normalized();
    let point = outward.fma(radius, centre);
    let reach = outward.abs().dot(centre.abs()) * F32x8::from(gamma(5)) + radius * F32x8::from(gamma(8));
    Place { point, outward, shading: outward, interpolated: Mask8::NONE, reach }
}

/// Points pulled back onto the plane along its normal.
fn on_planes(anchor: Vec3x8, axis: Vec3x8, near: Vec3x8) -> Place {
    let height = (near - anchor).dot(axis);
    let point = axis.fma(-height, near);
    let reach = axis.abs().dot(point.abs() + anchor.abs()) * F32x8::from(gamma(9));
    Place { point, outward: axis, shading: axis, interpolated: Mask8::NONE, reach }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// RT-15, RT-16, SI-04: over places up to 1e6 and triangles up to a thousand times longer than high, the point lies
    /// on the triangle's plane well within `reach`, and the normal is as right as corners of that rounding let it be.
    #[test]
    fn points_and_normals_of_triangles_are_within_their_bounds() {
        let mut state = 77_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 23) - 1.0
        };
        let u = f64::from(crate::math::UNIT_ROUNDOFF);
        for i in 0..40_000_i32 {
            let place = DVec3::new(random(), random(), random()) * [0.0, 1.0, 1e3, 1e6][i as usize % 4];
            let size = [1.0, 30.0, 1e3][i as usize / 4 % 3] * if i % 4 == 3 { 30.0 } else { 1.0 };
            let (along, aside) = (DVec3::new(random(), random(), random()), DVec3::new(random(), random(), random()));
            let thin = [1.0, 0.1, 1e-3][i as usize / 12 % 3];
            // The corner from which the edges are taken is any of the three.
            let offsets = [DVec3::ZERO, along, along * random().abs() + aside * thin];
            let turn = i as usize % 3;
            let corners = [0, 1, 2].map(|k| (place + offsets[(k + turn) % 3] * size).as_vec3());
            let [a, b, c] = corners.map(|p| p.as_dvec3());
            let spanned = (b - a).cross(c - a);
            let longest = (b - a).length().max((c - b).length()).max((a - c).length());
            let height = spanned.length() / longest;
            if height < 1e-4 * longest {
                continue;
            }
            let (x, y) = (random().abs(), random().abs());
            let (x, y) = if x + y > 1.0 { (1.0 - x, 1.0 - y) } else { (x, y) };
            let spread = |p: Vec3| Vec3x8::splat(p);
            let at = on_triangles(corners.map(spread), F32x8::from(x as f32), F32x8::from(y as f32));
            let (point, outward) = (at.point.lane(0).as_dvec3(), at.outward.lane(0).as_dvec3());
            let (normal, reach) = (spanned.normalize(), f64::from(at.reach.lane(0)));
            let off = (point - a).dot(normal).abs();
            assert!(off <= reach, "{off:e} beyond {reach:e}: {corners:?}");
            let angle = outward.cross(normal).length().atan2(outward.dot(normal));
            assert!(angle <= 8.0 * u * longest / height, "{angle:e} off, {longest} by {height}: {corners:?}");
        }
    }
}
