//! Packager of FMUs.
//!
//! - [`Project`] is a Cargo package whose library exports a model with `fmu-export`: Cargo builds the library for this machine or others,
//!   the library gives its model description, and licences, documentation and resources beside `Cargo.toml` are added. `cargo fmu build`
//!   (package `cargo-fmu`) is this on the command line.
//! - [`Fmu`] is an FMU that is put together from parts: a model description of FMI 2.0 or 3.0, libraries, and whatever else.
//!
//! ```no_run
//! use fmu_package::{Project, Request};
//!
//! # fn main() -> fmu_package::Result<()> {
//! let project = Project::find(&Request { package: Some("lag".to_owned()), ..Request::default() })?;
//! println!("{}", project.build()?.display());
//! # Ok(())
//! # }
//! ```
//!
//! Equal contents give equal bytes, whatever the machine and the day. An archive is written under another name and renamed, so that
//! nobody ever sees half of one.

mod binary;
pub mod cargo;
mod describe;
mod documentation;
mod entries;
mod error;
mod fmu;
mod licenses;
mod metadata;
mod platform;
mod project;
mod resources;
mod shared_file;
mod target;
mod tools;
mod version;

pub use binary::AddedBinary;
pub use cargo::Messages;
pub use entries::Entries;
pub use error::{PackageError, Result};
pub use fmu::Fmu;
pub use platform::Platform;
pub use project::{Project, Request};
pub use resources::add_resources;
pub use shared_file::write_shared;
pub use target::{Target, targets};
pub use version::FmiVersion;
