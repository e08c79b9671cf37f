//! Embeds every `.wesl` file below `src` as a WESL module named after its path, and lists every struct that
//! `gpu_struct!` declares: a technique's shaders and structs are found because they lie in its folder.

use std::{env, fmt::Write, fs, path::Path};

fn main() {
    let root = Path::new(&env::var("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("src");
    let mut files = Vec::new();
    collect(&root, &mut files);
    files.sort();
    let mut sources = String::from("pub(crate) const SOURCES: &[(&str, &str)] = &[\n");
    let mut structs = String::from("pub(crate) const HOST_STRUCTS: &[fn() -> String] = &[\n");
    for file in &files {
        let relative = file.strip_prefix(&root).expect("found below the root").with_extension("");
        let parts = relative.iter().map(|part| part.to_str().expect("UTF-8 path")).collect::<Vec<_>>();
        if file.extension().is_some_and(|e| e == "wesl") {
            let module = parts.join("::");
            writeln!(sources, "    (\"package::{module}\", include_str!({:?})),", file.display().to_string()).unwrap();
            continue;
        }
        let module = parts.iter().filter(|p| **p != "mod").map(|p| format!("{p}::")).collect::<String>();
        for name in host_structs(&fs::read_to_string(file).expect("sources are UTF-8")) {
            writeln!(structs, "    <crate::{module}{name} as crate::gpu::host_struct::HostStruct>::wgsl,").unwrap();
        }
    }
    let table = format!("{sources}];\n{structs}];\n");
    let out = Path::new(&env::var("OUT_DIR").expect("cargo sets it")).join("shader_sources.rs");
    fs::write(out, table).expect("the build folder is writable");
}

fn collect(folder: &Path, files: &mut Vec<std::path::PathBuf>) {
    println!("cargo::rerun-if-changed={}", folder.display());
    for entry in fs::read_dir(folder).expect("the source folder is readable") {
        let path = entry.expect("the source folder is readable").path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|e| e == "wesl" || e == "rs") {
            files.push(path);
        }
    }
}

/// Names of the structs that are declared at the start of a line by `gpu_struct!` or `crate::gpu_struct!`.
fn host_structs(source: &str) -> Vec<&str> {
    let starts = ["\ngpu_struct! {", "\ncrate::gpu_struct! {"];
    let declarations = starts.iter().flat_map(|start| source.split(start).skip(1));
    declarations.filter_map(|d| d.split_once(" struct ")?.1.split([' ', '{']).next()).collect()
}
