//! Any bytes as an OBJ file, and what follows its first NUL as each file that it refers to.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let (obj, other) = bytes.split_at(bytes.iter().position(|&b| b == 0).unwrap_or(bytes.len()));
    let mut read_file = |_: &str| Ok(other.get(1..).unwrap_or_default().to_vec());
    if let Ok(model) = antumbra_scene::import::obj::parse(obj, "fuzz.obj", &mut read_file) {
        model.into_scene();
    }
});
