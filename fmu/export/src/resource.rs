//! The resource location that an importer hands to `fmi2Instantiate`.

use std::path::PathBuf;

/// Why a resource location is no path.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ResourceError {
    /// Not a file on this machine.
    #[error("resource location {0:?} is no file URI; file:///path and file:/path are understood")]
    NoFileUri(String),
    /// A percent sign that does not start two hexadecimal digits, or bytes that are not UTF-8.
    #[error("resource location {0:?} is not percent-encoded UTF-8")]
    BadEncoding(String),
}

/// The path behind a resource location: `file:///path` as the standard has it, `file:/path` and
/// `file://localhost/path` as importers write it, percent-encoding decoded.
///
/// # Errors
/// If it is no file URI, or badly encoded.
pub fn resource_path(uri: &str) -> Result<PathBuf, ResourceError> {
    let no_file = || ResourceError::NoFileUri(uri.to_owned());
    let scheme = uri.get(..5).ok_or_else(no_file)?;
    if !scheme.eq_ignore_ascii_case("file:") {
        return Err(no_file());
    }
    let rest = &uri[5..];
    let path = match rest.strip_prefix("//") {
        None => rest,
        Some(authority) => authority.strip_prefix("localhost").unwrap_or(authority),
    };
    if !path.starts_with('/') {
        return Err(no_file());
    }
    let path = percent_decode(path).ok_or_else(|| ResourceError::BadEncoding(uri.to_owned()))?;
    Ok(PathBuf::from(without_drive_slash(&path)))
}

/// `/C:/fmu` is `C:/fmu` on Windows.
fn without_drive_slash(path: &str) -> &str {
    match path.as_bytes() {
        [b'/', drive, b':', ..] if drive.is_ascii_alphabetic() => &path[1..],
        _ => path,
    }
}

fn percent_decode(text: &str) -> Option<String> {
    let mut bytes = text.bytes();
    let mut decoded = Vec::with_capacity(text.len());
    while let Some(byte) = bytes.next() {
        if byte == b'%' {
            let mut digit = || char::from(bytes.next()?).to_digit(16);
            let (high, low) = (digit()?, digit()?);
            decoded.push(u8::try_from(high * 16 + low).ok()?);
        } else {
            decoded.push(byte);
        }
    }
    String::from_utf8(decoded).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spellings_of_importers_are_understood() {
        let cases = [
            ("file:///tmp/fmu/resources", "/tmp/fmu/resources"),
            ("file:/tmp/fmu/resources", "/tmp/fmu/resources"),
            ("file://localhost/tmp/a", "/tmp/a"),
            ("FILE:///tmp/a%20b%C3%A9", "/tmp/a b\u{e9}"),
            ("file:///C:/fmu", "C:/fmu"),
        ];
        for (uri, path) in cases {
            assert_eq!(resource_path(uri), Ok(PathBuf::from(path)), "{uri}");
        }
    }

    #[test]
    fn what_is_no_file_is_refused() {
        for uri in ["", "file", "file:", "/tmp", "http://host/a", "file://host/a", "file:a", "f\u{e9}le:/a"] {
            assert!(matches!(resource_path(uri), Err(ResourceError::NoFileUri(_))), "{uri}");
        }
        for uri in ["file:///a%2", "file:///a%zz", "file:///a%FF", "file:///%"] {
            assert!(matches!(resource_path(uri), Err(ResourceError::BadEncoding(_))), "{uri}");
        }
    }
}
