//! From WESL modules to a validated WGSL program whose bindings are known by name.

use crate::Error;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use std::collections::BTreeMap;
use wesl::{ManglerKind, ModulePath, VirtualResolver, Wesl};

include!(concat!(env!("OUT_DIR"), "/shader_sources.rs"));

/// A WESL module with its switches set. What differs between variants is a feature (`@if(name)` in the shader) or a
/// constant of the pipeline (`override`).
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct ShaderKey {
    /// Path below `src`, such as `techniques::pcss::filter`.
    pub module: &'static str,
    /// The features that are on; all others are off.
    pub features: Vec<&'static str>,
    /// WGSL text of the structs that the host shares, importable from `package::host`.
    pub structs: String,
    /// Modules that stand in for a name: what imports from `package::NAME` gets this module, given as a path below `src`.
    pub parts: Vec<(&'static str, &'static str)>,
    /// What `StorageTarget`, importable from `package::host`, is an array of.
    pub target: StorageFormat,
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

    /// Shares a host struct with the shader.
    pub fn with<T: HostStruct>(mut self) -> Self {
        self.structs.push_str(&T::wgsl());
        self
    }
}

/// A struct that is declared once, in Rust, and whose WGSL declaration is made from it: see [`gpu_struct`](crate::gpu_struct).
pub trait HostStruct: encase::ShaderType + encase::internal::WriteInto {
    /// The declaration in WGSL.
    fn wgsl() -> String;

    /// The bytes of a uniform buffer.
    fn uniform_bytes(&self) -> Vec<u8> {
        let mut buffer = encase::UniformBuffer::new(Vec::new());
        buffer.write(self).expect("a vector grows as needed");
        buffer.into_inner()
    }
}

/// The WGSL name of a Rust type that can stand in a [`HostStruct`].
pub trait WgslType {
    /// As written in WGSL.
    const NAME: &'static str;
}

macro_rules! wgsl_types {
    ($($rust:ty => $wgsl:literal),* $(,)?) => { $(impl WgslType for $rust { const NAME: &'static str = $wgsl; })* };
}
wgsl_types! {
    f32 => "f32", u32 => "u32", i32 => "i32",
    glam::Vec2 => "vec2<f32>", glam::Vec3 => "vec3<f32>", glam::Vec4 => "vec4<f32>",
    glam::UVec2 => "vec2<u32>", glam::UVec4 => "vec4<u32>", glam::Mat3 => "mat3x3<f32>", glam::Mat4 => "mat4x4<f32>",
    [glam::Vec4; 6] => "array<vec4<f32>, 6>",
}

/// Declares a struct once for the host and for the shaders that import it from `package::host`.
#[doc(hidden)]
#[macro_export]
macro_rules! gpu_struct {
    ($(#[$meta:meta])* $vis:vis struct $name:ident { $($(#[$field_meta:meta])* $field:ident : $type:ty),* $(,)? }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, encase::ShaderType)]
        $vis struct $name { $($(#[$field_meta])* pub $field: $type),* }

        impl $crate::shader::HostStruct for $name {
            fn wgsl() -> String {
                let mut text = format!("struct {} {{\n", stringify!($name));
                $(text.push_str(&format!("    {}: {},\n", stringify!($field), <$type as $crate::shader::WgslType>::NAME));)*
                text.push_str("}\n");
                text
            }
        }
    };
}

/// A shader that does not compose or does not validate. The message holds the place in the source.
#[derive(Debug, thiserror::Error)]
#[error("shader {module}: {message}")]
pub struct ShaderError {
    /// The module that was composed.
    pub module: String,
    /// What is wrong, with an excerpt.
    pub message: String,
}

/// A composed program.
pub struct Program {
    /// Plain WGSL.
    pub wgsl: String,
    module: naga::Module,
    info: ModuleInfo,
}

/// What one shader takes of what devices give a limited number of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Needs {
    /// Storage buffers.
    pub storage_buffers: u32,
    /// Storage textures.
    pub storage_textures: u32,
    /// Textures that are sampled or loaded from.
    pub sampled_textures: u32,
    /// Memory that a workgroup shares.
    pub workgroup_bytes: u32,
}

impl Needs {
    /// What every WebGPU device gives.
    pub const CORE: Needs =
        Needs { storage_buffers: 8, storage_textures: 4, sampled_textures: 16, workgroup_bytes: 16384 };

    /// The larger of each.
    pub fn max(self, other: Needs) -> Needs {
        Needs {
            storage_buffers: self.storage_buffers.max(other.storage_buffers),
            storage_textures: self.storage_textures.max(other.storage_textures),
            sampled_textures: self.sampled_textures.max(other.sampled_textures),
            workgroup_bytes: self.workgroup_bytes.max(other.workgroup_bytes),
        }
    }

    /// Refuses what a device gives too little of. `shader` is who needs it.
    pub(crate) fn check(&self, shader: &'static str, limits: &wgpu::Limits) -> Result<(), Error> {
        let pairs = [
            ("storage buffers", self.storage_buffers, limits.max_storage_buffers_per_shader_stage),
            ("storage textures", self.storage_textures, limits.max_storage_textures_per_shader_stage),
            ("textures", self.sampled_textures, limits.max_sampled_textures_per_shader_stage),
            ("bytes of workgroup memory", self.workgroup_bytes, limits.max_compute_workgroup_storage_size),
        ];
        match pairs.into_iter().find(|(_, needed, given)| needed > given) {
            None => Ok(()),
            Some((what, needed, given)) => Err(Error::Limit { shader, what, needed, given }),
        }
    }
}

/// Group and slot of each resource, by the name of its variable.
pub type Bindings = BTreeMap<String, (u32, u32)>;

impl Program {
    /// Links a module with what it imports and validates the result. Needs no GPU.
    pub fn compose(key: &ShaderKey) -> Result<Program, ShaderError> {
        let error = |message: String| ShaderError { module: key.module.to_owned(), message };
        let mut resolver = VirtualResolver::new();
        for (path, text) in SOURCES {
            resolver.add_module(module_path(path), (*text).into());
        }
        for (name, module) in &key.parts {
            let path = format!("package::{module}");
            let (_, text) =
                SOURCES.iter().find(|(p, _)| *p == path).ok_or_else(|| error(format!("there is no module {path}")))?;
            resolver.add_module(module_path(&format!("package::{name}")), (*text).into());
        }
        let StorageFormat(target) = key.target;
        let host = format!("{}\nalias StorageTarget = texture_storage_2d_array<{target}, write>;\n", key.structs);
        resolver.add_module(module_path("package::host"), host.into());
        let mut linker = Wesl::new("").set_custom_resolver(resolver);
        // Names are unique over all modules (a clash does not validate), so bindings keep theirs.
        linker.set_mangler(ManglerKind::None);
        linker.set_missing_feature_behavior(false).use_stripping(true);
        for feature in &key.features {
            linker.set_feature(feature, true);
        }
        let linked =
            linker.compile(&module_path(&format!("package::{}", key.module))).map_err(|e| error(e.to_string()))?;
        let wgsl = linked.to_string();
        let module = naga::front::wgsl::parse_str(&wgsl).map_err(|e| error(e.emit_to_string(&wgsl)))?;
        let info = Validator::new(ValidationFlags::all(), Capabilities::all())
            .validate(&module)
            .map_err(|e| error(e.emit_to_string(&wgsl)))?;
        Ok(Program { wgsl, module, info })
    }

    /// Names of the entry points.
    pub fn entry_points(&self) -> impl Iterator<Item = &str> {
        self.module.entry_points.iter().map(|e| e.name.as_str())
    }

    /// Threads of a workgroup of a compute entry point.
    pub fn workgroup_size(&self, entry: &str) -> [u32; 3] {
        self.module.entry_points.iter().find(|e| e.name == entry).map_or([1; 3], |e| e.workgroup_size)
    }

    /// What an entry point takes of the device's limits, by what it is.
    pub fn needs(&self, entry: &str) -> Needs {
        let mut needs = Needs::default();
        let Some(i) = self.module.entry_points.iter().position(|e| e.name == entry) else { return needs };
        let used = self.module.global_variables.iter().filter(|(h, _)| !self.info.get_entry_point(i)[*h].is_empty());
        for (_, variable) in used {
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
    pub fn bindings(&self, entries: &[&str]) -> Bindings {
        let used = |handle: naga::Handle<naga::GlobalVariable>| {
            self.module.entry_points.iter().enumerate().any(|(i, entry)| {
                entries.contains(&entry.name.as_str()) && !self.info.get_entry_point(i)[handle].is_empty()
            })
        };
        self.module
            .global_variables
            .iter()
            .filter(|(handle, _)| used(*handle))
            .filter_map(|(_, v)| Some((v.name.clone()?, v.binding.map(|b| (b.group, b.binding))?)))
            .collect()
    }
}

fn module_path(path: &str) -> ModulePath {
    path.parse().expect("module paths are made of file names")
}

#[cfg(test)]
pub(crate) mod twins;

#[cfg(test)]
mod tests {
    use super::*;

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

    /// What can stand in for the name that a module, or a shared one that it imports, imports from: every module of
    /// that name.
    fn parts_of(text: &str) -> Vec<Vec<(&'static str, &'static str)>> {
        let asks = |name: &str| {
            let own = text.contains(&format!("package::{name}::"));
            own || name == "warp" && text.contains("package::shaders::stored_texel::")
        };
        let Some(name) = ["warp", "soft", "listed", "pair"].into_iter().find(|name| asks(name)) else {
            return vec![Vec::new()];
        };
        // Techniques that are read by a module `soft` have nothing for a lookup.
        let serves = |module: &str| !text.contains("package::warp::visible") || module.contains("fn visible(");
        let modules = SOURCES.iter().filter(|(path, text)| path.ends_with(&format!("::{name}")) && serves(text));
        modules.map(|(path, _)| vec![(name, path.strip_prefix("package::").unwrap())]).collect()
    }

    #[test]
    fn every_variant_of_every_entry_module_composes_and_validates() {
        let structs: String = HOST_STRUCTS.iter().map(|wgsl| wgsl()).collect();
        let mut variants = 0;
        for (path, text) in SOURCES {
            if !["@compute", "@vertex", "@fragment"].iter().any(|stage| text.contains(stage)) {
                continue;
            }
            let features = features_of(text);
            for mask in 0..1u32 << features.len() {
                let on: Vec<_> =
                    features.iter().enumerate().filter(|(i, _)| mask >> i & 1 == 1).map(|(_, f)| *f).collect();
                for parts in parts_of(text) {
                    let key = ShaderKey {
                        module: path.strip_prefix("package::").unwrap(),
                        features: on.clone(),
                        structs: structs.clone(),
                        parts,
                        ..Default::default()
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

    #[test]
    fn an_unknown_import_is_an_error_that_names_the_module() {
        let error = Program::compose(&ShaderKey::new("techniques::nothing")).err().expect("must fail");
        assert!(error.to_string().contains("techniques::nothing"), "{error}");
    }
}
