//! Services of the operating system that leave nothing behind: temporary folders that go with the program, files written
//! atomically, child processes that end with the program, and input files that have an end.

pub mod atomic_file;
pub mod input;
pub mod output;
pub mod processes;
pub mod temporary;
