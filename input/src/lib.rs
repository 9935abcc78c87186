//! Files that a user gives. Nothing here waits for a file without an end, or takes more memory than its bounds say. The FMUs link this
//! package, so it needs nothing but the standard library.

pub mod columns;
mod regular;

pub use regular::{open_once, open_regular, read, read_text};
