//! Outputs: plain files are written whole or not at all, pipes and devices are written into.

mod encode;
mod target;

pub use encode::{Format, encode_rgb, encode_values};

use crate::error::CliError;
use crate::progress::Terminal;
use antumbra_bench::{Monitor, links};
use clap::builder::{PathBufValueParser, TypedValueParser};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;
use std::{fmt, thread};
use target::Target;
use tempfile::NamedTempFile;

/// Help on what may be named as an output.
pub const HELP: &str = "Outputs: A plain file is replaced as a whole. Of a link, the file behind it is written, and the \
    link stays. Pipes and devices, such as /dev/stdout, /dev/null, /dev/fd/3 or a FIFO, are written into; where their \
    names end in no format, they get PNG (--output), NPY (--visibility, --valid) or JSON (--stats).";

/// An output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputFile {
    /// As named on the command line.
    pub path: PathBuf,
    target: Target,
}

impl From<PathBuf> for OutputFile {
    fn from(path: PathBuf) -> OutputFile {
        OutputFile { target: Target::of(&path), path }
    }
}

impl OutputFile {
    /// True if text on standard output would end up among the bytes.
    pub fn is_stdout(&self) -> bool {
        self.target.is_stdout()
    }
}

/// An output of one number per pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ValuesFile {
    /// The file.
    pub file: OutputFile,
    /// How it is written.
    pub format: Format,
}

/// Reads the name of a file in any format.
pub fn any_file() -> impl TypedValueParser<Value = OutputFile> {
    PathBufValueParser::new().map(OutputFile::from)
}

/// Reads the name of a PNG.
pub fn png_file() -> impl TypedValueParser<Value = OutputFile> {
    PathBufValueParser::new().try_map(|path| with_format(path, &[("png", ())], ".png").map(|(file, ())| file))
}

/// Reads the name of an NPY.
pub fn npy_file() -> impl TypedValueParser<Value = OutputFile> {
    PathBufValueParser::new().try_map(|path| with_format(path, &[("npy", ())], ".npy").map(|(file, ())| file))
}

/// Reads the name of a file with one number per pixel.
pub fn values_file() -> impl TypedValueParser<Value = ValuesFile> {
    let formats = [("npy", Format::Npy), ("exr", Format::Exr), ("png", Format::Png)];
    let values = |(file, format)| ValuesFile { file, format };
    PathBufValueParser::new().try_map(move |path| with_format(path, &formats, ".npy, .exr or .png").map(values))
}

/// The format follows from the extension of the name, else of the file behind a link. Pipes and devices rarely have one
/// of these: they get the first.
fn with_format<T: Copy>(path: PathBuf, formats: &[(&str, T)], wanted: &str) -> Result<(OutputFile, T), String> {
    let file = OutputFile::from(path);
    let format_of = |path: &Path| formats.iter().find(|(end, _)| ending(path) == *end).map(|(_, format)| *format);
    let format = format_of(&file.path).or_else(|| format_of(file.target.path()?));
    match format.or_else(|| (!file.target.is_file()).then_some(formats[0].1)) {
        Some(format) => Ok((file, format)),
        None => Err(wrong_ending(&ending(&file.path), wanted)),
    }
}

fn ending(path: &Path) -> String {
    path.extension().map_or(String::new(), |e| e.to_string_lossy().to_lowercase())
}

fn wrong_ending(found: &str, wanted: &str) -> String {
    match found {
        "" => format!("the file's name should end in {wanted}"),
        _ => format!("`.{found}` is not supported here; the file's name should end in {wanted}"),
    }
}

/// The outputs of one run. Files are written to temporary ones and then moved together, so an error leaves none.
#[derive(Default)]
pub struct Outputs {
    files: Vec<(NamedTempFile, OutputFile)>,
    streams: Vec<(OutputFile, Vec<u8>)>,
}

impl Outputs {
    /// Writes a temporary file, or keeps the bytes for a stream.
    pub fn stage(&mut self, output: &OutputFile, bytes: io::Result<Vec<u8>>) -> Result<(), CliError> {
        let failed = |source| CliError::Write { path: output.path.clone(), source };
        let bytes = bytes.map_err(failed)?;
        let Target::File(path) = &output.target else {
            self.streams.push((output.clone(), bytes));
            return Ok(());
        };
        let mut file = temporary(&folder_of(path)).map_err(failed)?;
        take_permissions(file.as_file(), path);
        file.write_all(&bytes).and_then(|()| file.flush()).map_err(failed)?;
        self.files.push((file, output.clone()));
        Ok(())
    }

    /// Writes into the streams, then moves all files into place.
    pub fn commit(self) -> Result<(), CliError> {
        write_streams(self.streams)?;
        for (file, output) in self.files {
            let to = output.target.path().unwrap_or(&output.path);
            file.persist(to).map_err(|e| CliError::Write { path: output.path.clone(), source: e.error })?;
        }
        Ok(())
    }
}

/// Writes into all streams at once: their readers may wait for each other, and Ctrl-C ends the wait for a reader.
fn write_streams(streams: Vec<(OutputFile, Vec<u8>)>) -> Result<(), CliError> {
    let count = streams.len();
    let (sender, results) = mpsc::channel();
    for (output, bytes) in streams {
        let sender = sender.clone();
        thread::spawn(move || sender.send((output.target.write(&bytes), output.path)));
    }
    drop(sender);
    let mut written = 0;
    while written < count {
        match results.recv_timeout(Duration::from_millis(50)) {
            Ok((Ok(()), _)) => written += 1,
            Ok((Err(source), path)) => return Err(CliError::Write { path, source: with_reason(source) }),
            Err(RecvTimeoutError::Timeout) => Terminal.check()?,
            Err(RecvTimeoutError::Disconnected) => unreachable!("every thread sends its result"),
        }
    }
    Ok(())
}

fn with_reason(error: io::Error) -> io::Error {
    match error.kind() {
        io::ErrorKind::BrokenPipe => io::Error::new(error.kind(), format!("its reader is gone; {error}")),
        _ => error,
    }
}

/// Gives a new file the owner and the permissions of the one that it will replace, as far as the system allows.
fn take_permissions(new: &File, old: &Path) {
    let Ok(old) = fs::metadata(old) else { return };
    // The owner first: a change of owner takes permissions away.
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        let _ = fchown(new, None, Some(old.gid()));
        let _ = fchown(new, Some(old.uid()), None);
    }
    let _ = new.set_permissions(old.permissions());
}

/// Checks whether these outputs can be written, before the work starts.
pub fn check_files<'a>(outputs: impl IntoIterator<Item = &'a OutputFile>) -> Result<(), CliError> {
    let mut seen: Vec<&OutputFile> = Vec::new();
    for output in outputs {
        let OutputFile { path, target } = output;
        if seen.iter().any(|other| other.target.is_same(target)) {
            return Err(unwritable(path, "two outputs go there; give each its own"));
        }
        seen.push(output);
        match target {
            Target::File(file) if file.is_dir() || ends_in_slash(file) => {
                return Err(unwritable(path, "this is a folder; name a file in it"));
            }
            Target::File(file) if file.is_symlink() => return Err(unwritable(path, ENDLESS)),
            Target::File(file) => check_folder(path, &folder_of(file))?,
            stream => stream.obstacle().map_or(Ok(()), |why| Err(unwritable(path, why)))?,
        }
    }
    Ok(())
}

fn ends_in_slash(path: &Path) -> bool {
    path.as_os_str().as_encoded_bytes().ends_with(b"/")
}

const ENDLESS: &str = "this link leads back to itself";

/// Checks whether a folder can be created, or written to if it exists, before the work starts.
pub fn check_new_folder(path: &Path) -> Result<(), CliError> {
    let folder = links(path).last().unwrap_or_else(|| path.to_owned());
    if folder.is_symlink() {
        return Err(unwritable(path, ENDLESS));
    }
    let nearest = folder.ancestors().map(or_here).find(|p| p.exists()).unwrap_or(Path::new("."));
    check_folder(path, nearest)
}

fn check_folder(path: &Path, folder: &Path) -> Result<(), CliError> {
    let shown = folder.display();
    if !folder.exists() {
        return Err(unwritable(path, format_args!("there is no folder {shown}; make it first (mkdir -p {shown})")));
    }
    if !folder.is_dir() {
        return Err(unwritable(path, format_args!("{shown} is a file, not a folder")));
    }
    temporary(folder).map(drop).map_err(|e| unwritable(path, format_args!("cannot create files in {shown}: {e}")))
}

fn unwritable(path: &Path, why: impl fmt::Display) -> CliError {
    CliError::Unwritable { path: path.to_owned(), why: why.to_string() }
}

fn folder_of(path: &Path) -> PathBuf {
    or_here(path.parent().unwrap_or(path)).to_owned()
}

fn or_here(path: &Path) -> &Path {
    if path.as_os_str().is_empty() { Path::new(".") } else { path }
}

/// A file in `folder` that is deleted unless it is moved.
fn temporary(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".antumbra-");
    // Readable like any new file, within the user's umask.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}
