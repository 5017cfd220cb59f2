//! Rays prepared for traversal: whole packets ([`packet8`]), and one ray of a packet broadcast to all lanes
//! ([`lane_ray`]).

pub(crate) mod lane_ray;
pub(crate) mod packet8;
