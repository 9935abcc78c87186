//! Services of the operating system that leave nothing behind: temporary folders that go with the program, files written
//! atomically, and child processes that end with the program, with pipes to them and messages over these.

pub mod atomic_file;
pub mod folders;
mod lock;
pub mod messages;
pub mod output;
mod pipes;
pub mod processes;
mod streams;
pub mod temporary;
pub mod worker;
