//! Tools of measurement that trials and studies share: statistics of times, seeded random numbers, the machine's description,
//! and tables.

pub mod figure;
pub mod html;
pub mod machine;
pub mod percentiles;
pub mod random;
pub(crate) mod sample;
pub mod shell;
pub mod table;

pub use figure::Figure;
pub use machine::Machine;
pub use percentiles::Percentiles;
