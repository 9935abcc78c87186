//! The directory at the end of a zip archive, looked at before and beside the reader of it.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};

/// Whether the archive ends with a zip64 directory. Only that can announce more than 65535 entries, so its absence
/// bounds the memory that the directory takes before the entries can be counted.
pub(super) fn is_zip64(file: &mut File) -> io::Result<bool> {
    const END: &[u8] = b"PK\x05\x06";
    const ZIP64_LOCATOR: &[u8] = b"PK\x06\x07";
    const LOCATOR_LENGTH: usize = 20;
    // The end record may be followed by a comment of at most 64 KiB.
    const TAIL: u64 = 65_536 + 22 + LOCATOR_LENGTH as u64;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(TAIL)))?;
    let mut tail = Vec::new();
    file.take(TAIL).read_to_end(&mut tail)?;
    file.rewind()?;
    let mut records = tail.windows(LOCATOR_LENGTH + END.len());
    Ok(records.any(|window| window.starts_with(ZIP64_LOCATOR) && window.ends_with(END)))
}

/// Number of entries in the directory that begins at `start`, at most `most`. The reader keeps the last of those that
/// share a name, and says nothing.
pub(super) fn count(file: &File, start: u64, most: usize) -> io::Result<usize> {
    const HEADER: &[u8] = b"PK\x01\x02";
    const LENGTH: usize = 46;
    let mut file = BufReader::new(file);
    file.seek(SeekFrom::Start(start))?;
    let mut count = 0;
    let mut header = Vec::with_capacity(LENGTH);
    while count < most {
        header.clear();
        file.by_ref().take(LENGTH as u64).read_to_end(&mut header)?;
        if header.len() < LENGTH || !header.starts_with(HEADER) {
            break;
        }
        // Lengths of name, extra field and comment.
        let rest: i64 =
            [28, 30, 32].iter().map(|&at| i64::from(u16::from_le_bytes([header[at], header[at + 1]]))).sum();
        file.seek_relative(rest)?;
        count += 1;
    }
    Ok(count)
}
