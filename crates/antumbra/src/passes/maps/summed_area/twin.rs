//! `passes/summed_area` and `shaders/summed_area.wesl`: means over boxes of a large map against double precision.

use super::{SummedArea, Sums, TableShape};
use crate::bindings;
use crate::gpu::readback::read_buffer;
use crate::gpu::recorder::Work;
use crate::gpu::resources::{buffer_of, storage_buffer};
use crate::gpu::shader::ShaderKey;
use crate::passes::maps::light_depth::LightDepth;
use crate::passes::maps::moments::{DepthWarp, Nearest};
use crate::scene::SceneRenderer;
use crate::testing::{Random, gpu, submit};
use antumbra_scene::builtin;
use pollster::block_on;

const BOXES: u32 = 4096;

/// The scene's depths as the tables take them, in double precision.
struct Depths {
    size: usize,
    /// Sums over all texels before x and y.
    sums: Vec<f64>,
}

impl Depths {
    fn new(size: usize, depth: &LightDepth, warp: &DepthWarp) -> Depths {
        let read = |map: &crate::passes::maps::depth_map::DepthMap| -> Vec<f32> {
            bytemuck::pod_collect_to_vec(&block_on(gpu().read_texture(&map.texture)).expect("reads"))
        };
        let (near, behind) = (read(&depth.casters), depth.background.as_ref().map(read));
        let mut sums = vec![0.0; (size + 1) * (size + 1)];
        for y in 0..size {
            let mut row = 0.0;
            for x in 0..size {
                let i = y * size + x;
                let background = behind.as_ref().map_or(1.0, |b| b[i]);
                let d = if near[i] == 0.0 && background < 1.0 { background } else { near[i] };
                let z = f64::from(warp.map_near) / f64::from(d);
                let part = (z - f64::from(warp.nearest)) * f64::from(warp.per_metre);
                row += part.clamp(0.0, 1.0) - 0.5;
                sums[(y + 1) * (size + 1) + x + 1] = row + sums[y * (size + 1) + x + 1];
            }
        }
        Depths { size, sums }
    }

    /// Between texels the sum is bilinear.
    fn before(&self, x: f64, y: f64) -> f64 {
        let at = |v: f64| ((v.floor() as usize).min(self.size - 1), v - v.floor().min(self.size as f64 - 1.0));
        let ((i, fx), (j, fy)) = (at(x), at(y));
        let s = |i: usize, j: usize| self.sums[j * (self.size + 1) + i];
        (1.0 - fx) * (1.0 - fy) * s(i, j)
            + fx * (1.0 - fy) * s(i + 1, j)
            + (1.0 - fx) * fy * s(i, j + 1)
            + fx * fy * s(i + 1, j + 1)
    }

    fn mean(&self, b: &[f32]) -> f64 {
        let [x0, y0, x1, y1] = [0, 1, 2, 3].map(|i| f64::from(b[i]));
        let sum = self.before(x1, y1) - self.before(x0, y1) - self.before(x1, y0) + self.before(x0, y0);
        sum / ((x1 - x0) * (y1 - y0))
    }
}

/// The largest errors of means over boxes of 8 to 32, and of over 256 texels per side.
fn errors(size: u32, sums: &[Sums]) -> Vec<[f64; 2]> {
    let gpu = gpu();
    let renderer = SceneRenderer::new(gpu, &builtin::build("fence").expect("known"), [64, 48]).expect("uploads");
    let warp = DepthWarp::default().over(&renderer.frame, Nearest::Receiver);
    let mut random = Random(23);
    let boxes: Vec<f32> = (0..BOXES)
        .flat_map(|i| {
            let (low, high) = if i % 2 == 0 { (8.0, 32.0) } else { (256.0, 0.5 * size as f32) };
            let side = [random.within(low, high), random.within(low, high)];
            let at = side.map(|s| random.within(0.0, size as f32 - s));
            [at[0], at[1], at[0] + side[0], at[1] + side[1]]
        })
        .collect();
    let input = buffer_of(gpu, "boxes", bytemuck::cast_slice(&boxes), wgpu::BufferUsages::STORAGE);
    let kernel = "
        import package::shaders::summed_area::box_mean;
        var<storage, read> boxes: array<vec4<f32>>;
        var<storage, read_write> mean: array<f32>;
        @compute @workgroup_size(64) fn look(@builtin(global_invocation_id) id: vec3<u32>) {
            mean[id.x] = box_mean(boxes[id.x].xy, boxes[id.x].zw, 0u).x;
        }";
    let mut exact = None;
    let each = |sums: &Sums| {
        let key = ShaderKey::of_source(kernel).feature("fixed", *sums == Sums::Fixed);
        let look = gpu.compute_pipeline(&key, "look").unwrap_or_else(|e| panic!("{e}"));
        let output = storage_buffer(gpu, "means", u64::from(BOXES) * 4);
        let mut drawn = None;
        submit(|recorder| {
            let frame = renderer.frame.bind(recorder)?;
            let depth = LightDepth::record(recorder, &frame, size, 1)?;
            let warp = recorder.uniform("warp", &warp);
            let shape = TableShape { size, layers: 1, sums: *sums };
            let table = SummedArea::record(recorder, shape, &depth, "techniques::moments::vsm::warp", &warp)?;
            drawn = Some(depth);
            let own =
                bindings! { boxes: &input, mean: &output, summed_table: &table.texture, table_means: &table.means };
            recorder.compute("look", &look, &[own], Work::Threads([BOXES, 1, 1]))
        });
        let depth = drawn.expect("recorded");
        let got: Vec<f32> = bytemuck::pod_collect_to_vec(&block_on(read_buffer(gpu, &output)).expect("reads"));
        let exact = exact.get_or_insert_with(|| Depths::new(size as usize, &depth, &warp));
        let mut worst = [0f64; 2];
        for (i, (got, b)) in got.iter().zip(boxes.chunks_exact(4)).enumerate() {
            worst[i % 2] = worst[i % 2].max((f64::from(*got) - exact.mean(b)).abs());
        }
        println!("{size} x {size}, {sums:?}: boxes of 8 to 32 texels {:.2e}, of over 256 {:.2e}", worst[0], worst[1]);
        worst
    };
    sums.iter().map(each).collect()
}

#[test]
fn means_over_boxes_of_a_map_of_4096_are_those_of_double_precision() {
    let [float, offset, fixed] = errors(4096, &[Sums::Float, Sums::Offset, Sums::Fixed])[..] else { panic!("three") };
    // Depths themselves are rounded to 2^-25 of the range.
    assert!(fixed[0] < 3e-7 && fixed[1] < 3e-7, "64-bit integers: {fixed:?}");
    // Depths lie about 0 as they are, so the mean taken off is little; the differences are too large for 32 bits.
    assert!(float[0] > 1e-3 && offset[0] > 1e-3, "32 bits are enough: {float:?}, less the mean {offset:?}");
}

#[test]
fn a_size_that_threads_do_not_part_evenly_is_summed_too() {
    for (sums, worst) in [Sums::Offset, Sums::Fixed].iter().zip(errors(777, &[Sums::Offset, Sums::Fixed])) {
        assert!(worst[1] < 1e-5, "{sums:?}: {worst:?}");
    }
}
