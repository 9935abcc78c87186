//! Input files. Anything but a regular file is refused: opening or reading a pipe or a device may never end.

use std::fs::{File, Metadata};
use std::io;
use std::path::Path;

/// Opens a regular file for reading.
///
/// # Errors
/// If it is none, or the system refuses.
pub fn open_regular(path: &Path) -> io::Result<File> {
    open(path, |_| false)
}

/// Opens a file that is read once: a regular one, or one that the program was given open, such as `/dev/stdin` or `<(...)` of a
/// shell. A named pipe is refused: it may have no writer.
///
/// # Errors
/// If it is none, or the system refuses.
pub fn open_once(path: &Path) -> io::Result<File> {
    open(path, |path| path.starts_with("/dev") || path.starts_with("/proc/self/fd"))
}

/// As [`std::fs::read`], of a regular file.
///
/// # Errors
/// As [`open_regular`].
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    io::Read::read_to_end(&mut open_regular(path)?, &mut bytes).map(|_| bytes)
}

/// As [`std::fs::read_to_string`], of a regular file.
///
/// # Errors
/// As [`open_regular`], and if it is not UTF-8.
pub fn read_text(path: &Path) -> io::Result<String> {
    io::read_to_string(open_regular(path)?)
}

fn open(path: &Path, is_given: impl FnOnce(&Path) -> bool) -> io::Result<File> {
    let found = std::fs::metadata(path)?;
    if found.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if !found.is_file() && !is_given(path) {
        return Err(io::Error::other(format!("it is {}, not a regular file", kind(&found))));
    }
    File::open(path)
}

#[cfg(unix)]
fn kind(found: &Metadata) -> &'static str {
    use std::os::unix::fs::FileTypeExt as _;
    let kind = found.file_type();
    if kind.is_fifo() {
        "a pipe"
    } else if kind.is_socket() {
        "a socket"
    } else {
        "a device"
    }
}

#[cfg(not(unix))]
fn kind(_: &Metadata) -> &'static str {
    "something else"
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;

    #[test]
    fn what_may_have_no_end_is_refused_before_it_is_opened() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for open in [open_regular, open_once] {
            assert_eq!(open(&pipe).unwrap_err().to_string(), "it is a pipe, not a regular file");
            assert_eq!(open(folder.path()).unwrap_err().kind(), io::ErrorKind::IsADirectory);
        }
        assert_eq!(open_regular(Path::new("/dev/zero")).unwrap_err().to_string(), "it is a device, not a regular file");
    }

    #[test]
    fn what_the_program_was_given_open_is_read_once() {
        assert!(open_once(Path::new("/dev/null")).is_ok());
    }
}
