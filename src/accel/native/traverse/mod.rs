//! Traversal. [`dispatch`] divides a stream of ray packets between three kernels: [`tile`] traces packets together as
//! frustums, [`stream`] traces scattered rays node by node, [`single`] traces rays one by one.

pub(crate) mod dispatch;
mod frustum;
mod grouping;
mod single;
pub(crate) mod stack;
mod stream;
mod tile;
