//! Makes one file of the page that shows the harvester in a browser.
//!
//! Cargo compiles `videg-explorer` for wasm32-unknown-unknown, wasm-bindgen makes its interface for JavaScript ([`Engine`]), and both go
//! into `explorer/page/page.html` with the scripts and the style beside it ([`page`]). The page loads nothing, and runs the scripts in
//! it only.
#![forbid(unsafe_code)]

mod engine;
mod module;
mod page;

pub use engine::Engine;
pub use page::page;
