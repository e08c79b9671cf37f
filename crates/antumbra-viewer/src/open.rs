//! Opening a scene in the background: a built-in one or a file.

use crate::here;
use crate::job::{Job, Slice};
use crate::loaded_scene::LoadedScene;
use crate::view_state::OpenScene;
use antumbra::Gpu;
use antumbra::scene::Arrangement;
use antumbra_scene::{ReadFile, load_from};
use eframe::egui;
use std::path::Path;
use std::sync::Arc;

/// A request to open a scene.
pub enum Source {
    /// As on the command line: a path (on a page, an address) or `builtin:NAME`.
    Argument(String),
    /// Dropped files: the scene or model, and files that it may refer to.
    Dropped(Vec<egui::DroppedFileHandle>),
    /// The scene that was open when the device was lost.
    Again(OpenScene),
}

/// File extensions of scenes and models.
pub const EXTENSIONS: [&str; 6] = ["glb", "gltf", "obj", "ply", "toml", "json"];

/// Result of a file dialog: files, none if it was closed, or the reason why there is no dialog.
pub type Chosen = Result<Vec<egui::DroppedFileHandle>, String>;

/// Loads a scene and puts it on the GPU.
pub fn start(
    gpu: &Gpu,
    source: Source,
    pose: u64,
    wake: impl Fn() + Clone + Send + 'static,
) -> Job<Result<(OpenScene, LoadedScene), String>> {
    let gpu = gpu.clone();
    let title = match &source {
        Source::Argument(name) => name.clone(),
        Source::Dropped(files) => chief(files).map_or_else(String::new, |f| f.display().to_string()),
        Source::Again(open) => open.source.clone(),
    };
    let told = wake.clone();
    Job::start(title, wake, move |status| async move {
        let say = async |what: &str| {
            told();
            if status.step(what).await { Ok(()) } else { Err("cancelled".to_owned()) }
        };
        say("Reading").await?;
        let open = read(source).await?;
        let triangles = open.scene.triangle_count();
        say(&format!("Sorting {} triangles", thousands(triangles))).await?;
        let scene = open.scene.clone();
        let mut arrangement = Arrangement::new(&scene);
        Slice::default().run(&mut arrangement, || true).await;
        let arranged = arrangement.finish();
        say("Putting it on the GPU").await?;
        let loaded = gpu.checked(|| LoadedScene::new(&gpu, scene, arranged, pose)).await.map_err(|e| e.to_string())?;
        say("Ready").await?;
        Ok((open, loaded))
    })
}

async fn read(source: Source) -> Result<OpenScene, String> {
    match source {
        Source::Again(open) => Ok(open),
        Source::Argument(name) if name.starts_with("builtin:") => from_files(&name, &mut |_| unreachable!("no file")),
        Source::Argument(name) => here::load(&name).await,
        Source::Dropped(files) => {
            let file = chief(&files).ok_or("nothing was dropped")?.to_owned();
            here::load_dropped(&file, &files).await
        }
    }
}

/// Reads the scene `name`; `read` gives the bytes of files.
pub fn from_files(name: &str, read: &mut ReadFile) -> Result<OpenScene, String> {
    let scene = load_from(name, read).map_err(|e| e.to_string())?;
    let is_file = !name.starts_with("builtin:") && is_scene_file(name);
    let bytes = if is_file { read(Path::new(name)).ok() } else { None };
    let text = bytes.and_then(|b| String::from_utf8(b).ok());
    Ok(OpenScene { source: name.to_owned(), text, scene: Arc::new(scene) })
}

/// The dropped file that refers to the others: a scene file, else a model, else the first.
fn chief(files: &[egui::DroppedFileHandle]) -> Option<&Path> {
    let rank = |path: &&Path| match extension(&path.to_string_lossy()).as_str() {
        "toml" | "json" => 0,
        "glb" | "gltf" | "obj" | "ply" => 1,
        _ => 2,
    };
    files.iter().map(|f| f.path()).min_by_key(rank)
}

/// True for scene files, false for models.
pub fn is_scene_file(name: &str) -> bool {
    extension(name) == "toml" || extension(name) == "json"
}

fn extension(name: &str) -> String {
    Path::new(name).extension().map_or_else(String::new, |e| e.to_string_lossy().to_lowercase())
}

/// Digit groups: 1234567 is `1,234,567`.
pub fn thousands(count: usize) -> String {
    let digits = count.to_string();
    let lead = digits.len() % 3;
    let (first, rest) = digits.split_at(lead);
    let groups = rest.as_bytes().chunks(3).map(|g| String::from_utf8_lossy(g).into_owned());
    let all: Vec<String> = (!first.is_empty()).then(|| first.to_owned()).into_iter().chain(groups).collect();
    all.join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_grouped() {
        let seen = [0, 12, 123, 1234, 1_234_567].map(thousands);
        assert_eq!(seen, ["0", "12", "123", "1,234", "1,234,567"]);
    }
}
