//! From arguments to a scene and to a device that is ready to draw it.

use crate::cli::{GpuArgs, SceneArgs};
use crate::error::CliError;
use antumbra::scene::SceneRenderer;
use antumbra::{AdapterChoice, Gpu};
use antumbra_scene::Scene;
use pollster::block_on;
use std::sync::Arc;

/// The side of a picture that neither the command line nor the scene gives a size.
const DEFAULT_SIDE: u32 = 768;

/// Loads the scene and settles the size of its picture.
pub fn scene(args: &SceneArgs) -> Result<(Scene, [u32; 2]), CliError> {
    let mut scene = antumbra_scene::load(&args.scene)?;
    if let Some(size) = args.light_size {
        scene.light.size = size.0.into();
    }
    let own = scene.size.map(|(width, height)| [width, height]);
    let size = args.size.map(|s| s.0).or(own).unwrap_or([DEFAULT_SIDE; 2]);
    Ok((scene, size))
}

/// Opens the adapter and sees that it can hold the picture.
pub fn gpu(args: &GpuArgs, size: [u32; 2]) -> Result<Gpu, CliError> {
    let best = AdapterChoice::default();
    let gpu = block_on(Gpu::new(args.adapter.as_ref().unwrap_or(&best)))?;
    gpu.check_size("picture", size[0], size[1])?;
    // Errors that no scope of ours was waiting for: by default they would be a panic.
    gpu.device.on_uncaptured_error(Arc::new(|error| {
        eprintln!("error: the GPU failed unexpectedly: {error}");
        std::process::exit(1);
    }));
    Ok(gpu)
}

/// Puts the scene on the device.
pub fn renderer(gpu: &Gpu, scene: &Scene, size: [u32; 2]) -> Result<SceneRenderer, CliError> {
    Ok(block_on(gpu.checked(|| SceneRenderer::new(gpu, scene, size)))?)
}

/// The picture with what is in the visibility texture, as 8-bit sRGB triples.
pub fn picture(gpu: &Gpu, renderer: &SceneRenderer) -> Result<Vec<u8>, CliError> {
    let rgba = block_on(gpu.checked(|| block_on(renderer.picture(gpu))))?;
    Ok(rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect())
}

/// What the technique has found.
pub fn visibility(gpu: &Gpu, renderer: &SceneRenderer) -> Result<Vec<f32>, CliError> {
    Ok(block_on(gpu.checked(|| block_on(renderer.read_visibility(gpu))))?)
}

/// The command as it was typed; words with spaces in quotes.
pub fn command_line() -> String {
    let quoted = |word: String| if word.contains(' ') { format!("'{word}'") } else { word };
    let words = std::env::args_os().skip(1).map(|word| quoted(word.to_string_lossy().into_owned()));
    std::iter::once("antumbra".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}
