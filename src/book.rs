//! Chapters of the book whose Rust is compiled and run as documentation tests. `tests/book` sees that each one with Rust in it
//! is listed.

macro_rules! chapters {
    ($($name:ident: $path:literal;)*) => {
        $(#[doc = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), $path))] mod $name {})*
    };
}

chapters! {
    circuit: "/docs/howto/circuit.md";
    dynamics: "/docs/howto/dynamics.md";
    map: "/docs/howto/map.md";
}
