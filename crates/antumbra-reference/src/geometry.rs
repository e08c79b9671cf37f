//! A scene's instances flattened to world-space triangles.

use crate::cutout::Cutout;
use antumbra_scene::Scene;
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

/// All triangles that a ray can hit, with the data of their alpha tests.
pub(crate) struct Geometry {
    pub triangles: Vec<Triangle>,
    pub sources: Vec<Source>,
    pub cutouts: Vec<Cutout>,
}

impl Geometry {
    /// Flattens all instances; degenerate triangles are left out.
    pub fn of_scene(scene: &Scene) -> Geometry {
        let mut geometry = Geometry::with_room(scene);
        (0..scene.instances.len()).for_each(|i| geometry.add(scene, i));
        geometry
    }

    /// No triangles yet.
    pub fn with_room(scene: &Scene) -> Geometry {
        let count = scene.triangle_count();
        Geometry { triangles: Vec::with_capacity(count), sources: Vec::with_capacity(count), cutouts: Vec::new() }
    }

    /// Adds the triangles of an instance.
    pub fn add(&mut self, scene: &Scene, index: usize) {
        let instance = &scene.instances[index];
        let mesh = &scene.meshes[instance.mesh];
        let material = scene.materials.get(mesh.material).filter(|m| m.is_masked());
        let world: Vec<Vec3> = mesh.positions.iter().map(|&p| instance.world_from_object.transform_point3(p)).collect();
        let base_tag = if instance.receiver_only { RECEIVER_ONLY } else { 0 };
        for (k, corner) in mesh.indices.chunks_exact(3).enumerate() {
            let corner = [corner[0] as usize, corner[1] as usize, corner[2] as usize];
            let mut triangle = Triangle { vertices: corner.map(|c| world[c]), tag: base_tag };
            if triangle.is_degenerate() {
                continue;
            }
            if let Some(material) = material {
                let uvs = corner.map(|c| mesh.uvs.get(c).copied().unwrap_or_default());
                self.cutouts.push(Cutout::new(uvs, material));
                triangle.tag |= self.cutouts.len() as u32;
            }
            self.triangles.push(triangle);
            self.sources.push(Source { instance: index as u32, triangle: k as u32 });
        }
    }

    /// Puts the triangles in the order of `order`, which may leave some out.
    pub fn reorder(&mut self, order: &[u32]) {
        self.triangles = order.iter().map(|&i| self.triangles[i as usize]).collect();
        self.sources = order.iter().map(|&i| self.sources[i as usize]).collect();
    }
}
