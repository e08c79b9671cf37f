//! A scene made ready for rays.

use crate::bvh::Bvh;
use crate::geometry::Geometry;
use crate::packet::{LANES, NONE, Packet, Scratch, Target};
use crate::parts::PartsBuild;
use antumbra_scene::Scene;
use fearless_simd::Level;
use glam::{DVec3, Vec3};

/// A half-open stretch of a line: `origin + t * direction` for t in (t_min, t_max).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start, metres.
    pub origin: Vec3,
    /// Of any length over zero; t counts in this length.
    pub direction: Vec3,
    /// Hits at or before this do not count, >= 0.
    pub t_min: f32,
    /// Hits beyond this do not count.
    pub t_max: f32,
}

impl Ray {
    /// Everything ahead of `origin`.
    pub fn new(origin: Vec3, direction: Vec3) -> Ray {
        Ray { origin, direction, t_min: 0.0, t_max: f32::INFINITY }
    }
}

/// Where a ray met a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in lengths of the ray's direction.
    pub t: f64,
    /// Index into the scene's instances.
    pub instance: u32,
    /// Triangle of that instance's mesh.
    pub triangle: u32,
    /// The point on the triangle's plane, to double precision.
    pub position: DVec3,
    /// Geometric unit normal, turned against the ray.
    pub normal: DVec3,
    /// Triangle in the tree's order.
    pub(crate) id: u32,
}

/// [`Tracer::new`] piece by piece, for programs with one thread: an iterator whose every step takes some milliseconds,
/// of large scenes some tens of them. The tree is another one, and as good within a few percent.
pub struct TracerBuild<'a> {
    scene: &'a Scene,
    instances: usize,
    geometry: Geometry,
    parts: Option<PartsBuild>,
}

impl<'a> TracerBuild<'a> {
    /// Begins to build.
    pub fn new(scene: &'a Scene) -> TracerBuild<'a> {
        TracerBuild { scene, instances: 0, geometry: Geometry::with_room(scene), parts: None }
    }

    /// The tracer, once the iterator has ended.
    pub fn finish(self) -> Tracer {
        let (bvh, geometry) = self.parts.unwrap_or_else(|| PartsBuild::new(self.geometry)).finish();
        Tracer { bvh, geometry, level: Level::new() }
    }
}

impl Iterator for TracerBuild<'_> {
    type Item = ();

    fn next(&mut self) -> Option<()> {
        if self.instances < self.scene.instances.len() {
            self.geometry.add(self.scene, self.instances);
            self.instances += 1;
            return Some(());
        }
        let nothing = || Geometry { triangles: Vec::new(), sources: Vec::new(), cutouts: Vec::new() };
        let flat = &mut self.geometry;
        self.parts.get_or_insert_with(|| PartsBuild::new(std::mem::replace(flat, nothing()))).next()
    }
}

/// A scene's triangles in a hierarchy. Watertight: a ray cannot slip between triangles that share an edge or a vertex,
/// from either side [Woop, Benthin and Wald 2013]. Degenerate triangles are never hit.
pub struct Tracer {
    bvh: Bvh,
    geometry: Geometry,
    level: Level,
}

impl Tracer {
    /// Flattens the scene's instances and builds the hierarchy: about a microsecond a triangle, 150 bytes per triangle.
    pub fn new(scene: &Scene) -> Tracer {
        let mut geometry = Geometry::of_scene(scene);
        let bvh = Bvh::build(&mut geometry);
        Tracer { bvh, geometry, level: Level::new() }
    }

    /// Number of triangles that can be hit.
    pub fn triangle_count(&self) -> usize {
        self.geometry.triangles.len()
    }

    /// The nearest surface, holes of masked materials being passed through.
    pub fn nearest(&self, ray: &Ray) -> Option<Hit> {
        let mut packet = Packet::unused();
        packet.set(0, ray.origin, ray.direction, ray.t_max, NONE);
        let (t, id) = self.target().nearest(&packet, ray.t_min, &mut Scratch::default())[0];
        (id != NONE).then(|| self.hit(ray.origin, ray.direction, t, id))
    }

    /// True if a shadow caster lies strictly between the two points.
    pub fn occluded(&self, from: Vec3, to: Vec3) -> bool {
        self.occluded_all(&[[from, to]])[0]
    }

    /// [`Tracer::occluded`] for many segments; fastest where eight in a row run close together.
    pub fn occluded_all(&self, segments: &[[Vec3; 2]]) -> Vec<bool> {
        let (mut scratch, mut packets, mut hidden) = (Scratch::default(), Vec::new(), Vec::new());
        let mut out = Vec::with_capacity(segments.len());
        // In blocks, so that the packets stay in the nearest cache.
        for block in segments.chunks(16 * LANES) {
            packets.clear();
            packets.extend(block.chunks(LANES).map(packet_of));
            hidden.clear();
            self.target().occluded(&packets, self.root(), &mut scratch, &mut hidden);
            out.extend((0..block.len()).map(|i| hidden[i / LANES] >> (i % LANES) & 1 != 0));
        }
        out
    }

    pub(crate) fn target(&self) -> Target<'_> {
        Target { bvh: &self.bvh, geometry: &self.geometry, level: self.level }
    }

    pub(crate) fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// The whole tree as a list of subtrees.
    pub(crate) fn root(&self) -> &'static [u32] {
        if self.bvh.nodes.is_empty() { &[] } else { &[0] }
    }

    pub(crate) fn hit(&self, origin: Vec3, direction: Vec3, t: f64, id: u32) -> Hit {
        let triangle = &self.geometry.triangles[id as usize];
        let source = self.geometry.sources[id as usize];
        let d = direction.as_dvec3();
        let n = triangle.double_area_normal().normalize();
        let p = origin.as_dvec3() + d * t;
        Hit {
            t,
            instance: source.instance,
            triangle: source.triangle,
            position: p - n * n.dot(p - triangle.vertices[0].as_dvec3()),
            normal: if n.dot(d) > 0.0 { -n } else { n },
            id,
        }
    }

    /// A point just off the surface on the normal's side, so close that nothing fits between, yet above the plane
    /// after rounding. The offset covers the rounding of the point and of the triangle's vertices, axis by axis: in a
    /// floor at y = 0 neither rounds, and the offset is zero but for a last bit.
    pub fn off_surface(&self, hit: &Hit) -> Vec3 {
        let triangle = &self.geometry.triangles[hit.id as usize];
        let largest = triangle.vertices.iter().fold(hit.position.abs(), |m, v| m.max(v.abs().as_dvec3()));
        let offset = hit.normal.abs().dot(largest) * f64::from(f32::EPSILON) + largest.max_element() * 1e-12;
        (hit.position + hit.normal * offset).as_vec3()
    }
}

/// Up to eight segments.
fn packet_of(segments: &[[Vec3; 2]]) -> Packet {
    let mut packet = Packet::unused();
    for (lane, [from, to]) in segments.iter().enumerate() {
        packet.set(lane, *from, to - from, 1.0, NONE);
    }
    packet
}
