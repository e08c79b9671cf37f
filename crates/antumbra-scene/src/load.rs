//! From a scene argument to a scene.

use crate::read_file::{ReadFile, read_from_disk};
use crate::{Scene, SceneError, builtin};
use glam::DVec3;
use std::ffi::OsStr;
use std::path::Path;

/// Loads the scene that an argument names: `builtin:NAME[:key=value,…]`, a model (`.glb`, `.gltf`, `.obj`, `.ply`) or a
/// scene file (`.toml`, `.json`), in upper or lower case.
pub fn load(argument: &(impl AsRef<OsStr> + ?Sized)) -> Result<Scene, SceneError> {
    load_from(argument, &mut |file| read_from_disk(file))
}

/// The same with files that `read` gives: where there is no disk.
pub fn load_from(argument: &(impl AsRef<OsStr> + ?Sized), read: &mut ReadFile) -> Result<Scene, SceneError> {
    Ok(load_placed(argument, read)?.0)
}

/// The same with the point of the files' coordinates that is the scene's origin. It is 0 unless the scene lies so far
/// away that it was moved; then whoever writes places for these files adds it.
pub fn load_placed(argument: &(impl AsRef<OsStr> + ?Sized), read: &mut ReadFile) -> Result<(Scene, DVec3), SceneError> {
    let argument = argument.as_ref();
    match argument.to_string_lossy().strip_prefix("builtin:") {
        Some(spec) => Ok((builtin::build(spec)?, DVec3::ZERO)),
        None => load_file(Path::new(argument), read),
    }
}

#[cfg(not(feature = "import"))]
fn load_file(path: &Path, _read: &mut ReadFile) -> Result<(Scene, DVec3), SceneError> {
    let message = "this program is built without file formats; use builtin:NAME".to_string();
    Err(SceneError::Argument { argument: path.display().to_string(), message })
}

#[cfg(feature = "import")]
use files::load_file;
#[cfg(feature = "import")]
mod files {
    use super::{DVec3, Path, ReadFile, Scene, SceneError, builtin};
    use crate::import::{self, Model};

    const MODELS: &str = ".glb, .gltf, .obj or .ply";

    pub(super) fn load_file(path: &Path, read: &mut ReadFile) -> Result<(Scene, DVec3), SceneError> {
        let (mut scene, origin) = match extension(path).as_str() {
            #[cfg(feature = "scene-file")]
            "toml" => load_scene_file(path, crate::scene_file::Format::Toml, read)?,
            #[cfg(feature = "scene-file")]
            "json" => load_scene_file(path, crate::scene_file::Format::Json, read)?,
            _ => {
                let model = load_model(path, read)?;
                let origin = model.origin;
                (model.into_scene(), origin)
            }
        };
        scene.name = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        Ok((scene, origin))
    }

    fn extension(path: &Path) -> String {
        path.extension().map_or(String::new(), |e| e.to_string_lossy().to_lowercase())
    }

    #[cfg(feature = "scene-file")]
    fn load_scene_file(
        path: &Path,
        format: crate::scene_file::Format,
        read: &mut ReadFile,
    ) -> Result<(Scene, DVec3), SceneError> {
        let bytes = bytes_of(path, read)?;
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        let mut load = |mesh: &str| load_model(&folder.join(mesh), read);
        crate::scene_file::read(&bytes, format, &path.display().to_string(), &mut load)
    }

    fn load_model(path: &Path, read: &mut ReadFile) -> Result<Model, SceneError> {
        let name = path.display().to_string();
        let parse: fn(&[u8], &str, &mut import::ReadFile) -> Result<Model, SceneError> = match extension(path).as_str()
        {
            #[cfg(feature = "gltf")]
            "glb" | "gltf" => import::gltf::parse,
            #[cfg(feature = "obj")]
            "obj" => import::obj::parse,
            #[cfg(feature = "ply")]
            "ply" => |bytes, name, _| import::ply::parse(bytes, name),
            _ => return Err(unknown(path, name)),
        };
        let bytes = bytes_of(path, read)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        parse(&bytes, &name, &mut |other| read(&folder.join(other)))
    }

    /// Why a path that no importer takes is not a scene.
    fn unknown(path: &Path, argument: String) -> SceneError {
        let is_builtin = builtin::list().iter().any(|b| argument.split(':').next() == Some(b.name));
        let message = if path.is_dir() {
            format!("this is a folder; name a file in it: {MODELS}, or a scene file, .toml or .json")
        } else if is_builtin {
            format!("there is no such file; did you mean `builtin:{argument}`?")
        } else if extension(path) == "json" || extension(path) == "toml" {
            format!("a scene file cannot be used here; give a model: {MODELS}")
        } else if path.exists() || (cfg!(target_arch = "wasm32") && path.extension().is_some()) {
            // A page has no disk: the given parts are kept.
            format!(
                "this kind of file is not read; give a model ({MODELS}), a scene file (.toml or .json) or builtin:NAME"
            )
        } else {
            "there is no such file".to_string()
        };
        SceneError::Argument { argument, message }
    }

    fn bytes_of(path: &Path, read: &mut ReadFile) -> Result<Vec<u8>, SceneError> {
        if path.is_dir() {
            return Err(unknown(path, path.display().to_string()));
        }
        let fail = |source| SceneError::Read { file: path.display().to_string(), referrer: None, source };
        read(path).map_err(fail)
    }
}
