//! Pictures: the film, and reading, writing and comparing them.

mod film;

pub use film::Film;
