//! The resource location that an importer hands to `fmi2Instantiate`.

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

/// Whether it is `file:///path` as the standard has it, `file:/path` or `file://localhost/path` as importers write it.
pub(crate) fn check_resource_location(uri: &str) -> Result<(), ResourceError> {
    let rest = uri.split_at_checked(5).filter(|(scheme, _)| scheme.eq_ignore_ascii_case("file:"));
    let path = rest.map(|(_, rest)| match rest.strip_prefix("//") {
        None => rest,
        Some(authority) => authority.strip_prefix("localhost").unwrap_or(authority),
    });
    match path.filter(|path| path.starts_with('/')) {
        None => Err(ResourceError::NoFileUri(uri.to_owned())),
        Some(path) if is_percent_encoded(path) => Ok(()),
        Some(_) => Err(ResourceError::BadEncoding(uri.to_owned())),
    }
}

fn is_percent_encoded(text: &str) -> bool {
    let mut parts = text.split('%');
    let mut bytes = parts.next().unwrap_or_default().as_bytes().to_vec();
    for part in parts {
        let Some((hex, rest)) = part.split_at_checked(2) else { return false };
        let Some(byte) = u8::from_str_radix(hex, 16).ok().filter(|_| !hex.starts_with('+')) else { return false };
        bytes.push(byte);
        bytes.extend(rest.as_bytes());
    }
    String::from_utf8(bytes).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spellings_of_importers_are_understood() {
        for path in ["///tmp/fmu/resources", "/tmp/fmu", "//localhost/tmp/a", "///tmp/a%20b%C3%A9", "///C:/fmu"] {
            assert_eq!(check_resource_location(&format!("file:{path}")), Ok(()), "{path}");
        }
        assert_eq!(check_resource_location("FILE:///tmp"), Ok(()));
    }

    #[test]
    fn what_is_no_file_is_refused() {
        for uri in ["", "file", "file:", "/tmp", "http://host/a", "file://host/a", "file:a", "f\u{e9}le:/a"] {
            assert!(matches!(check_resource_location(uri), Err(ResourceError::NoFileUri(_))), "{uri}");
        }
        for uri in ["file:///a%2", "file:///a%zz", "file:///a%+f", "file:///a%FF", "file:///%"] {
            assert!(matches!(check_resource_location(uri), Err(ResourceError::BadEncoding(_))), "{uri}");
        }
    }
}
