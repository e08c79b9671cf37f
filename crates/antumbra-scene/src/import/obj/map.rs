//! Arguments of `map_*`: options and a path.

use super::mtl::with_slashes;
use crate::import::warnings::Warnings;
use glam::{Affine2, Vec2};
use image::RgbaImage;

/// Path of a texture, with the options that decide where it lies and how opaque it is.
#[derive(Clone, PartialEq)]
pub(super) struct Map {
    pub path: String,
    pub clamp: bool,
    /// `-s` and `-o`.
    scale: Vec2,
    offset: Vec2,
    /// `-mm`: added to and multiplied with every value.
    base: f32,
    gain: f32,
    /// `-imfchan`, if it names one of RGBA.
    channel: Option<usize>,
}

impl Map {
    /// Options, then a file name that may hold spaces. `place` is that of the statement.
    pub fn parse(text: &str, place: impl Fn() -> String, warnings: &Warnings) -> Option<Map> {
        let (scale, offset) = (Vec2::ONE, Vec2::ZERO);
        let mut map = Map { path: String::new(), clamp: false, scale, offset, base: 0.0, gain: 1.0, channel: None };
        let mut rest = text.trim();
        while rest.starts_with('-') {
            let (option, after) = rest.split_once(char::is_whitespace)?;
            rest = after.trim_start();
            let (least, most) = match option.to_ascii_lowercase().as_str() {
                "-mm" => (2, 2),
                "-o" | "-s" | "-t" => (1, 3),
                _ => (1, 1),
            };
            let mut words = Vec::new();
            for i in 0..most {
                let Some((word, after)) = rest.split_once(char::is_whitespace) else { break };
                if i >= least && word.parse::<f32>().is_err() {
                    break;
                }
                words.push(word);
                rest = after.trim_start();
            }
            if words.len() < least {
                return None;
            }
            map.set(&option.to_ascii_lowercase(), &words, &place, warnings);
        }
        map.path = with_slashes(rest);
        (!rest.is_empty()).then_some(map)
    }

    fn set(&mut self, option: &str, words: &[&str], place: &impl Fn() -> String, warnings: &Warnings) {
        let number = |i: usize| words.get(i).and_then(|w| w.parse::<f32>().ok()).filter(|x| x.is_finite());
        match option {
            "-clamp" => self.clamp = words[0].eq_ignore_ascii_case("on"),
            "-s" => self.scale = Vec2::new(number(0).unwrap_or(1.0), number(1).unwrap_or(1.0)),
            "-o" => self.offset = Vec2::new(number(0).unwrap_or(0.0), number(1).unwrap_or(0.0)),
            "-mm" => (self.base, self.gain) = (number(0).unwrap_or(0.0), number(1).unwrap_or(1.0)),
            "-imfchan" => match ["r", "g", "b", "m"].iter().position(|c| words[0].eq_ignore_ascii_case(c)) {
                Some(channel) => self.channel = Some(channel),
                None => warnings.add(place(), "the options -imfchan l and z of a texture are not read"),
            },
            "-t" => warnings.add(place(), "the option -t of a texture, turbulence, is not read"),
            _ => {} // How sharp, bright and blended a texture is does not move its holes.
        }
    }

    /// True if one set of texture coordinates fits both.
    pub fn lies_as(&self, other: &Map) -> bool {
        (self.clamp, self.scale, self.offset) == (other.clamp, other.scale, other.offset)
    }

    /// Texture coordinates whose v points down to those of the image: `-s` and `-o` are meant for a v that points up.
    pub fn uv_transform(&self) -> Affine2 {
        let offset = Vec2::new(self.offset.x, 1.0 - self.scale.y - self.offset.y);
        Affine2::from_scale_angle_translation(self.scale, 0.0, offset)
    }

    /// An opacity map with its opacity as alpha. It is grey, or has its opacity in the alpha channel.
    pub fn opacities(&self, pixels: &RgbaImage) -> RgbaImage {
        let has_alpha = pixels.pixels().any(|p| p[3] < 255);
        let channel = self.channel.unwrap_or(if has_alpha { 3 } else { 0 });
        let mut pixels = pixels.clone();
        for pixel in pixels.pixels_mut() {
            let opacity = self.base * 255.0 + self.gain * f32::from(pixel[channel]);
            pixel[3] = opacity.round().clamp(0.0, 255.0) as u8;
        }
        pixels
    }
}
