//! Files on disk.

use crate::open;
use crate::view_state::OpenScene;
use eframe::egui;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Opens a file.
pub async fn load(name: &str) -> Result<OpenScene, String> {
    open::from_files(name, &mut |file| antumbra_scene::read_from_disk(file))
}

/// Opens a file that was dropped on the window.
pub async fn load_dropped(file: &Path, _all: &[egui::DroppedFileHandle]) -> Result<OpenScene, String> {
    load(&file.display().to_string()).await
}

/// A path from a command, treated as a dropped file.
pub fn dropped(path: PathBuf) -> egui::DroppedFileHandle {
    Arc::new(DroppedPath(path))
}

#[derive(Debug)]
struct DroppedPath(PathBuf);

impl egui::DroppedFile for DroppedPath {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|e| e.to_string())
    }
}

/// Writes bytes to a new file in the current folder and returns its path.
pub fn keep(stem: &str, extension: &str, bytes: &[u8]) -> Result<String, String> {
    let path = free_name(&std::env::current_dir().unwrap_or_default(), stem, extension);
    write(&path, bytes)
}

/// Writes a file, replacing an old one, and returns its path.
pub fn write(path: &Path, bytes: &[u8]) -> Result<String, String> {
    std::fs::write(path, bytes).map_err(|e| format!("cannot write {}: {e}", path.display()))?;
    Ok(path.display().to_string())
}

/// A free file name: `name.png`, else `name-2.png` and so on.
fn free_name(folder: &Path, stem: &str, extension: &str) -> PathBuf {
    let name = |k: u32| match k {
        1 => folder.join(format!("{stem}.{extension}")),
        _ => folder.join(format!("{stem}-{k}.{extension}")),
    };
    (1..).map(name).find(|p| !p.exists()).unwrap_or_else(|| name(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_file_is_written_over() {
        let folder = tempfile::tempdir().unwrap();
        for wanted in ["a.png", "a-2.png", "a-3.png"] {
            let path = free_name(folder.path(), "a", "png");
            assert_eq!(path, folder.path().join(wanted));
            std::fs::write(path, "").unwrap();
        }
    }
}
