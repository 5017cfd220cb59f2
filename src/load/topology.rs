//! How triangles hang together: corners at the same place, and edges that two triangles share.

use std::collections::HashMap;

use glam::Vec3;

use crate::geometry::TriMesh;

/// For each position the first one at exactly the same place (0 and -0 are the same).
pub(super) fn weld(positions: &[Vec3]) -> Vec<u32> {
    let mut seen: HashMap<[u32; 3], u32> = HashMap::with_capacity(positions.len());
    positions
        .iter()
        .enumerate()
        // Adding zero turns -0 into 0.
        .map(|(i, p)| *seen.entry((*p + Vec3::ZERO).to_array().map(f32::to_bits)).or_insert(i as u32))
        .collect()
}

/// The most bytes that [`weld`] and [`Edges::new`] take for a mesh.
pub(super) fn bytes(mesh: &TriMesh) -> u64 {
    // A hash map has a power of two of entries and is seven eighths full at most.
    let entries = (mesh.positions.len() / 7 * 8 + 8).next_power_of_two() * (size_of::<([u32; 3], u32)>() + 1);
    let edges = 3 * mesh.triangles.len() * size_of::<(u64, Side)>();
    (entries + mesh.positions.len() * size_of::<u32>() + edges) as u64
}

/// All edges of a mesh, equal ones next to each other.
pub(super) struct Edges {
    /// Both ends (the lower one in the upper half), and where it is met.
    sorted: Vec<(u64, Side)>,
}

/// One triangle's side of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side {
    /// The triangle.
    pub triangle: u32,
    /// The corner that the edge starts at, 0..3.
    pub corner: u8,
    /// Whether the triangle runs along it from the lower to the higher end.
    pub upwards: bool,
}

impl Edges {
    /// The edges of `triangles`, whose corner `i` counts as `weld[i]`. Edges of no length are left out.
    pub(super) fn new(triangles: &[[u32; 3]], weld: &[u32]) -> Self {
        let mut sorted = Vec::with_capacity(triangles.len() * 3);
        for (triangle, t) in triangles.iter().enumerate() {
            let t = t.map(|i| weld[i as usize]);
            if t[0] == t[1] || t[1] == t[2] || t[2] == t[0] {
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
    pub(super) fn groups(&self) -> impl Iterator<Item = &[(u64, Side)]> {
        self.sorted.chunk_by(|a, b| a.0 == b.0)
    }

    /// How many edges are not run along equally often both ways, and a triangle at one of them; none when the mesh
    /// is closed.
    pub(super) fn open(&self) -> Option<(usize, u32)> {
        let balance = |group: &[(u64, Side)]| group.iter().map(|(_, s)| if s.upwards { 1i64 } else { -1 }).sum::<i64>();
        let open: Vec<u32> = self.groups().filter(|g| balance(g) != 0).map(|g| g[0].1.triangle).collect();
        open.iter().min().map(|&first| (open.len(), first))
    }

    /// Whether every edge has exactly two sides, once each way.
    #[cfg(test)]
    pub(super) fn manifold(&self) -> bool {
        self.groups().all(|g| g.len() == 2 && g[0].1.upwards != g[1].1.upwards)
    }
}
