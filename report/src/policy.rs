//! Which scripts a page may run: exactly those that stand in it.

use std::sync::LazyLock;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use sha2::{Digest, Sha256};

/// The script that turns figures into interactive charts.
pub(super) const PAGE_SCRIPT: &str = include_str!("page.js");

/// The charting library, Plotly (MIT license), as text that may stand in a page.
pub(super) static CHART_LIBRARY: LazyLock<String> = LazyLock::new(|| {
    let sources = plotly::Plot::offline_js_sources();
    // The first script is the library, the second typesets formulas, of which there are none.
    let script = sources.split_once('>').and_then(|(_, rest)| rest.split_once("</script>"));
    script.map_or_else(String::new, |(script, _)| script.replace('\r', "").trim().to_owned())
});

/// The content security policy of a page, with or without interactive charts.
pub(super) fn policy(has_charts: bool) -> String {
    if !has_charts {
        return "default-src 'none'; style-src 'unsafe-inline'; img-src data:".to_owned();
    }
    // The library sets styles from its script, and makes its PNG files by way of an image.
    format!(
        "default-src 'none'; script-src '{}' '{}'; style-src 'unsafe-inline'; img-src data: blob:",
        hash(PAGE_SCRIPT),
        hash(&CHART_LIBRARY)
    )
}

/// JSON that no page takes for the end of a script.
#[must_use]
pub fn inert(json: &str) -> String {
    // Outside of strings, JSON has none of these.
    json.replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
}

fn hash(script: &str) -> String {
    format!("sha256-{}", BASE64_STANDARD.encode(Sha256::digest(script.as_bytes())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_is_whole_and_may_stand_in_a_page() {
        assert!(CHART_LIBRARY.len() > 1_000_000 && CHART_LIBRARY.contains("plotly.js v"));
        for script in [CHART_LIBRARY.as_str(), PAGE_SCRIPT] {
            let script = script.to_ascii_lowercase();
            assert!(!script.contains("</script") && !script.contains("<!--"));
        }
    }

    #[test]
    fn hashes_are_those_of_the_standard() {
        assert_eq!(hash("abc"), "sha256-ungWv48Bz+pBQUDeXa4iI7ADYaOWF3qctBD/YfIAFa0=");
        assert!(!policy(false).contains("script-src"));
        assert_eq!(policy(true).matches("'sha256-").count(), 2);
    }
}
