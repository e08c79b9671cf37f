//! Triangles and materials.

use crate::Aabb;
use glam::{Vec2, Vec3, Vec4};
use std::sync::Arc;

/// An indexed triangle mesh in object space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Name from the file, for messages.
    pub name: String,
    /// Vertex positions in metres, all finite.
    pub positions: Vec<Vec3>,
    /// Texture coordinates, one a vertex, or empty.
    pub uvs: Vec<Vec2>,
    /// Three indices a triangle, each below `positions.len()`.
    pub indices: Vec<u32>,
    /// Index into [`crate::Scene::materials`].
    pub material: usize,
}

impl Mesh {
    /// Number of triangles, degenerate ones included.
    pub fn triangle_count(&self) -> usize {
        self.indices.len() / 3
    }

    /// Box around the vertices that triangles use; unreferenced ones do not count.
    pub fn bounds(&self) -> Aabb {
        Aabb::of_points(self.indices.iter().map(|&i| self.positions[i as usize]))
    }
}

/// How a surface looks, and where it has holes. Every surface casts and receives on both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Linear RGBA factor.
    pub base_color: Vec4,
    /// Multiplied with the factor: sRGB colour with linear alpha.
    pub texture: Option<Arc<Texture>>,
    /// Where factor alpha times texture alpha is below this, the surface is cut out (glTF's `MASK`).
    pub alpha_cutoff: Option<f32>,
    /// glTF's flag. Kept for hosts; both sides of every surface are drawn and traced whatever it says,
    /// because a shadow must not depend on the winding of a triangle.
    pub double_sided: bool,
}

impl Default for Material {
    fn default() -> Self {
        Material { base_color: Vec4::new(0.8, 0.8, 0.8, 1.0), texture: None, alpha_cutoff: None, double_sided: true }
    }
}

impl Material {
    /// An opaque, untextured material of a linear colour.
    pub fn of_color(r: f32, g: f32, b: f32) -> Self {
        Material { base_color: Vec4::new(r, g, b, 1.0), ..Material::default() }
    }

    /// True if parts of the surface are cut out.
    pub fn is_masked(&self) -> bool {
        self.alpha_cutoff.is_some()
    }
}

/// Addressing outside of [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// Start again.
    #[default]
    Repeat,
    /// Every second copy is mirrored.
    Mirror,
    /// The edge texel is repeated.
    Clamp,
}

/// An 8-bit RGBA image, row 0 at v = 0 (glTF's convention).
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Texels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width * height * 4` bytes: sRGB colour, linear alpha.
    pub rgba: Vec<u8>,
    /// Along u and v.
    pub wrap: [Wrap; 2],
    /// True to take the nearest texel, false to interpolate between four.
    pub nearest: bool,
}
