//! Linking WESL modules into one WGSL program: imports are resolved, names mangled, binding numbers assigned.

use super::shader::{ShaderKey, Slot, StorageFormat};
use crate::error::ShaderError;
use std::collections::BTreeSet;
use std::sync::LazyLock;
use wesl::syntax::{
    AddressSpace, Attribute, AttributeNode, Declaration, DeclarationKind, ExpressionNode, GlobalDeclaration,
    LiteralExpression, TranslationUnit,
};
use wesl::{BasicSourceMap, ManglerKind, ModulePath, SourceMap, VirtualResolver, Wesl};

include!(concat!(env!("OUT_DIR"), "/shader_sources.rs"));

/// The declarations of all host structs.
static HOST: LazyLock<String> = LazyLock::new(|| HOST_STRUCTS.iter().map(|wgsl| wgsl()).collect());

/// A program before it is validated.
pub(super) struct Linked {
    pub wgsl: String,
    pub slots: Vec<Slot>,
    pub known_names: Vec<String>,
    map: BasicSourceMap,
}

/// Links a module with its imports.
pub(super) fn link(key: &ShaderKey) -> Result<Linked, ShaderError> {
    let error = |message: String| ShaderError { module: key.module.to_owned(), message };
    let path = format!("package::{}", key.module);
    if key.source.is_none() && !SOURCES.iter().any(|(known, _)| *known == path) {
        return Err(error(format!("there is no file src/{}.wesl", key.module.replace("::", "/"))));
    }
    let StorageFormat(target) = key.target;
    let host = format!("{}\nalias StorageTarget = texture_storage_2d_array<{target}, write>;\n", *HOST);
    let mut resolver = VirtualResolver::new();
    for (path, text) in SOURCES {
        resolver.add_module(module_path(path), (*text).into());
    }
    for (name, module) in &key.parts {
        let path = format!("package::{module}");
        let found = SOURCES.iter().find(|(p, _)| *p == path);
        let (_, text) = found.ok_or_else(|| error(format!("there is no module {path}")))?;
        resolver.add_module(module_path(&format!("package::{name}")), (*text).into());
    }
    if let Some(source) = &key.source {
        let text: Vec<&str> = source.lines().map(str::trim_start).collect();
        resolver.add_module(module_path(&path), text.join("\n").into());
    }
    resolver.add_module(module_path("package::host"), host.into());
    let mut wesl = Wesl::new("").set_custom_resolver(resolver);
    wesl.set_mangler(ManglerKind::Escape).use_sourcemap(true);
    wesl.set_missing_feature_behavior(false).use_stripping(true);
    for feature in &key.features {
        wesl.set_feature(feature, true);
    }
    let mut linked = wesl.compile(&module_path(&path)).map_err(|e| error(without_colors(&e.to_string())))?;
    let map = linked.sourcemap.take().unwrap_or_default();
    let slots = assign_bindings(&mut linked.syntax, &map, key.module).map_err(error)?;
    let known_names = known_names(key);
    Ok(Linked { wgsl: linked.syntax.to_string(), slots, known_names, map })
}

/// A message without the escape codes that colour it in a terminal: it may go to a log or a web page.
fn without_colors(message: &str) -> String {
    let mut parts = message.split("\x1b[");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| text + part.split_once('m').map_or(part, |(_, rest)| rest))
}

/// Numbers the resources of a program in the order of their declarations, all in group 0.
fn assign_bindings(program: &mut TranslationUnit, map: &BasicSourceMap, root: &str) -> Result<Vec<Slot>, String> {
    let mut found: Vec<(Slot, String)> = Vec::new();
    for node in &mut program.global_declarations {
        let span = node.span();
        let GlobalDeclaration::Declaration(declaration) = node.node_mut() else { continue };
        if !is_resource(declaration) {
            continue;
        }
        let mangled = declaration.ident.name().clone();
        let (module, name) = map.get_decl(&mangled).map_or_else(
            || (root.to_owned(), mangled.clone()),
            |(path, name)| (path.components.join("::"), name.to_owned()),
        );
        if let Some((_, other)) = found.iter().find(|(slot, _)| slot.name == name) {
            return Err(format!("the resource `{name}` is declared by {other} and by {module}: rename one of them"));
        }
        let binding = found.len() as u32;
        let number = |n: u32| ExpressionNode::new(LiteralExpression::AbstractInt(n.into()).into(), span);
        let attributes = [Attribute::Group(number(0)), Attribute::Binding(number(binding))];
        declaration.attributes.extend(attributes.map(|a| AttributeNode::new(a, span)));
        found.push((Slot { name, binding }, module));
    }
    Ok(found.into_iter().map(|(slot, _)| slot).collect())
}

/// True for buffers, textures and samplers.
fn is_resource(declaration: &Declaration) -> bool {
    match &declaration.kind {
        DeclarationKind::Var(None) => true,
        DeclarationKind::Var(Some((space, _))) => {
            matches!(space, AddressSpace::Uniform | AddressSpace::Storage | AddressSpace::Handle)
        }
        _ => false,
    }
}

/// Names of the resources that a module, its imports and all modules that can stand in for a part declare under any
/// feature, sorted.
fn known_names(key: &ShaderKey) -> Vec<String> {
    let source_of = |module: &str| {
        let known = SOURCES.iter().find(|(path, _)| path.strip_prefix("package::") == Some(module));
        key.source.as_deref().filter(|_| module == key.module).or(known.map(|(_, text)| *text))
    };
    let of_parts = SOURCES.iter().filter_map(|(path, _)| path.strip_prefix("package::")).filter(|path| {
        let name = path.rsplit("::").next().unwrap_or_default();
        key.parts.iter().any(|(part, _)| *part == name)
    });
    let given = key.parts.iter().map(|(_, module)| *module);
    let mut open: Vec<String> = of_parts.chain(given).chain([key.module]).map(str::to_owned).collect();
    let (mut names, mut seen) = (BTreeSet::new(), BTreeSet::new());
    while let Some(module) = open.pop() {
        let Some(text) = source_of(&module).filter(|_| seen.insert(module.clone())) else { continue };
        // Kernels of tests are indented.
        let line = |line| if key.source.is_some() { str::trim_start(line) } else { line };
        names.extend(text.lines().filter_map(|text| resource_of_line(line(text))));
        open.extend(text.split("import ").skip(1).flat_map(|rest| imported_modules(&module, rest)));
    }
    names.into_iter().map(str::to_owned).collect()
}

/// The modules that an import statement may name: its path up to the braces, with and without the last word.
fn imported_modules(importer: &str, statement: &str) -> [String; 2] {
    let path = statement.split([';', '{']).next().unwrap_or_default().trim().trim_end_matches("::");
    let parent = importer.rsplit_once("::").map_or("", |(parent, _)| parent);
    let whole = match path.strip_prefix("super::") {
        Some(rest) => format!("{parent}::{rest}"),
        None => path.strip_prefix("package::").unwrap_or(path).to_owned(),
    };
    let module = whole.rsplit_once("::").map_or(whole.as_str(), |(module, _)| module).to_owned();
    [whole, module]
}

/// The name in a line that declares a resource: such declarations start a line, after `@if` at most.
fn resource_of_line(line: &str) -> Option<&str> {
    let rest = match line.strip_prefix("@if(") {
        Some(condition) => condition.split_once(") var")?.1,
        None => line.strip_prefix("var")?,
    };
    let name = match rest.strip_prefix('<') {
        Some(rest) => rest.split_once("> ")?.1,
        None => rest.strip_prefix(' ')?,
    };
    Some(name.split_once(':')?.0.trim())
}

impl Linked {
    /// An error of the linked text, with the module and line of the declaration that it lies in.
    pub fn error(
        &self,
        key: &ShaderKey,
        location: Option<naga::SourceLocation>,
        error: &dyn std::error::Error,
    ) -> ShaderError {
        let place = location.and_then(|l| self.place(key, l.offset as usize)).unwrap_or_else(|| key.module.to_owned());
        let line = location.and_then(|l| self.wgsl.lines().nth(l.line_number as usize - 1)).unwrap_or_default();
        let mut message = format!("{place}: {error}");
        let mut source = error.source();
        while let Some(cause) = source {
            message.push_str(&format!(": {cause}"));
            source = cause.source();
        }
        ShaderError { module: key.module.to_owned(), message: format!("{message}\n  {}", line.trim()) }
    }

    /// `module:line` of the declaration around a byte of the linked text.
    fn place(&self, key: &ShaderKey, offset: usize) -> Option<String> {
        let starts = ["fn ", "var<", "var ", "const ", "override ", "struct ", "alias "];
        let is_start = |line: &&str| {
            let bare = line.trim_start_matches('@');
            starts.iter().any(|s| bare.starts_with(s) || line.contains(&format!(") {s}")))
        };
        let line = self.wgsl[..offset.min(self.wgsl.len())].lines().rfind(is_start)?;
        let after = starts.iter().filter_map(|s| line.find(s).map(|at| (at, &line[at + s.len()..]))).min()?.1;
        let after = after.split_once("> ").filter(|_| line.contains("var<")).map_or(after, |(_, rest)| rest);
        let mangled = after.split(|c: char| !(c.is_alphanumeric() || c == '_')).next()?;
        let (module, name, source) = match self.map.get_decl(mangled) {
            Some((path, name)) => (path.components.join("::"), name.to_owned(), self.map.get_source(path)?),
            None => {
                let root = module_path(&format!("package::{}", key.module));
                (key.module.to_owned(), mangled.to_owned(), self.map.get_source(&root)?)
            }
        };
        let declares = |line: &str| {
            let mut words = line.split(|c: char| !(c.is_alphanumeric() || c == '_')).filter(|w| !w.is_empty());
            !line.starts_with([' ', '}', '/']) && words.any(|w| w == name) && starts.iter().any(|s| line.contains(s))
        };
        let number = source.lines().position(declares)? + 1;
        Some(format!("{module}:{number}"))
    }
}

fn module_path(path: &str) -> ModulePath {
    path.parse().expect("module paths are made of file names")
}
