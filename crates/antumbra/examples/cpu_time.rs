//! CPU time to record and submit a frame, by technique: `cargo run -p antumbra --example cpu_time -- [SPEC …]`.
//!
//! Prints the medians over 100 frames of `builtin:fence` at 768 x 512: recording, and recording with finishing the
//! encoder and submitting. The GPU's work is waited for between frames and does not count, but a software adapter
//! shares the CPU: absolute times need a GPU.

use antumbra::scene::SceneRenderer;
use antumbra::techniques::TECHNIQUES;
use antumbra::{AdapterChoice, Gpu, Shadows};
use std::error::Error;
use std::time::Instant;

const FRAMES: usize = 100;
/// Frames in which pipelines are compiled and lists grow.
const WARM_UP: usize = 10;

fn main() -> Result<(), Box<dyn Error>> {
    let mut specs: Vec<String> = std::env::args().skip(1).collect();
    if specs.is_empty() {
        specs = TECHNIQUES.iter().map(|info| info.name.to_owned()).collect();
    }
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::Best))?;
    let scene = antumbra_scene::builtin::build("fence")?;
    let renderer = SceneRenderer::new(&gpu, &scene, [768, 512])?;
    println!("{}: record, record and submit, in ms", gpu.info.name);
    for spec in specs {
        let mut shadows = Shadows::from_spec(&gpu, &spec.parse()?)?;
        let mut times = [Vec::new(), Vec::new()];
        for frame in 0..WARM_UP + FRAMES {
            let start = Instant::now();
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            shadows.record(&gpu, &mut encoder, &renderer.frame)?;
            let recorded = start.elapsed();
            gpu.queue.submit([encoder.finish()]);
            let submitted = start.elapsed();
            gpu.wait()?;
            if frame >= WARM_UP {
                times[0].push(recorded);
                times[1].push(submitted);
            }
        }
        let [record, submit] = times.map(|mut times| {
            times.sort();
            times[FRAMES / 2].as_secs_f64() * 1e3
        });
        println!("{spec:20} {record:8.3} {submit:8.3}");
    }
    Ok(())
}
