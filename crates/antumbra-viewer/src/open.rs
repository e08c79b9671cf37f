//! Opening a scene in the background: a built-in one or a file.

use crate::desk::Open;
use crate::job::Job;
use crate::stage::Stage;
use antumbra::Gpu;
use antumbra_scene::load;
use std::path::Path;
use std::sync::Arc;

/// What is to be opened.
pub enum Source {
    /// As on the command line: a path or `builtin:NAME`.
    Argument(String),
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
        Source::Argument(name) => name.clone(),
        Source::Again(open) => open.source.clone(),
    };
    let told = wake.clone();
    Job::start(title, wake, move |status| async move {
        let say = |what: &str| {
            let goes_on = status.step(what);
            told();
            if goes_on { Ok(()) } else { Err("cancelled".to_owned()) }
        };
        say("Reading")?;
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
        Source::Again(open) => Ok(open),
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
}
