//! Access to files: on disk, or where there is none.

use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};

/// Gives the bytes of a file by its path, or by the name of a file where there is no disk.
pub type ReadFile<'a> = dyn FnMut(&Path) -> io::Result<Vec<u8>> + 'a;

/// Reads a file from disk. A name that is not UTF-8 is also found as messages show it, with U+FFFD in the place of what
/// is not text, if there is only one such name: files that refer to others, and interfaces, hold names as text.
pub fn read_from_disk(path: &Path) -> io::Result<Vec<u8>> {
    std::fs::read(path).or_else(|error| match meant(path) {
        Some(file) => std::fs::read(file),
        None => Err(error),
    })
}

/// The path that messages show as this one.
fn meant(path: &Path) -> Option<PathBuf> {
    let is_shown = |part: &OsStr| part.to_str().is_some_and(|text| text.contains(char::REPLACEMENT_CHARACTER));
    if !path.iter().any(is_shown) {
        return None;
    }
    path.iter().try_fold(PathBuf::new(), |folder, part| {
        let as_given = folder.join(part);
        if is_shown(part) && !as_given.exists() { entry_shown_as(&folder, part) } else { Some(as_given) }
    })
}

fn entry_shown_as(folder: &Path, part: &OsStr) -> Option<PathBuf> {
    let here = Path::new(".");
    let entries = std::fs::read_dir(if folder.as_os_str().is_empty() { here } else { folder }).ok()?;
    let mut alike = entries.flatten().map(|e| e.file_name()).filter(|name| *name.to_string_lossy() == *part);
    let name = alike.next().filter(|_| alike.next().is_none())?;
    Some(folder.join(name))
}
