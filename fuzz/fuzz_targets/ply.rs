//! Any bytes as a PLY file.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(model) = antumbra_scene::import::ply::parse(bytes, "fuzz.ply") {
        model.into_scene();
    }
});
