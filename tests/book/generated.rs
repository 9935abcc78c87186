//! Files that follow from others and are kept equal to them.

use crate::{root, updating};

/// Holds the file at `path`, from the root of the source tree, against what it must be; writes it when updating.
pub fn keep(path: &str, expected: &str) {
    let file = root().join(path);
    if updating() {
        std::fs::write(&file, expected).unwrap();
    }
    let found = std::fs::read_to_string(&file).unwrap_or_default();
    let differs = expected.lines().zip(found.lines()).find(|(wanted, there)| wanted != there);
    assert!(found == expected, "{path} is out of date, at {differs:?}: run `UPDATE_BOOK=1 cargo test --test book`");
}
