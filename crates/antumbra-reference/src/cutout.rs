//! Holes that a material's alpha cuts into a triangle.

use antumbra_scene::{Material, Texture, Wrap};
use glam::{DVec3, Vec2};
use std::sync::Arc;

/// Alpha test of a point of a masked triangle.
pub(crate) struct Cutout {
    uvs: [Vec2; 3],
    factor: f32,
    cutoff: f32,
    texture: Option<Arc<Texture>>,
}

impl Cutout {
    /// `uvs` belong to the triangle's vertices.
    pub fn new(uvs: [Vec2; 3], material: &Material) -> Cutout {
        Cutout {
            uvs,
            factor: material.base_color.w,
            cutoff: material.alpha_cutoff.unwrap_or(0.0),
            texture: material.texture.clone().filter(|t| t.width > 0 && t.height > 0),
        }
    }

    /// True if the surface is there at the barycentric coordinates `weights`.
    pub fn is_solid(&self, weights: DVec3) -> bool {
        let w = weights.as_vec3();
        let uv = self.uvs[0] * w.x + self.uvs[1] * w.y + self.uvs[2] * w.z;
        self.factor * self.texture.as_ref().map_or(1.0, |t| alpha(t, uv)) >= self.cutoff
    }
}

/// Alpha in [0, 1] at `uv`, from the finest level: texel centres at (i + 1/2) / n, row 0 at v = 0.
pub(crate) fn alpha(texture: &Texture, uv: Vec2) -> f32 {
    let (w, h) = (texture.width as i64, texture.height as i64);
    let texel = |x: i64, y: i64| {
        let x = wrapped(x, w, texture.wrap[0]);
        let y = wrapped(y, h, texture.wrap[1]);
        f32::from(texture.rgba[((y * w + x) * 4 + 3) as usize]) / 255.0
    };
    let (x, y) = (uv.x * w as f32, uv.y * h as f32);
    if texture.nearest {
        return texel(x.floor() as i64, y.floor() as i64);
    }
    let (x, y) = (x - 0.5, y - 0.5);
    let (x0, y0) = (x.floor(), y.floor());
    let (fx, fy) = (x - x0, y - y0);
    let (x0, y0) = (x0 as i64, y0 as i64);
    let row = |y| texel(x0, y) * (1.0 - fx) + texel(x0 + 1, y) * fx;
    row(y0) * (1.0 - fy) + row(y0 + 1) * fy
}

/// The texel in 0..n that `i` stands for.
fn wrapped(i: i64, n: i64, wrap: Wrap) -> i64 {
    match wrap {
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::Clamp => i.clamp(0, n - 1),
        Wrap::Mirror => {
            let k = i.rem_euclid(2 * n);
            k.min(2 * n - 1 - k)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(wrap: Wrap, nearest: bool) -> Texture {
        let rgba = [0u8, 51, 102, 255].iter().flat_map(|&a| [9, 9, 9, a]).collect();
        Texture { width: 4, height: 1, rgba, wrap: [wrap; 2], nearest }
    }

    #[test]
    fn texel_centres_and_midpoints() {
        let t = ramp(Wrap::Clamp, false);
        for (u, want) in [(0.125, 0.0), (0.375, 0.2), (0.5, 0.3), (0.625, 0.4), (0.0, 0.0), (1.0, 1.0), (7.0, 1.0)] {
            assert!((alpha(&t, Vec2::new(u, 0.3)) - want).abs() < 1e-6, "u = {u}");
        }
    }

    #[test]
    fn outside_follows_the_wrap_mode() {
        let at = |wrap, u| alpha(&ramp(wrap, true), Vec2::new(u, 0.5));
        for (u, repeat, mirror, clamp) in
            [(1.1, 0.0, 1.0, 1.0), (-0.1, 1.0, 0.0, 0.0), (1.3, 0.2, 0.4, 1.0), (2.3, 0.2, 0.2, 1.0)]
        {
            assert_eq!(at(Wrap::Repeat, u), repeat, "repeat, u = {u}");
            assert_eq!(at(Wrap::Mirror, u), mirror, "mirror, u = {u}");
            assert_eq!(at(Wrap::Clamp, u), clamp, "clamp, u = {u}");
        }
        // Between the last texel and the first of the next copy.
        assert!((alpha(&ramp(Wrap::Repeat, false), Vec2::new(1.0, 0.5)) - 0.5).abs() < 1e-6);
    }
}
