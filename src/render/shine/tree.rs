//! Tree of emitters, by which a shaded point picks one with a probability near its share of the light there.
//!
//! Each node bounds the place, the power and the directions of the emitters below it. From the root down, the next
//! child is picked by an estimate of the light that it sends to the point (Conty Estevez & Kulla 2018, "Importance
//! Sampling of Many Lights with Adaptive Tree Splitting"). So the cost grows with the depth of the tree, which is the
//! logarithm of the number of emitters. The estimate decides how noisy the picture is, and never its mean.
//!
//! Picks are computed in `f64` by both renderers. A pick is a comparison, and a sample for which it falls out differently
//! is another sample.

use glam::DVec3;

use crate::geometry::Aabb;

/// Bounds of some emitters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// Ball around them.
    pub centre: DVec3,
    pub radius: f64,
    /// Power, up to a common factor.
    pub power: f64,
    /// Axis of the cone of their normals. Zero if there is none.
    pub axis: DVec3,
    /// Cosine of the cone's half angle; -1 if they face all directions.
    pub cos_cone: f64,
    /// Box around the closed surfaces that they are part of. From outside it only their fronts can be seen. `None` if
    /// some are part of no closed surface.
    pub hull: Option<Aabb>,
}

impl Bounds {
    /// Returns true if only fronts can be seen from `from`.
    pub fn shows_fronts(&self, from: DVec3) -> bool {
        self.hull.is_some_and(|hull| from.cmplt(hull.lo.as_dvec3()).any() || from.cmpgt(hull.hi.as_dvec3()).any())
    }

    /// Returns an estimate of the light at a point with unit normal `normal`. It is 0 only where none arrives.
    pub fn importance(&self, from: DVec3, normal: DVec3) -> f64 {
        let way = self.centre - from;
        let (near, radius) = (way.length_squared(), self.radius * 1.0001);
        let squared = radius * radius;
        if near <= squared {
            // The point is among them.
            return self.power / squared.max(f64::MIN_POSITIVE);
        }
        let way = way / near.sqrt();
        // Half angle under which they are seen.
        let (sin, cos) = ((squared / near).sqrt(), (1.0 - squared / near).max(0.0).sqrt());
        let arriving = within(normal.dot(way), cos, sin);
        let leaving = if self.cos_cone <= -1.0 {
            1.0
        } else {
            let facing = -self.axis.dot(way);
            let facing = if self.shows_fronts(from) { facing } else { facing.abs() };
            let sin_cone = (1.0 - self.cos_cone * self.cos_cone).max(0.0).sqrt();
            // The angle to the axis less the cone's half angle, and then less the half angle seen.
            let least = within(facing, self.cos_cone, sin_cone);
            within(least, cos, sin)
        };
        self.power * arriving.max(0.0) * leaving.max(0.0) / near
    }

    fn and(&self, o: &Self) -> Self {
        let gap = self.centre.distance(o.centre);
        let (centre, radius) = if gap + o.radius <= self.radius {
            (self.centre, self.radius)
        } else if gap + self.radius <= o.radius {
            (o.centre, o.radius)
        } else {
            let radius = 0.5 * (gap + self.radius + o.radius);
            (self.centre.lerp(o.centre, (radius - self.radius) / gap), radius)
        };
        let (axis, cos_cone) = joined((self.axis, self.cos_cone), (o.axis, o.cos_cone));
        let hull = self.hull.zip(o.hull).map(|(a, b)| a.union(b));
        Self { centre, radius, power: self.power + o.power, axis, cos_cone, hull }
    }
}

/// Returns the cosine of the angle of cosine `cos` less another one, given by its cosine and sine; 1 if that is larger.
fn within(cos: f64, by_cos: f64, by_sin: f64) -> f64 {
    if cos >= by_cos {
        return 1.0;
    }
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    cos * by_cos + sin * by_sin
}

/// Returns a cone around two cones, each given by axis and cosine of the half angle.
fn joined(a: (DVec3, f64), b: (DVec3, f64)) -> (DVec3, f64) {
    if a.1 <= -1.0 || b.1 <= -1.0 {
        return (DVec3::ZERO, -1.0);
    }
    let (wide, narrow) = if a.1 <= b.1 { (a, b) } else { (b, a) };
    let half = |cone: (DVec3, f64)| cone.1.clamp(-1.0, 1.0).acos();
    let between = wide.0.dot(narrow.0).clamp(-1.0, 1.0).acos();
    if between + half(narrow) <= half(wide) {
        return wide;
    }
    let around = 0.5 * (half(wide) + between + half(narrow));
    let across = (narrow.0 - wide.0 * wide.0.dot(narrow.0)).normalize_or_zero();
    if around >= std::f64::consts::PI || across == DVec3::ZERO {
        return (DVec3::ZERO, -1.0);
    }
    let (sin, cos) = (around - half(wide)).sin_cos();
    // The margin covers the rounding of these angles.
    ((wide.0 * cos + across * sin).normalize(), (around + 1e-9).min(std::f64::consts::PI).cos())
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds,
    /// Index of the second child, for the first one follows its parent; or of the emitter, in a leaf.
    next: u32,
    is_leaf: bool,
}

/// The tree.
#[derive(Debug)]
pub(super) struct Tree {
    /// In order of depth-first traversal.
    nodes: Vec<Node>,
}

impl Tree {
    /// Builds the tree over at least one emitter.
    pub fn new(emitters: &[Bounds]) -> Self {
        let mut order: Vec<u32> = (0..emitters.len() as u32).collect();
        let mut tree = Self { nodes: Vec::with_capacity(2 * emitters.len()) };
        tree.grow(emitters, &mut order);
        tree
    }

    /// Adds the subtree of the emitters in `order`, and returns its bounds. Halves of equal size keep the depth, and thus
    /// the stack, at the logarithm of the number.
    fn grow(&mut self, emitters: &[Bounds], order: &mut [u32]) -> Bounds {
        let at = self.nodes.len();
        let first = emitters[order[0] as usize];
        self.nodes.push(Node { bounds: first, next: order[0], is_leaf: true });
        if order.len() == 1 {
            return first;
        }
        let place = |&e: &u32| emitters[e as usize].centre;
        let (lo, hi) =
            order.iter().map(place).fold((place(&order[0]), place(&order[0])), |(lo, hi), p| (lo.min(p), hi.max(p)));
        let extent = hi - lo;
        let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
        let middle = order.len() / 2;
        order.select_nth_unstable_by(middle, |a, b| place(a)[axis].total_cmp(&place(b)[axis]).then(a.cmp(b)));
        let (low, high) = order.split_at_mut(middle);
        let before = self.grow(emitters, low);
        let next = self.nodes.len() as u32;
        let bounds = before.and(&self.grow(emitters, high));
        self.nodes[at] = Node { bounds, next, is_leaf: false };
        bounds
    }

    /// Picks an emitter by `at`, a number from 0 to below 1, for a point with unit normal `normal`. Returns its index and the
    /// probability of the pick, and replaces `at` by what the pick left undetermined of it. Returns `None` if no light
    /// arrives.
    pub fn pick(&self, from: DVec3, normal: DVec3, at: &mut f64) -> Option<(u32, f64)> {
        let (mut node, mut probability) = (0, 1.0);
        loop {
            let Node { next, is_leaf, .. } = self.nodes[node];
            if is_leaf {
                return Some((next, probability));
            }
            let children = [node + 1, next as usize];
            let lights = children.map(|child| self.nodes[child].bounds.importance(from, normal));
            let (picked, share) = choose(&lights, at)?;
            node = children[picked];
            probability *= share;
        }
    }
}

/// Chooses one of several weights in proportion to it. Returns its index and its share, and replaces `at`, from 0 to below
/// 1, by its place within that share. Returns `None` if all are 0.
pub(super) fn choose(weights: &[f64], at: &mut f64) -> Option<(usize, f64)> {
    let sum: f64 = weights.iter().sum();
    if !(sum > 0.0 && sum.is_finite()) {
        return None;
    }
    let (mut low, mut last) = (0.0, None);
    for (i, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
        let share = weight / sum;
        last = Some((i, share, low));
        if *at < low + share {
            break;
        }
        low += share;
    }
    let (i, share, low) = last?;
    *at = ((*at - low) / share).clamp(0.0, 1.0 - f64::EPSILON);
    Some((i, share))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn balls(count: usize) -> Vec<Bounds> {
        let at = |i: usize, k: f64| (i as f64 * k).fract() * 4.0 - 2.0;
        (0..count)
            .map(|i| Bounds {
                centre: DVec3::new(at(i, 0.618_034), 2.0 + at(i, 0.754_878), at(i, 0.569_840)),
                radius: 0.01,
                power: 1.0 + (i % 5) as f64,
                axis: DVec3::ZERO,
                cos_cone: -1.0,
                hull: None,
            })
            .collect()
    }

    #[test]
    fn shares_of_the_unit_interval_are_the_probabilities_of_the_picks() {
        let emitters = balls(37);
        let tree = Tree::new(&emitters);
        let (from, normal) = (DVec3::new(0.3, 0.0, -0.2), DVec3::Y);
        let n = 200_000;
        let mut found = vec![(0_u32, 0.0); emitters.len()];
        for i in 0..n {
            let mut at = (f64::from(i) + 0.5) / f64::from(n);
            let (picked, probability) = tree.pick(from, normal, &mut at).expect("all are above");
            assert!((0.0..1.0).contains(&at));
            found[picked as usize].0 += 1;
            found[picked as usize].1 = probability;
        }
        let sum: f64 = found.iter().map(|f| f.1).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
        for (count, probability) in found {
            assert!((f64::from(count) / f64::from(n) - probability).abs() < 2e-5, "{count} {probability}");
        }
    }

    #[test]
    fn the_depth_is_the_logarithm_of_the_number() {
        for (count, deepest) in [(1, 0), (2, 1), (1000, 10), (65_536, 16)] {
            let tree = Tree::new(&balls(count));
            let mut depths = vec![(0, 0)];
            let mut most = 0;
            while let Some((node, depth)) = depths.pop() {
                most = most.max(depth);
                if !tree.nodes[node].is_leaf {
                    depths.extend([(node + 1, depth + 1), (tree.nodes[node].next as usize, depth + 1)]);
                }
            }
            assert_eq!(most, deepest, "{count}");
        }
    }

    #[test]
    fn bounds_never_deny_light_that_arrives() {
        // Flat emitters on the faces of a cube: every one that faces the point and lies above its horizon counts.
        let mut emitters = Vec::new();
        let axes = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
        for axis in axes {
            for k in 0..9 {
                let (u, v) = axis.any_orthonormal_pair();
                let centre = axis + u * (f64::from(k % 3) - 1.0) * 0.6 + v * (f64::from(k / 3) - 1.0) * 0.6;
                let hull = Some(Aabb { lo: glam::Vec3::splat(-1.0), hi: glam::Vec3::ONE });
                emitters.push(Bounds { centre, radius: 0.0, power: 1.0, axis, cos_cone: 1.0, hull });
            }
        }
        let tree = Tree::new(&emitters);
        for k in 0..200 {
            let turn = |by: f64| (f64::from(k) * by).sin();
            let from = DVec3::new(turn(1.3), turn(2.1), turn(0.7)).normalize() * 2.5;
            let normal = DVec3::new(turn(5.3), turn(4.1), turn(3.7)).normalize();
            for e in &emitters {
                let way = (e.centre - from).normalize();
                let sent = normal.dot(way).max(0.0) * (-e.axis.dot(way)).max(0.0);
                let told = shares(&tree, 0, from, normal, e.centre);
                assert!(sent <= 1e-9 || told > 0.0, "{from} {normal} {e:?}");
            }
        }
    }

    /// The least estimate on the way from a node down to the emitter at a place; 0 if it is not below the node.
    fn shares(tree: &Tree, node: usize, from: DVec3, normal: DVec3, place: DVec3) -> f64 {
        let Node { bounds, next, is_leaf } = tree.nodes[node];
        let below = match is_leaf {
            true if bounds.centre == place => f64::INFINITY,
            true => 0.0,
            false => {
                let child = |child| shares(tree, child, from, normal, place);
                child(node + 1).max(child(next as usize))
            }
        };
        bounds.importance(from, normal).min(below)
    }
}
