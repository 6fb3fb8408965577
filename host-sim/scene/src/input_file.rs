//! Reading of files that a user names: plain files only, up to a size.
//!
//! A pipe or a device may have no end, or never begin.

use std::fmt;
use std::fs::{self, File};
use std::io::{self, Read, Take};
use std::path::Path;

/// Largest size of a table that the command itself wrote: a trace or the rows of a campaign, bytes.
pub const MAX_TABLE_BYTES: u64 = 1 << 30;

/// Reason why a file cannot be read. Its text follows the file's name, and needs a fix after it.
#[derive(Debug)]
pub enum Unreadable {
    /// It cannot be opened.
    Open(io::Error),
    /// It is a directory.
    Directory,
    /// It is neither a file nor a directory.
    NotPlain,
    /// It has more bytes than this.
    TooLarge(u64),
    /// It cannot be read.
    Read(io::Error),
}

impl fmt::Display for Unreadable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Open(error) => write!(f, "cannot be opened: {error}"),
            Self::Directory => write!(f, "is a directory"),
            Self::NotPlain => write!(f, "is a pipe or a device, and not a plain file"),
            Self::TooLarge(max) => write!(f, "is larger than {} MiB", max >> 20),
            Self::Read(error) => write!(f, "cannot be read: {error}"),
        }
    }
}

impl std::error::Error for Unreadable {}

/// Opens a plain file of at most `max` bytes. No more are read if it grows.
///
/// # Errors
/// It is no such file, or cannot be opened.
pub fn open(path: &Path, max: u64) -> Result<Take<File>, Unreadable> {
    // The kind is checked first, because a pipe without a writer cannot be opened.
    let about = fs::metadata(path).map_err(Unreadable::Open)?;
    if about.is_dir() {
        return Err(Unreadable::Directory);
    }
    if !about.is_file() {
        return Err(Unreadable::NotPlain);
    }
    if about.len() > max {
        return Err(Unreadable::TooLarge(max));
    }
    let file = File::open(path).map_err(Unreadable::Open)?;
    Ok(file.take(max))
}

/// Reads a plain file of at most `max` bytes.
///
/// # Errors
/// It is no such file, or cannot be read.
pub fn read(path: &Path, max: u64) -> Result<Vec<u8>, Unreadable> {
    let mut bytes = Vec::new();
    open(path, max)?
        .read_to_end(&mut bytes)
        .map_err(Unreadable::Read)?;
    Ok(bytes)
}

/// Reads a plain file of UTF-8 text of at most `max` bytes.
///
/// # Errors
/// It is no such file, or cannot be read.
pub fn read_text(path: &Path, max: u64) -> Result<String, Unreadable> {
    let mut text = String::new();
    open(path, max)?
        .read_to_string(&mut text)
        .map_err(Unreadable::Read)?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_plain_files_up_to_the_size_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, [7; 100]).unwrap();
        assert_eq!(read(&file, 100).unwrap().len(), 100);
        assert!(matches!(read(&file, 99), Err(Unreadable::TooLarge(99))));
        assert!(matches!(
            read(folder.path(), 100),
            Err(Unreadable::Directory)
        ));
        assert!(matches!(
            read(&folder.path().join("none"), 100),
            Err(Unreadable::Open(_))
        ));
    }

    /// If this fails, the test hangs at the pipe, or its memory grows without a bound at the device.
    #[cfg(unix)]
    #[test]
    fn pipes_and_devices_are_refused_before_they_are_opened() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.unwrap().success());
        for path in [&*pipe, Path::new("/dev/zero"), Path::new("/dev/null")] {
            assert!(
                matches!(read_text(path, 100), Err(Unreadable::NotPlain)),
                "{}",
                path.display()
            );
        }
    }
}
