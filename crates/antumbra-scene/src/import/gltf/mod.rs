//! glTF 2.0, as text (`.gltf`) or binary (`.glb`).
//!
//! Read are: the default scene's nodes (all root nodes where there is no scene), triangle lists, strips and fans,
//! indices of every type, sparse and quantised accessors, skins and morph targets at rest, base colour factor and
//! texture with `KHR_texture_transform`, or those of `KHR_materials_pbrSpecularGlossiness`, alpha of vertices,
//! `doubleSided`, the first perspective camera, the first light of `KHR_lights_punctual` as a rectangular light whose
//! edge is 1/20 of its distance, `EXT_mesh_gpu_instancing` and `KHR_node_visibility`.
//!
//! A shadow is cast or it is not: `alphaMode` `BLEND` is read as `MASK` with a cutoff of one half. Points and lines are
//! skipped, as they cast no shadow. Extensions that are not read and may change what casts are named in a warning.

mod accessor;
mod buffers;
mod cutout;
mod extensions;
mod geometry;
mod material;
mod nodes;
mod pose;
mod views;

use super::text::{abridged, decoded};
use super::warnings::Warnings;
use super::{Model, ReadFile};
use crate::{Place, SceneError};
use buffers::Buffers;
use gltf_json::{Index, Root, Value};
use std::cell::OnceCell;

/// Reads a `.glb` or `.gltf` file. `name` is for messages; `read_file` reads the buffers and images that the file
/// refers to.
pub fn parse(bytes: &[u8], name: &str, read_file: &mut ReadFile) -> Result<Model, SceneError> {
    let (json, binary) = if bytes.starts_with(b"glTF") { chunks(bytes, name)? } else { (bytes, None) };
    // Some exporters pad with zeros instead of spaces.
    let json = &decoded(json)[..];
    let json = json.trim_ascii_end().strip_suffix(b"\0").map_or(json, |_| trim_zeros(json));
    let root = read_json(json, name)?;
    extensions::check(&root, name)?;
    let buffers = Buffers::load(&root, name, binary, read_file)?;
    let (warnings, values) = (Warnings::new(name), OnceCell::new());
    let file = File { name, json, values, root: &root, buffers: &buffers, warnings };
    extensions::warn(&file);
    nodes::import(&file, read_file)?.checked(name)
}

/// The document and its buffers.
struct File<'a> {
    name: &'a str,
    json: &'a [u8],
    /// The document as it is written, once it was asked for.
    values: OnceCell<Value>,
    root: &'a Root,
    buffers: &'a Buffers<'a>,
    warnings: Warnings<'a>,
}

impl<'a> File<'a> {
    /// The item that `index` refers to; `what` is its kind, `place` the referring element.
    fn get<T>(&self, list: &'a [T], index: Index<T>, what: &'static str, place: &str) -> Result<&'a T, SceneError> {
        list.get(index.value()).ok_or_else(|| SceneError::IndexOutOfRange {
            file: self.name.to_string(),
            place: Place::Part(place.to_string()),
            index: index.value() as i64,
            count: list.len(),
            what,
        })
    }

    /// The document with the parts that [`Root`] leaves out.
    fn values(&self) -> &Value {
        self.values.get_or_init(|| gltf_json::deserialize::from_slice(self.json).unwrap_or_default())
    }

    fn malformed(&self, place: impl Into<String>, problem: impl Into<String>) -> SceneError {
        malformed(self.name, Place::Part(place.into()), problem)
    }
}

fn malformed(file: &str, place: Place, problem: impl Into<String>) -> SceneError {
    SceneError::Malformed { file: file.to_string(), place, problem: problem.into() }
}

/// `mesh 2 "roof"`, or `mesh 2` where it has no name.
fn label(kind: &str, index: usize, name: &Option<String>) -> String {
    name.as_ref().map_or_else(|| format!("{kind} {index}"), |n| format!("{kind} {index} {n:?}"))
}

/// The JSON chunk and the binary chunk of a `.glb` file.
fn chunks<'a>(bytes: &'a [u8], name: &str) -> Result<(&'a [u8], Option<&'a [u8]>), SceneError> {
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let cut = |at: usize, what: &str, needed: usize| SceneError::Truncated {
        file: name.to_string(),
        place: Place::Byte(at),
        what: what.to_string(),
        needed: needed as u128,
        available: bytes.len().saturating_sub(at),
    };
    let version = word(4).ok_or_else(|| cut(0, "the header", 12))?;
    if version != 2 {
        return Err(malformed(name, Place::Byte(4), format!("this is version {version} of the format, and 2 is read")));
    }
    let length = word(8).ok_or_else(|| cut(0, "the header", 12))? as usize;
    if length > bytes.len() {
        return Err(cut(0, "the whole file", length));
    }
    let (mut at, mut json, mut binary) = (12, None, None);
    while at < length {
        let (Some(size), Some(kind)) = (word(at), word(at + 4)) else { return Err(cut(at, "a chunk's header", 8)) };
        let start = at + 8;
        let end = start + size as usize;
        let chunk = bytes.get(start..end).ok_or_else(|| cut(start, "a chunk", size as usize))?;
        match kind {
            JSON_CHUNK if json.is_none() => json = Some(chunk),
            BINARY_CHUNK if binary.is_none() => binary = Some(chunk),
            _ => {} // The specification lets other chunks be.
        }
        at = end;
    }
    let json = json.ok_or_else(|| malformed(name, Place::Byte(12), "there is no JSON chunk in the file"))?;
    Ok((json, binary))
}

const JSON_CHUNK: u32 = u32::from_le_bytes(*b"JSON");
const BINARY_CHUNK: u32 = u32::from_le_bytes(*b"BIN\0");

fn read_json(json: &[u8], name: &str) -> Result<Root, SceneError> {
    let root = Root::from_slice(json).map_err(|e| {
        let place = Place::LineColumn(e.line(), e.column());
        malformed(name, place, format!("the JSON is not that of glTF 2.0: {}", without_position(&e)))
    })?;
    if !root.asset.version.starts_with("2.") {
        let problem = format!("the file is glTF {}, and 2.0 is read; export it as glTF 2.0", root.asset.version);
        return Err(malformed(name, Place::Part("asset.version".to_string()), problem));
    }
    Ok(root)
}

fn trim_zeros(json: &[u8]) -> &[u8] {
    let end = json.iter().rposition(|&b| b != 0).map_or(0, |i| i + 1);
    &json[..end]
}

/// The message of a JSON error without the place, which is said elsewhere.
fn without_position(error: &gltf_json::Error) -> String {
    let text = error.to_string();
    abridged(text.split(" at line ").next().unwrap_or(&text)).into_owned()
}
