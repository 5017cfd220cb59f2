//! Tests of the program `vitrum`, one module a subject.

mod support;

mod bench;
mod budgets;
mod cli;
mod far;
mod faults;
mod limits;
mod mirrors_cli;
mod parity;
mod pixel;
mod price;
mod startup;
mod verify;
mod without_embree;
