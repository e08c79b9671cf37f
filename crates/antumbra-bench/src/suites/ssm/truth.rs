//! The reference in the soft shadow map: rays at the receiver of each texel [Atty 2006, section 5.2.1].

use antumbra::techniques::ssm::Ssm;
use antumbra::{Error, Frame, Gpu};
use antumbra_reference::Tracer;
use antumbra_scene::{RectLight, Scene};
use glam::{Vec2, Vec3};
use pollster::block_on;

/// Largest number of sampled texels, spread over the map: the mean over all hardly differs.
const SAMPLED: usize = 2500;
/// Rays to the light per texel.
const RAYS: u32 = 512;
/// Shadow and penumbra are below this visibility.
const LIT: f64 = 0.999;

/// Reference of some texels of a map.
pub struct MapTruth {
    /// Index in the map and visible fraction of the light.
    texels: Vec<(usize, f64)>,
}

impl MapTruth {
    /// Traces from the receivers in the technique's map.
    pub fn of(gpu: &Gpu, scene: &Scene, tracer: &Tracer, frame: &Frame, ssm: &Ssm) -> Result<MapTruth, Error> {
        let Some(maps) = ssm.maps() else { return Ok(MapTruth { texels: Vec::new() }) };
        let depths: Vec<f32> = floats(&block_on(gpu.read_texture(&maps.receivers))?);
        let texels: Vec<usize> = spread(depths.len()).filter(|&i| depths[i] > 0.0).collect();
        let [side, _] = maps.receivers.size();
        let point = |i: usize| receiver(frame, side, i, depths[i]);
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let chunks = texels.chunks(texels.len().div_ceil(threads).max(1));
        let texels = std::thread::scope(|scope| {
            let trace =
                |chunk: &[usize]| chunk.iter().map(|&i| (i, visible(tracer, &scene.light, point(i), i))).collect();
            let running: Vec<_> = chunks.map(|chunk| scope.spawn(move || -> Vec<_> { trace(chunk) })).collect();
            running.into_iter().flat_map(|t| t.join().expect("rays do not panic")).collect()
        });
        Ok(MapTruth { texels })
    }

    /// Sum of absolute differences over the number of texels in shadow or penumbra [Atty 2006, section 5.2.1]; 0 where
    /// there is no shadow.
    pub fn error(&self, gpu: &Gpu, ssm: &Ssm) -> Result<f64, Error> {
        let Some(maps) = ssm.maps() else { return Ok(0.0) };
        let hidden: Vec<f32> = floats(&block_on(gpu.read_texture(&maps.soft_shadow))?);
        let sum: f64 = self.texels.iter().map(|&(i, truth)| (1.0 - f64::from(hidden[i]) - truth).abs()).sum();
        Ok(sum / self.texels.iter().filter(|(_, truth)| *truth < LIT).count().max(1) as f64)
    }
}

/// Every number below `count`, or [`SAMPLED`] of them, in steps that share no factor with any side of a map.
fn spread(count: usize) -> impl Iterator<Item = usize> {
    const STRIDE: usize = 1_000_003; // prime, and above every count of texels' factors
    (0..count.min(SAMPLED)).map(move |k| k * STRIDE % count)
}

/// The receiver at a texel, world space.
fn receiver(frame: &Frame, side: u32, texel: usize, depth: f32) -> Vec3 {
    let (x, y) = (texel as u32 % side, texel as u32 / side);
    let z = frame.frustum.near / depth;
    let tangent = (Vec2::new(x as f32 + 0.5, y as f32 + 0.5) * 2.0 / side as f32 - 1.0) * frame.frustum.tan_half;
    let (right, up, forward) = frame.light.basis();
    frame.light.center + (right * tangent.x + up * tangent.y + forward) * z
}

/// Visible fraction of the light from a point, by a Hammersley set that is shifted for each texel.
fn visible(tracer: &Tracer, light: &RectLight, p: Vec3, seed: usize) -> f64 {
    let shift = Vec2::new((seed as f32 * 0.754_877_7).fract(), (seed as f32 * 0.569_840_3).fract());
    let of_light = |i: u32| {
        let point = Vec2::new((i as f32 + 0.5) / RAYS as f32, i.reverse_bits() as f32 / 4_294_967_296.0) + shift;
        let centred = Vec2::new(point.x.fract(), point.y.fract()) - 0.5;
        [p, light.point(centred.x, centred.y)]
    };
    let segments: Vec<[Vec3; 2]> = (0..RAYS).map(of_light).collect();
    let hidden = tracer.occluded_all(&segments).into_iter().filter(|h| *h).count();
    1.0 - hidden as f64 / f64::from(RAYS)
}

/// The numbers of a texture of 32-bit floats.
pub fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}
