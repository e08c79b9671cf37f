//! Material libraries (MTL): diffuse colour, diffuse texture, and transparency as a mask.

use super::statements::text_after;
use crate::import::{ReadFile, texture_file};
use crate::{Material, Texture, Wrap};
use glam::Vec3;
use image::{Rgba, RgbaImage};
use std::collections::HashMap;
use std::sync::Arc;

/// Materials by name.
pub(super) type Library = HashMap<String, Material>;

/// Alpha below which a surface is a hole: a shadow is cast or it is not.
const CUTOFF: f32 = 0.5;

const WHITE: Rgba<u8> = Rgba([255; 4]);

/// Statements on one material.
#[derive(Default)]
struct Entry {
    name: String,
    color: Option<Vec3>,
    opacity: Option<f32>,
    color_map: Option<Map>,
    opacity_map: Option<Map>,
}

/// Path of a texture and the only option of `map_*` that is read.
#[derive(Clone, PartialEq)]
struct Map {
    path: String,
    clamp: bool,
}

/// Reads the libraries that an OBJ file names. A file that cannot be read is a warning.
pub(super) fn load(names: &[String], obj: &str, read_file: &mut ReadFile) -> Library {
    let mut library = Library::new();
    for names in names {
        for (path, bytes) in find(names, obj, read_file) {
            let mut textures = Textures { mtl: &path, read_file, known: HashMap::new() };
            for entry in entries(&bytes) {
                let material = textures.material(&entry);
                library.entry(entry.name).or_insert(material);
            }
        }
    }
    library
}

/// Files of one `mtllib`: one whose name may hold spaces, or several.
fn find(names: &str, obj: &str, read_file: &mut ReadFile) -> Vec<(String, Vec<u8>)> {
    let whole = with_slashes(names);
    if let Ok(bytes) = read_file(&whole) {
        return vec![(whole, bytes)];
    }
    let mut found = Vec::new();
    for path in whole.split_whitespace() {
        match read_file(path) {
            Ok(bytes) => found.push((path.to_string(), bytes)),
            Err(error) => tracing::warn!("{obj}: cannot read the material library {path}: {error}; it is left out"),
        }
    }
    found
}

fn with_slashes(path: &str) -> String {
    path.replace('\\', "/")
}

fn entries(bytes: &[u8]) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for line in bytes.split(|&b| b == b'\n') {
        let line = line.trim_ascii();
        let keyword = line.split(|b| b.is_ascii_whitespace()).next().unwrap_or_default();
        let text = text_after(line, keyword);
        if keyword == b"newmtl" {
            entries.push(Entry { name: text, ..Entry::default() });
            continue;
        }
        let Some(entry) = entries.last_mut() else { continue };
        let numbers = || text.split_whitespace().map_while(|w| w.parse::<f32>().ok()).filter(|x| x.is_finite());
        match keyword {
            b"Kd" => {
                let values: Vec<f32> = numbers().collect();
                entry.color = match values[..] {
                    [r, g, b, ..] => Some(Vec3::new(r, g, b)),
                    [grey, ..] => Some(Vec3::splat(grey)),
                    [] => None,
                };
            }
            b"d" => entry.opacity = numbers().next(),
            b"Tr" => entry.opacity = numbers().next().map(|t| 1.0 - t),
            b"map_Kd" => entry.color_map = map(&text),
            b"map_d" => entry.opacity_map = map(&text),
            _ => {}
        }
    }
    entries
}

/// Arguments of `map_*`: options, then a file name that may hold spaces.
fn map(text: &str) -> Option<Map> {
    let (mut rest, mut clamp) = (text.trim(), false);
    while rest.starts_with('-') {
        let (option, after) = rest.split_once(char::is_whitespace)?;
        rest = after.trim_start();
        let word = rest.split(char::is_whitespace).next()?;
        let (least, most) = match option {
            "-mm" => (2, 2),
            "-o" | "-s" | "-t" => (1, 3),
            _ => (1, 1),
        };
        clamp |= option == "-clamp" && word == "on";
        for i in 0..most {
            let (word, after) = rest.split_once(char::is_whitespace)?;
            if i >= least && word.parse::<f32>().is_err() {
                break;
            }
            rest = after.trim_start();
        }
    }
    (!rest.is_empty()).then(|| Map { path: with_slashes(rest), clamp })
}

/// Reads the textures of one library, each once.
struct Textures<'a, 'r> {
    mtl: &'a str,
    read_file: &'a mut ReadFile<'r>,
    known: HashMap<String, Option<Arc<RgbaImage>>>,
}

impl Textures<'_, '_> {
    fn material(&mut self, entry: &Entry) -> Material {
        let map = entry.color_map.as_ref().or(entry.opacity_map.as_ref());
        let pixels = self.pixels(entry);
        let opacity = entry.opacity.unwrap_or(1.0);
        let masked = opacity < 1.0 || (entry.opacity_map.is_some() && pixels.is_some());
        // Where there is a texture, a black diffuse colour is a common exporter's slip for white.
        let color = entry.color.filter(|c| pixels.is_none() || *c != Vec3::ZERO).unwrap_or(match pixels {
            Some(_) => Vec3::ONE,
            None => Material::default().base_color.truncate(),
        });
        let wrap = if map.is_some_and(|m| m.clamp) { Wrap::Clamp } else { Wrap::Repeat };
        Material {
            base_color: color.extend(opacity),
            texture: pixels.map(|p| {
                let (width, height) = p.dimensions();
                Arc::new(Texture { width, height, rgba: p.into_raw(), wrap: [wrap; 2], nearest: false })
            }),
            alpha_cutoff: masked.then_some(CUTOFF),
            ..Material::default()
        }
    }

    /// Colour of one texture with the alpha of the other.
    fn pixels(&mut self, entry: &Entry) -> Option<RgbaImage> {
        let color = entry.color_map.as_ref().and_then(|m| self.read(&m.path));
        let opacity = entry.opacity_map.as_ref().and_then(|m| self.read(&m.path));
        let (width, height) = color.as_ref().or(opacity.as_ref())?.dimensions();
        let mut pixels = color.map_or_else(|| RgbaImage::from_pixel(width, height, WHITE), |c| RgbaImage::clone(&c));
        // An opacity map is grey, or has its opacity in the alpha channel.
        let channel = if opacity.iter().any(|o| o.pixels().any(|p| p[3] < 255)) { 3 } else { 0 };
        let scaled = |i: u32, from: u32, to: u32| (u64::from(i) * u64::from(to) / u64::from(from)) as u32;
        for (x, y, pixel) in pixels.enumerate_pixels_mut() {
            pixel[3] = opacity
                .as_ref()
                .map_or(255, |o| o.get_pixel(scaled(x, width, o.width()), scaled(y, height, o.height()))[channel]);
        }
        Some(pixels)
    }

    fn read(&mut self, path: &str) -> Option<Arc<RgbaImage>> {
        if let Some(known) = self.known.get(path) {
            return known.clone();
        }
        // Paths are relative to the library's folder.
        let folder = self.mtl.rfind('/').map_or("", |i| &self.mtl[..=i]);
        let full = if path.starts_with('/') { path.to_string() } else { format!("{folder}{path}") };
        let read = (self.read_file)(&full).map_err(|e| e.to_string()).and_then(|bytes| texture_file::decode(&bytes));
        let left_out = |error| tracing::warn!("{}: cannot read the texture {full}: {error}; it is left out", self.mtl);
        let texture = read.map_err(left_out).ok().map(Arc::new);
        self.known.insert(path.to_string(), texture.clone());
        texture
    }
}
