//! The same picture in `f64`.
