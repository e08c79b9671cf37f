//! The shaders of `subpixel` against twins in double precision, and masks that are known.

mod blockers;
mod known_masks;
mod silhouettes;

use super::half_planes::{self, Samples, table};
use super::key_for;
use super::pattern::{Arrangement, Pattern};
use crate::bindings;
use crate::gpu::shader::ShaderKey;
use crate::testing::{evaluate_on, gpu};
use glam::{DVec2, DVec3, Vec3};

/// Reproducible numbers.
struct Random(u64);

impl Random {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        let x = (self.0 ^ (self.0 >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        low + (high - low) * (x >> 40) as f64 / (1u64 << 24) as f64
    }

    fn point(&mut self, low: DVec3, high: DVec3) -> DVec3 {
        DVec3::new(self.within(low.x, high.x), self.within(low.y, high.y), self.within(low.z, high.z))
    }
}

/// Runs `fn masks(at: u32) -> array<Samples, 2>` of a WESL text for every input of `stride` numbers.
fn masks_on_gpu(pattern: &Pattern, text: &str, input: &[f32], stride: usize) -> Vec<[Samples; 2]> {
    let gpu = gpu();
    let text = format!(
        "import package::techniques::alias_free::subpixel::samples::{{Samples, WORDS, word, samples_within}};
        {text}
        fn vector(at: u32) -> vec3<f32> {{ return vec3(input[at], input[at + 1u], input[at + 2u]); }}
        fn evaluate(at: u32, to: u32) {{
            var found = masks(at);
            for (var k = 0u; k < WORDS; k++) {{
                output[to + k] = word(found[0], k);
                output[to + 4u + k] = word(found[1], k);
            }}
        }}"
    );
    let key = key_for(ShaderKey::default(), pattern);
    let sampling = super::sampling(gpu, pattern);
    let planes = table(gpu, pattern);
    let more = bindings! { sampling: &sampling, half_planes: &planes };
    let mask = |w: &[u32]| w.iter().rev().fold(0, |bits, word| bits << 32 | Samples::from(*word));
    let words: Vec<Vec<u32>> = evaluate_on(key, ("u32", &text), input, stride, 8, more);
    words.iter().map(|w| [mask(&w[..4]), mask(&w[4..])]).collect()
}

/// How far a line may be moved by its entry in the table, in the unit of |h.x| + |h.y|, at a sample.
fn entry_error(s: DVec2) -> f64 {
    let step = 1.0 / f64::from(half_planes::STEPS);
    0.5 * step + (s.x.abs() + s.y.abs()) * step + 1e-5
}

#[test]
fn half_planes_hold_the_samples_on_their_side() {
    let mut random = Random(3);
    for n in [1, 6, 8, 16, 32, 64, 128] {
        let pattern = Pattern::arranged(Arrangement::Rotated, n);
        let mut input: Vec<f32> = (0..2048)
            .flat_map(|_| [random.within(-1.0, 1.0), random.within(-1.0, 1.0), random.within(-0.8, 0.8)])
            .map(|v| v as f32)
            .collect();
        input.extend([0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.25, 0.0, -1.0, 0.25, 1.0, 0.0, 0.0, -1e-30, 0.0, 1.0]);
        let text = "fn masks(at: u32) -> array<Samples, 2> {
            let h = vector(at);
            return array(samples_within(h), samples_within(-h));
        }";
        let mut off = 0;
        for (h, [mask, other]) in input.chunks_exact(3).zip(masks_on_gpu(&pattern, text, &input, 3)) {
            let h = DVec3::new(h[0].into(), h[1].into(), h[2].into());
            assert_eq!(mask ^ other, half_planes::all(&pattern), "{n} samples: {h} and its opposite leave a gap");
            let size = h.x.abs() + h.y.abs();
            let differing = mask ^ half_planes::exact(&pattern, h);
            for (i, s) in pattern.samples().iter().enumerate().filter(|(i, _)| differing >> i & 1 != 0) {
                let distance = (h.truncate().dot(*s) + h.z).abs() / size;
                assert!(distance <= entry_error(*s), "{n} samples, {h}: sample {i} at {s} is {distance} from the line");
                off += 1;
            }
        }
        println!("{n} samples: {off} of {} on the other side of the nearest line", 2054 * n);
        assert!(off < 2054 * n / 100, "{off} of {} samples", 2054 * n);
    }
}

#[test]
fn the_table_holds_each_entrys_own_line_exactly() {
    for arrangement in [Arrangement::Rotated, Arrangement::Grid] {
        let pattern = Pattern::arranged(arrangement, 32);
        let places = [(0, 0), (17, 200), (128, 127), (255, 255), (3, 128), (200, 64)];
        let lines: Vec<DVec3> = places.map(|(c, r)| half_planes::entry(c, r)).to_vec();
        let input: Vec<f32> = lines.iter().flat_map(|h| h.as_vec3().to_array()).collect();
        let text = "fn masks(at: u32) -> array<Samples, 2> { return array(samples_within(vector(at)), Samples()); }";
        for (h, [mask, _]) in lines.iter().zip(masks_on_gpu(&pattern, text, &input, 3)) {
            assert_eq!(mask, half_planes::exact(&pattern, *h), "{arrangement:?}, {h}");
        }
    }
}
