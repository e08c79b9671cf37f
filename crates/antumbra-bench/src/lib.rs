//! The papers' tables and curves, measured again: techniques are timed and compared with ray-traced references, and the
//! results become pages, tables and files. The program `antumbra` calls this library; it adds arguments, progress bars
//! and exit codes.
//!
//! Dependencies go one way: `page` and [`table`] format; [`measure`] and [`truth`] measure; [`comparison`] is the
//! report of `antumbra compare`; [`kit`] runs experiments and writes the reports of suites; `suites` and [`studies`]
//! use the kit; [`list`] has one line per suite.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

pub mod comparison;
mod error;
pub mod kit;
pub mod list;
pub mod measure;
mod monitor;
mod page;
pub mod studies;
mod suites;
pub mod table;
pub mod truth;

pub use error::Error;
pub use monitor::{Monitor, Silent};
pub use page::files::{ReportError, links};
