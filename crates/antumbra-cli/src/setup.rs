//! From arguments to a scene, a device and the settings of the reference.

use crate::cli::{GpuArgs, SceneArgs, TruthArgs};
use crate::progress::Terminal;
use antumbra::{AdapterChoice, Gpu};
use antumbra_bench::truth::TruthSettings;
use antumbra_bench::{Error, Monitor};
use antumbra_scene::Scene;
use pollster::block_on;
use std::sync::Arc;

/// Side of an image whose size neither the command line nor the scene gives.
const DEFAULT_SIDE: u32 = 768;

/// Loads the scene and determines the size of its image.
pub fn scene(args: &SceneArgs) -> Result<(Scene, [u32; 2]), Error> {
    let mut scene = antumbra_scene::load(&args.scene)?;
    if let Some(size) = args.light_size {
        scene.light.size = size.0.into();
    }
    let own = scene.size.map(|(width, height)| [width, height]);
    let size = args.size.map(|s| s.0).or(own).unwrap_or([DEFAULT_SIDE; 2]);
    Ok((scene, size))
}

/// Opens the adapter and checks that it supports images of this size.
pub fn gpu(args: &GpuArgs, size: [u32; 2]) -> Result<Gpu, Error> {
    let best = AdapterChoice::default();
    let gpu = block_on(Gpu::new(args.adapter.as_ref().unwrap_or(&best)))?;
    gpu.check_size("image", size[0], size[1])?;
    // Errors outside of every error scope: by default they are a panic.
    gpu.device.on_uncaptured_error(Arc::new(|error| {
        Terminal.log(&format!("error: the GPU failed unexpectedly: {error}"));
        std::process::exit(1);
    }));
    Ok(gpu)
}

/// Sampling of the reference, and the folder of its cache.
pub fn truth(args: &TruthArgs) -> TruthSettings {
    let named = args.cache.clone().filter(|dir| !dir.as_os_str().is_empty());
    let cache = if args.no_cache { None } else { named.or_else(|| Some(dirs::cache_dir()?.join("antumbra"))) };
    let TruthArgs { light_samples, pixel_samples, seed, .. } = *args;
    TruthSettings { light_samples, pixel_samples, seed, cache }
}

/// The command as it was typed; words with spaces in quotes.
pub fn command_line() -> String {
    let quoted = |word: String| if word.contains(' ') { format!("'{word}'") } else { word };
    let words = std::env::args_os().skip(1).map(|word| quoted(word.to_string_lossy().into_owned()));
    std::iter::once("antumbra".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}
