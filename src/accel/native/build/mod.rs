//! The build: primitives become a binary tree ([`sah`], or [`morton`] for fast builds), which [`reinsert`] may improve and
//! [`collapse`] turns into an eight-wide hierarchy. [`child_order`] then orders children for any-hit rays.

mod binary;
mod child_order;
pub(crate) mod collapse;
mod morton;
pub(crate) mod primitive;
mod reinsert;
mod sah;
mod split;
