//! What the harness asks of the operating system, with nothing left behind: folders that are gone when the program ends, files
//! that are there whole or not at all, processes that end with the program, files read only where they have an end.

pub mod atomic_file;
pub mod input;
pub mod processes;
pub mod temporary;
