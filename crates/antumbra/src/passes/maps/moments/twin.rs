//! Values stored of depths, filtered, and read as a bound: `passes/maps/moments`, `shaders/chebyshev.wesl`,
//! `shaders/hamburger.wesl`, `shaders/fourier.wesl`.

use super::{BlurUniform, DepthWarp, TexelFormat, fourier};
use crate::bindings;
use crate::gpu::readback::read_buffer;
use crate::gpu::recorder::Work;
use crate::gpu::resources::{buffer_of, storage_buffer, uniform};
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::{Texture, TextureDescription};
use crate::testing::{Random, Worst, evaluate, gpu, submit};
use glam::UVec2;
use pollster::block_on;

/// Blocks of 8 x 8 texels, of which a part has the occluder's depth and the rest the receiver's.
const BLOCKS: u32 = 64;

fn key(kernel: &str, format: TexelFormat) -> ShaderKey {
    ShaderKey::of_source(kernel).feature("split", format.is_split()).storing(format.storage())
}

fn map(format: TexelFormat, size: u32, mips: u32) -> Texture {
    let description = TextureDescription::new([size; 2], format.texture(), "moments").layers(1).mips(mips);
    Texture::new(gpu(), "moments", description)
}

/// The numbers in a buffer.
fn floats(buffer: &wgpu::Buffer) -> Vec<f32> {
    bytemuck::pod_collect_to_vec(&block_on(read_buffer(gpu(), buffer)).expect("reads"))
}

/// The bound for each pair of depths (rows) and number of texels out of 64 that the receiver has (columns), after the
/// technique's own storing and the mip chain of the shared pass.
fn bounds(format: TexelFormat, pairs: &[[f32; 2]]) -> Vec<f32> {
    let gpu = gpu();
    let size = 8 * BLOCKS;
    let texture = map(format, size, 4);
    let levels: Vec<_> = (0..4).map(|level| texture.array_mip(level)).collect();
    let warp = uniform(gpu, "warp", &DepthWarp { rounding: format.rounding(), ..Default::default() });
    let input = buffer_of(gpu, "pairs", bytemuck::cast_slice(pairs), wgpu::BufferUsages::STORAGE);
    let output = storage_buffer(gpu, "bounds", u64::from(BLOCKS * BLOCKS) * 4);
    let store = "
        import package::host::StorageTarget;
        import package::warp::stored;
        import package::shaders::depth_warp::Texel;
        import package::shaders::texel_format::encoded;
        var<storage, read> pairs: array<vec2<f32>>;
        var texels: StorageTarget;
        @compute @workgroup_size(8, 8) fn fill(@builtin(global_invocation_id) id: vec3<u32>) {
            let place = (id.x % 8u) + 8u * (id.y % 8u);
            let pair = pairs[id.y / 8u];
            let x = select(pair.x, pair.y, place < id.x / 8u) - 0.5;
            textureStore(texels, id.xy, 0u, encoded(stored(Texel(x, 0.0, 0.0, 0.0, vec2(0.0)), 0u)));
        }";
    let read = "
        import package::warp::visible;
        import package::shaders::texel_format::decoded;
        var coarse: texture_2d_array<f32>;
        var<storage, read> pairs: array<vec2<f32>>;
        var<storage, read_write> bound: array<f32>;
        @compute @workgroup_size(8, 8) fn look(@builtin(global_invocation_id) id: vec3<u32>) {
            let moments = decoded(textureLoad(coarse, id.xy, 0u, 0));
            bound[id.y * 64u + id.x] = visible(moments, pairs[id.y].y - 0.5, 0u);
        }";
    let pipeline = |kernel, entry| {
        gpu.compute_pipeline(&key(kernel, format).part("warp", "techniques::moments::vsm::warp"), entry)
            .unwrap_or_else(|e| panic!("{e}"))
    };
    let (fill, look) = (pipeline(store, "fill"), pipeline(read, "look"));
    let chain = ShaderKey::new("passes::maps::moments::mip_chain")
        .feature("split", format.is_split())
        .storing(format.storage());
    let chain = gpu.compute_pipeline(&chain, "reduce_level").unwrap_or_else(|e| panic!("{e}"));
    submit(|recorder| {
        let set = bindings! { pairs: &input, texels: &levels[0], warp: &warp };
        recorder.compute("fill", &fill, &[set], Work::Threads([size, size, 1]))?;
        for (level, pair) in levels.windows(2).enumerate() {
            let side = size >> (level + 1);
            let set = bindings! { finer: &pair[0], coarser: &pair[1] };
            recorder.compute("mips", &chain, &[set], Work::Threads([side, side, 1]))?;
        }
        let set = bindings! { coarse: &levels[3], pairs: &input, bound: &output, warp: &warp };
        recorder.compute("read", &look, &[set], Work::Threads([BLOCKS, BLOCKS, 1]))
    });
    floats(&output)
}

/// Depths in [0, 1] of an occluder and of a receiver that are `apart` at least.
fn pairs(apart: f32) -> Vec<[f32; 2]> {
    let mut random = Random(7);
    (0..BLOCKS)
        .map(|_| {
            let receiver = random.within(apart, 1.0);
            [random.within(0.0, receiver - apart), receiver]
        })
        .collect()
}

/// The largest difference of bound and coverage.
fn worst_of_planes(format: TexelFormat, apart: f32) -> Worst {
    let pairs = pairs(apart);
    let mut worst = Worst::default();
    for (i, bound) in bounds(format, &pairs).iter().enumerate() {
        let (lit, pair) = ((i % 64) as f64 / 64.0, pairs[i / 64]);
        worst.see((f64::from(*bound) - lit).abs(), || format!("{pair:?}, {lit} lit: {bound}"));
    }
    println!("{}, {apart} apart: {worst:?}", format.name());
    worst
}

#[test]
fn of_two_planes_the_bound_is_the_coverage() {
    // [Donnelly, Lauritzen 2006, section 3.1]. Closer planes are separated as far as 32 bits resolve a difference of
    // squares.
    for apart in [0.01, 0.1, 0.5] {
        let worst = worst_of_planes(TexelFormat::Rg32Float, apart);
        assert!(worst.error < 1e-3, "{apart} apart: {worst:?}");
    }
}

#[test]
fn sixteen_bits_show_and_two_times_sixteen_do_not() {
    // [Section 5.3 there.]
    let (half, split) = (worst_of_planes(TexelFormat::Rg16Float, 0.02), worst_of_planes(TexelFormat::Split, 0.02));
    assert!(half.error > 0.1, "16 bits are as good as 32: {half:?}");
    assert!(split.error < 2e-3, "{split:?}");
}

#[test]
fn a_mip_level_is_the_mean_over_its_area_and_a_blur_a_gaussian() {
    let gpu = gpu();
    let size = 37u32;
    let mut random = Random(3);
    let values: Vec<[f32; 2]> = (0..size * size).map(|_| [random.unit(), random.unit() - 0.5]).collect();
    let uses = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::COPY_DST;
    let description = |side| TextureDescription::new([side; 2], wgpu::TextureFormat::Rg32Float, "test").layers(1);
    let texture = |side| Texture::new(gpu, "test", description(side).usage(uses));
    let (source, coarse, blurred) = (texture(size), texture(size / 2), texture(size));
    gpu.queue.write_texture(
        source.texture.as_image_copy(),
        bytemuck::cast_slice(&values),
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(size * 8), rows_per_image: None },
        source.texture.size(),
    );
    let kernel = BlurUniform { axis: UVec2::X, radius: 3, deviation: 1.75 };
    let kernel_buffer = uniform(gpu, "blur", &kernel);
    let key = |module| ShaderKey::new(module).storing(TexelFormat::Rg32Float.storage());
    let reduce = gpu.compute_pipeline(&key("passes::maps::moments::mip_chain"), "reduce_level").expect("compiles");
    let blur = gpu.compute_pipeline(&key("passes::maps::moments::blur"), "blur_texels").expect("compiles");
    submit(|recorder| {
        let set = bindings! { finer: &source, coarser: &coarse };
        recorder.compute("mip", &reduce, &[set], Work::Threads([18, 18, 1]))?;
        let set = bindings! { blur: &kernel_buffer, source: &source, blurred: &blurred };
        recorder.compute("blur", &blur, &[set], Work::Threads([size, size, 1]))
    });
    let read =
        |t: &Texture| -> Vec<[f32; 2]> { bytemuck::pod_collect_to_vec(&block_on(gpu.read_texture(t)).expect("reads")) };
    let at = |x: i32, y: u32| f64::from(values[(y * size) as usize + x.clamp(0, size as i32 - 1) as usize][0]);
    let (mut worst_mip, mut worst_blur) = (Worst::default(), Worst::default());
    let scale = f64::from(size) / 18.0;
    for (i, got) in read(&coarse).iter().enumerate() {
        let low = [i as u32 % 18, i as u32 / 18].map(|k| f64::from(k) * scale);
        let share = |k: u32, low: f64| (f64::from(k + 1).min(low + scale) - f64::from(k).max(low)).max(0.0) / scale;
        let texels = (0..size).flat_map(|y| (0..size).map(move |x| (x, y)));
        let exact: f64 = texels.map(|(x, y)| share(x, low[0]) * share(y, low[1]) * at(x as i32, y)).sum();
        worst_mip.see((f64::from(got[0]) - exact).abs(), || format!("{i}: {got:?} instead of {exact}"));
    }
    for (i, got) in read(&blurred).iter().enumerate() {
        let (x, y) = ((i as u32 % size) as i32, i as u32 / size);
        let weight = |k: i32| (-0.5 * (f64::from(k) / 1.75).powi(2)).exp();
        let total: f64 = (-3..=3).map(weight).sum();
        let exact = (-3..=3).map(|k| weight(k) * at(x + k, y)).sum::<f64>() / total;
        worst_blur.see((f64::from(got[0]) - exact).abs(), || format!("{i}: {got:?} instead of {exact}"));
    }
    println!("mip {worst_mip:?}, blur {worst_blur:?}");
    assert!(worst_mip.error < 1e-6 && worst_blur.error < 1e-6, "mip {worst_mip:?}, blur {worst_blur:?}");
}

/// Moments of weighted depths.
fn moments(points: &[(f64, f64)]) -> [f64; 4] {
    [1, 2, 3, 4].map(|k| points.iter().map(|(z, w)| w * z.powi(k)).sum())
}

/// The hidden fraction before a depth by four moments.
const HIDDEN_PART: &str = "import package::shaders::hamburger::hidden_part;
    fn evaluate(at: u32, to: u32) {
        let m = vec4(input[at], input[at + 1u], input[at + 2u], input[at + 3u]);
        output[to] = hidden_part(m, input[at + 4u], 3.0e-7);
    }";

#[test]
fn four_moments_of_two_surfaces_give_what_they_hide() {
    let mut random = Random(11);
    let (mut input, mut cases) = (Vec::new(), Vec::new());
    while cases.len() < 4000 {
        let (a, b, part) = (random.within(-1.0, 1.0), random.within(-1.0, 1.0), random.within(0.05, 0.95));
        let z = random.within(-1.0, 1.0);
        // Not too close: moments are given in single precision.
        if (a - b).abs() > 0.2 && (z - a).abs() > 0.1 && (z - b).abs() > 0.1 {
            let points = [(f64::from(a), f64::from(part)), (f64::from(b), 1.0 - f64::from(part))];
            input.extend(moments(&points).map(|m| m as f32).iter().chain([&z]));
            cases.push((points, f64::from(z)));
        }
    }
    let mut worst = Worst::default();
    for (got, (points, z)) in evaluate(HIDDEN_PART, &input, 5, 1).iter().zip(&cases) {
        let exact: f64 = points.iter().filter(|(p, _)| p < z).map(|(_, w)| w).sum();
        worst.see((f64::from(got[0]) - exact).abs(), || format!("{points:?} at {z}: {got:?} instead of {exact}"));
    }
    println!("{worst:?}");
    assert!(worst.error < 5e-3, "{worst:?}");
}

#[test]
fn four_moments_never_hide_more_than_there_is() {
    let mut random = Random(5);
    let (mut input, mut cases) = (Vec::new(), Vec::new());
    for _ in 0..4000 {
        let points: Vec<(f64, f64)> =
            (0..5).map(|_| (f64::from(random.within(-1.0, 1.0)), f64::from(random.unit()) + 0.01)).collect();
        let total: f64 = points.iter().map(|(_, w)| w).sum();
        let points: Vec<_> = points.iter().map(|(z, w)| (*z, w / total)).collect();
        let z = random.within(-1.0, 1.0);
        input.extend(moments(&points).map(|m| m as f32).iter().chain([&z]));
        cases.push((points, f64::from(z)));
    }
    let mut worst = Worst::default();
    for (got, (points, z)) in evaluate(HIDDEN_PART, &input, 5, 1).iter().zip(&cases) {
        let there: f64 = points.iter().filter(|(p, _)| p < z).map(|(_, w)| w).sum();
        worst.see(f64::from(got[0]) - there, || format!("{points:?} at {z}: {got:?}, there is {there}"));
    }
    println!("{worst:?}");
    assert!(worst.error < 5e-3, "{worst:?}");
}

/// To the nearest of the fractions that 16 bits hold.
fn sixteen_bits(fraction: f64) -> f64 {
    (fraction.clamp(0.0, 1.0) * 65535.0).round() / 65535.0
}

/// The values that `techniques/moments/msm/warp.wesl` stores of moments in 16 bits each.
fn fractions_of(m: [f64; 4]) -> [f64; 4] {
    let root = 3f64.sqrt();
    [
        0.5 + 1.5 * m[0] - 2.0 * m[2],
        4.0 * (m[1] - m[3]),
        0.5 + root * (0.5 * m[0] - 2.0 / 9.0 * m[2]),
        0.5 * (m[1] + m[3]),
    ]
}

#[test]
fn sixteen_bits_of_the_basis_lose_less_than_sixteen_bits_of_the_moments() {
    // Three readings of two surfaces: unrounded, rounded in the basis, rounded as plain moments, which lie in -1…1 and
    // 0…1.
    let mut random = Random(13);
    let (mut input, mut cases) = (Vec::new(), Vec::new());
    while cases.len() < 20_000 {
        let (a, b, part) = (random.within(-1.0, 1.0), random.within(-1.0, 1.0), random.within(0.02, 0.98));
        let z = random.within(-1.0, 1.0);
        if (z - a).abs() > 0.02 && (z - b).abs() > 0.02 {
            let points = [(f64::from(a), f64::from(part)), (f64::from(b), 1.0 - f64::from(part))];
            let exact = moments(&points);
            let basis = fractions_of(exact);
            assert!(basis.iter().all(|f| (-1e-9..=1.0 + 1e-9).contains(f)), "{points:?}: {basis:?}");
            let odd = |m: f64| 2.0 * sixteen_bits(0.5 + 0.5 * m) - 1.0;
            let plain = [odd(exact[0]), sixteen_bits(exact[1]), odd(exact[2]), sixteen_bits(exact[3])];
            input.extend([exact, basis.map(sixteen_bits), plain].iter().flatten().map(|m| *m as f32).chain([z]));
            cases.push((points, f64::from(z), exact, plain));
        }
    }
    let kernel = "import package::shaders::hamburger::hidden_part;
        import package::techniques::moments::msm::warp::{fractions_of, moments_of};
        fn at4(k: u32) -> vec4<f32> {
            return vec4(input[k], input[k + 1u], input[k + 2u], input[k + 3u]);
        }
        fn evaluate(at: u32, to: u32) {
            let basis = moments_of(at4(at + 4u));
            let back = moments_of(fractions_of(at4(at))) - at4(at);
            let z = input[at + 12u];
            for (var k = 0u; k < 4u; k++) { output[to + k] = basis[k]; }
            output[to + 4u] = max(max(abs(back.x), abs(back.y)), max(abs(back.z), abs(back.w)));
            output[to + 5u] = hidden_part(basis, z, 6.0e-5);
            output[to + 6u] = hidden_part(at4(at + 8u), z, 6.0e-5);
        }";
    // Determinant of the matrix (1 m1 m2; m1 m2 m3; m2 m3 m4), which is 0 for two surfaces and below for what no
    // surfaces have, of moments that are moved as hamburger.wesl does.
    let possible = |m: [f64; 4]| {
        let towards = [0.0, 0.375, 0.0, 0.375];
        let [m1, m2, m3, m4] = [0, 1, 2, 3].map(|k| m[k] + 6e-5 * (towards[k] - m[k]));
        m2 * m4 - m3 * m3 - m1 * (m1 * m4 - m2 * m3) + m2 * (m1 * m3 - m2 * m2) >= 0.0
    };
    let (mut there_and_back, mut too_dark) = (0f64, Worst::default());
    let (mut lost, mut off, mut impossible) = ([0f64; 2], [0f64; 2], [0usize; 2]);
    let count = cases.len() as f64;
    for (got, (points, z, exact, plain)) in evaluate(kernel, &input, 13, 7).iter().zip(&cases) {
        there_and_back = there_and_back.max(f64::from(got[4]));
        let hidden: f64 = points.iter().filter(|(p, _)| p < z).map(|(_, w)| w).sum();
        too_dark.see(f64::from(got[5]) - hidden, || format!("{points:?} at {z}: {got:?}, there is {hidden}"));
        let basis = [0, 1, 2, 3].map(|k| f64::from(got[k]));
        for (k, m) in [basis, *plain].into_iter().enumerate() {
            lost[k] += (0..4).map(|i| (m[i] - exact[i]).powi(2)).sum::<f64>() / count;
            off[k] += (f64::from(got[5 + k]) - hidden).abs() / count;
            impossible[k] += usize::from(!possible(m));
        }
    }
    let lost = lost.map(f64::sqrt);
    println!(
        "basis and plain: moments off by {lost:?}, impossible {impossible:?} of {count}, hidden part off by {off:?}; \
         the basis there and back {there_and_back}, darkest {too_dark:?}"
    );
    assert!(there_and_back < 1e-6, "{there_and_back}");
    assert!(lost[0] < lost[1] && 10 * impossible[0] < impossible[1], "moments {lost:?}, impossible {impossible:?}");
    assert!(too_dark.error < 5e-3, "{too_dark:?}");
}

#[test]
fn the_series_in_the_shader_is_that_of_the_host() {
    let gpu = gpu();
    let mut random = Random(9);
    let input: Vec<[f32; 2]> = (0..2048).map(|_| [random.within(-0.5, 0.5), random.within(-0.5, 0.5)]).collect();
    let kernel = "
        import package::shaders::depth_warp::warp;
        import package::shaders::fourier::{sines_of, compared};
        var<storage, read> depths: array<vec2<f32>>;
        var<storage, read_write> series: array<f32>;
        @compute @workgroup_size(64) fn look(@builtin(global_invocation_id) id: vec3<u32>) {
            let x = depths[id.x];
            var sum = 0.5;
            for (var layer = 0u; layer < (warp.terms + 1u) / 2u; layer++) {
                sum += compared(sines_of(x.x, 0.0, layer), x.y, layer);
            }
            series[id.x] = sum;
        }";
    let look = gpu.compute_pipeline(&key(kernel, TexelFormat::Rgba32Float), "look").unwrap_or_else(|e| panic!("{e}"));
    for terms in [1u32, 4, 7, 16] {
        let warp = uniform(gpu, "warp", &DepthWarp { terms, ..Default::default() });
        let depths = buffer_of(gpu, "depths", bytemuck::cast_slice(&input), wgpu::BufferUsages::STORAGE);
        let series = storage_buffer(gpu, "series", 2048 * 4);
        let set = bindings! { warp: &warp, depths: &depths, series: &series };
        submit(|recorder| recorder.compute("series", &look, &[set], Work::Threads([2048, 1, 1])));
        let got = floats(&series);
        let mut worst = Worst::default();
        for (got, v) in got.iter().zip(&input) {
            let exact = fourier::comparison(terms, f64::from(v[0]) - f64::from(v[1]));
            worst.see((f64::from(*got) - exact).abs(), || format!("{v:?}: {got} instead of {exact}"));
        }
        println!("{terms} terms: {worst:?}");
        assert!(worst.error < 2e-5, "{terms} terms: {worst:?}");
    }
}
