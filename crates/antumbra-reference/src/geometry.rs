//! A scene's instances flattened to world-space triangles.

use crate::cutout::Cutout;
use antumbra_scene::Scene;
use antumbra_scene::slices::{RUN, at_once};
use glam::{DVec3, Vec3};

/// A world-space triangle in single precision: exactly these three points are the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    /// Vertices, metres.
    pub vertices: [Vec3; 3],
    /// `RECEIVER_ONLY`, and in the lower bits one more than an index into [`Geometry::cutouts`], or zero.
    pub tag: u32,
}

const RECEIVER_ONLY: u32 = 1 << 31;

impl Triangle {
    /// True if it casts no shadow.
    #[inline(always)]
    pub fn is_receiver_only(&self) -> bool {
        self.tag & RECEIVER_ONLY != 0
    }

    /// Which cutout decides about holes, if any.
    #[inline(always)]
    pub fn cutout(&self) -> Option<usize> {
        ((self.tag & !RECEIVER_ONLY) as usize).checked_sub(1)
    }

    /// Twice the area times the unit normal, in double precision.
    #[inline(always)]
    pub fn double_area_normal(&self) -> DVec3 {
        let [a, b, c] = self.vertices.map(|v| v.as_dvec3());
        (b - a).cross(c - a)
    }

    /// A triangle that no ray can hit: its points lie on a line, or are not numbers.
    fn is_degenerate(&self) -> bool {
        let n = self.double_area_normal();
        !n.is_finite() || n == DVec3::ZERO
    }
}

/// Where a triangle came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Source {
    /// Index into the scene's instances.
    pub instance: u32,
    /// Triangle of that instance's mesh.
    pub triangle: u32,
}

/// All triangles that a ray can hit, with what decides about their holes.
pub(crate) struct Geometry {
    pub triangles: Vec<Triangle>,
    pub sources: Vec<Source>,
    pub cutouts: Vec<Cutout>,
}

impl Geometry {
    /// Flattens all instances; degenerate triangles are left out.
    pub fn of_scene(scene: &Scene) -> Geometry {
        at_once(Geometry::with_pauses(scene, &mut async || true)).expect("it is never told to stop")
    }

    /// The same with a pause after every few thousand triangles; none once `pause` says to stop.
    pub async fn with_pauses(scene: &Scene, pause: &mut impl AsyncFnMut() -> bool) -> Option<Geometry> {
        let count = scene.triangle_count();
        let mut g =
            Geometry { triangles: Vec::with_capacity(count), sources: Vec::with_capacity(count), cutouts: Vec::new() };
        for (i, instance) in scene.instances.iter().enumerate() {
            let mesh = &scene.meshes[instance.mesh];
            let material = scene.materials.get(mesh.material).filter(|m| m.is_masked());
            let world: Vec<Vec3> =
                mesh.positions.iter().map(|&p| instance.world_from_object.transform_point3(p)).collect();
            let base_tag = if instance.receiver_only { RECEIVER_ONLY } else { 0 };
            for (k, corner) in mesh.indices.chunks_exact(3).enumerate() {
                let corner = [corner[0] as usize, corner[1] as usize, corner[2] as usize];
                let mut triangle = Triangle { vertices: corner.map(|c| world[c]), tag: base_tag };
                if triangle.is_degenerate() {
                    continue;
                }
                if let Some(material) = material {
                    let uvs = corner.map(|c| mesh.uvs.get(c).copied().unwrap_or_default());
                    g.cutouts.push(Cutout::new(uvs, material));
                    triangle.tag |= g.cutouts.len() as u32;
                }
                g.triangles.push(triangle);
                g.sources.push(Source { instance: i as u32, triangle: k as u32 });
                if k % RUN == RUN - 1 && !pause().await {
                    return None;
                }
            }
        }
        Some(g)
    }

    /// Puts the triangles in the order of `order`, which may leave some out.
    pub fn reorder(&mut self, order: &[u32]) {
        self.triangles = order.iter().map(|&i| self.triangles[i as usize]).collect();
        self.sources = order.iter().map(|&i| self.sources[i as usize]).collect();
    }
}
