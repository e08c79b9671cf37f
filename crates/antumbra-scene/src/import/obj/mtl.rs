//! Material libraries (MTL): diffuse colour, diffuse texture, and transparency as a mask.

use super::map::Map;
use super::statements::text_after;
use crate::import::warnings::Warnings;
use crate::import::{ReadFile, text, texture_file};
use crate::{Material, Texture, Wrap};
use glam::{Affine2, Vec3};
use image::{Rgba, RgbaImage};
use std::collections::HashMap;
use std::sync::Arc;

/// Materials by name.
pub(super) type Library = HashMap<String, Paint>;

/// A material, and the transform of the texture coordinates that it asks for.
#[derive(Clone, Default)]
pub(super) struct Paint {
    pub material: Material,
    pub uv: Affine2,
}

/// Alpha below which a surface is a hole: a shadow is cast or it is not.
const CUTOFF: f32 = 0.5;

const WHITE: Rgba<u8> = Rgba([255; 4]);

/// Statements on one material.
#[derive(Default)]
struct Entry {
    name: String,
    color: Option<Vec3>,
    /// `d`.
    opacity: Option<f32>,
    /// `Tr`.
    transparency: Option<f32>,
    color_map: Option<Map>,
    opacity_map: Option<Map>,
}

/// Reads the libraries that an OBJ file names. A file that cannot be read is a warning.
pub(super) fn load(names: &[String], obj: &str, read_file: &mut ReadFile) -> Library {
    let mut library = Library::new();
    for names in names {
        for (path, bytes) in find(names, obj, read_file) {
            let warnings = Warnings::new(&path);
            let entries = entries(&bytes, &warnings);
            let mut textures = Textures { mtl: &path, warnings: &warnings, read_file, known: HashMap::new() };
            for entry in entries {
                let paint = textures.paint(&entry);
                library.entry(entry.name).or_insert(paint);
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

pub(super) fn with_slashes(path: &str) -> String {
    path.replace('\\', "/")
}

fn entries(bytes: &[u8], warnings: &Warnings) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for (number, line) in (1..).zip(text::plain(bytes).split(|&b| b == b'\n')) {
        let line = line.trim_ascii();
        let keyword = line.split(|b| b.is_ascii_whitespace()).next().unwrap_or_default();
        let text = text_after(line, keyword);
        let keyword = keyword.to_ascii_lowercase();
        if keyword == b"newmtl" {
            entries.push(Entry { name: text, ..Entry::default() });
            continue;
        }
        let Some(entry) = entries.last_mut() else { continue };
        let place = || format!("line {number}");
        let words = text.split_whitespace().skip_while(|w| *w == "-halo");
        let numbers = words.map_while(|w| w.parse::<f32>().ok()).filter(|x| x.is_finite());
        match &keyword[..] {
            b"kd" => {
                let values: Vec<f32> = numbers.collect();
                entry.color = match values[..] {
                    [r, g, b, ..] => Some(Vec3::new(r, g, b)),
                    [grey, ..] => Some(Vec3::splat(grey)),
                    [] => None,
                };
            }
            b"d" => {
                if text.starts_with("-halo") {
                    warnings.add(place(), "the option -halo is not read; the opacity is the same from everywhere");
                }
                entry.opacity = numbers.last();
            }
            b"tr" => entry.transparency = numbers.last(),
            b"map_kd" => entry.color_map = Map::parse(&text, place, warnings),
            b"map_d" => entry.opacity_map = Map::parse(&text, place, warnings),
            b"map_tr" => warnings.add(place(), "map_Tr is not read; write its opacity as map_d"),
            b"disp" | b"map_disp" => warnings.add(place(), "displacement is not read; surfaces stay where they are"),
            _ => {}
        }
    }
    entries
}

/// Reads the textures of one library, each once.
struct Textures<'a, 'r> {
    mtl: &'a str,
    warnings: &'a Warnings<'a>,
    read_file: &'a mut ReadFile<'r>,
    known: HashMap<String, Option<Arc<RgbaImage>>>,
}

impl Textures<'_, '_> {
    fn paint(&mut self, entry: &Entry) -> Paint {
        let color = entry.color_map.as_ref().and_then(|m| Some((m, self.read(&m.path)?)));
        let mask = entry.opacity_map.as_ref().and_then(|m| Some((m, self.read(&m.path)?)));
        let color = self.fitting(color, mask.as_ref(), &entry.name);
        let alpha = match &mask {
            Some((map, pixels)) => Some(map.opacities(pixels)),
            None => color.as_ref().and_then(|(_, pixels)| self.own_alpha(pixels, &entry.name)),
        };
        let opacity = self.opacity(entry);
        let masked = opacity < 1.0 || alpha.is_some();
        let map = mask.as_ref().or(color.as_ref()).map(|(map, _)| *map);
        let pixels = combined(color.as_ref().map(|(_, pixels)| &**pixels), alpha);
        // Where there is a texture, a black diffuse colour is a common exporter's slip for white.
        let base = entry.color.filter(|c| pixels.is_none() || *c != Vec3::ZERO).unwrap_or(match pixels {
            Some(_) => Vec3::ONE,
            None => Material::default().base_color.truncate(),
        });
        let wrap = if map.is_some_and(|m| m.clamp) { Wrap::Clamp } else { Wrap::Repeat };
        let material = Material {
            base_color: base.extend(opacity),
            texture: pixels.map(|p| {
                let (width, height) = p.dimensions();
                Arc::new(Texture { width, height, rgba: p.into_raw(), wrap: [wrap; 2], nearest: false })
            }),
            alpha_cutoff: masked.then_some(CUTOFF),
            ..Material::default()
        };
        Paint { material, uv: map.map_or(Affine2::IDENTITY, Map::uv_transform) }
    }

    /// The colours, if they lie on the surface as the mask does: a surface has one set of texture coordinates here, and
    /// the mask decides what casts.
    fn fitting<'m>(
        &self,
        color: Option<(&'m Map, Arc<RgbaImage>)>,
        mask: Option<&(&Map, Arc<RgbaImage>)>,
        name: &str,
    ) -> Option<(&'m Map, Arc<RgbaImage>)> {
        let fits = |map: &Map| mask.is_none_or(|(m, _)| m.lies_as(map));
        if let Some((map, _)) = color.as_ref().filter(|(map, _)| !fits(map)) {
            let message = "map_Kd and map_d have other options; the texture of map_Kd is left out";
            self.warnings.add(format!("material {name:?}, {}", map.path), message);
            return None;
        }
        color
    }

    /// `d`, or else 1 less `Tr`.
    fn opacity(&self, entry: &Entry) -> f32 {
        let (d, tr) = (entry.opacity, entry.transparency);
        if let (Some(d), Some(tr)) = (d, tr)
            && (d + tr - 1.0).abs() > 0.01
        {
            let message = "d and Tr contradict each other, some programs write Tr as another d; d counts";
            self.warnings.add(format!("material {:?}", entry.name), message);
        }
        d.or(tr.map(|tr| 1.0 - tr)).unwrap_or(1.0)
    }

    /// The alpha of a colour map, unless it would leave nothing, which is an exporter's slip.
    fn own_alpha(&self, pixels: &RgbaImage, name: &str) -> Option<RgbaImage> {
        let is_hole = |p: &Rgba<u8>| f32::from(p[3]) < CUTOFF * 255.0;
        if !pixels.pixels().any(is_hole) {
            return None;
        }
        if pixels.pixels().all(is_hole) {
            let message = "the alpha of map_Kd would cut all of it out; it is left out";
            self.warnings.add(format!("material {name:?}"), message);
            return None;
        }
        Some(pixels.clone())
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

/// Colours with the alpha of another image.
fn combined(color: Option<&RgbaImage>, alpha: Option<RgbaImage>) -> Option<RgbaImage> {
    let (width, height) = color.or(alpha.as_ref())?.dimensions();
    let mut pixels = color.map_or_else(|| RgbaImage::from_pixel(width, height, WHITE), RgbaImage::clone);
    let scaled = |i: u32, from: u32, to: u32| (u64::from(i) * u64::from(to) / u64::from(from)) as u32;
    for (x, y, pixel) in pixels.enumerate_pixels_mut() {
        let opacity = |a: &RgbaImage| a.get_pixel(scaled(x, width, a.width()), scaled(y, height, a.height()))[3];
        pixel[3] = alpha.as_ref().map_or(255, opacity);
    }
    Some(pixels)
}
