//! `shaders/patches.wesl`: what lies below a node of a pyramid as one plane or as two surfaces.

mod promises;

use super::{Random, Worst, evaluate};
use glam::DVec2;

#[derive(Clone, Copy, Debug, PartialEq)]
struct Patch {
    near: f64,
    slope: DVec2,
    far: f64,
    share: f64,
    side: u32,
    residual: f64,
}

impl Patch {
    fn plane(near: f64, slope: DVec2) -> Patch {
        Patch { near, slope, far: near, share: 1.0, side: 0, residual: 0.0 }
    }

    fn half_range(&self) -> f64 {
        0.5 * (self.slope.x.abs() + self.slope.y.abs()) + self.residual
    }

    fn top(&self) -> f64 {
        self.near + self.half_range()
    }

    /// The farthest of it from a plane over its parent.
    fn deviation(&self, middle: DVec2, plane: &Patch) -> f64 {
        let tilt = (self.slope - 0.5 * plane.slope).abs();
        (self.near - plane.near - plane.slope.dot(middle)).abs() + 0.5 * (tilt.x + tilt.y) + self.residual
    }
}

fn child_middle(i: usize) -> DVec2 {
    DVec2::new((i & 1) as f64, (i >> 1) as f64) * 0.5 - 0.25
}

/// A surface of a child: its area, and as a patch.
type Surface = (usize, f64, Patch);

fn surfaces(children: &[Patch; 4]) -> Vec<Surface> {
    let both = |(i, p): (usize, &Patch)| [(i, p.share, *p), (i, 1.0 - p.share, Patch::plane(p.far, DVec2::ZERO))];
    children.iter().enumerate().flat_map(both).filter(|s| s.1 > 0.0).collect()
}

fn range(children: &[Patch; 4]) -> (f64, f64) {
    surfaces(children).iter().fold((f64::INFINITY, 0.0), |(low, high), s| (low.min(s.2.near), high.max(s.2.near)))
}

/// A plane with the residual that some surfaces have of it.
fn fitted(near: f64, slope: DVec2, of: &[Surface]) -> Patch {
    let plane = Patch::plane(near, slope);
    let residual = of.iter().map(|(i, _, p)| p.deviation(child_middle(*i), &plane)).fold(0.0, f64::max);
    Patch { residual, ..plane }
}

fn merge(children: &[Patch; 4]) -> Patch {
    merge_with(children, 1.0)
}

/// With the range of a flat patch taken for this many times what it is: often a tilted one has the same.
fn merge_with(children: &[Patch; 4], flat_counts: f64) -> Patch {
    let (low, high) = range(children);
    if children.iter().all(|c| c.share >= 1.0) {
        let q = children.map(|c| c.near);
        let slope = DVec2::new(q[1] + q[3] - q[0] - q[2], q[2] + q[3] - q[0] - q[1]);
        let one = fitted(q.iter().sum::<f64>() / 4.0, slope, &surfaces(children));
        if one.residual <= 0.25 * (high - low) || high == low {
            return one;
        }
    }
    let (near, far): (Vec<Surface>, Vec<Surface>) =
        surfaces(children).into_iter().partition(|s| s.2.near >= 0.5 * (low + high));
    let area = |of: &[Surface]| of.iter().map(|s| s.1).sum::<f64>();
    let mean_q = |of: &[Surface]| of.iter().map(|s| s.1 * s.2.near).sum::<f64>() / area(of);
    let centre = near.iter().map(|s| s.1 * child_middle(s.0)).sum::<DVec2>() / area(&near);
    let slope = near.iter().map(|s| s.1 * s.2.slope).sum::<DVec2>() * 2.0 / area(&near);
    let mean = mean_q(&near);
    let (tilted, flat) = (fitted(mean - slope.dot(centre), slope, &near), fitted(mean, DVec2::ZERO, &near));
    let best = if flat_counts * flat.half_range() < tilted.half_range() { flat } else { tilted };
    if far.is_empty() {
        return best;
    }
    let side = if centre.y.abs() > centre.x.abs() { 2 + u32::from(centre.y > 0.0) } else { u32::from(centre.x > 0.0) };
    Patch { far: mean_q(&far), share: area(&near) / (area(&near) + area(&far)), side, ..best }
}

const KERNEL: &str = "
    import package::shaders::patches::{Patch, merge_patches, pack_patch, unpack_patch, patch_top};
    fn patch_at(at: u32) -> Patch {
        return Patch(input[at], vec2(input[at + 1u], input[at + 2u]), input[at + 3u], input[at + 4u],
                     u32(input[at + 5u]), input[at + 6u]);
    }
    fn put(to: u32, p: Patch) {
        output[to] = p.near;
        output[to + 1u] = p.slope.x;
        output[to + 2u] = p.slope.y;
        output[to + 3u] = p.far;
        output[to + 4u] = p.share;
        output[to + 5u] = f32(p.side);
        output[to + 6u] = p.residual;
    }
    fn evaluate(at: u32, to: u32) {
        let merged = merge_patches(array(patch_at(at), patch_at(at + 7u), patch_at(at + 14u), patch_at(at + 21u)));
        put(to, merged);
        put(to + 7u, unpack_patch(pack_patch(merged)));
        output[to + 14u] = patch_top(merged);
    }";

fn numbers(p: &Patch) -> [f32; 7] {
    [p.near, p.slope.x, p.slope.y, p.far, p.share, f64::from(p.side), p.residual].map(|v| v as f32)
}

fn patch_of(v: &[f32]) -> Patch {
    let at = |i: usize| f64::from(v[i]);
    Patch { near: at(0), slope: DVec2::new(at(1), at(2)), far: at(3), share: at(4), side: v[5] as u32, residual: at(6) }
}

/// Children that are planes, two surfaces, or nothing: of one plane, or each of its own, with and without residual.
fn inputs(count: usize) -> Vec<[Patch; 4]> {
    let mut random = Random(3);
    let mut child = |i: usize, k: usize| {
        let scale = [1.0, 1e3, 1e-2][i % 3];
        let mut unit = || f64::from(random.unit());
        let slope = DVec2::new(unit() - 0.5, unit() - 0.5) * scale * 0.2;
        let (a, b) = (scale * unit().max(1e-3), scale * unit().max(1e-3));
        let one = Patch { residual: 0.02 * a * unit(), ..Patch::plane(a, slope) };
        let p = match (i / 3 + k * (i / 11)) % 4 {
            0 => one,
            1 => Patch::plane(0.0, DVec2::ZERO),
            2 => Patch { near: a.max(b), far: a.min(b), share: unit().clamp(0.01, 0.99), side: 2, ..one },
            _ => Patch { near: a.max(b), far: 0.0, share: unit().clamp(0.01, 0.99), side: 1, ..one },
        };
        // As the shader gets it.
        patch_of(&numbers(&p))
    };
    let mut all: Vec<[Patch; 4]> = (0..count).map(|i| std::array::from_fn(|k| child(i, k))).collect();
    for (i, children) in all.iter_mut().enumerate().step_by(5) {
        let plane = Patch::plane(1.0 + i as f64 / count as f64, child(0, 0).slope);
        *children =
            std::array::from_fn(|k| Patch::plane(plane.near + plane.slope.dot(child_middle(k)), 0.5 * plane.slope));
    }
    all
}

fn on_gpu(inputs: &[[Patch; 4]]) -> Vec<Vec<f32>> {
    evaluate(KERNEL, &inputs.iter().flatten().flat_map(numbers).collect::<Vec<f32>>(), 28, 15)
}

fn worst_on_gpu(twin: impl Fn(&[Patch; 4], f64) -> Patch) -> Worst {
    let inputs = inputs(4096);
    let mut worst = Worst::default();
    for (got, children) in on_gpu(&inputs).iter().zip(&inputs) {
        let got = patch_of(got);
        let unit = range(children).1.max(1e-30);
        let error = |exact: &Patch| {
            let depths = [got.near - exact.near, got.far - exact.far, got.residual - exact.residual];
            let slope = (got.slope - exact.slope).abs().max_element() / unit;
            depths.iter().fold((got.share - exact.share).abs().max(slope), |w, e| w.max(e.abs() / unit))
        };
        // Where two planes are as good as each other, either is right.
        let exact = [1.0 - 1e-6, 1.0 + 1e-6].map(|flat_counts| twin(children, flat_counts));
        worst.see(error(&exact[0]).min(error(&exact[1])), || format!("{children:?}: {got:?} not {:?}", exact[0]));
    }
    worst
}

#[test]
fn the_gpu_agrees_with_its_twin() {
    let worst = worst_on_gpu(merge_with);
    println!("{worst:?}");
    assert!(worst.error < 2e-6, "{worst:?}");
}

#[test]
fn children_in_another_order_are_caught() {
    let worst = worst_on_gpu(|[a, b, c, d], flat_counts| merge_with(&[*a, *c, *b, *d], flat_counts));
    assert!(worst.error > 0.05, "{worst:?}");
}

#[test]
fn a_packed_patch_bounds_what_it_was() {
    let mut worst = [0.0f64; 3];
    for got in on_gpu(&inputs(4096)) {
        let (p, packed) = (patch_of(&got), patch_of(&got[7..]));
        let unit = p.near.max(1e-30);
        assert_eq!((packed.near, packed.far, packed.side), (p.near, p.far, p.side));
        assert_eq!(packed.share < 1.0, p.share < 1.0, "{p:?} {packed:?}");
        assert!(packed.share > 0.0 && (packed.share - p.share).abs() <= 0.5 / 254.0 + 1e-6, "{p:?} {packed:?}");
        let bend = (packed.slope - p.slope).abs();
        let spare = (packed.residual - p.residual - 0.5 * (bend.x + bend.y)) / unit;
        assert!(spare > -1e-9 && packed.top() >= p.top(), "short of {}: {p:?} {packed:?}", -spare);
        worst =
            [worst[0].max(bend.max_element() / unit), worst[1].max(spare), worst[2].max(f64::from(got[14]) - p.top())];
    }
    println!("slopes off by {:.1e}, residuals too large by {:.1e} of the inverse distance", worst[0], worst[1]);
    assert!(worst[0] < 3e-4 && worst[1] < 3e-3 && worst[2] < 1e-3, "{worst:?}");
}
