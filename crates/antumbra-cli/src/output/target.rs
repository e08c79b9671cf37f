//! Where an output goes: a plain file, a pipe or a device; behind links, if its name is one.

use antumbra_bench::links;
use std::ffi::OsStr;
use std::fs::{self, File, FileType, Metadata, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// What takes the bytes of an output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// A plain file, which may be new. It is replaced as a whole.
    File(PathBuf),
    /// A pipe, a device, or a file that the program was started with, as `/dev/fd/3`. It is written into.
    Stream(PathBuf),
    /// Standard output, as `/dev/stdout`. Opened by its name, a file would be written from its start again.
    Stdout,
    /// Standard error.
    Stderr,
}

impl Target {
    /// Follows links.
    pub fn of(path: &Path) -> Target {
        match links(path).find_map(|step| descriptor(&step)) {
            Some(1) => return Target::Stdout,
            Some(2) => return Target::Stderr,
            Some(_) => return Target::Stream(path.to_owned()),
            None => {}
        }
        let end = links(path).last().unwrap_or_else(|| path.to_owned());
        match fs::metadata(&end).is_ok_and(|m| !m.is_file() && !m.is_dir()) {
            true => Target::Stream(end),
            false => Target::File(end),
        }
    }

    /// True for a plain file.
    pub fn is_file(&self) -> bool {
        matches!(self, Target::File(_))
    }

    /// The path behind links, if it has a name of its own.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Target::File(path) | Target::Stream(path) => Some(path),
            Target::Stdout | Target::Stderr => None,
        }
    }

    /// True if two outputs would destroy each other. A device takes many.
    pub fn is_same(&self, other: &Target) -> bool {
        match (self, other) {
            (Target::File(a), Target::File(b)) => place(a) == place(b),
            (Target::Stdout, Target::Stdout) | (Target::Stderr, Target::Stderr) => true,
            _ => self.identity().is_some_and(|own| other.identity() == Some(own)),
        }
    }

    /// True if text on standard output would end up among the bytes.
    pub fn is_stdout(&self) -> bool {
        !self.is_file() && self.is_same(&Target::Stdout)
    }

    /// Writes into a stream.
    pub fn write(&self, bytes: &[u8]) -> io::Result<()> {
        self.open()?.write_all(bytes)
    }

    fn open(&self) -> io::Result<File> {
        match self {
            Target::Stdout => standard(1),
            Target::Stderr => standard(2),
            Target::File(path) | Target::Stream(path) => OpenOptions::new().append(true).open(path),
        }
    }

    fn metadata(&self) -> io::Result<Metadata> {
        match self.path() {
            Some(path) => fs::metadata(path),
            None => self.open()?.metadata(),
        }
    }

    /// Device and number of an existing file or pipe.
    #[cfg(unix)]
    fn identity(&self) -> Option<(u64, u64)> {
        use std::os::unix::fs::{FileTypeExt, MetadataExt};
        let metadata = self.metadata().ok().filter(|m| !m.file_type().is_char_device())?;
        Some((metadata.dev(), metadata.ino()))
    }

    #[cfg(not(unix))]
    fn identity(&self) -> Option<(u64, u64)> {
        None
    }

    /// Why a stream takes no bytes, as far as can be told before the work.
    pub fn obstacle(&self) -> Option<String> {
        let kind = match self.metadata() {
            Ok(metadata) => metadata.file_type(),
            Err(e) => return Some(format!("nothing is open there: {e}")),
        };
        match self {
            Target::Stream(_) if kind.is_dir() => Some("this is a folder; name a file in it".to_owned()),
            Target::Stream(path) => refusal(path, kind),
            _ => None,
        }
    }
}

#[cfg(unix)]
fn refusal(path: &Path, kind: FileType) -> Option<String> {
    use rustix::fs::{Access, access};
    use std::os::unix::fs::FileTypeExt;
    if kind.is_block_device() || kind.is_socket() {
        return Some("this is a disk or a socket; name a file, a pipe or a character device".to_owned());
    }
    access(path, Access::WRITE_OK).err().map(|e| io::Error::from(e).to_string())
}

#[cfg(not(unix))]
fn refusal(_path: &Path, _kind: FileType) -> Option<String> {
    None
}

/// The number of a path like `/dev/fd/3`.
fn descriptor(path: &Path) -> Option<u32> {
    let number = path.file_name().and_then(OsStr::to_str)?.parse().ok()?;
    let folder = fs::canonicalize(path.parent()?).ok()?;
    let is_own = |list: &str| fs::canonicalize(list).is_ok_and(|own| own == folder);
    ["/dev/fd", "/proc/self/fd"].into_iter().any(is_own).then_some(number)
}

/// The stream itself, not a second one on the same file: what the shell writes next comes behind it.
#[cfg(unix)]
fn standard(number: u32) -> io::Result<File> {
    use std::os::fd::AsFd;
    let (out, err) = (io::stdout(), io::stderr());
    let stream = if number == 1 { out.as_fd() } else { err.as_fd() };
    stream.try_clone_to_owned().map(File::from)
}

#[cfg(not(unix))]
fn standard(_number: u32) -> io::Result<File> {
    Err(io::ErrorKind::Unsupported.into())
}

/// A path that is equal for equal files, which may not exist yet.
fn place(path: &Path) -> PathBuf {
    let folder = fs::canonicalize(super::folder_of(path));
    folder.map_or_else(|_| path.to_owned(), |folder| folder.join(path.file_name().unwrap_or_default()))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn devices_and_standard_streams_are_never_replaced() {
        assert_eq!(Target::of(Path::new("/dev/null")), Target::Stream("/dev/null".into()));
        for (stream, names) in
            [(Target::Stdout, ["/dev/stdout", "/dev/fd/1"]), (Target::Stderr, ["/dev/stderr", "/dev/fd/2"])]
        {
            assert!(names.iter().all(|name| Target::of(Path::new(name)) == stream), "{stream:?}");
        }
        let folder = tempfile::tempdir().expect("a temporary folder");
        let link = folder.path().join("link.png");
        std::os::unix::fs::symlink("/dev/stdout", &link).expect("a link");
        assert_eq!(Target::of(&link), Target::Stdout);
        assert_eq!(Target::of(&folder.path().join("new")), Target::File(folder.path().join("new")));
    }
}
