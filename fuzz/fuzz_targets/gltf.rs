//! Any bytes as a glTF file whose other files are 64 zeros long.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(model) = antumbra_scene::import::gltf::parse(bytes, "fuzz.gltf", &mut |_: &str| Ok(vec![0; 64])) {
        model.into_scene();
    }
});
