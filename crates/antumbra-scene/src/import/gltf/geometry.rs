//! Primitives to meshes.

use super::accessor::Elements;
use super::cutout;
use super::material::{Materials, UvSource};
use super::pose::Pose;
use super::{File, label};
use crate::import::far::Extent;
use crate::{Mesh, Place, SceneError};
use glam::{DVec3, Vec2};
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;
use std::collections::HashMap;

impl<'a> File<'a> {
    /// The triangles of one glTF mesh: a [`Mesh`] a primitive, each with the point that is its origin.
    pub fn meshes(
        &self,
        index: usize,
        pose: &Pose,
        materials: &mut Materials<'_, 'a>,
    ) -> Result<Vec<(Mesh, DVec3)>, SceneError> {
        let source = &self.root.meshes[index];
        let mesh_label = label("mesh", index, &source.name);
        let mut meshes = Vec::new();
        for (i, primitive) in source.primitives.iter().enumerate() {
            let place = format!("{mesh_label}, primitive {i}");
            let name = source.name.clone().unwrap_or_else(|| format!("mesh {index}"));
            meshes.extend(self.primitive(primitive, name, pose, &place, materials)?);
        }
        Ok(meshes)
    }

    /// A primitive's triangles, or `None` where it has none.
    fn primitive(
        &self,
        primitive: &Primitive,
        name: String,
        pose: &Pose,
        place: &str,
        materials: &mut Materials<'_, 'a>,
    ) -> Result<Option<(Mesh, DVec3)>, SceneError> {
        let Checked::Valid(mode) = primitive.mode else {
            return Err(self.malformed(place, "its mode is not one of glTF's seven"));
        };
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            self.warnings.add(place, "points and lines cast no shadow and are left out");
            return Ok(None);
        }
        let Some(&accessor) = primitive.attributes.get(&Checked::Valid(Semantic::Positions)) else {
            self.warnings.add(place, "it has no POSITION attribute and is left out");
            return Ok(None);
        };
        let base = self.elements::<3>(accessor, |c| c != ComponentType::U32, &format!("{place}, POSITION"))?;
        let corners = self.corners(primitive, base.count, place)?;
        let mut indices = triangles(mode, &corners);
        if indices.is_empty() {
            return Ok(None);
        }
        let paint = materials.get(primitive.material, place)?;
        let uvs = self.uvs(primitive, paint.uvs.as_ref(), base.count, place)?;
        let material = if paint.uvs.is_some() && uvs.is_none() {
            self.warnings.add(place, "it has a texture but no coordinates for it; the texture is left out");
            materials.untextured(paint.material)
        } else {
            paint.material
        };
        let used = used_vertices(&mut indices, &base);
        let positions = pose.positions(self, primitive, &base, &used, place)?;
        let origin = self.origin(&positions, &used, place)?;
        let positions = positions.iter().map(|&p| (p - origin).as_vec3()).collect();
        let uvs = match (uvs, paint.uvs) {
            (Some(uvs), Some(source)) => used.iter().map(|&i| source.transform(uvs.floats(i as usize))).collect(),
            _ => Vec::new(),
        };
        let mut mesh = Mesh { name, positions, uvs, indices, material };
        if let Some(cutoff) = paint.cutoff
            && let Some(alphas) = self.alphas(primitive, &used, base.count, place)?
        {
            cutout::cut(self, &mut mesh, &alphas, cutoff, materials, place);
        }
        Ok(Some((mesh, origin)).filter(|(mesh, _)| !mesh.indices.is_empty()))
    }

    /// The origin of a mesh, near its vertices; checks that these are points.
    fn origin(&self, positions: &[DVec3], used: &[u32], place: &str) -> Result<DVec3, SceneError> {
        let Some(i) = positions.iter().position(|p| !p.as_vec3().is_finite()) else {
            return Ok(Extent::of(positions.iter().copied()).local_origin());
        };
        let (file, place) = (self.name.to_string(), Place::Part(place.to_string()));
        Err(SceneError::NotFinite {
            file,
            place,
            vertex: used[i] as usize,
            position: positions[i].as_vec3().to_array(),
        })
    }

    /// The alpha of the vertices that are used, if there is any below one.
    fn alphas(
        &self,
        primitive: &Primitive,
        used: &[u32],
        vertices: usize,
        place: &str,
    ) -> Result<Option<Vec<f32>>, SceneError> {
        let Some(&index) = primitive.attributes.get(&Checked::Valid(Semantic::Colors(0))) else { return Ok(None) };
        let place = format!("{place}, COLOR_0");
        if self.get(&self.root.accessors, index, "accessors", &place)?.type_ != Checked::Valid(Type::Vec4) {
            return Ok(None);
        }
        let colors = self.elements::<4>(index, |c| c != ComponentType::U32, &place)?;
        self.check_count(&colors, vertices, &place)?;
        let alpha = |&i: &u32| Some(colors.floats::<4>(i as usize)[3]).filter(|a| a.is_finite()).unwrap_or(1.0);
        let alphas: Vec<f32> = used.iter().map(alpha).collect();
        Ok(Some(alphas).filter(|a| a.iter().any(|&a| a != 1.0)))
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
        self.check_count(&uvs, vertices, &place)?;
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

/// The vertices to keep. Many primitives may share one large vertex buffer: each then keeps only its vertices, and
/// `indices` are renumbered. So it is where some vertices are no points, since those may be unused.
fn used_vertices(indices: &mut [u32], positions: &Elements) -> Vec<u32> {
    let is_point = |i: usize| positions.floats::<3>(i).iter().all(|x| x.is_finite());
    if indices.len() >= positions.count / 2 && (0..positions.count).all(is_point) {
        return (0..positions.count as u32).collect();
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
    used
}

impl UvSource {
    /// Texture coordinates as the material wants them; NaN becomes 0: a wrong texture is better than an image of NaN.
    fn transform(&self, uv: [f32; 2]) -> Vec2 {
        let uv = self.transform.transform_point2(Vec2::from(uv));
        if uv.is_finite() { uv } else { Vec2::ZERO }
    }
}
