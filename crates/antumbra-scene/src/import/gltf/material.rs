//! Materials and textures.

use super::buffers::read_uri;
use super::{File, label};
use crate::import::{ReadFile, texture_file};
use crate::{Material, Place, SceneError, Texture, Wrap};
use glam::{Affine2, Mat2, Vec2, Vec4};
use gltf_json::material::AlphaMode;
use gltf_json::texture::{Info, MagFilter, Sampler, WrappingMode};
use gltf_json::validation::Checked;
use gltf_json::{Index, material};
use std::collections::HashMap;
use std::sync::Arc;

/// The materials that are used so far; each is read when a primitive first asks for it.
pub(super) struct Materials<'f, 'a> {
    file: &'f File<'a>,
    read_file: &'f mut ReadFile<'f>,
    /// The model's list of materials.
    pub list: Vec<Material>,
    known: HashMap<Option<usize>, Known>,
    textures: HashMap<usize, Arc<Texture>>,
    untextured: HashMap<usize, usize>,
    faded: HashMap<(usize, u32), usize>,
}

/// A material that was read.
#[derive(Clone, Copy)]
pub(super) struct Known {
    /// Its number in the model's list.
    pub material: usize,
    /// Its texture coordinates, if it has a texture.
    pub uvs: Option<UvSource>,
    /// The cutoff of its alpha, also where the material alone cuts nothing.
    pub cutoff: Option<f32>,
}

/// Where a material's texture coordinates come from.
#[derive(Clone, Copy)]
pub(super) struct UvSource {
    /// Number of the `TEXCOORD` attribute.
    pub set: u32,
    /// `KHR_texture_transform`.
    pub transform: Affine2,
}

impl<'f, 'a> Materials<'f, 'a> {
    pub fn new(file: &'f File<'a>, read_file: &'f mut ReadFile<'f>) -> Self {
        let (known, textures, untextured, faded) = Default::default();
        Materials { file, read_file, list: Vec::new(), known, textures, untextured, faded }
    }

    /// A material of the file, or the default one.
    pub fn get(&mut self, index: Option<Index<gltf_json::Material>>, place: &str) -> Result<Known, SceneError> {
        let key = index.map(|i| i.value());
        if let Some(&known) = self.known.get(&key) {
            return Ok(known);
        }
        let (mut material, uvs) = match index {
            None => (Material::default(), None),
            Some(index) => {
                let source = self.file.get(&self.file.root.materials, index, "materials", place)?;
                self.read(source, &label("material", index.value(), &source.name))?
            }
        };
        let cutoff = material.alpha_cutoff;
        texture_file::drop_idle_mask(&mut material);
        self.list.push(material);
        let known = Known { material: self.list.len() - 1, uvs, cutoff };
        self.known.insert(key, known);
        Ok(known)
    }

    /// The same material without its texture.
    pub fn untextured(&mut self, material: usize) -> usize {
        let list = &mut self.list;
        *self.untextured.entry(material).or_insert_with(|| {
            let mut copy = Material { texture: None, ..list[material].clone() };
            texture_file::drop_idle_mask(&mut copy);
            list.push(copy);
            list.len() - 1
        })
    }

    /// The same material with its alpha multiplied.
    pub fn faded(&mut self, material: usize, alpha: f32, cutoff: f32) -> usize {
        let list = &mut self.list;
        *self.faded.entry((material, alpha.to_bits())).or_insert_with(|| {
            let mut copy = Material { alpha_cutoff: Some(cutoff), ..list[material].clone() };
            copy.base_color.w *= alpha;
            texture_file::drop_idle_mask(&mut copy);
            list.push(copy);
            list.len() - 1
        })
    }

    fn read(&mut self, source: &material::Material, place: &str) -> Result<(Material, Option<UvSource>), SceneError> {
        let gloss = source.extensions.as_ref().and_then(|e| e.pbr_specular_glossiness.as_ref());
        let pbr = &source.pbr_metallic_roughness;
        let (factor, info) = match gloss {
            Some(gloss) => (gloss.diffuse_factor.0, &gloss.diffuse_texture),
            None => (pbr.base_color_factor.0, &pbr.base_color_texture),
        };
        let texture = match info {
            None => None,
            Some(info) => Some(self.texture(info.index, place)?),
        };
        let alpha_cutoff = match source.alpha_mode {
            Checked::Valid(AlphaMode::Opaque) => None,
            Checked::Valid(AlphaMode::Mask) => Some(source.alpha_cutoff.map_or(0.5, |c| c.0)),
            Checked::Valid(AlphaMode::Blend) => Some(0.5),
            Checked::Invalid => return Err(self.file.malformed(place, "its alphaMode is not OPAQUE, MASK or BLEND")),
        };
        let base_color = Vec4::from(factor);
        if !base_color.is_finite() || alpha_cutoff.is_some_and(|c| !c.is_finite()) {
            return Err(self.file.malformed(place, "its colour factor and its alphaCutoff must be finite"));
        }
        let material = Material { base_color, texture, alpha_cutoff, double_sided: source.double_sided };
        if alpha_cutoff.is_some_and(|cutoff| base_color.w < cutoff) {
            let message = "its alpha is below the cutoff; its surfaces cast no shadow and are not drawn";
            self.file.warnings.add(place, message);
        }
        Ok((material, info.as_ref().map(uv_source)))
    }

    fn texture(&mut self, index: Index<gltf_json::Texture>, place: &str) -> Result<Arc<Texture>, SceneError> {
        if let Some(known) = self.textures.get(&index.value()) {
            return Ok(known.clone());
        }
        let file = self.file;
        let source = file.get(&file.root.textures, index, "textures", place)?;
        let place = format!("{place}, {}", label("texture", index.value(), &source.name));
        let Some(image) = file.root.images.get(source.source.value()) else {
            return Err(SceneError::Unsupported {
                file: file.name.to_string(),
                place: Place::Part(place),
                feature: "a texture without a PNG or JPEG image".to_string(),
                advice: "export the model with PNG or JPEG textures".to_string(),
            });
        };
        let place = format!("{place}, {}", label("image", source.source.value(), &image.name));
        let bytes = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => read_uri(uri, file.name, &place, self.read_file)?.into(),
            (None, Some(view)) => std::borrow::Cow::Borrowed(file.view(view, &place)?.0),
            (None, None) => return Err(file.malformed(place, "it has neither a uri nor a bufferView")),
        };
        let pixels = texture_file::decode(&bytes).map_err(|problem| file.malformed(&place, problem))?;
        let sampler = match source.sampler {
            None => None,
            Some(index) => Some(file.get(&file.root.samplers, index, "samplers", &place)?),
        };
        let texture = Arc::new(sampled(pixels, sampler));
        self.textures.insert(index.value(), texture.clone());
        Ok(texture)
    }
}

fn sampled(pixels: image::RgbaImage, sampler: Option<&Sampler>) -> Texture {
    let wrap = sampler.map_or([Wrap::Repeat; 2], |s| [wrap(s.wrap_s), wrap(s.wrap_t)]);
    let nearest = sampler.is_some_and(|s| s.mag_filter == Some(Checked::Valid(MagFilter::Nearest)));
    Texture { width: pixels.width(), height: pixels.height(), rgba: pixels.into_raw(), wrap, nearest }
}

fn wrap(mode: Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    }
}

/// A rotation turns the coordinates counter-clockwise in the image, whose second axis points down.
fn uv_source(info: &Info) -> UvSource {
    let plain = UvSource { set: info.tex_coord, transform: Affine2::IDENTITY };
    let Some(t) = info.extensions.as_ref().and_then(|e| e.texture_transform.as_ref()) else { return plain };
    let (sin, cos) = t.rotation.0.sin_cos();
    let turn = Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos));
    let scale = Mat2::from_diagonal(t.scale.0.into());
    UvSource {
        set: t.tex_coord.unwrap_or(info.tex_coord),
        transform: Affine2::from_mat2_translation(turn * scale, t.offset.0.into()),
    }
}
