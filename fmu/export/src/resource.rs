//! The resource location that an importer hands to `fmi2Instantiate`.

use std::path::PathBuf;

/// Why a resource location is none.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(crate) enum ResourceError {
    /// Not a file on this machine.
    #[error("resource location {0:?} is no file URI; file:///path and file:/path are understood")]
    NoFileUri(String),
    /// A percent sign that does not start two hexadecimal digits, or bytes that are not UTF-8.
    #[error("resource location {0:?} is not percent-encoded UTF-8")]
    BadEncoding(String),
}

/// The folder that a resource location names: `file:///path` as the standard has it, `file:/path` or `file://localhost/path` as
/// importers write it.
pub(crate) fn resource_folder(uri: &str) -> Result<PathBuf, ResourceError> {
    let rest = uri.split_at_checked(5).filter(|(scheme, _)| scheme.eq_ignore_ascii_case("file:"));
    let path = rest.map(|(_, rest)| match rest.strip_prefix("//") {
        None => rest,
        Some(authority) => authority.strip_prefix("localhost").unwrap_or(authority),
    });
    let path = path.filter(|path| path.starts_with('/')).ok_or_else(|| ResourceError::NoFileUri(uri.to_owned()))?;
    let path = decoded(path).ok_or_else(|| ResourceError::BadEncoding(uri.to_owned()))?;
    // On Windows a drive follows the slash.
    Ok(if cfg!(windows) { path.trim_start_matches('/').into() } else { path.into() })
}

/// Text without its percent encoding.
fn decoded(text: &str) -> Option<String> {
    let mut parts = text.split('%');
    let mut bytes = parts.next().unwrap_or_default().as_bytes().to_vec();
    for part in parts {
        let (hex, rest) = part.split_at_checked(2)?;
        bytes.push(u8::from_str_radix(hex, 16).ok().filter(|_| !hex.starts_with('+'))?);
        bytes.extend(rest.as_bytes());
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spellings_of_importers_are_understood() {
        for (uri, path) in [
            ("file:///tmp/fmu/resources", "/tmp/fmu/resources"),
            ("file:/tmp/fmu", "/tmp/fmu"),
            ("file://localhost/tmp/a", "/tmp/a"),
            ("file:///tmp/a%20b%C3%A9", "/tmp/a b\u{e9}"),
            ("FILE:///tmp", "/tmp"),
        ] {
            let path = if cfg!(windows) { &path[1..] } else { path };
            assert_eq!(resource_folder(uri), Ok(path.into()), "{uri}");
        }
    }

    #[test]
    fn what_is_no_file_is_refused() {
        for uri in ["", "file", "file:", "/tmp", "http://host/a", "file://host/a", "file:a", "f\u{e9}le:/a"] {
            assert!(matches!(resource_folder(uri), Err(ResourceError::NoFileUri(_))), "{uri}");
        }
        for uri in ["file:///a%2", "file:///a%zz", "file:///a%+f", "file:///a%FF", "file:///%"] {
            assert!(matches!(resource_folder(uri), Err(ResourceError::BadEncoding(_))), "{uri}");
        }
    }
}
