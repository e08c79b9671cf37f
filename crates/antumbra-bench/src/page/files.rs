//! Files of a report: all of them are written, or none.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Why a report could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The folder or a file cannot be written.
    #[error("cannot write the report's {}: {source}; choose a folder that you may write to with -o", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The size of an image differs from the report's.
    #[error("the {image} of `{spec}` is not {width} x {height} like the report's other images")]
    Size {
        /// Kind of the image.
        image: &'static str,
        /// The technique's SPEC.
        spec: String,
        /// Width of the report's images, pixels.
        width: u32,
        /// Height of the report's images, pixels.
        height: u32,
    },
    /// An image cannot be encoded.
    #[error("cannot encode an image as PNG: {0}")]
    Png(#[from] image::ImageError),
    /// The results cannot be encoded as JSON.
    #[error("cannot write the figures as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// The results cannot be encoded as CSV.
    #[error("cannot write the figures as CSV: {0}")]
    Csv(#[from] csv::Error),
}

/// A path and where it leads, link by link. The last one is no link, or one of many that lead back to themselves.
pub fn links(path: &Path) -> impl Iterator<Item = PathBuf> {
    const MOST: usize = 40;
    let next = |link: &PathBuf| Some(link.parent()?.join(fs::read_link(link).ok()?));
    std::iter::successors(Some(path.to_owned()), next).take(MOST + 1)
}

/// Writes files, each a relative path and its content, into the folder `to`, which is created if necessary, behind a
/// link too. All files are written to a temporary folder and then moved in order, so a failure leaves no partial file.
pub fn write_all(files: &[(String, Vec<u8>)], to: &Path) -> Result<(), ReportError> {
    let to = &links(to).last().unwrap_or_else(|| to.to_owned());
    let is_new = !to.exists();
    let written = write_and_move(files, to);
    if written.is_err() && is_new {
        let _ = fs::remove_dir(to); // the first error is the one to report
    }
    written
}

fn write_and_move(files: &[(String, Vec<u8>)], to: &Path) -> Result<(), ReportError> {
    let at = |path: &Path| {
        let path = path.to_owned();
        move |source: io::Error| ReportError::Write { path, source }
    };
    fs::create_dir_all(to).map_err(at(to))?;
    let temporary = tempfile::Builder::new().prefix(".report-").tempdir_in(to).map_err(at(to))?;
    let create_parent = |file: &Path| fs::create_dir_all(file.parent().unwrap_or(to));
    for (name, content) in files {
        let file = temporary.path().join(name);
        create_parent(&file).and_then(|()| fs::write(&file, content)).map_err(at(&to.join(name)))?;
    }
    for (name, _) in files {
        let file = to.join(name);
        create_parent(&file).and_then(|()| fs::rename(temporary.path().join(name), &file)).map_err(at(&file))?;
    }
    Ok(())
}

/// A value as indented JSON with a final line break.
pub fn json(value: &impl serde::Serialize) -> Result<Vec<u8>, ReportError> {
    let mut json = serde_json::to_vec_pretty(value)?;
    json.push(b'\n');
    Ok(json)
}
