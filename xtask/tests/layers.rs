//! The order of the folders: each uses only those above it, and no circle leads through several folders.
//!
//! Imports are read as text: paths that start with `crate`, `super`, `self` or the name of a child module, outside of
//! comments and of code for tests.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The folders and files of `crates/antumbra/src`, each above those that may use it.
const ORDER: &[&str] =
    &["error", "gpu", "input", "technique", "shaders", "passes", "techniques", "shadows", "scene", "lib"];

/// A source file: its module path, and its code without comments and tests.
struct Source {
    module: Vec<String>,
    code: String,
}

/// The files of a crate, and which imports which.
struct Crate {
    sources: Vec<Source>,
    /// The file that defines each macro, and each name that the crate's root exports.
    names: BTreeMap<String, usize>,
}

impl Crate {
    fn read(src: &Path) -> Crate {
        let mut files = Vec::new();
        collect(src, &mut files);
        let texts: Vec<(Vec<String>, String)> = files.iter().map(|f| (module_of(src, f), read(f))).collect();
        let for_tests = modules_for_tests(&texts);
        let kept = texts.into_iter().filter(|(module, _)| !for_tests.iter().any(|t| module.starts_with(t)));
        let sources: Vec<Source> = kept.map(|(module, text)| Source { module, code: bare(&text) }).collect();
        let macros = sources.iter().enumerate().flat_map(|(i, s)| {
            let names = s.code.split("macro_rules! ").skip(1);
            names.filter_map(|rest| rest.split(|c: char| !is_word(c)).next()).map(move |n| (n.to_owned(), i))
        });
        let mut krate = Crate { names: macros.collect(), sources };
        let root = krate.sources.iter().find(|s| s.module == ["lib"]);
        let exported = root.map(paths).unwrap_or_default().into_iter();
        let exported: Vec<_> = exported.filter_map(|(p, _)| Some((p.last()?.clone(), krate.file_of(&p)?))).collect();
        krate.names.extend(exported);
        krate
    }

    /// The file that a path of modules and items leads to. None: the path names nothing in this crate.
    fn file_of(&self, path: &[String]) -> Option<usize> {
        let longest = (1..=path.len()).rev().find_map(|n| self.sources.iter().position(|s| s.module == path[..n]));
        longest.or_else(|| self.names.get(path.first()?.as_str()).copied())
    }

    /// For each file the files that it imports, with the path as written.
    fn imports(&self) -> Vec<Vec<(usize, String)>> {
        let of =
            |s: &Source| paths(s).into_iter().filter_map(|(p, written)| Some((self.file_of(&p)?, written))).collect();
        self.sources.iter().map(of).collect()
    }
}

fn read(file: &Path) -> String {
    fs::read_to_string(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()))
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    let entries = fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    for path in entries.map(|e| e.expect("the folder is readable").path()) {
        match path.is_dir() {
            true => collect(&path, files),
            false if path.extension().is_some_and(|e| e == "rs") => files.push(path),
            false => {}
        }
    }
    files.sort();
}

fn module_of(src: &Path, file: &Path) -> Vec<String> {
    let relative = file.strip_prefix(src).expect("found below it").with_extension("");
    let mut parts: Vec<String> = relative.iter().map(|p| p.to_string_lossy().into_owned()).collect();
    if parts.last().is_some_and(|last| last == "mod") {
        parts.pop();
    }
    parts
}

/// Modules that are declared under `#[cfg(test)]`.
fn modules_for_tests(texts: &[(Vec<String>, String)]) -> Vec<Vec<String>> {
    let of = |(module, text): &(Vec<String>, String)| {
        let declared = text.split("#[cfg(test)]\n").skip(1);
        let names =
            declared.filter_map(|rest| Some(rest.lines().next()?.split_once("mod ")?.1.strip_suffix(';')?.to_owned()));
        let parent = if *module == ["lib"] || *module == ["main"] { Vec::new() } else { module.clone() };
        names.map(|name| [parent.clone(), vec![name]].concat()).collect::<Vec<_>>()
    };
    texts.iter().flat_map(of).collect()
}

/// Code without comments, and without the tests at a file's end.
fn bare(text: &str) -> String {
    let end =
        text.find("\n#[cfg(test)]\nmod ").filter(|at| text[at + 19..].lines().next().is_some_and(|l| l.ends_with('{')));
    let code = text[..end.unwrap_or(text.len())].lines().map(|line| line.split("//").next().unwrap_or_default());
    code.collect::<Vec<_>>().join("\n")
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// All paths in a file that lead into its own crate, from the root on, and as they are written.
fn paths(source: &Source) -> Vec<(Vec<String>, String)> {
    let own = match source.module.as_slice() {
        [one] if one == "lib" || one == "main" => Vec::new(),
        module => module.to_vec(),
    };
    let children: BTreeSet<&str> = source
        .code
        .lines()
        .filter_map(|l| l.trim().split_once("mod ").map(|(_, rest)| rest).and_then(|rest| rest.strip_suffix(';')))
        .collect();
    let mut found = Vec::new();
    for (at, _) in source.code.match_indices("::") {
        let start = source.code[..at].rfind(|c: char| !is_word(c)).map_or(0, |i| i + 1);
        let first = &source.code[start..at];
        let is_start = !source.code[..start].ends_with(':');
        let base = match first {
            "crate" => Vec::new(),
            "self" => own.clone(),
            "super" => own[..own.len().saturating_sub(1)].to_vec(),
            child if children.contains(child) => [own.clone(), vec![child.to_owned()]].concat(),
            _ => continue,
        };
        if is_start {
            expand(&source.code[at + 2..], base, first.to_owned(), &mut found);
        }
    }
    found
}

/// Follows a path through its braces.
fn expand(rest: &str, base: Vec<String>, written: String, found: &mut Vec<(Vec<String>, String)>) {
    if let Some(inside) = rest.strip_prefix('{') {
        let (mut depth, mut start) = (0, 0);
        for (i, c) in inside.char_indices() {
            match c {
                '{' => depth += 1,
                '}' if depth > 0 => depth -= 1,
                ',' | '}' if depth == 0 => {
                    let part = inside[start..i].trim();
                    if !part.is_empty() {
                        expand(part, base.clone(), written.clone(), found);
                    }
                    start = i + 1;
                    if c == '}' {
                        return;
                    }
                }
                _ => {}
            }
        }
        return;
    }
    let end = rest.find(|c: char| !is_word(c)).unwrap_or(rest.len());
    let (name, after) = rest.split_at(end);
    let mut path = base;
    match name {
        "super" => drop(path.pop()),
        "self" | "" => {}
        name => path.push(name.to_owned()),
    }
    let written = format!("{written}::{name}");
    match after.strip_prefix("::") {
        Some(more) if more.starts_with(|c: char| is_word(c) || c == '{') => expand(more, path, written, found),
        _ => found.push((path, written)),
    }
}

fn crates() -> Vec<(String, Crate)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace").join("crates");
    let entries = fs::read_dir(folder).expect("the workspace has crates").map(|e| e.expect("readable").path());
    let mut all: Vec<_> = entries
        .map(|path| (path.file_name().expect("a name").to_string_lossy().into_owned(), path.join("src")))
        .filter(|(_, src)| src.is_dir())
        .map(|(name, src)| (name, Crate::read(&src)))
        .collect();
    all.sort_by(|a, b| a.0.cmp(&b.0));
    all
}

/// Imports against the order, or of a name from the crate's root, which hides where it comes from; each in words.
fn against_order(krate: &Crate, order: &[&str]) -> Vec<String> {
    let rank = |i: usize| {
        let top = krate.sources[i].module.first().expect("modules have names");
        order.iter().position(|o| o == top).unwrap_or_else(|| panic!("`{top}` has no place in the order of folders"))
    };
    let mut wrong = Vec::new();
    for (i, imports) in krate.imports().iter().enumerate().filter(|(i, _)| krate.sources[*i].module != ["lib"]) {
        let module = krate.sources[i].module.join("::");
        for (file, written) in imports {
            let name = written.strip_prefix("crate::").unwrap_or_default();
            if name.starts_with(char::is_uppercase) {
                wrong.push(format!("{module} imports `{written}` not from the module that defines it"));
            } else if rank(*file) > rank(i) {
                wrong.push(format!("{module} uses `{written}`, which is below it"));
            }
        }
    }
    wrong
}

/// Circles of imports that lead through several folders, each in words.
fn circles(krate: &Crate) -> Vec<String> {
    let imports = krate.imports();
    let reach: Vec<BTreeSet<usize>> = (0..imports.len())
        .map(|start| {
            let (mut seen, mut open) = (BTreeSet::new(), vec![start]);
            while let Some(i) = open.pop() {
                open.extend(imports[i].iter().map(|(to, _)| *to).filter(|to| seen.insert(*to)));
            }
            seen
        })
        .collect();
    let is_folder =
        |module: &[String]| krate.sources.iter().any(|s| s.module.len() > module.len() && s.module.starts_with(module));
    let folder = |i: usize| {
        let module = &krate.sources[i].module;
        let end = if is_folder(module) { module.len() } else { module.len() - 1 };
        module[..end].join("::")
    };
    let mut found = Vec::new();
    for a in 0..imports.len() {
        for b in a + 1..imports.len() {
            if reach[a].contains(&b) && reach[b].contains(&a) && folder(a) != folder(b) {
                let name = |i: usize| krate.sources[i].module.join("::");
                found.push(format!("{} and {} import each other", name(a), name(b)));
            }
        }
    }
    found
}

#[test]
fn each_folder_of_the_library_uses_only_those_above_it() {
    let (_, library) = crates().into_iter().find(|(name, _)| name == "antumbra").expect("there is the library");
    let wrong = against_order(&library, ORDER);
    assert!(wrong.is_empty(), "{} imports against the order {ORDER:?}:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn no_circle_of_imports_leads_through_several_folders() {
    let of = |(name, krate): (String, Crate)| circles(&krate).into_iter().map(move |pair| format!("{name}: {pair}"));
    let found: Vec<String> = crates().into_iter().flat_map(of).collect();
    assert!(found.is_empty(), "{} pairs of files:\n{}", found.len(), found.join("\n"));
}

/// The check itself must fail where it should.
#[test]
fn a_wrong_import_and_a_circle_are_found() {
    let source =
        |module: &str, code: &str| Source { module: module.split("::").map(str::to_owned).collect(), code: bare(code) };
    let names = BTreeMap::from([("Error".to_owned(), 1)]);
    let sources = vec![
        source("gpu", "pub mod device;"),
        source("gpu::device", "use crate::{passes::maps::{self, Map}, gpu::device};"),
        source("passes", "pub mod maps; // use crate::techniques;"),
        source("passes::maps", "use crate::Error; fn f() { crate::gpu::device::open(); }"),
    ];
    let broken = Crate { names, sources };
    let wrong = against_order(&broken, ORDER);
    assert_eq!(wrong.len(), 3, "{wrong:?}");
    assert!(wrong[0].contains("gpu::device uses `crate::passes::maps"), "{wrong:?}");
    assert!(wrong[2].contains("`crate::Error` not from the module"), "{wrong:?}");
    assert_eq!(circles(&broken).len(), 1);
}
