//! Builds glTF files.

use serde_json::{Value, json};

pub const U8: u32 = 5121;
pub const I16: u32 = 5122;
pub const U16: u32 = 5123;
pub const U32: u32 = 5125;
pub const F32: u32 = 5126;

/// A file under construction: JSON, and the bytes of buffer 0.
pub struct Builder {
    pub json: Value,
    pub bytes: Vec<u8>,
}

impl Builder {
    pub fn new() -> Builder {
        let json = json!({
            "asset": {"version": "2.0"}, "buffers": [{"byteLength": 0}], "bufferViews": [], "accessors": [],
            "meshes": [], "nodes": [], "materials": [], "textures": [], "images": [], "samplers": [], "cameras": [], "skins": [],
        });
        Builder { json, bytes: Vec::new() }
    }

    /// Adds an item to one of the lists and returns its number.
    pub fn add(&mut self, list: &str, item: Value) -> usize {
        let list = self.json[list].as_array_mut().unwrap();
        list.push(item);
        list.len() - 1
    }

    pub fn view(&mut self, bytes: &[u8]) -> usize {
        while !self.bytes.len().is_multiple_of(4) {
            self.bytes.push(0);
        }
        let offset = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.add("bufferViews", json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}))
    }

    pub fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        self.add("accessors", json!({"bufferView": view, "componentType": component, "type": kind, "count": count}))
    }

    pub fn floats(&mut self, values: &[f32], kind: &str) -> usize {
        let width = match kind {
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        self.accessor(&float_bytes(values), F32, kind, values.len() / width)
    }

    /// A mesh of one primitive and a node that shows it.
    pub fn show(&mut self, primitive: Value) -> usize {
        let mesh = self.add("meshes", json!({"name": "shape", "primitives": [primitive]}));
        self.add("nodes", json!({"mesh": mesh}))
    }

    /// The triangle (0 0 0) (1 0 0) (0 1 0), shown.
    pub fn triangle() -> Builder {
        let mut file = Builder::new();
        let positions = file.floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.], "VEC3");
        file.show(json!({"attributes": {"POSITION": positions}}));
        file
    }

    /// As one binary file.
    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"][0]["byteLength"] = self.bytes.len().into();
        let (mut json, mut binary) = (json.to_string().into_bytes(), self.bytes.clone());
        json.resize(json.len().next_multiple_of(4), b' ');
        binary.resize(binary.len().next_multiple_of(4), 0);
        let mut file = b"glTF\x02\0\0\0".to_vec();
        file.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
        for (kind, chunk) in [(b"JSON", json), (b"BIN\0", binary)] {
            file.extend((chunk.len() as u32).to_le_bytes());
            file.extend(kind);
            file.extend(chunk);
        }
        file
    }

    /// As text that refers to its buffer.
    pub fn gltf(&self, uri: &str) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"][0] = json!({"byteLength": self.bytes.len(), "uri": uri});
        json.to_string().into_bytes()
    }
}

pub fn float_bytes(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}
