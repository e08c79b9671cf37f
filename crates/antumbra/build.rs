//! Embeds every `.wesl` file below `src` as a WESL module named after its path, so that a technique's shaders are
//! found because they lie in its folder.

use std::{env, fmt::Write, fs, path::Path};

fn main() {
    let root = Path::new(&env::var("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("src");
    let mut files = Vec::new();
    collect(&root, &mut files);
    files.sort();
    let mut table = String::from("pub(crate) const SOURCES: &[(&str, &str)] = &[\n");
    for file in &files {
        let relative = file.strip_prefix(&root).expect("found below the root").with_extension("");
        let module = relative.iter().map(|part| part.to_str().expect("UTF-8 path")).collect::<Vec<_>>().join("::");
        writeln!(table, "    (\"package::{module}\", include_str!({:?})),", file.display().to_string()).unwrap();
    }
    table.push_str("];\n");
    let out = Path::new(&env::var("OUT_DIR").expect("cargo sets it")).join("shader_sources.rs");
    fs::write(out, table).expect("the build folder is writable");
}

fn collect(folder: &Path, files: &mut Vec<std::path::PathBuf>) {
    println!("cargo::rerun-if-changed={}", folder.display());
    for entry in fs::read_dir(folder).expect("the source folder is readable") {
        let path = entry.expect("the source folder is readable").path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|e| e == "wesl") {
            files.push(path);
        }
    }
}
