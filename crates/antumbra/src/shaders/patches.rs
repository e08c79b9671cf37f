//! `shaders/patches.wesl`: the texels below a node of a pyramid as one plane or as two surfaces.

mod promises;

use crate::testing::{Random, Worst, evaluate};
use glam::DVec2;

#[derive(Clone, Copy, Debug, PartialEq)]
struct Patch {
    near: f64,
    slope: DVec2,
    residual: f64,
    thick: f64,
    far: f64,
    share: f64,
    far_share: f64,
    side: u32,
}

impl Patch {
    const NONE: Patch = Patch {
        near: 0.0,
        slope: DVec2::ZERO,
        residual: 0.0,
        thick: 0.0,
        far: 0.0,
        share: 0.0,
        far_share: 0.0,
        side: 0,
    };

    fn plane(near: f64, slope: DVec2) -> Patch {
        Patch { near, slope, share: 1.0, ..Patch::NONE }
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
    let both = |(i, p): (usize, &Patch)| [(i, p.share, *p), (i, p.far_share, Patch::plane(p.far, DVec2::ZERO))];
    children.iter().enumerate().flat_map(both).filter(|s| s.1 > 0.0).collect()
}

/// The lowest and the highest surface, where there is any.
fn range(children: &[Patch; 4]) -> Option<(f64, f64)> {
    let all = surfaces(children).into_iter().map(|s| (s.2.near, s.2.near));
    all.reduce(|(low, high), (q, _)| (low.min(q), high.max(q)))
}

/// A plane with the residual that some surfaces have of it, and as thick as all of them or as their mean up to `GAP`.
fn fitted(near: f64, slope: DVec2, of: &[Surface]) -> Patch {
    let plane = Patch::plane(near, slope);
    let residual = of.iter().map(|(i, _, p)| p.deviation(child_middle(*i), &plane)).fold(0.0, f64::max);
    let area = of.iter().map(|s| s.1).sum::<f64>();
    let within_gap = of.iter().map(|(_, area, p)| area * p.thick.min(GAP)).sum::<f64>() / area;
    let thinnest = of.iter().map(|s| s.2.thick).fold(f64::INFINITY, f64::min);
    Patch { residual, thick: within_gap.max(thinnest), ..plane }
}

/// The four's patch, and the inverse distance from which on a surface of theirs is of its nearer one.
fn merge(children: &[Patch; 4]) -> (Patch, f64) {
    merge_with(children, 1.0)
}

/// With the range of a flat patch multiplied by this: often a tilted one has the same.
fn merge_with(children: &[Patch; 4], flat_counts: f64) -> (Patch, f64) {
    let Some((low, high)) = range(children) else { return (Patch::NONE, 0.0) };
    let one = if children.iter().all(|c| c.share == 1.0) {
        let q = children.map(|c| c.near);
        let slope = DVec2::new(q[1] + q[3] - q[0] - q[2], q[2] + q[3] - q[0] - q[1]);
        fitted(q.iter().sum::<f64>() / 4.0, slope, &surfaces(children))
    } else {
        parted(children, 0.0, flat_counts)
    };
    if one.residual <= 0.25 * (high - low) || high - low <= 1.0e-6 * high {
        return (one, 0.0);
    }
    let middle = 0.5 * (low + high);
    (parted(children, middle, flat_counts), middle)
}

/// Split into surfaces no farther than `middle` and farther ones.
fn parted(children: &[Patch; 4], middle: f64, flat_counts: f64) -> Patch {
    let (near, far): (Vec<Surface>, Vec<Surface>) = surfaces(children).into_iter().partition(|s| s.2.near >= middle);
    let area = |of: &[Surface]| of.iter().map(|s| s.1).sum::<f64>();
    let mean_q = |of: &[Surface]| of.iter().map(|s| s.1 * s.2.near).sum::<f64>() / area(of);
    let place = near.iter().map(|s| s.1 * child_middle(s.0)).sum::<DVec2>();
    let slope = near.iter().map(|s| s.1 * s.2.slope).sum::<DVec2>() * 2.0 / area(&near);
    let mean = mean_q(&near);
    let tilted = fitted(mean - slope.dot(place / area(&near)), slope, &near);
    let flat = fitted(mean, DVec2::ZERO, &near);
    let best = if flat_counts * flat.half_range() < tilted.half_range() { flat } else { tilted };
    let top = children.iter().map(Patch::top).fold(0.0, f64::max);
    Patch {
        residual: best.residual + (top - best.top()).max(0.0),
        far: if far.is_empty() { 0.0 } else { mean_q(&far) },
        share: area(&near) / 4.0,
        far_share: area(&far) / 4.0,
        side: if place.y.abs() > place.x.abs() { 2 + u32::from(place.y > 0.0) } else { u32::from(place.x > 0.0) },
        ..best
    }
}

/// Surfaces of a layer that are closer together than this are one whatever its thickness.
const GAP: f64 = 0.125;

const KERNEL: &str = "
    import package::shaders::patches::{Patch, merge_patches, pack_patch, unpack_patch, patch_top};
    fn patch_at(at: u32) -> Patch {
        return Patch(input[at], vec2(input[at + 1u], input[at + 2u]), input[at + 3u], input[at + 4u], input[at + 5u],
                     input[at + 6u], input[at + 7u], u32(input[at + 8u]));
    }
    fn put(to: u32, p: Patch) {
        output[to] = p.near;
        output[to + 1u] = p.slope.x;
        output[to + 2u] = p.slope.y;
        output[to + 3u] = p.residual;
        output[to + 4u] = p.thickness;
        output[to + 5u] = p.far;
        output[to + 6u] = p.share;
        output[to + 7u] = p.far_share;
        output[to + 8u] = f32(p.side);
    }
    fn evaluate(at: u32, to: u32) {
        let merged = merge_patches(array(patch_at(at), patch_at(at + 9u), patch_at(at + 18u), patch_at(at + 27u)), 0.125);
        put(to, merged);
        put(to + 9u, unpack_patch(pack_patch(merged)));
        output[to + 18u] = patch_top(merged);
    }";

fn numbers(p: &Patch) -> [f32; 9] {
    let v = [p.near, p.slope.x, p.slope.y, p.residual, p.thick, p.far, p.share, p.far_share, f64::from(p.side)];
    v.map(|v| v as f32)
}

fn patch_of(v: &[f32]) -> Patch {
    let [near, x, y, residual, thick, far, share, far_share] = std::array::from_fn(|i| f64::from(v[i]));
    Patch { near, slope: DVec2::new(x, y), residual, thick, far, share, far_share, side: v[8] as u32 }
}

/// Children that are planes, two surfaces, or nothing: of one plane, or each of its own, with and without residual.
fn inputs(count: usize) -> Vec<[Patch; 4]> {
    let mut random = Random(3);
    let mut child = |i: usize, k: usize| {
        let scale = [1.0, 1e3, 1e-2][i % 3];
        let mut unit = || f64::from(random.unit());
        let slope = DVec2::new(unit() - 0.5, unit() - 0.5) * scale * 0.2;
        let (a, b) = (scale * unit().max(1e-3), scale * unit().max(1e-3));
        // Parts as they are kept.
        let steps = |share: f64, count: f64| (1.0 + share * (count - 2.0)).round() / count;
        let one = Patch { residual: 0.02 * a * unit(), thick: a * (unit() - 0.5).max(0.0), ..Patch::plane(a, slope) };
        let two = Patch { near: a.max(b), far: a.min(b), share: steps(unit(), 255.0), side: 2, ..one };
        let p = match (i / 3 + k * (i / 11)) % 5 {
            0 => one,
            1 => Patch::NONE,
            2 => Patch { far_share: 1.0 - two.share, ..two },
            3 => Patch { far_share: (1.0 - two.share) * steps(unit(), 63.0), ..two },
            _ => Patch { far: 0.0, ..two },
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
    evaluate(KERNEL, &inputs.iter().flatten().flat_map(numbers).collect::<Vec<f32>>(), 36, 19)
}

fn worst_on_gpu(twin: impl Fn(&[Patch; 4], f64) -> Patch) -> Worst {
    let inputs = inputs(4096);
    let mut worst = Worst::default();
    for (got, children) in on_gpu(&inputs).iter().zip(&inputs) {
        let got = patch_of(got);
        let unit = range(children).map_or(1.0, |r| r.1);
        let error = |exact: &Patch| {
            let surfaces = [got.near - exact.near, got.far - exact.far];
            let depths = surfaces.into_iter().chain([got.residual - exact.residual, got.thick - exact.thick]);
            let slope = (got.slope - exact.slope).abs().max_element() / unit;
            let shares = (got.share - exact.share).abs().max((got.far_share - exact.far_share).abs());
            depths.fold(shares.max(slope), |w, e| w.max(e.abs() / unit))
        };
        // Where two planes are as good as each other, either is right.
        let exact = [1.0 - 1e-6, 1.0 + 1e-6].map(|flat_counts| twin(children, flat_counts));
        worst.see(error(&exact[0]).min(error(&exact[1])), || format!("{children:?}: {got:?} not {:?}", exact[0]));
    }
    worst
}

#[test]
fn the_gpu_agrees_with_its_twin() {
    let worst = worst_on_gpu(|children, flat_counts| merge_with(children, flat_counts).0);
    println!("{worst:?}");
    assert!(worst.error < 2e-6, "{worst:?}");
}

#[test]
fn children_in_another_order_are_caught() {
    let worst = worst_on_gpu(|[a, b, c, d], flat_counts| merge_with(&[*a, *c, *b, *d], flat_counts).0);
    assert!(worst.error > 0.05, "{worst:?}");
}

#[test]
fn a_packed_patch_bounds_what_it_was() {
    let mut worst = [0.0f64; 3];
    for got in on_gpu(&inputs(4096)) {
        let (p, packed) = (patch_of(&got), patch_of(&got[9..]));
        let unit = p.near.max(1e-30);
        assert_eq!((packed.near, packed.side), (p.near, p.side));
        assert!(packed.far <= p.far && packed.far >= p.far * (1.0 - 1.0 / 32768.0), "{p:?} {packed:?}");
        assert!((packed.thick - p.thick).abs() <= 0.031 * p.thick, "{p:?} {packed:?}");
        let bend = (packed.slope - p.slope).abs();
        let spare = (packed.residual - p.residual - 0.5 * (bend.x + bend.y)) / unit;
        assert!(spare > -1e-9 && packed.top() >= p.top(), "short of {}: {p:?} {packed:?}", -spare);
        worst =
            [worst[0].max(bend.max_element() / unit), worst[1].max(spare), worst[2].max(f64::from(got[18]) - p.top())];
    }
    println!("slopes off by {:.1e}, residuals too large by {:.1e} of the inverse distance", worst[0], worst[1]);
    assert!(worst[0] < 3e-4 && worst[1] < 3e-3 && worst[2] < 1e-3, "{worst:?}");
}

/// Coverage is kept: an empty node stays empty, and no hole opens.
#[test]
fn shares_are_packed_to_the_next_step() {
    for got in on_gpu(&inputs(4096)) {
        let (p, packed) = (patch_of(&got), patch_of(&got[9..]));
        let is_there = |p: &Patch| (p.share > 0.0, p.far_share > 0.0);
        assert_eq!(is_there(&packed), is_there(&p), "{p:?} {packed:?}");
        let rest = (1.0 - p.share).max(1e-9);
        let off = [packed.share - p.share, (packed.far_share / (1.0 - packed.share).max(1e-9)) - p.far_share / rest];
        // The last steps at either end are left to all and nothing.
        assert!(off[0].abs() <= 1.0 / 255.0 && off[1].abs() <= 1.0 / 63.0, "{off:?}: {p:?} {packed:?}");
        let [before, after] = [p, packed].map(|p| p.share + p.far_share);
        assert_eq!(after > 1.0 - 1e-6, before > 1.0 - 1e-6, "{p:?} {packed:?}");
    }
}
