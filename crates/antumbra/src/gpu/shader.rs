//! Shader variants: a WESL module with its switches set, composed into validated WGSL.

use super::limits::Needs;
use super::link;
use crate::error::ShaderError;
use arrayvec::ArrayVec;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use std::sync::Arc;

/// A WESL module with its switches set. Variants differ by features (`@if(name)` in the shader), parts and the format
/// that they store.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct ShaderKey {
    /// Path below `src`, such as `techniques::pcss::soften`.
    pub module: &'static str,
    /// The features that are on; all others are off.
    pub features: ArrayVec<&'static str, 8>,
    /// Modules that stand in for a name: an import from `package::NAME` gets this module, given as a path below `src`.
    pub parts: ArrayVec<(&'static str, &'static str), 1>,
    /// The element of `StorageTarget`, which shaders import from `package::host`.
    pub target: StorageFormat,
    /// Source of a module that is not below `src`: a kernel of a test.
    pub source: Option<Arc<str>>,
}

/// The WGSL name of a format that shaders store to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct StorageFormat(pub &'static str);

impl Default for StorageFormat {
    fn default() -> Self {
        StorageFormat("rgba32float")
    }
}

impl ShaderKey {
    /// A module with every feature off.
    pub fn new(module: &'static str) -> Self {
        ShaderKey { module, ..Default::default() }
    }

    /// A module of this source, called `kernel`.
    pub fn of_source(source: &str) -> Self {
        ShaderKey { source: Some(source.into()), ..ShaderKey::new("kernel") }
    }

    /// Turns a feature on if `on`.
    pub fn feature(mut self, name: &'static str, on: bool) -> Self {
        if on {
            self.features.push(name);
        }
        self
    }

    /// Puts a module in the place of a name: one shader serves several techniques that differ in a few functions.
    pub fn part(mut self, name: &'static str, module: &'static str) -> Self {
        self.parts.push((name, module));
        self
    }

    /// Sets the format of `StorageTarget`.
    pub fn storing(mut self, format: StorageFormat) -> Self {
        self.target = format;
        self
    }
}

/// A resource of a program: its name in the source, and its number within the bind group.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Slot {
    /// Name of the variable, without its module.
    pub name: String,
    /// Number that was assigned when the program was composed.
    pub binding: u32,
}

/// A composed program.
pub struct Program {
    /// Plain WGSL.
    pub wgsl: String,
    /// Names of all resources that any variant of the program's modules declares, sorted.
    pub known_names: Vec<String>,
    /// The resources that are left in this variant.
    slots: Vec<Slot>,
    module: naga::Module,
    info: ModuleInfo,
}

impl Program {
    /// Links a module with its imports and validates the result. Needs no GPU.
    pub fn compose(key: &ShaderKey) -> Result<Program, ShaderError> {
        let linked = link::link(key)?;
        let module =
            naga::front::wgsl::parse_str(&linked.wgsl).map_err(|e| linked.error(key, e.location(&linked.wgsl), &e))?;
        let info = Validator::new(ValidationFlags::all(), Capabilities::all())
            .validate(&module)
            .map_err(|e| linked.error(key, e.location(&linked.wgsl), e.as_inner()))?;
        Ok(Program { known_names: linked.known_names, slots: linked.slots, wgsl: linked.wgsl, module, info })
    }

    /// Names of the entry points.
    pub fn entry_points(&self) -> impl Iterator<Item = &str> {
        self.module.entry_points.iter().map(|e| e.name.as_str())
    }

    /// Threads of a workgroup of a compute entry point.
    pub fn workgroup_size(&self, entry: &str) -> [u32; 3] {
        self.module.entry_points.iter().find(|e| e.name == entry).map_or([1; 3], |e| e.workgroup_size)
    }

    /// The limited resources that an entry point takes, by kind.
    pub fn needs(&self, entry: &str) -> Needs {
        let mut needs = Needs::default();
        for (_, variable) in self.module.global_variables.iter().filter(|(h, _)| self.uses(&[entry], *h)) {
            let inner = &self.module.types[variable.ty].inner;
            match (variable.space, inner) {
                (naga::AddressSpace::Storage { .. }, _) => needs.storage_buffers += 1,
                (naga::AddressSpace::WorkGroup, _) => {
                    needs.workgroup_bytes += inner.size(self.module.to_ctx()).next_multiple_of(16);
                }
                (_, naga::TypeInner::Image { class: naga::ImageClass::Storage { .. }, .. }) => {
                    needs.storage_textures += 1;
                }
                (_, naga::TypeInner::Image { .. }) => needs.sampled_textures += 1,
                _ => {}
            }
        }
        needs
    }

    /// The resources that the named entry points use.
    pub fn slots(&self, entries: &[&str]) -> Vec<Slot> {
        let used = |slot: &&Slot| {
            let bound = |v: &naga::GlobalVariable| v.binding.is_some_and(|b| b.binding == slot.binding);
            self.module.global_variables.iter().any(|(handle, v)| bound(v) && self.uses(entries, handle))
        };
        self.slots.iter().filter(used).cloned().collect()
    }

    fn uses(&self, entries: &[&str], variable: naga::Handle<naga::GlobalVariable>) -> bool {
        let points = self.module.entry_points.iter().enumerate();
        let mut named = points.filter(|(_, entry)| entries.contains(&entry.name.as_str()));
        named.any(|(i, _)| !self.info.get_entry_point(i)[variable].is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::link::SOURCES;

    /// All names in `@if(...)` of a module.
    fn features_of(text: &'static str) -> Vec<&'static str> {
        let mut names: Vec<&str> = text
            .match_indices("@if(")
            .flat_map(|(at, _)| {
                let inside = &text[at + 4..];
                let end = inside.find(')').expect("closed");
                inside[..end].split(|c: char| !(c.is_alphanumeric() || c == '_')).filter(|w| !w.is_empty())
            })
            .collect();
        names.sort();
        names.dedup();
        names
    }

    /// The choices of `ShaderKey::parts` for a module: every module of the name that it imports from, itself or through
    /// `shaders::stored_texel`.
    fn parts_of(text: &str) -> Vec<Option<(&'static str, &'static str)>> {
        let imports = |name: &str| {
            let own = text.contains(&format!("package::{name}::"));
            own || name == "warp" && text.contains("package::shaders::stored_texel::")
        };
        let Some(name) = ["warp", "soft", "listed", "pair"].into_iter().find(|name| imports(name)) else {
            return vec![None];
        };
        // Some modules `warp` have no function `visible`: a module `soft` filters their maps.
        let serves = |module: &str| !text.contains("package::warp::visible") || module.contains("fn visible(");
        let modules = SOURCES.iter().filter(|(path, text)| path.ends_with(&format!("::{name}")) && serves(text));
        modules.map(|(path, _)| Some((name, path.strip_prefix("package::").unwrap()))).collect()
    }

    #[test]
    fn every_variant_of_every_entry_module_composes_and_validates() {
        let mut variants = 0;
        for (path, text) in SOURCES {
            if !["@compute", "@vertex", "@fragment"].iter().any(|stage| text.contains(stage)) {
                continue;
            }
            let features = features_of(text);
            for mask in 0..1u32 << features.len() {
                let on = features.iter().enumerate().filter(|(i, _)| mask >> i & 1 == 1).map(|(_, f)| *f);
                for part in parts_of(text) {
                    let key = ShaderKey {
                        features: on.clone().collect(),
                        parts: part.into_iter().collect(),
                        ..ShaderKey::new(path.strip_prefix("package::").unwrap())
                    };
                    if let Err(e) = Program::compose(&key) {
                        panic!("{e} with features {:?} and parts {:?}", key.features, key.parts);
                    }
                    variants += 1;
                }
            }
        }
        assert!(variants >= 10, "only {variants} variants found: are the shaders embedded?");
    }

    fn error_of(key: &ShaderKey) -> String {
        Program::compose(key).err().expect("must fail").to_string()
    }

    #[test]
    fn a_module_without_a_file_is_an_error_that_names_the_file() {
        let error = error_of(&ShaderKey::new("techniques::nothing"));
        assert!(error.contains("src/techniques/nothing.wesl"), "{error}");
    }

    #[test]
    fn errors_name_module_and_line_before_and_after_linking() {
        let unknown = "import package::shaders::frame::frame;\n\n@compute @workgroup_size(1)\nfn run() {\n    let a = nothing;\n}\n";
        let error = error_of(&ShaderKey::of_source(unknown));
        assert!(error.contains("kernel") && error.contains("nothing"), "{error}");
        assert!(!error.contains('\x1b'), "colours in {error:?}");
        let mistyped =
            "const one = 1u;\n\n@compute @workgroup_size(1)\nfn run() {\n    var a = one;\n    a = 1.5;\n}\n";
        let error = error_of(&ShaderKey::of_source(mistyped));
        assert!(error.contains("kernel:4"), "the declaration of line 4 is at fault: {error}");
    }

    #[test]
    fn several_modules_may_declare_a_name_but_only_one_a_resource() {
        let own = "import package::shaders::frame::receiver_at;\nstruct Receiver { a: u32 }\nvar<storage, read_write> out: array<u32>;\n\
                   @compute @workgroup_size(1) fn run() {\n let r = receiver_at(vec2(0u), 0.5);\n out[0] = Receiver(u32(r.q)).a;\n}\n";
        let program = Program::compose(&ShaderKey::of_source(own)).unwrap_or_else(|e| panic!("{e}"));
        let mut names: Vec<_> = program.slots(&["run"]).into_iter().map(|s| s.name).collect();
        names.sort();
        assert_eq!(names, ["frame", "geometry_normal", "out"]);
        let twice = "import package::shaders::frame::receiver_at;\nvar<storage, read_write> frame: array<f32>;\n\
                     @compute @workgroup_size(1) fn run() { frame[0] = receiver_at(vec2(0u), 0.5).q; }\n";
        let error = error_of(&ShaderKey::of_source(twice));
        assert!(error.contains("`frame`") && error.contains("shaders::frame") && error.contains("kernel"), "{error}");
    }
}
