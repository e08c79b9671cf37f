//! Pixels of one image.

use crate::image::Settings;
use crate::packet::{LANES, NONE, Packet, Scratch};
use crate::pattern::{Pattern, Shuffle};
use crate::shaft::Shaft;
use crate::tracer::{Hit, Tracer};
use antumbra_scene::{Aabb, Camera, RectLight};
use glam::{DVec3, Vec2, Vec3};
use std::ops::Range;

/// A shadow ray ends this part of its length before the light, so that a lamp modelled where the light is, to within
/// rounding, does not hide it.
const SHADOW_END: f32 = 1.0 - 1e-5;

/// Smallest cosines at the receiver and at the light for a pixel to be valid.
const LEAST_COSINE: f64 = 0.1;

/// Result of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Fraction of the light's area that is seen, mean over the sub-pixels; those that see no surface count as lit.
    pub visibility: f32,
    /// See [`crate::Reference::valid`].
    pub valid: bool,
    /// See [`crate::Reference::grazing`].
    pub grazing: bool,
    /// Estimated standard error of the visibility.
    pub error: f32,
    /// Shadow rays that were traced; none where nothing can stand between the pixel and the light.
    pub rays: u32,
}

/// One image to be traced: scene, camera, light and settings. Its pixels can be asked for in any order, from any
/// thread, and come out the same.
pub struct View<'a> {
    tracer: &'a Tracer,
    camera: Camera,
    size: Vec2,
    light: RectLight,
    /// Unit vector that the light faces along.
    facing: Vec3,
    pattern: Pattern,
    width: u32,
}

/// A point that is lit or not: where the rays of one sub-pixel start.
#[derive(Clone, Copy)]
struct Receiver {
    origin: Vec3,
    normal: Vec3,
    leaves: u32,
}

/// Buffers that pixels reuse.
#[derive(Default)]
struct Buffers {
    receivers: Vec<Option<Receiver>>,
    packets: Vec<Packet>,
    /// Lanes of each packet that see their light point unless something is in the way, and those without a surface.
    open: Vec<(u8, u8)>,
    hidden: Vec<u8>,
    entries: Vec<u32>,
    scratch: Scratch,
}

impl<'a> View<'a> {
    /// The image of `tracer`'s scene for `camera` and `light`; usually those of the same scene.
    pub fn new(tracer: &'a Tracer, camera: &Camera, light: &RectLight, settings: &Settings) -> View<'a> {
        let extent = [light.size.x > 0.0, light.size.y > 0.0];
        let per_sub_pixel =
            if extent == [false; 2] { 1 } else { settings.light_samples.div_ceil(settings.pixel_samples) };
        View {
            tracer,
            camera: *camera,
            size: Vec2::new(settings.width as f32, settings.height as f32),
            light: *light,
            facing: light.basis().2,
            pattern: Pattern::new(settings.pixel_samples, per_sub_pixel, extent, settings.seed),
            width: settings.width,
        }
    }

    /// The hard shadow of the light's centre: every pixel looks through these places only, each with one shadow ray.
    pub fn of_centre(
        tracer: &'a Tracer,
        camera: &Camera,
        light: &RectLight,
        size: [u32; 2],
        places: &[Vec2],
    ) -> View<'a> {
        let point = RectLight { size: Vec2::ZERO, ..*light };
        let settings = Settings { pixel_samples: 1, ..Settings::of_size(size[0], size[1]) };
        View { pattern: Pattern::at(places), ..View::new(tracer, camera, &point, &settings) }
    }

    /// The pixels of some rows, row after row, on this thread.
    pub fn rows(&self, rows: Range<u32>) -> Vec<Pixel> {
        self.pixels(0..self.width, rows)
    }

    /// The pixels of some columns of some rows, row after row, on this thread.
    pub fn pixels(&self, columns: Range<u32>, rows: Range<u32>) -> Vec<Pixel> {
        let mut buffers = Buffers::default();
        let places = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
        places.map(|(x, y)| self.pixel(x, y, &mut buffers)).collect()
    }

    fn pixel(&self, x: u32, y: u32, buffers: &mut Buffers) -> Pixel {
        let facing = self.find_receivers(x, y, buffers);
        let live = buffers.receivers.iter().flatten();
        let from = Aabb::of_points(live.map(|r| r.origin));
        if from.is_empty() {
            return Pixel { visibility: 1.0, valid: false, grazing: false, error: 0.0, rays: 0 };
        }
        self.aim(self.pattern.shuffle(u64::from(y) * u64::from(self.width) + u64::from(x)), buffers);
        Shaft::new(from, self.light_bounds()).entries(self.tracer.bvh(), &mut buffers.entries);
        buffers.hidden.clear();
        if buffers.entries.is_empty() {
            buffers.hidden.resize(buffers.packets.len(), 0);
        } else {
            let Buffers { packets, entries, scratch, hidden, .. } = buffers;
            self.tracer.target().occluded(packets, entries, scratch, hidden);
        }
        self.count(facing, buffers)
    }

    /// Traces the primary rays; the smallest cosine between the direction to the light and either normal, negative
    /// where a sub-pixel sees no surface.
    fn find_receivers(&self, x: u32, y: u32, buffers: &mut Buffers) -> f64 {
        buffers.receivers.clear();
        let mut least = f64::INFINITY;
        for points in self.pattern.sub_pixels.chunks(LANES) {
            let mut packet = Packet::unused();
            for (lane, p) in points.iter().enumerate() {
                let direction = self.camera_ray(Vec2::new(x as f32, y as f32) + *p);
                packet.set(lane, self.camera.eye, direction, self.camera.far, NONE);
            }
            let nearest = self.tracer.target().nearest(&packet, self.camera.near, &mut buffers.scratch);
            for (lane, &(t, id)) in nearest[..points.len()].iter().enumerate() {
                let hit = (id != NONE).then(|| {
                    let direction = Vec3::from(packet.direction.map(|d| d[lane]));
                    self.tracer.hit(self.camera.eye, direction, t, id)
                });
                least = hit.as_ref().map_or(-1.0, |h| self.facing_of(h)).min(least);
                buffers.receivers.push(hit.map(|h| Receiver {
                    origin: self.tracer.off_surface(&h),
                    normal: h.normal.as_vec3(),
                    leaves: h.id,
                }));
            }
        }
        least
    }

    /// Direction through an image position, in pixels; as long as the view depth of 1 metre, so that the near and the
    /// far plane are at fixed distances.
    fn camera_ray(&self, p: Vec2) -> Vec3 {
        let (right, up, forward) = self.camera.basis();
        let tan = (0.5 * f64::from(self.camera.fov_y_deg).to_radians()).tan();
        let ndc = p.as_dvec2() / self.size.as_dvec2() * 2.0 - 1.0;
        let aspect = f64::from(self.size.x) / f64::from(self.size.y);
        let d = forward.as_dvec3() + right.as_dvec3() * (ndc.x * tan * aspect) - up.as_dvec3() * (ndc.y * tan);
        d.as_vec3()
    }

    /// The smaller of the cosines at the receiver and at the light.
    fn facing_of(&self, hit: &Hit) -> f64 {
        let to_light: DVec3 = (self.light.center.as_dvec3() - hit.position).normalize();
        hit.normal.dot(to_light).min(-to_light.dot(self.facing.as_dvec3()))
    }

    /// Box around the light.
    fn light_bounds(&self) -> Aabb {
        let corners = [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)];
        Aabb::of_points(corners.map(|(u, v)| self.light.point(u, v)))
    }

    /// Fills the packets with the pixel's shadow rays, neighbours on the light side by side.
    fn aim(&self, shuffle: Shuffle, buffers: &mut Buffers) {
        let (edge_u, edge_v) = self.light.edges();
        let unit = |bits: u32| bits as f32 * (1.0 / 4_294_967_296.0) - 0.5;
        let sub_pixels = buffers.receivers.len();
        buffers.packets.clear();
        buffers.open.clear();
        for samples in self.pattern.light.chunks(LANES) {
            let mut packet = Packet::unused();
            let (mut open, mut missing) = (0u8, 0u8);
            for (lane, s) in samples.iter().enumerate() {
                let turned = (s.sub_pixel + shuffle.turn) as usize;
                let index = if turned < sub_pixels { turned } else { turned - sub_pixels };
                let Some(r) = buffers.receivers[index] else {
                    missing |= 1 << lane;
                    continue;
                };
                let point = s.point ^ shuffle.flip;
                let d = self.light.center + edge_u * unit(point.x) + edge_v * unit(point.y) - r.origin;
                if d.dot(r.normal) > 0.0 && d.dot(self.facing) < 0.0 {
                    open |= 1 << lane;
                    packet.set(lane, r.origin, d, SHADOW_END, r.leaves);
                }
            }
            buffers.packets.push(packet);
            buffers.open.push((open, missing));
        }
    }

    /// Visibility and its error from the lanes that were found hidden.
    ///
    /// Each sample has a stratum of the light's area of its own; neighbours in the list are neighbours on the light.
    /// The squared difference of two neighbours overestimates the sum of their variances by the difference of their
    /// strata, so the estimate is on the safe side [Cochran 1977, section 5A.12]. Where all agree, details smaller than
    /// a stratum may have been missed: half a stratum is that error's largest standard deviation.
    fn count(&self, facing: f64, buffers: &Buffers) -> Pixel {
        let n = self.pattern.light.len() as f32;
        let (mut seen, mut differing, mut rays) = (0, 0, 0);
        for (&(open, missing), hidden) in buffers.open.iter().zip(&buffers.hidden) {
            let lit = (open & !hidden) | missing;
            seen += lit.count_ones();
            differing += ((lit ^ (lit >> 1)) & 0b0101_0101).count_ones();
            rays += open.count_ones();
        }
        let proven = buffers.entries.is_empty();
        let missed = if proven { 0.0 } else { 0.25 };
        Pixel {
            visibility: seen as f32 / n,
            valid: facing > LEAST_COSINE,
            grazing: facing > 0.0 && facing <= LEAST_COSINE,
            error: (differing as f32 + missed).sqrt() / n,
            rays: if proven { 0 } else { rays },
        }
    }
}
