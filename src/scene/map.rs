//! Environment maps: pictures of all directions around a point, as a cube, as a mirrored ball or by longitude and latitude.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use super::Rgb;
use super::texture::Texture;
use crate::math::Real;

crate::choice! {
    /// Shape of an environment map.
    ///
    /// Directions are in the frame of the map: x to the right, y up, z towards the viewer. The frame of a map in a file is
    /// that of the world.
    pub enum MapKind("kind", derive(Eq, Hash)) {
        /// Six square faces side by side, in the order and orientation of OpenGL: +x, -x, +y, -y, +z, -z.
        "cube" => Cube,
        /// Mirrored ball seen from far off along -z, as in OpenGL's sphere mapping; its rim is the direction -z.
        "sphere" => Sphere,
        /// Longitude and latitude: the top row is +y, the middle column -z, and u = 0.75 is +x.
        "latlong" => LatLong,
    }
}

/// Face, column and row of a cube map, in texels; a texel's centre lies at a half.
#[derive(Clone, Copy, Debug, PartialEq)]
struct OnFace<R> {
    face: usize,
    x: R,
    y: R,
}

impl MapKind {
    /// Columns and rows of a map whose faces, disc or half a turn are `size` texels wide.
    #[must_use]
    pub fn shape(self, size: u32) -> [u32; 2] {
        match self {
            Self::Cube => [size.saturating_mul(6), size],
            Self::Sphere => [size, size],
            Self::LatLong => [size.saturating_mul(2), size],
        }
    }

    /// Returns true if a picture can be such a map.
    #[must_use]
    pub fn fits(self, width: u32, height: u32) -> bool {
        [width, height] == self.shape(height) && height > 0
    }

    /// Returns the unit direction that a map with `size` rows shows at column `x` and row `y`, in texels from its upper left
    /// corner; the first texel is centred at (0.5, 0.5). Beside the disc of a sphere map this is the direction of its rim.
    #[must_use]
    pub fn direction(self, x: f64, y: f64, size: u32) -> DVec3 {
        let size = f64::from(size);
        match self {
            Self::Cube => {
                let face = (x / size).floor().clamp(0.0, 5.0);
                face_direction(face as usize, 2.0 * (x / size - face) - 1.0, 2.0 * y / size - 1.0).normalize()
            }
            // The reflected direction r lies at s = r.x / m + 1/2, t = r.y / m + 1/2 with m = 2 sqrt(r.x^2 + r.y^2 + (r.z + 1)^2). The
            // direction -z, where m is 0, is the whole rim of the disc.
            Self::Sphere => {
                let (x, y) = (2.0 * x / size - 1.0, 1.0 - 2.0 * y / size);
                let beyond = 1.0 - x * x - y * y;
                // The ball's normal is (x, y, z); the view along -z is reflected in it.
                let z = beyond.max(0.0).sqrt();
                DVec3::new(2.0 * z * x, 2.0 * z * y, 2.0 * z * z - 1.0)
            }
            Self::LatLong => {
                let (longitude, polar) = ((x / (2.0 * size) - 0.5) * TAU, y / size * PI);
                let level = polar.sin();
                DVec3::new(longitude.sin() * level, polar.cos(), -longitude.cos() * level)
            }
        }
    }

    /// Returns the colour of a map in a direction of about unit length, in the map's frame, bilinear between texels and
    /// without seams.
    #[must_use]
    pub fn look_up(self, map: &Texture, dir: Vec3) -> Rgb {
        let size = map.height as f32;
        let texel = |i: i64, j: i64| map.pixels.get((j * i64::from(map.width) + i) as usize);
        match self {
            Self::Cube => {
                let n = i64::from(map.height);
                let OnFace { face, x, y } = on_face([dir.x, dir.y, dir.z], size);
                bilinear(x, y, |i, j| match inside(i, j, n) {
                    true => texel(face as i64 * n + i, j),
                    false => beyond_edge(face, i, j, n, &texel),
                })
            }
            Self::Sphere => {
                let m = 2.0 * (dir.x * dir.x + dir.y * dir.y + (dir.z + 1.0) * (dir.z + 1.0)).sqrt();
                // At the singular direction any place of the rim is right.
                let (s, t) = if m > 0.0 { (dir.x / m + 0.5, dir.y / m + 0.5) } else { (0.0, 0.5) };
                let last = i64::from(map.height) - 1;
                bilinear(s * size, (1.0 - t) * size, |i, j| texel(i.clamp(0, last), j.clamp(0, last)))
            }
            Self::LatLong => {
                let u = 0.5 + dir.x.atan2(-dir.z) / std::f32::consts::TAU;
                let v = dir.y.clamp(-1.0, 1.0).acos() / std::f32::consts::PI;
                let (columns, last) = (i64::from(map.width), i64::from(map.height) - 1);
                bilinear(u * map.width as f32, v * size, |i, j| texel(i.rem_euclid(columns), j.clamp(0, last)))
            }
        }
    }
}

/// Turns a direction into the frame of a map that is turned by `rotation` radians about +y, from -z towards +x.
#[must_use]
pub fn turned_back(dir: Vec3, rotation: f32) -> Vec3 {
    let (sin, cos) = rotation.sin_cos();
    Vec3::new(dir.x * cos + dir.z * sin, dir.y, dir.z * cos - dir.x * sin)
}

/// The colour at a place in texels, between the four texels around it.
fn bilinear(x: f32, y: f32, texel: impl Fn(i64, i64) -> Rgb) -> Rgb {
    let (x, y) = (x - 0.5, y - 0.5);
    let (column, row) = (x.floor(), y.floor());
    let (i, j) = (column as i64, row as i64);
    let across = |j: i64| texel(i, j).lerp(texel(i + 1, j), x - column);
    across(j).lerp(across(j + 1), y - row)
}

fn inside(i: i64, j: i64, n: i64) -> bool {
    (0..n).contains(&i) && (0..n).contains(&j)
}

/// The direction, of any length, at `s` and `t` in -1..=1 of a face, `t` downwards.
fn face_direction(face: usize, s: f64, t: f64) -> DVec3 {
    match face {
        0 => DVec3::new(1.0, -t, -s),
        1 => DVec3::new(-1.0, -t, s),
        2 => DVec3::new(s, 1.0, t),
        3 => DVec3::new(s, -1.0, -t),
        4 => DVec3::new(s, -t, 1.0),
        _ => DVec3::new(-s, -t, -1.0),
    }
}

/// The place of a direction on the face whose axis is its largest component.
fn on_face<R: Real<Mask = bool> + PartialOrd>([x, y, z]: [R; 3], size: R) -> OnFace<R> {
    let (ax, ay, az) = (x.abs(), y.abs(), z.abs());
    let zero = R::zero();
    let (face, s, t, along) = if ax >= ay && ax >= az {
        if x > zero { (0, -z, -y, ax) } else { (1, z, -y, ax) }
    } else if ay >= az {
        if y > zero { (2, x, z, ay) } else { (3, x, -z, ay) }
    } else if z > zero {
        (4, x, -y, az)
    } else {
        (5, -x, -y, az)
    };
    let half = size * R::splat(0.5);
    OnFace { face, x: s / along * half + half, y: t / along * half + half }
}

/// The texel that continues a face beyond its edge: the neighbour's next to the edge; at a corner, where three faces meet,
/// the mean of those next to it.
fn beyond_edge(face: usize, i: i64, j: i64, n: i64, texel: &impl Fn(i64, i64) -> Rgb) -> Rgb {
    let (ci, cj) = (i.clamp(0, n - 1), j.clamp(0, n - 1));
    if ci != i && cj != j {
        let own = texel(face as i64 * n + ci, cj);
        return (own + beyond_edge(face, i, cj, n, texel) + beyond_edge(face, ci, j, n, texel)) / 3.0;
    }
    // A little beyond the edge, so that the neighbour's face is the nearer one.
    let place = |i: i64| {
        let centre = 2.0 * (i as f64 + 0.5) / n as f64 - 1.0;
        if i < 0 {
            -1.0 - 1e-6
        } else if i >= n {
            1.0 + 1e-6
        } else {
            centre
        }
    };
    let dir = face_direction(face, place(i), place(j));
    let OnFace { face, x, y } = on_face([dir.x, dir.y, dir.z], n as f64);
    let index = |x: f64| (x as i64).clamp(0, n - 1);
    texel(face as i64 * n + index(x), index(y))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A map that shows its directions as colours.
    fn of_directions(kind: MapKind, size: u32) -> Texture {
        let [width, height] = kind.shape(size);
        let at = |p: u32| kind.direction(f64::from(p % width) + 0.5, f64::from(p / width) + 0.5, size).as_vec3();
        Texture::new("", width, height, (0..width * height).map(at).collect::<Vec<_>>())
    }

    fn directions() -> impl Iterator<Item = Vec3> {
        // A spiral of directions over the sphere, and the axes, edges and corners of a cube.
        let spiral = (0..2000).map(|i| {
            let y = 1.0 - (f64::from(i) + 0.5) / 1000.0;
            let (sin, cos) = (2.399_963 * f64::from(i)).sin_cos();
            let level = (1.0 - y * y).sqrt();
            DVec3::new(cos * level, y, sin * level).as_vec3()
        });
        let grid = (0..27).map(|i| Vec3::new((i % 3) as f32, (i / 3 % 3) as f32, (i / 9) as f32) - Vec3::ONE);
        spiral.chain(grid.filter(|d| *d != Vec3::ZERO).map(Vec3::normalize))
    }

    #[test]
    fn a_map_looked_up_in_a_direction_gives_that_direction_to_a_texel() {
        for (kind, size) in [(MapKind::Cube, 32), (MapKind::Sphere, 128), (MapKind::LatLong, 64)] {
            let map = of_directions(kind, size);
            assert!(kind.fits(map.width, map.height) && !kind.fits(map.width + 1, map.height));
            for dir in directions() {
                let off = (kind.look_up(&map, dir) - dir).length();
                // Of a sphere map, texels near the rim stand for more and more.
                let texel = match kind {
                    MapKind::Cube => 2.0 / 32.0,
                    MapKind::Sphere if dir.z < -0.9 => continue,
                    MapKind::Sphere => 4.0 / 128.0 / ((dir.z + 1.0) / 2.0).sqrt(),
                    MapKind::LatLong => std::f32::consts::PI / 64.0,
                };
                assert!(off < texel, "{} {dir}: {off}", kind.name());
            }
        }
    }

    #[test]
    fn directions_lie_where_opengl_and_the_manual_say() {
        let at = |kind: MapKind, x: f64, y: f64| kind.direction(x, y, 2);
        // The middles of the six faces.
        let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
        for (face, axis) in axes.into_iter().enumerate() {
            assert_eq!(at(MapKind::Cube, face as f64 * 2.0 + 1.0, 1.0), axis);
        }
        // Seen from within, +x has -z on its right and +y on its top.
        let p = at(MapKind::Cube, 1.5, 0.5);
        assert!(p.x > 0.0 && p.z < 0.0 && p.y > 0.0);
        assert_eq!(at(MapKind::Sphere, 1.0, 1.0), DVec3::Z);
        assert!((at(MapKind::Sphere, 1.0 + 0.5_f64.sqrt(), 1.0) - DVec3::X).length() < 1e-12);
        assert!((at(MapKind::Sphere, 1.0, 0.0) - DVec3::NEG_Z).length() < 1e-12, "the rim is straight behind");
        assert!((at(MapKind::LatLong, 2.0, 1.0) - DVec3::NEG_Z).length() < 1e-12);
        assert!((at(MapKind::LatLong, 3.0, 1.0) - DVec3::X).length() < 1e-12);
        assert!((at(MapKind::LatLong, 1.0, 0.0) - DVec3::Y).length() < 1e-12);
    }

    #[test]
    fn a_cube_map_has_no_seams() {
        let map = of_directions(MapKind::Cube, 8);
        for dir in directions() {
            // The least step towards either side of an edge or a corner changes the colour by no more than that.
            for axis in Vec3::AXES.into_iter().flat_map(|a| [a, -a]) {
                let [a, b] = [dir, (dir + axis * 1e-5).normalize()].map(|d| MapKind::Cube.look_up(&map, d));
                assert!((a - b).length() < 1e-3, "{dir}: {a} {b}");
            }
        }
    }

    #[test]
    fn a_turn_moves_the_middle_from_minus_z_towards_plus_x() {
        let quarter = std::f32::consts::FRAC_PI_2;
        assert!((turned_back(Vec3::X, quarter) - Vec3::NEG_Z).length() < 1e-6);
        assert!((turned_back(Vec3::new(0.0, 1.0, -2.0), 0.0) - Vec3::new(0.0, 1.0, -2.0)).length() < 1e-6);
    }
}
