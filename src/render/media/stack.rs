//! Stack of the bodies that a ray has entered.

use crate::scene::{Bodies, Medium, Rgb};

/// Index of an interned stack within one [`MediaTable`](super::MediaTable).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct StackId(pub(super) u32);

/// Bodies a ray has entered, by rising rank, and its wavelength. Wavelength 0 is white; the others are counted through
/// all sets.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Stack {
    pub entered: Vec<u32>,
    pub wave: u32,
}

/// Optical properties of the medium on top of a stack.
#[derive(Clone, Copy, Debug)]
pub(super) struct TopMedium {
    pub medium: u32,
    pub ior: f64,
    pub absorption: Rgb,
    pub absorbs: bool,
}

/// Inserts `body` by rank: above all bodies of equal or lower rank, below all of higher rank. The top is the end of the
/// list.
pub(super) fn insert(stack: &mut Vec<u32>, body: u32, bodies: &Bodies) {
    let rank = bodies.rank(body);
    let at = stack.partition_point(|&b| bodies.rank(b) <= rank);
    stack.insert(at, body);
}

/// Returns the medium that fills the space inside the bodies of `stack`: that of the top, unless medium 0 has a higher
/// priority.
pub(super) fn filling(stack: &[u32], bodies: &Bodies, media: &[Medium]) -> u32 {
    let top = stack.last().map(|&body| bodies.medium(body));
    top.filter(|&m| media[m as usize].priority >= media[0].priority).unwrap_or(0)
}
