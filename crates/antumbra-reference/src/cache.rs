//! References kept in files: no image is traced twice.

use crate::image::{Reference, ReferenceError, Settings, trace};
use antumbra_scene::Scene;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Raised whenever the same scene and settings would give other numbers than before.
const VERSION: u32 = 2;

const MAGIC: &[u8; 8] = b"antumbra";

/// A reference and where it came from.
#[derive(Debug)]
pub struct Cached {
    /// The image.
    pub reference: Reference,
    /// True if it was read from a file, false if it was traced now.
    pub was_stored: bool,
    /// The file that holds it, or why it could not be written: the image is still valid.
    pub stored: Result<PathBuf, io::Error>,
}

/// Reads the image from `dir`, or traces and stores it. `dir` is created if need be.
///
/// A file is used only if it is whole and belongs to this scene and these settings; a damaged one is replaced. Files
/// appear complete or not at all, also with several programs at work in one folder.
pub fn trace_cached(
    scene: &Scene,
    settings: &Settings,
    dir: &Path,
    progress: &(dyn Fn(f32) + Sync),
    cancel: &AtomicBool,
) -> Result<Cached, ReferenceError> {
    let key = key(scene, settings);
    let path = dir.join(format!("{}.reference", &key.to_hex()[..32]));
    if let Some(reference) = std::fs::read(&path).ok().and_then(|bytes| decode(&bytes, &key, settings)) {
        return Ok(Cached { reference, was_stored: true, stored: Ok(path) });
    }
    let reference = trace(scene, settings, progress, cancel)?;
    let stored = write_whole(&path, &encode(&reference, &key)).map(|()| path);
    Ok(Cached { reference, was_stored: false, stored })
}

/// A hash of exactly the inputs of an image: names and colours do not count.
pub fn key(scene: &Scene, settings: &Settings) -> blake3::Hash {
    let mut h = blake3::Hasher::new();
    h.update(&VERSION.to_le_bytes());
    for v in [settings.width, settings.height, settings.light_samples, settings.pixel_samples] {
        h.update(&v.to_le_bytes());
    }
    h.update(&settings.seed.to_le_bytes());
    let camera = &scene.camera;
    let light = &scene.light;
    for v in [camera.eye, camera.target, camera.up, light.center, light.target, light.up] {
        hash_floats(&mut h, v.to_array());
    }
    hash_floats(&mut h, [camera.fov_y_deg, camera.near, camera.far, light.size.x, light.size.y]);
    for instance in &scene.instances {
        hash_floats(&mut h, instance.world_from_object.to_cols_array());
        h.update(&[instance.receiver_only.into()]);
        h.update(&(instance.mesh as u64).to_le_bytes());
    }
    for mesh in &scene.meshes {
        for count in [mesh.positions.len(), mesh.indices.len()] {
            h.update(&(count as u64).to_le_bytes());
        }
        hash_floats(&mut h, mesh.positions.iter().flat_map(|p| p.to_array()));
        let indices: Vec<u8> = mesh.indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        h.update(&indices);
        hash_mask(&mut h, scene, mesh);
    }
    h.finalize()
}

fn hash_mask(h: &mut blake3::Hasher, scene: &Scene, mesh: &antumbra_scene::Mesh) {
    let masked = scene.materials.get(mesh.material).and_then(|m| m.alpha_cutoff.map(|cutoff| (m, cutoff)));
    h.update(&[masked.is_some().into()]);
    let Some((material, cutoff)) = masked else { return };
    hash_floats(h, [cutoff, material.base_color.w]);
    h.update(&[material.texture.is_some().into()]);
    let Some(texture) = &material.texture else { return };
    for v in [texture.width, texture.height, texture.wrap[0] as u32, texture.wrap[1] as u32, texture.nearest.into()] {
        h.update(&v.to_le_bytes());
    }
    let alpha: Vec<u8> = texture.rgba.iter().skip(3).step_by(4).copied().collect();
    h.update(&alpha);
    h.update(&(mesh.uvs.len() as u64).to_le_bytes());
    hash_floats(h, mesh.uvs.iter().flat_map(|uv| uv.to_array()));
}

fn hash_floats(h: &mut blake3::Hasher, values: impl IntoIterator<Item = f32>) {
    let bytes: Vec<u8> = values.into_iter().flat_map(f32::to_le_bytes).collect();
    h.update(&bytes);
}

/// Magic, key, width, height, rays, visibility, error, valid (1) or grazing (2), and the hash of all that; little-endian.
fn encode(r: &Reference, key: &blake3::Hash) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(128 + r.visibility.len() * 9);
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(key.as_bytes());
    bytes.extend(r.width.to_le_bytes());
    bytes.extend(r.height.to_le_bytes());
    bytes.extend(r.rays.to_le_bytes());
    bytes.extend(r.visibility.iter().chain(&r.error).flat_map(|v| v.to_le_bytes()));
    bytes.extend(r.valid.iter().zip(&r.grazing).map(|(&valid, &grazing)| u8::from(valid) + 2 * u8::from(grazing)));
    let hash = blake3::hash(&bytes);
    bytes.extend_from_slice(hash.as_bytes());
    bytes
}

/// The image in `bytes`, if they are complete and of the same inputs.
fn decode(bytes: &[u8], key: &blake3::Hash, settings: &Settings) -> Option<Reference> {
    let (body, hash) = bytes.split_last_chunk::<32>()?;
    if blake3::hash(body).as_bytes() != hash {
        return None;
    }
    let body = body.strip_prefix(MAGIC)?.strip_prefix(key.as_bytes())?;
    let (width, body) = body.split_first_chunk()?;
    let (height, body) = body.split_first_chunk()?;
    let (rays, body) = body.split_first_chunk()?;
    let (width, height) = (u32::from_le_bytes(*width), u32::from_le_bytes(*height));
    let n = width as usize * height as usize;
    if (width, height) != (settings.width, settings.height) || body.len() != 9 * n {
        return None;
    }
    let floats = |bytes: &[u8]| bytes.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
    Some(Reference {
        width,
        height,
        visibility: floats(&body[..4 * n]),
        error: floats(&body[4 * n..8 * n]),
        valid: body[8 * n..].iter().map(|&b| b == 1).collect(),
        grazing: body[8 * n..].iter().map(|&b| b == 2).collect(),
        rays: u64::from_le_bytes(*rays),
    })
}

/// Writes under a name of its own beside `path` and moves it there.
fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    if let Some(dir) = path.parent() {
        std::fs::create_dir_all(dir)?;
    }
    let unique = format!("{}-{}.tmp", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
    let temporary = path.with_extension(unique);
    std::fs::write(&temporary, bytes).and_then(|()| std::fs::rename(&temporary, path)).inspect_err(|_| {
        // The first error is the one to report.
        let _ = std::fs::remove_file(&temporary);
    })
}
