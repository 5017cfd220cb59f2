//! Light of the environment: directions by the cosine to the surface, and towards the bright parts of a picture.
//!
//! Parts of a picture more than twice as bright as the mean of all directions get a share of the samples, in proportion to
//! solid angle times the excess. So a sun of one texel is found. The other samples are spread by the cosine to the normal.
//! A sample's weight is that of both ways together (the balance heuristic of Veach & Guibas 1995). An environment without
//! bright parts is sampled by the cosine alone: under an even one every sample is exact.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use glam::DVec3;

use crate::math::{Real, Vector3};
use crate::render::sky::{Any, Sky};
use crate::scene::{Environment, Rgb, Scene, Texture};
use crate::simd::Vec3x8;

/// Largest number of texels that samples are directed by; larger pictures are taken in blocks.
const MOST_TEXELS: usize = 1 << 21;

/// Brightness above which directions are sampled by brightness, relative to the mean.
const BRIGHT: f64 = 2.0;

/// Share of the light that bright parts must have to get samples of their own.
const LEAST_BRIGHT: f64 = 1e-3;

/// Environment of a scene, prepared for sampling.
#[derive(Debug)]
pub struct Around {
    bright: Option<Bright>,
}

/// Sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct Ray<R> {
    /// Unit direction.
    pub dir: Vector3<R>,
    /// Solid angle that it stands for, if it were the only one.
    pub solid: R,
}

/// Excess of the environment's brightness over twice its mean, by texels of longitude and latitude, rows from the top.
#[derive(Debug)]
struct Bright {
    columns: usize,
    rows: usize,
    /// Rotation about +y in radians, from -z towards +x.
    rotation: f64,
    /// Excess of each texel, times the sine of its polar angle.
    weights: Vec<f32>,
    /// Sums of the weights of each row from its first texel on.
    along: Vec<f64>,
    /// Sums of the weights of the rows above each; one more than there are rows.
    above: Vec<f64>,
    /// Share of the samples.
    share: f64,
}

impl Around {
    /// Prepares the environment of a scene. Returns `None` if it is black.
    #[must_use]
    pub fn of(scene: &Scene) -> Option<Self> {
        match scene.environment {
            Environment::Constant(Rgb::ZERO) => None,
            Environment::Constant(_) | Environment::Gradient { .. } => Some(Self { bright: None }),
            Environment::LatLong { texture, scale, rotation } => {
                let picture = &scene.textures[texture as usize];
                let grid = of_picture(picture, scale);
                Some(Self { bright: Bright::new(&grid, f64::from(rotation)) })
            }
            Environment::Map { texture, .. } => {
                let rows = (2 * scene.textures[texture as usize].height as usize).clamp(64, 1024);
                Some(Self { bright: Bright::new(&looked_up(scene, rows), 0.0) })
            }
        }
    }

    /// Largest factor by which the weights of samples exceed those of samples by the cosine alone.
    #[must_use]
    pub fn excess(&self) -> f64 {
        self.bright.as_ref().map_or(1.0, |bright| 1.0 / (1.0 - bright.share))
    }

    /// Returns the direction of the sample `at` of the unit cube above a surface of unit normal `normal`. Its solid angle is
    /// 0 if it lies below.
    #[must_use]
    pub fn sample<R: Real<Mask = bool>>(
        &self,
        normal: Vector3<R>,
        at: [f32; 3],
        wide: impl Fn(Vector3<R>) -> DVec3,
    ) -> Ray<R> {
        let number = |x: f64| R::splat(x);
        let cosine = R::splat(FRAC_1_PI);
        let Some(bright) = &self.bright else {
            let dir = by_cosine(normal, [at[0], at[1]].map(|x| number(f64::from(x))));
            // The least cosine keeps a direction along the surface, which brings nothing, finite.
            return Ray { dir, solid: R::one() / (normal.dot(dir).max(number(1e-9)) * cosine) };
        };
        let share = bright.share;
        let dir = if f64::from(at[2]) < share {
            let dir = bright.direction([at[0], at[1]].map(f64::from));
            Vector3::new(number(dir.x), number(dir.y), number(dir.z))
        } else {
            by_cosine(normal, [at[0], at[1]].map(|x| number(f64::from(x))))
        };
        let cos = normal.dot(dir);
        if !cos.gt(R::zero()) {
            return Ray { dir, solid: R::zero() };
        }
        let density = number(share * bright.density(wide(dir))) + number(1.0 - share) * cos * cosine;
        Ray { dir, solid: R::one() / density }
    }
}

/// Brightness of the environment by texels of longitude and latitude, rows from the top.
struct Grid {
    columns: usize,
    rows: usize,
    brightness: Vec<f64>,
}

fn brightness(colour: Rgb) -> f64 {
    f64::from(colour.abs().element_sum())
}

/// Sine of the polar angle at the middle of a row.
fn sine_of(row: usize, rows: usize) -> f64 {
    (PI * (row as f64 + 0.5) / rows as f64).sin()
}

/// Returns the brightness of a picture's texels, or of blocks of them.
fn of_picture(picture: &Texture, scale: Rgb) -> Grid {
    let (w, h) = (picture.width as usize, picture.height as usize);
    let mut block = 1;
    while w.div_ceil(block) * h.div_ceil(block) > MOST_TEXELS {
        block += 1;
    }
    let (columns, rows) = (w.div_ceil(block), h.div_ceil(block));
    let mut sums = vec![0.0; columns * rows];
    for y in 0..h {
        // A block at the edge has the share of what it covers.
        let line = &mut sums[y * rows / h * columns..][..columns];
        (0..w).for_each(|x| line[x * columns / w] += brightness(picture.pixels.get(y * w + x) * scale));
    }
    let share = (columns * rows) as f64 / (w * h) as f64;
    Grid { columns, rows, brightness: sums.into_iter().map(|sum| sum * share).collect() }
}

/// Returns the brightness of an environment of any kind, from eight directions in each texel.
fn looked_up(scene: &Scene, rows: usize) -> Grid {
    let columns = 2 * rows;
    let mut brightnesses = Vec::with_capacity(columns * rows);
    for row in 0..rows {
        for column in 0..columns {
            let mut dirs = Vec3x8::splat(glam::Vec3::Y);
            for k in 0..8 {
                let within = |k: usize, n: f64| (k as f64 + 0.5) / n;
                let (x, y) = (column as f64 + within(k % 4, 4.0), row as f64 + within(k / 4, 2.0));
                dirs.set_lane(k, towards(x / columns as f64, y / rows as f64).as_vec3());
            }
            let seen = Any::radiance(&scene.environment, &scene.textures, &dirs);
            brightnesses.push((0..8).map(|k| brightness(seen.lane(k))).sum::<f64>() / 8.0);
        }
    }
    Grid { columns, rows, brightness: brightnesses }
}

/// Returns the unit direction at `u`, a share of a turn from the picture's left edge, and `v`, a share of half a turn from its
/// top.
fn towards(u: f64, v: f64) -> DVec3 {
    let (sin, cos) = ((u - 0.5) * TAU).sin_cos();
    let (level, height) = (v * PI).sin_cos();
    DVec3::new(sin * level, height, -cos * level)
}

/// Returns the place at which a tent function of width 2 around 0 has the share `at` of its area before it.
fn tent(at: f64) -> f64 {
    if at < 0.5 { (2.0 * at).sqrt() - 1.0 } else { 1.0 - (2.0 * (1.0 - at)).sqrt() }
}

/// Finds `at` among ascending sums, each of which ends a part. Returns the index of the part and the place within it.
fn find(sums: &[f64], at: f64) -> (usize, f64) {
    let i = sums.partition_point(|&sum| sum <= at).min(sums.len() - 1);
    let low = if i == 0 { 0.0 } else { sums[i - 1] };
    (i, ((at - low) / (sums[i] - low)).clamp(0.0, 1.0))
}

impl Bright {
    fn new(grid: &Grid, rotation: f64) -> Option<Self> {
        let &Grid { columns, rows, .. } = grid;
        let sum = |of: &dyn Fn(f64) -> f64| -> f64 {
            let row = |(y, row): (usize, &[f64])| sine_of(y, rows) * row.iter().map(|&b| of(b)).sum::<f64>();
            grid.brightness.chunks(columns).enumerate().map(row).sum()
        };
        let (whole, area) = (sum(&|b| b), sum(&|_| 1.0));
        let least = BRIGHT * whole / area;
        let excess = |b: f64| (b - least).max(0.0);
        let part = sum(&excess) / whole;
        // Shares are powers of two, so that a power of two of samples has the same number for the bright parts everywhere.
        let share = match part {
            part if part > 0.5 => 0.5,
            part if part > 0.25 => 0.25,
            part if part > LEAST_BRIGHT => 0.125,
            _ => return None,
        };
        let mut weights = Vec::with_capacity(columns * rows);
        let (mut along, mut above) = (Vec::with_capacity(columns * rows), vec![0.0]);
        let mut total = 0.0;
        for (y, row) in grid.brightness.chunks(columns).enumerate() {
            let mut within = 0.0;
            for &b in row {
                let weight = (excess(b) * sine_of(y, rows)) as f32;
                within += f64::from(weight);
                weights.push(weight);
                along.push(within);
            }
            total += within;
            above.push(total);
        }
        (total.is_finite() && total > 0.0).then_some(Self { columns, rows, rotation, weights, along, above, share })
    }

    /// Returns the direction of a sample of the unit square. Its density over the picture is that of the weights,
    /// interpolated between texels as colours are.
    fn direction(&self, [u, v]: [f64; 2]) -> DVec3 {
        let (y, down) = find(&self.above[1..], v * self.above[self.rows]);
        let row = &self.along[y * self.columns..][..self.columns];
        let (x, across) = find(row, u * row[self.columns - 1]);
        let place = |i: usize, within: f64| i as f64 + 0.5 + tent(within);
        // Beyond the poles the picture goes on as in a mirror, since there the edge rows stay.
        let (rows, y) = (self.rows as f64, place(y, down).abs());
        let v = y.min(2.0 * rows - y) / rows;
        towards(place(x, across) / self.columns as f64 + self.rotation / TAU, v)
    }

    /// Returns the density of [`Self::direction`] per unit of solid angle.
    fn density(&self, dir: DVec3) -> f64 {
        let level = dir.x.hypot(dir.z).max(1e-9);
        let u = 0.5 + (dir.x.atan2(-dir.z) - self.rotation) / TAU;
        let (x, y) = ((u - u.floor()) * self.columns as f64 - 0.5, level.atan2(dir.y) / PI * self.rows as f64 - 0.5);
        let (column, row) = (x.floor(), y.floor());
        let at = |i: f64, j: f64| {
            let (i, j) = (i.rem_euclid(self.columns as f64) as usize, j.clamp(0.0, (self.rows - 1) as f64) as usize);
            f64::from(self.weights[j * self.columns + i])
        };
        let (right, down) = (x - column, y - row);
        let line = |j: f64| at(column, j) * (1.0 - right) + at(column + 1.0, j) * right;
        let weight = line(row) * (1.0 - down) + line(row + 1.0) * down;
        weight / self.above[self.rows] * (self.columns * self.rows) as f64 / (2.0 * PI * PI * level)
    }
}

/// Returns a direction about the unit vector `normal`, with a density of the cosine over pi.
fn by_cosine<R: Real<Mask = bool>>(normal: Vector3<R>, at: [R; 2]) -> Vector3<R> {
    let splat = |x: f64, y: f64, z: f64| Vector3::new(R::splat(x), R::splat(y), R::splat(z));
    // As for spherical lamps, the axes turn where scenes seldom have normals.
    let across = splat(0.231, 0.519, 0.823).cross(normal);
    let across = if across.length_squared().gt(R::splat(1e-4)) { across } else { splat(1.0, 0.0, 0.0).cross(normal) };
    let across = across.normalized();
    let [x, y] = crate::render::extent::disc(at);
    let up = (R::one() - x * x - y * y).safe_sqrt();
    (normal * up + across * x + normal.cross(across) * y).normalized()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of radiance `ground`, but for one texel.
    fn with_sun(ground: f32, sun: f32, (x, y): (u32, u32)) -> Scene {
        let mut scene = Scene::default();
        let (width, height) = (64, 32);
        let mut pixels = vec![Rgb::splat(ground); (width * height) as usize];
        pixels[(y * width + x) as usize] = Rgb::splat(sun);
        let texture = scene.add_texture(Texture {
            name: "sky".into(),
            width,
            height,
            pixels: pixels.into(),
            ..Texture::default()
        });
        scene.environment = Environment::LatLong { texture, scale: Rgb::ONE, rotation: 0.7 };
        scene
    }

    /// Irradiance on a surface by n^3 samples.
    fn irradiance(scene: &Scene, normal: DVec3, n: u32) -> f64 {
        let around = Around::of(scene).expect("it is not black");
        let middle = |k: u32| (k as f32 + 0.5) / n as f32;
        let sum: f64 = (0..n * n * n)
            .map(|i| {
                let at = [middle(i % n), middle(i / n % n), middle(i / n / n)];
                let ray = around.sample::<f64>(normal.into(), at, DVec3::from);
                let dir = DVec3::from(ray.dir);
                let mut dirs = Vec3x8::splat(dir.as_vec3());
                dirs.set_lane(0, dir.as_vec3());
                let seen = Any::radiance(&scene.environment, &scene.textures, &dirs).lane(0);
                f64::from(seen.x) * normal.dot(dir).max(0.0) * ray.solid
            })
            .sum();
        sum / f64::from(n).powi(3)
    }

    #[test]
    fn an_even_sky_is_exact_with_every_sample() {
        for scene in [
            with_sun(0.5, 0.5, (3, 3)),
            Scene { environment: Environment::Constant(Rgb::splat(0.5)), ..Scene::default() },
        ] {
            let around = Around::of(&scene).expect("it is not black");
            for k in 0..100_u8 {
                // Off the edges, where directions run along the surface.
                let k = f32::from(k) + 0.5;
                let at = [k / 100.0, k * 0.618 % 1.0, k * 0.755 % 1.0];
                let normal = DVec3::new(0.3, 0.8, -0.5).normalize();
                let ray = around.sample::<f64>(normal.into(), at, DVec3::from);
                let cos = normal.dot(ray.dir.into());
                assert!((cos * ray.solid / PI - 1.0).abs() < 1e-9, "{at:?}");
            }
        }
    }

    #[test]
    fn a_sun_of_one_texel_brings_its_radiance_times_its_solid_angle() {
        for place in [(40, 6), (0, 12), (63, 0)] {
            let scene = with_sun(0.0, 5000.0, place);
            // Rows of texels cover 1 / 32 of half a turn; interpolation spreads a texel without changing its integral over
            // the picture.
            let solid = 2.0 * PI * PI / (64.0 * 32.0) * sine_of(place.1 as usize, 32);
            let towards = towards((f64::from(place.0) + 0.5) / 64.0 + 0.7 / TAU, (f64::from(place.1) + 0.5) / 32.0);
            let got = irradiance(&scene, towards, 32);
            let want = 5000.0 * solid;
            // The sine varies over a texel, most next to the pole.
            let near = if place.1 == 0 { 0.25 } else { 0.01 };
            assert!((got / want - 1.0).abs() < near, "{place:?}: {got} {want}");
            assert_eq!(irradiance(&scene, -towards, 8), 0.0, "nothing comes from below");
        }
    }

    #[test]
    fn densities_are_those_of_the_directions() {
        let scene = with_sun(0.1, 400.0, (20, 9));
        let Some(Around { bright: Some(bright) }) = Around::of(&scene) else { panic!("the sun is bright") };
        // The integral of the density over all directions is 1.
        let n = 512;
        let sum: f64 = (0..n * 2 * n)
            .map(|i| {
                let (u, v) =
                    ((f64::from(i % (2 * n)) + 0.5) / f64::from(2 * n), (f64::from(i / (2 * n)) + 0.5) / f64::from(n));
                bright.density(towards(u, v)) * (PI * v).sin()
            })
            .sum();
        let integral = sum * 2.0 * PI * PI / f64::from(2 * n * n);
        assert!((integral - 1.0).abs() < 1e-3, "{integral}");
        // Where samples fall, they are as dense as said: the mean of 1 / density over samples is the solid angle.
        let mean: f64 = (0..4096)
            .map(|i| {
                1.0 / bright
                    .density(bright.direction([(f64::from(i % 64) + 0.5) / 64.0, (f64::from(i / 64) + 0.5) / 64.0]))
            })
            .sum::<f64>()
            / 4096.0;
        // Tents overlap four texels.
        let solid = 4.0 / 2048.0 * 2.0 * PI * PI * sine_of(9, 32);
        assert!((mean / solid - 1.0).abs() < 0.15, "{mean} {solid}");
    }
}
