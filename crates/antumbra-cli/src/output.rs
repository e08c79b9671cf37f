//! Output files, written whole or not at all, and their formats.

use crate::error::CliError;
use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use tempfile::NamedTempFile;

/// A format for one number per pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// NumPy, float32, height x width.
    Npy,
    /// OpenEXR, one 32-bit float channel `Y`.
    Exr,
    /// 16-bit grey, 1 is white.
    Png,
}

/// An output file; its extension determines the format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ValuesFile {
    /// The file.
    pub path: PathBuf,
    /// Format of the extension.
    pub format: Format,
}

impl FromStr for ValuesFile {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let format = match ending(text).as_str() {
            "npy" => Format::Npy,
            "exr" => Format::Exr,
            "png" => Format::Png,
            other => return Err(wrong_ending(other, ".npy, .exr or .png")),
        };
        Ok(ValuesFile { path: text.into(), format })
    }
}

/// A path that must end in `.png`.
pub fn png_path(text: &str) -> Result<PathBuf, String> {
    path_with_ending(text, "png")
}

/// A path that must end in `.npy`.
pub fn npy_path(text: &str) -> Result<PathBuf, String> {
    path_with_ending(text, "npy")
}

fn path_with_ending(text: &str, wanted: &str) -> Result<PathBuf, String> {
    match ending(text) {
        found if found == wanted => Ok(text.into()),
        found => Err(wrong_ending(&found, &format!(".{wanted}"))),
    }
}

fn ending(text: &str) -> String {
    Path::new(text).extension().map_or(String::new(), |e| e.to_string_lossy().to_lowercase())
}

fn wrong_ending(found: &str, wanted: &str) -> String {
    match found {
        "" => format!("the file's name should end in {wanted}"),
        _ => format!("`.{found}` is not supported here; the file's name should end in {wanted}"),
    }
}

/// One number per pixel, row 0 on top, as the bytes of a file.
pub fn encode_values(format: Format, size: [u32; 2], values: &[f32]) -> io::Result<Vec<u8>> {
    match format {
        Format::Npy => npy(size, values),
        Format::Exr => exr(size, values).map_err(io::Error::other),
        Format::Png => {
            let grey = values.iter().map(|v| (v.clamp(0.0, 1.0) * 65535.0).round() as u16);
            let bytes: Vec<u8> = grey.flat_map(u16::to_ne_bytes).collect();
            png(size, &bytes, image::ExtendedColorType::L16)
        }
    }
}

/// 8-bit sRGB triples as a PNG.
pub fn encode_rgb(size: [u32; 2], rgb: &[u8]) -> io::Result<Vec<u8>> {
    png(size, rgb, image::ExtendedColorType::Rgb8)
}

fn npy([width, height]: [u32; 2], values: &[f32]) -> io::Result<Vec<u8>> {
    use npyz::WriterBuilder;
    let mut bytes = Vec::with_capacity(values.len() * 4 + 128);
    let shape = [u64::from(height), u64::from(width)];
    let mut writer = npyz::WriteOptions::<f32>::new().default_dtype().shape(&shape).writer(&mut bytes).begin_nd()?;
    writer.extend(values.iter().copied())?;
    writer.finish()?;
    Ok(bytes)
}

fn exr([width, height]: [u32; 2], values: &[f32]) -> exr::error::Result<Vec<u8>> {
    use exr::prelude::*;
    let channel = AnyChannel::new("Y", FlatSamples::F32(values.to_vec()));
    let layer = Layer::new(
        (width as usize, height as usize),
        LayerAttributes::default(),
        Encoding::FAST_LOSSLESS,
        AnyChannels::sort(std::iter::once(channel).collect()),
    );
    let mut bytes = io::Cursor::new(Vec::new());
    Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes)?;
    Ok(bytes.into_inner())
}

fn png([width, height]: [u32; 2], bytes: &[u8], color: image::ExtendedColorType) -> io::Result<Vec<u8>> {
    use image::ImageEncoder;
    let mut out = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut out);
    encoder.write_image(bytes, width, height, color).map_err(io::Error::other)?;
    Ok(out)
}

/// The files of one run. All are written to temporary files and then moved together, so an error leaves none.
#[derive(Default)]
pub struct Outputs {
    staged: Vec<(NamedTempFile, PathBuf)>,
}

impl Outputs {
    /// Writes a temporary file.
    pub fn stage(&mut self, path: &Path, bytes: io::Result<Vec<u8>>) -> Result<(), CliError> {
        let failed = |source| CliError::Write { path: path.to_owned(), source };
        let bytes = bytes.map_err(failed)?;
        let mut file = temporary(&folder_of(path)).map_err(failed)?;
        file.write_all(&bytes).and_then(|()| file.flush()).map_err(failed)?;
        self.staged.push((file, path.to_owned()));
        Ok(())
    }

    /// Moves all files into place.
    pub fn commit(self) -> Result<(), CliError> {
        for (file, path) in self.staged {
            file.persist(&path).map_err(|e| CliError::Write { path, source: e.error })?;
        }
        Ok(())
    }
}

/// Checks whether these files can be written, before the work starts.
pub fn check_files<'a>(paths: impl IntoIterator<Item = &'a Path>) -> Result<(), CliError> {
    let mut seen: Vec<&Path> = Vec::new();
    for path in paths {
        if seen.contains(&path) {
            return Err(unwritable(path, "two outputs have this name; give each its own"));
        }
        seen.push(path);
        if path.is_dir() {
            return Err(unwritable(path, "this is a folder; name a file in it"));
        }
        check_folder(path, &folder_of(path))?;
    }
    Ok(())
}

/// Checks whether a folder can be created, or written to if it exists, before the work starts.
pub fn check_new_folder(path: &Path) -> Result<(), CliError> {
    let nearest = path.ancestors().map(or_here).find(|p| p.exists()).unwrap_or(Path::new("."));
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
