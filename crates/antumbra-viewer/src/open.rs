//! Opening a scene in the background: a built-in one, a file, or bytes that were dropped on a web page.

use crate::desk::Open;
use crate::job::Job;
use crate::stage::Stage;
use antumbra::Gpu;
use antumbra_scene::{Scene, load};
use std::path::Path;
use std::sync::Arc;

/// What is to be opened.
pub enum Source {
    /// As on the command line: a path or `builtin:NAME`.
    Argument(String),
    /// A file's name and what is in it, where there is no path.
    Bytes(String, Vec<u8>),
    /// A file that was dropped on a page, which gives its bytes in its own time.
    #[cfg(target_arch = "wasm32")]
    Dropped(eframe::egui::DroppedFileHandle),
    /// A scene that was open before, and its argument: the device was lost.
    Again(Open),
}

/// Loads a scene and puts it on the GPU.
pub fn start(
    gpu: &Gpu,
    source: Source,
    pose: u64,
    wake: impl Fn() + Clone + Send + 'static,
) -> Job<Result<(Open, Stage), String>> {
    let gpu = gpu.clone();
    let title = match &source {
        Source::Argument(name) | Source::Bytes(name, _) => name.clone(),
        Source::Again(open) => open.source.clone(),
        #[cfg(target_arch = "wasm32")]
        Source::Dropped(file) => file.path().display().to_string(),
    };
    let told = wake.clone();
    Job::start(title, wake, move |status| async move {
        let say = |what: &str| {
            let goes_on = status.step(what);
            told();
            if goes_on { Ok(()) } else { Err("cancelled".to_owned()) }
        };
        say("Reading")?;
        #[cfg(target_arch = "wasm32")]
        let source = match source {
            Source::Dropped(file) => Source::Bytes(file.path().display().to_string(), file.bytes_async().await?),
            source => source,
        };
        let open = read(source)?;
        let triangles = open.scene.triangle_count();
        say(&format!("Sorting {} triangles for the GPU", thousands(triangles)))?;
        let scene = open.scene.clone();
        let stage = gpu.checked(|| Stage::new(&gpu, scene, pose)).await.map_err(|e| e.to_string())?;
        say("Ready")?;
        Ok((open, stage))
    })
}

fn read(source: Source) -> Result<Open, String> {
    match source {
        #[cfg(target_arch = "wasm32")]
        Source::Dropped(_) => Err("its bytes have not come".to_owned()),
        Source::Again(open) => Ok(open),
        Source::Bytes(name, bytes) => {
            let scene = from_bytes(&name, &bytes).map_err(|e| e.to_string())?;
            Ok(Open { source: name, text: None, scene: Arc::new(scene) })
        }
        Source::Argument(source) => {
            let scene = load(&source).map_err(|e| e.to_string())?;
            let is_file = !source.starts_with("builtin:") && is_scene_file(&source);
            let text = if is_file { std::fs::read_to_string(&source).ok() } else { None };
            Ok(Open { source, text, scene: Arc::new(scene) })
        }
    }
}

/// True of scene files, false of models.
pub fn is_scene_file(name: &str) -> bool {
    extension(name) == "toml" || extension(name) == "json"
}

fn extension(name: &str) -> String {
    Path::new(name).extension().map_or_else(String::new, |e| e.to_string_lossy().to_lowercase())
}

/// A scene from a single file that refers to no other.
fn from_bytes(name: &str, bytes: &[u8]) -> Result<Scene, antumbra_scene::SceneError> {
    use antumbra_scene::{SceneError, import, scene_file};
    let alone = || std::io::Error::new(std::io::ErrorKind::NotFound, "on a web page only the dropped file can be read");
    let mut missing = |_: &str| Err(alone());
    let mut scene = match extension(name).as_str() {
        "glb" | "gltf" => import::gltf::parse(bytes, name, &mut missing)?.into_scene(),
        "obj" => import::obj::parse(bytes, name, &mut missing)?.into_scene(),
        "ply" => import::ply::parse(bytes, name)?.into_scene(),
        "toml" | "json" => {
            let is_toml = extension(name) == "toml";
            let format = if is_toml { scene_file::Format::Toml } else { scene_file::Format::Json };
            let mut no_mesh = |mesh: &str| {
                Err(SceneError::Read { file: mesh.to_owned(), referrer: Some(name.to_owned()), source: alone() })
            };
            scene_file::parse(bytes, format, name, &mut no_mesh)?
        }
        _ => {
            let message = "this kind of file is not read; drop a .glb, .obj, .ply or a scene file".to_owned();
            return Err(SceneError::Argument { argument: name.to_owned(), message });
        }
    };
    name.clone_into(&mut scene.name);
    Ok(scene)
}

/// 1234567 as 1,234,567.
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

    #[test]
    fn dropped_bytes_are_read_by_their_name() {
        let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        assert_eq!(from_bytes("a.OBJ", obj).unwrap().triangle_count(), 3);
        let scene = b"[[meshes]]\nbuiltin = 'fence'";
        assert!(from_bytes("a.toml", scene).unwrap().triangle_count() > 3);
        for (name, bytes) in [("a.ply", &b"plx"[..]), ("a.txt", obj), ("a.toml", b"[[meshes]]\npath='x.obj'")] {
            let message = from_bytes(name, bytes).unwrap_err().to_string();
            assert!(message.contains(name), "{message}");
        }
    }
}
