//! Primitives to meshes.

use super::accessor::Elements;
use super::material::{Materials, UvSource};
use super::{File, label};
use crate::{Mesh, Place, SceneError};
use glam::{Vec2, Vec3};
use gltf_json::accessor::ComponentType;
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;
use std::collections::HashMap;

impl<'a> File<'a> {
    /// The triangles of one glTF mesh: a [`Mesh`] a primitive.
    pub fn meshes(&self, index: usize, materials: &mut Materials<'_, 'a>) -> Result<Vec<Mesh>, SceneError> {
        let source = &self.root.meshes[index];
        let mesh_label = label("mesh", index, &source.name);
        let mut meshes = Vec::new();
        for (i, primitive) in source.primitives.iter().enumerate() {
            let place = format!("{mesh_label}, primitive {i}");
            let name = source.name.clone().unwrap_or_else(|| format!("mesh {index}"));
            meshes.extend(self.primitive(primitive, name, &place, materials)?);
        }
        Ok(meshes)
    }

    /// A primitive's triangles, or `None` where it has none.
    fn primitive(
        &self,
        primitive: &Primitive,
        name: String,
        place: &str,
        materials: &mut Materials<'_, 'a>,
    ) -> Result<Option<Mesh>, SceneError> {
        let Checked::Valid(mode) = primitive.mode else {
            return Err(self.malformed(place, "its mode is not one of glTF's seven"));
        };
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            tracing::warn!("{}, {place}: points and lines cast no shadow and are left out", self.name);
            return Ok(None);
        }
        let Some(&accessor) = primitive.attributes.get(&Checked::Valid(Semantic::Positions)) else {
            tracing::warn!("{}, {place}: it has no POSITION attribute and is left out", self.name);
            return Ok(None);
        };
        if primitive.targets.is_some() {
            tracing::warn!("{}, {place}: morph targets are not applied", self.name);
        }
        let is_coordinate = |c| c != ComponentType::U32;
        let positions = self.elements::<3>(accessor, is_coordinate, &format!("{place}, POSITION"))?;
        let corners = self.corners(primitive, positions.count, place)?;
        let mut indices = triangles(mode, &corners);
        if indices.is_empty() {
            return Ok(None);
        }
        let (mut material, uv_source) = materials.get(primitive.material, place)?;
        let uvs = self.uvs(primitive, uv_source.as_ref(), positions.count, place)?;
        if uv_source.is_some() && uvs.is_none() {
            tracing::warn!(
                "{}, {place}: it has a texture but no coordinates for it; the texture is left out",
                self.name
            );
            material = materials.untextured(material);
        }
        let used = used_vertices(&mut indices, positions.count);
        let point = |i: usize| self.position(&positions, i, place);
        let positions = used.iter().map(point).collect::<Result<Vec<_>, _>>()?;
        let uvs = match (uvs, uv_source) {
            (Some(uvs), Some(source)) => used.iter().map(|i| source.transform(uvs.floats(i))).collect(),
            _ => Vec::new(),
        };
        Ok(Some(Mesh { name, positions, uvs, indices, material }))
    }

    fn position(&self, positions: &Elements, i: usize, place: &str) -> Result<Vec3, SceneError> {
        let position = positions.floats(i);
        if position.iter().all(|x| x.is_finite()) {
            return Ok(position.into());
        }
        let (file, place) = (self.name.to_string(), Place::Part(place.to_string()));
        Err(SceneError::NotFinite { file, place, vertex: i, position })
    }

    /// The vertices in drawing order.
    fn corners(&self, primitive: &Primitive, vertices: usize, place: &str) -> Result<Vec<u32>, SceneError> {
        let Some(accessor) = primitive.indices else { return Ok((0..vertices as u32).collect()) };
        let is_index = |c| matches!(c, ComponentType::U8 | ComponentType::U16 | ComponentType::U32);
        let place = format!("{place}, indices");
        let elements = self.elements::<1>(accessor, is_index, &place)?;
        let corners: Vec<u32> = (0..elements.count).map(|i| elements.integer(i)).collect();
        match corners.iter().position(|&v| v as usize >= vertices) {
            None => Ok(corners),
            Some(at) => Err(SceneError::IndexOutOfRange {
                file: self.name.to_string(),
                place: Place::Part(format!("{place}, element {at}")),
                index: corners[at].into(),
                count: vertices,
                what: "vertices",
            }),
        }
    }

    fn uvs(
        &self,
        primitive: &Primitive,
        source: Option<&UvSource>,
        vertices: usize,
        place: &str,
    ) -> Result<Option<Elements<'a>>, SceneError> {
        let Some(source) = source else { return Ok(None) };
        let place = format!("{place}, TEXCOORD_{}", source.set);
        let Some(&accessor) = primitive.attributes.get(&Checked::Valid(Semantic::TexCoords(source.set))) else {
            return Ok(None);
        };
        let uvs = self.elements::<2>(accessor, |c| c != ComponentType::U32, &place)?;
        if uvs.count < vertices {
            let problem = format!("there are {} texture coordinates for {vertices} vertices", uvs.count);
            return Err(self.malformed(place, problem));
        }
        Ok(Some(uvs))
    }
}

/// Three vertices a triangle; every second triangle of a strip is turned round to face as the first does.
fn triangles(mode: Mode, corners: &[u32]) -> Vec<u32> {
    match mode {
        Mode::TriangleStrip => corners
            .windows(3)
            .enumerate()
            .flat_map(|(i, t)| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] })
            .collect(),
        Mode::TriangleFan => {
            corners.iter().skip(1).zip(corners.iter().skip(2)).flat_map(|(&b, &c)| [corners[0], b, c]).collect()
        }
        _ => corners[..corners.len() / 3 * 3].to_vec(),
    }
}

/// The vertices to keep.
enum Used {
    All(usize),
    Some(Vec<u32>),
}

impl Used {
    fn iter(&self) -> Box<dyn Iterator<Item = usize> + '_> {
        match self {
            Used::All(count) => Box::new(0..*count),
            Used::Some(list) => Box::new(list.iter().map(|&i| i as usize)),
        }
    }
}

/// Many primitives may share one large vertex buffer: each then keeps only its vertices, and `indices` are renumbered.
fn used_vertices(indices: &mut [u32], count: usize) -> Used {
    if indices.len() >= count / 2 {
        return Used::All(count);
    }
    let (mut numbers, mut used) = (HashMap::new(), Vec::new());
    for index in indices {
        let next = used.len() as u32;
        let vertex = *index;
        *index = *numbers.entry(vertex).or_insert_with(|| {
            used.push(vertex);
            next
        });
    }
    Used::Some(used)
}

impl UvSource {
    /// Texture coordinates as the material wants them; NaN becomes 0: a wrong texture is better than an image of NaN.
    fn transform(&self, uv: [f32; 2]) -> Vec2 {
        let uv = self.transform.transform_point2(Vec2::from(uv));
        if uv.is_finite() { uv } else { Vec2::ZERO }
    }
}
