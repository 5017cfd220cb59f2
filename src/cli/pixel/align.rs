//! Two trees of rays side by side.

use crate::render::RayKind;
use crate::render::record::{Event, Met, Node, Tree};

/// A ray in either renderer, or in one of them alone.
#[derive(Clone, Debug)]
pub(super) struct Row {
    /// Node in the `f32` tree.
    pub narrow: Option<Node>,
    /// Node in the `f64` tree.
    pub wide: Option<Node>,
    /// Row of the surface that sent it.
    pub parent: Option<usize>,
    /// Number of rows above it in the tree.
    pub level: usize,
    /// Rows that its surface sent.
    pub sent: Vec<usize>,
}

/// Returns the rows of both trees, or of one sample (from 1), each before the rows that it sent.
pub(super) fn rows(narrow: &Tree, wide: &Tree, sample: Option<u32>) -> Vec<Row> {
    let sent = (narrow.children(), wide.children());
    let mut rows: Vec<Row> = Vec::new();
    let roots = zipped(&narrow.roots(), &wide.roots());
    let shown = |i: usize| sample.is_none_or(|k| k as usize == i + 1);
    let mut waiting: Vec<_> =
        roots.into_iter().enumerate().filter(|(i, _)| shown(*i)).map(|(_, (a, b))| (a, b, None, 0)).collect();
    waiting.reverse();
    while let Some((a, b, parent, level)) = waiting.pop() {
        let place = rows.len();
        rows.push(Row { narrow: a, wide: b, parent, level, sent: Vec::new() });
        if let Some(parent) = parent {
            let parent: &mut Row = &mut rows[parent];
            parent.sent.push(place);
        }
        let of = |tree: &Tree, sent: &[Vec<Node>], node: Option<Node>, kind: RayKind| -> Vec<Node> {
            let all = node.map_or(&[][..], |node| &sent[node as usize]);
            all.iter().copied().filter(|&child| tree.events[child as usize].kind == kind).collect()
        };
        let comparable = match (a, b) {
            (Some(a), Some(b)) => met_alike(&narrow.events[a as usize], &wide.events[b as usize]),
            _ => false,
        };
        // Last in, first out.
        for kind in [RayKind::Transmitted, RayKind::Reflected] {
            let (mine, theirs) = (of(narrow, &sent.0, a, kind), of(wide, &sent.1, b, kind));
            let mut pairs = if comparable {
                zipped(&mine, &theirs)
            } else {
                let alone = mine.iter().map(|&m| (Some(m), None)).chain(theirs.iter().map(|&t| (None, Some(t))));
                alone.collect()
            };
            pairs.reverse();
            waiting.extend(pairs.into_iter().map(|(a, b)| (a, b, Some(place), level + 1)));
        }
    }
    rows
}

/// Returns true if the rays that follow two rays can be compared.
pub(super) fn met_alike(a: &Event, b: &Event) -> bool {
    let kind = |event: &Event| match event.met {
        Met::Nothing => 0,
        Met::Spent => 1,
        Met::Absent { .. } => 2,
        Met::Surface { front, .. } => 3 + i32::from(front),
    };
    a.object() == b.object() && kind(a) == kind(b)
}

fn zipped(a: &[Node], b: &[Node]) -> Vec<(Option<Node>, Option<Node>)> {
    (0..a.len().max(b.len())).map(|i| (a.get(i).copied(), b.get(i).copied())).collect()
}
