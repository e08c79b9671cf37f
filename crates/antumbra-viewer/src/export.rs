//! Exports: scene file, SPEC, and the command line of the same image.

use antumbra_scene::{Camera, RectLight, Scene};
use glam::Vec3;
use std::path::Path;
use toml::{Table, Value};

/// A scene file of the open scene with its current camera and light. `source` is its command-line argument; the
/// text is needed if that is a scene file itself.
pub fn scene_file(
    source: &str,
    text: Option<&str>,
    scene: &Scene,
    camera: &Camera,
    light: &RectLight,
    size: [u32; 2],
) -> Result<String, String> {
    let mut file = match text {
        Some(text) => meshes_of_file(source, text)?,
        None => Table::from_iter([("meshes".to_owned(), Value::Array(meshes_of(source, scene)))]),
    };
    let [width, height] = size.map(|s| Value::Integer(s.into()));
    file.insert("width".to_owned(), width);
    file.insert("height".to_owned(), height);
    file.insert("camera".to_owned(), Value::Table(camera_entry(camera)));
    file.insert("light".to_owned(), Value::Table(light_entry(light)));
    toml::to_string(&file).map_err(|e| format!("the scene cannot be written as a file: {e}"))
}

/// A model with its added ground, or a built-in scene.
fn meshes_of(source: &str, scene: &Scene) -> Vec<Value> {
    let entry = match source.strip_prefix("builtin:") {
        Some(spec) => ("builtin", spec.to_owned()),
        None => ("path", absolute(Path::new(source))),
    };
    let mut meshes = vec![Value::Table(Table::from_iter([(entry.0.to_owned(), Value::String(entry.1))]))];
    let is_model = !source.starts_with("builtin:");
    let ground =
        scene.instances.last().filter(|i| is_model && i.receiver_only && scene.meshes[i.mesh].name == "ground");
    if let Some(ground) = ground {
        let bounds = scene.meshes[ground.mesh].bounds();
        let half = 0.5 * bounds.size().x;
        meshes.push(Value::Table(Table::from_iter([
            ("builtin".to_owned(), Value::String("plane".to_owned())),
            ("translate".to_owned(), vector(bounds.center())),
            ("scale".to_owned(), number(half)),
            ("receiver_only".to_owned(), Value::Boolean(true)),
        ])));
    }
    meshes
}

/// The keys of another scene file, with absolute paths.
fn meshes_of_file(source: &str, text: &str) -> Result<Table, String> {
    let read = |e: &dyn std::fmt::Display| format!("{source} cannot be read again: {e}");
    let is_json = Path::new(source).extension().is_some_and(|e| e.eq_ignore_ascii_case("json"));
    let mut file: Table = match is_json {
        true => serde_json::from_str(text).map_err(|e| read(&e))?,
        false => toml::from_str(text).map_err(|e| read(&e))?,
    };
    let folder = Path::new(source).parent().unwrap_or(Path::new(""));
    for mesh in file.get_mut("meshes").and_then(Value::as_array_mut).into_iter().flatten() {
        if let Some(path) = mesh.get_mut("path") {
            *path = Value::String(absolute(&folder.join(path.as_str().unwrap_or_default())));
        }
    }
    Ok(file)
}

fn absolute(path: &Path) -> String {
    // A missing path is written as given.
    std::path::absolute(path).map_or_else(|_| path.display().to_string(), |p| p.display().to_string())
}

fn camera_entry(camera: &Camera) -> Table {
    Table::from_iter([
        ("eye".to_owned(), vector(camera.eye)),
        ("target".to_owned(), vector(camera.target)),
        ("up".to_owned(), vector(camera.up)),
        ("fov_y_deg".to_owned(), number(camera.fov_y_deg)),
        ("near".to_owned(), number(camera.near)),
        ("far".to_owned(), number(camera.far)),
    ])
}

fn light_entry(light: &RectLight) -> Table {
    let mut entry = Table::from_iter([
        ("center".to_owned(), vector(light.center)),
        ("target".to_owned(), vector(light.target)),
        ("up".to_owned(), vector(light.up)),
        ("size".to_owned(), Value::Array(light.size.to_array().map(number).to_vec())),
    ]);
    if let Some(degrees) = light.shadow_fov_deg {
        entry.insert("shadow_fov_deg".to_owned(), number(degrees));
    }
    entry
}

fn vector(v: Vec3) -> Value {
    Value::Array(v.to_array().map(number).to_vec())
}

/// The shortest decimal of a 32-bit number.
fn number(v: f32) -> Value {
    Value::Float(v.to_string().parse().unwrap_or(f64::from(v)))
}

/// The command that draws the same image.
pub fn command(scene: &str, spec: &str, size: [u32; 2]) -> String {
    let [width, height] = size;
    format!("antumbra render {} -t {} --size {width}x{height} -o image.png", quoted(scene), quoted(spec))
}

/// Quotes a word for a shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=,+@".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// An 8-bit RGBA image as a PNG file.
pub fn png(size: [u32; 2], rgba: &[u8]) -> Result<Vec<u8>, image::ImageError> {
    let mut bytes = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut bytes);
    image::ImageEncoder::write_image(encoder, rgba, size[0], size[1], image::ExtendedColorType::Rgba8)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use antumbra_scene::{builtin, load};
    use glam::Vec2;

    /// What was open, and what its scene file opens.
    fn again(source: &str, text: Option<&str>, scene: &Scene) -> Scene {
        let camera = Camera { eye: Vec3::new(0.1, 7.3, 3.3), near: 0.017, ..scene.camera };
        let light = RectLight { size: Vec2::new(0.3, 0.7), ..scene.light };
        let file = scene_file(source, text, scene, &camera, &light, [320, 200]).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("again.toml");
        std::fs::write(&path, &file).unwrap();
        let read = load(path.to_str().unwrap()).unwrap_or_else(|e| panic!("{e}\n{file}"));
        assert_eq!((read.camera, read.light, read.size), (camera, light, Some((320, 200))), "{file}");
        read
    }

    #[test]
    fn a_builtin_scene_comes_back() {
        let scene = builtin::build("fence").unwrap();
        let read = again("builtin:fence", None, &scene);
        assert_eq!((read.meshes, read.instances), (scene.meshes, scene.instances));
    }

    #[test]
    fn a_model_comes_back_with_its_ground() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a model.obj");
        std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0.5\nf 1 2 3\n").unwrap();
        let source = path.to_str().unwrap();
        let scene = load(source).unwrap();
        let read = again(source, None, &scene);
        assert_eq!(read.instances.len(), 2);
        let (a, b) = (scene.bounds(), read.bounds());
        assert!((a.min - b.min).length() < 1e-4 && (a.max - b.max).length() < 1e-4, "{a:?} {b:?}");
        assert_eq!(read.materials, scene.materials);
        // And the file of the file is the same.
        let file = scene_file(source, None, &scene, &scene.camera, &scene.light, [8, 8]).unwrap();
        assert_eq!(again(folder.path().join("x.toml").to_str().unwrap(), Some(&file), &scene).bounds(), b);
    }

    #[test]
    fn words_are_quoted_for_the_shell() {
        assert_eq!(
            command("a b.toml", "pcss:map=512", [4, 3]),
            "antumbra render 'a b.toml' -t pcss:map=512 --size 4x3 -o image.png"
        );
        assert_eq!(quoted("it's"), r"'it'\''s'");
    }
}
