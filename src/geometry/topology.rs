//! Connectivity of triangles: corners at one place, edges that triangles share, and sheets of triangles joined along
//! their edges.
//!
//! This is the one topology of the house. Loading (smooth normals, warnings about open glass), the effect plan (closed
//! shells), `verify` (open edges by name) and the `f64` arbiter (leaks against cracks) all use it.

use std::collections::HashMap;

use glam::Vec3;

use super::mesh::TriMesh;

/// Returns for each position the index of the first one at exactly the same place (0 and -0 are the same).
pub(crate) fn weld(positions: &[Vec3]) -> Vec<u32> {
    let mut seen: HashMap<[u32; 3], u32> = HashMap::with_capacity(positions.len());
    positions.iter().enumerate().map(|(i, p)| *seen.entry(place(*p)).or_insert(i as u32)).collect()
}

/// The bits of a position; 0 and -0 are the same place.
pub(crate) fn place(p: Vec3) -> [u32; 3] {
    // Adding zero turns -0 into 0.
    (p + Vec3::ZERO).to_array().map(f32::to_bits)
}

/// The most bytes that [`weld`] and [`Edges::new`] take for a mesh.
pub(crate) fn bytes(mesh: &TriMesh) -> u64 {
    // A hash map has a power of two of entries and is seven eighths full at most.
    let entries = (mesh.positions.len() / 7 * 8 + 8).next_power_of_two() * (size_of::<([u32; 3], u32)>() + 1);
    let edges = 3 * mesh.triangles.len() * size_of::<(u64, Side)>();
    (entries + mesh.positions.len() * size_of::<u32>() + edges) as u64
}

/// All edges of some triangles, equal ones next to each other.
pub(crate) struct Edges {
    /// Both ends (the lower one in the upper half), and the side of one triangle.
    sorted: Vec<(u64, Side)>,
}

/// One triangle's side of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Side {
    /// The triangle.
    pub triangle: u32,
    /// The corner that the edge starts at, 0..3.
    pub corner: u8,
    /// True if the triangle runs along it from the lower to the higher end.
    pub upwards: bool,
}

impl Edges {
    /// The edges of `triangles`, whose corner `i` counts as `weld[i]`. Triangles with an edge of no length are left out.
    pub fn new(triangles: &[[u32; 3]], weld: &[u32]) -> Self {
        Self::some(triangles, weld, |_| true)
    }

    /// The edges of the triangles of `mesh` that can be hit. Corners at one place are one corner.
    pub fn usable(mesh: &TriMesh) -> Self {
        Self::some(&mesh.triangles, &weld(&mesh.positions), |i| mesh.is_usable(i))
    }

    fn some(triangles: &[[u32; 3]], weld: &[u32], keep: impl Fn(usize) -> bool) -> Self {
        let mut sorted = Vec::with_capacity(triangles.len() * 3);
        for (triangle, t) in triangles.iter().enumerate() {
            let t = t.map(|i| weld[i as usize]);
            if t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || !keep(triangle) {
                continue;
            }
            for corner in 0..3 {
                let (a, b) = (t[corner], t[(corner + 1) % 3]);
                let key = u64::from(a.min(b)) << 32 | u64::from(a.max(b));
                sorted.push((key, Side { triangle: triangle as u32, corner: corner as u8, upwards: a < b }));
            }
        }
        sorted.sort_unstable();
        Self { sorted }
    }

    /// The sides of each edge.
    pub fn groups(&self) -> impl Iterator<Item = &[(u64, Side)]> {
        self.sorted.chunk_by(|a, b| a.0 == b.0)
    }

    /// The edges that are not run along equally often both ways.
    fn unbalanced(&self) -> impl Iterator<Item = &[(u64, Side)]> {
        let balance = |group: &[(u64, Side)]| group.iter().map(|(_, s)| if s.upwards { 1i64 } else { -1 }).sum::<i64>();
        self.groups().filter(move |g| balance(g) != 0)
    }

    /// The number of edges that are not run along equally often both ways, and a triangle at one of them; none if the
    /// mesh is closed.
    pub fn open(&self) -> Option<(usize, u32)> {
        let open: Vec<u32> = self.unbalanced().map(|g| g[0].1.triangle).collect();
        open.iter().min().map(|&first| (open.len(), first))
    }

    /// The first triangle of each edge that is not run along equally often both ways; ascending, each once.
    pub fn open_triangles(&self) -> Vec<usize> {
        let mut open: Vec<usize> = self.unbalanced().map(|g| g[0].1.triangle as usize).collect();
        open.sort_unstable();
        open.dedup();
        open
    }

    /// Returns true if every edge has exactly two sides, once each way.
    pub fn manifold(&self) -> bool {
        self.groups().all(|g| g.len() == 2 && g[0].1.upwards != g[1].1.upwards)
    }
}

/// Sets of numbers that are joined pair by pair.
#[derive(Clone, Debug)]
pub(crate) struct Groups {
    parents: Vec<u32>,
}

impl Groups {
    /// The numbers `0..count`, each in a group of its own.
    pub fn new(count: usize) -> Self {
        Self { parents: (0..count as u32).collect() }
    }

    /// The number that stands for the group of `i`.
    pub fn find(&mut self, mut i: u32) -> u32 {
        while self.parents[i as usize] != i {
            let above = self.parents[self.parents[i as usize] as usize];
            self.parents[i as usize] = above;
            i = above;
        }
        i
    }

    /// Makes one group of those of `a` and `b`.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }
}
