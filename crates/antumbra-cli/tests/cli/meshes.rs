//! Scenes that tests write: a small animal that stands in for a scanned one, and files that are broken in some way.

use std::fmt::Write;

/// A body with two ears as an OBJ of about 1000 triangles: curved, with contact, self-shadow and thin parts.
pub fn animal() -> String {
    let mut obj = String::from("# an animal\n");
    let mut first = 1;
    for (center, radius) in [
        ([0.0, 0.5, 0.0], [0.5, 0.5, 0.6]),
        ([0.0, 1.0, 0.5], [0.3, 0.3, 0.3]),
        ([-0.15, 1.45, 0.45], [0.07, 0.3, 0.05]),
        ([0.15, 1.45, 0.45], [0.07, 0.3, 0.05]),
    ] {
        first = ellipsoid(&mut obj, first, center, radius);
    }
    obj
}

/// Adds an ellipsoid with a furry surface; returns the number of the next vertex.
fn ellipsoid(obj: &mut String, first: usize, center: [f32; 3], radius: [f32; 3]) -> usize {
    const ROWS: usize = 12;
    const COLUMNS: usize = 16;
    for row in 0..=ROWS {
        for column in 0..COLUMNS {
            let (u, v) = (column as f32 / COLUMNS as f32, row as f32 / ROWS as f32);
            let (theta, phi) = (v * std::f32::consts::PI, u * std::f32::consts::TAU);
            let fur = 1.0 + 0.03 * (5.0 * phi).sin() * (7.0 * theta).sin();
            let unit = [theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()];
            let p: [f32; 3] = std::array::from_fn(|i| center[i] + radius[i] * fur * unit[i]);
            let _ = writeln!(obj, "v {} {} {}", p[0], p[1], p[2]);
        }
    }
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let at = |r: usize, c: usize| first + r * COLUMNS + c % COLUMNS;
            let quad = [at(row, column), at(row, column + 1), at(row + 1, column + 1), at(row + 1, column)];
            let _ = writeln!(obj, "f {} {} {} {}", quad[0], quad[1], quad[2], quad[3]);
        }
    }
    first + (ROWS + 1) * COLUMNS
}

/// A GLB of one triangle whose header and chunks are right.
pub fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut text = json.as_bytes().to_vec();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut out = b"glTF".to_vec();
    out.extend(2u32.to_le_bytes());
    out.extend(((12 + 8 + text.len() + 8 + binary.len()) as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text[..]), (b"BIN\0", binary)] {
        out.extend((chunk.len() as u32).to_le_bytes());
        out.extend(kind);
        out.extend(chunk);
    }
    out
}

/// The JSON of one triangle, its buffer `bytes` long and its positions `count` in number.
pub fn triangle_json(bytes: u64, count: u64) -> String {
    serde_json::json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "buffers": [{"byteLength": bytes}],
        "bufferViews": [{"buffer": 0, "byteLength": bytes}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3",
            "min": [0, 0, 0], "max": [1, 1, 0]}],
    })
    .to_string()
}

/// Positions of one triangle.
pub fn triangle_bytes() -> Vec<u8> {
    [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].into_iter().flat_map(f32::to_le_bytes).collect()
}
