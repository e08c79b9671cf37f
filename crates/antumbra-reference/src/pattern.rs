//! Where in the pixel and where on the light.

use glam::{UVec2, Vec2};

/// One shadow ray of a pixel: from which sub-pixel, to which point of the light, both before the pixel's own shuffle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightSample {
    pub sub_pixel: u32,
    /// Fixed-point coordinates in [0, 1)².
    pub point: UVec2,
}

/// The samples of a pixel: an Owen-scrambled (0,2)-sequence over the light, consecutive runs of which belong to the
/// sub-pixels [Kollig and Keller 2002]. With powers of two each sub-pixel's points are a net, and all together too.
pub(crate) struct Pattern {
    /// Positions of the primary rays in the pixel, [0, 1)².
    pub sub_pixels: Vec<Vec2>,
    /// In Morton order over the light, so that neighbours in the list make a slim packet of rays.
    pub light: Vec<LightSample>,
    seed: u64,
}

/// Seed of a pixel's samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shuffle {
    /// Exclusive-or of the fixed-point coordinates: keeps every property of a net.
    pub flip: UVec2,
    /// Added to the sub-pixel, modulo their number.
    pub turn: u32,
}

impl Pattern {
    /// `per_sub_pixel` points of the light for each of `sub_pixels`; `extent` is 0 along edges without length.
    pub fn new(sub_pixels: u32, per_sub_pixel: u32, extent: [bool; 2], seed: u64) -> Pattern {
        let scramble = [mix(seed, 1) as u32, mix(seed, 2) as u32];
        let coordinate = |k: usize, x: u32| if extent[k] { owen_scramble(x, scramble[k]) } else { 0 };
        let mut light: Vec<LightSample> = (0..sub_pixels * per_sub_pixel)
            .map(|i| LightSample {
                sub_pixel: i / per_sub_pixel,
                point: UVec2::new(coordinate(0, i.reverse_bits()), coordinate(1, sobol_second(i))),
            })
            .collect();
        light.sort_by_key(|s| morton(s.point));
        Pattern { sub_pixels: pixel_grid(sub_pixels), light, seed }
    }

    /// One ray to the light's centre from each of these places of the pixel, [0, 1].
    pub fn at(places: &[Vec2]) -> Pattern {
        Pattern { sub_pixels: places.to_vec(), ..Pattern::new(places.len() as u32, 1, [false; 2], 0) }
    }

    /// The shuffle of pixel number `index`.
    pub fn shuffle(&self, index: u64) -> Shuffle {
        let h = mix(self.seed, 3 + index);
        let turn = (mix(h, 0) % self.sub_pixels.len() as u64) as u32;
        Shuffle { flip: UVec2::new(h as u32, (h >> 32) as u32), turn }
    }
}

/// A square number gives a regular grid, any other number the first points of a (0,2)-sequence.
fn pixel_grid(n: u32) -> Vec<Vec2> {
    let side = n.isqrt();
    if side * side == n {
        let at = |k: u32| (k as f32 + 0.5) / side as f32;
        return (0..n).map(|i| Vec2::new(at(i % side), at(i / side))).collect();
    }
    let unit = |x: u32| (x >> 8) as f32 / (1 << 24) as f32;
    (0..n).map(|i| Vec2::new((i as f32 + 0.5) / n as f32, unit(sobol_second(i)))).collect()
}

/// Second dimension of Sobol's sequence; the first is the bit reversal. Together a (0,2)-sequence.
fn sobol_second(index: u32) -> u32 {
    let (mut x, mut direction, mut i) = (0, 1 << 31, index);
    while i != 0 {
        if i & 1 != 0 {
            x ^= direction;
        }
        direction ^= direction >> 1;
        i >>= 1;
    }
    x
}

/// Nested uniform scrambling: every bit is flipped by a hash of the bits above it [Burley 2020, listing 3].
fn owen_scramble(x: u32, seed: u32) -> u32 {
    let mut v = x.reverse_bits();
    v ^= v.wrapping_mul(0x3d20_adea);
    v = v.wrapping_add(seed);
    v = v.wrapping_mul((seed >> 16) | 1);
    v ^= v.wrapping_mul(0x0552_6c56);
    v ^= v.wrapping_mul(0x53a2_2864);
    v.reverse_bits()
}

/// The bits of both coordinates in turn, highest first.
fn morton(p: UVec2) -> u64 {
    let spread = |x: u32| {
        let mut x = u64::from(x);
        for (shift, mask) in [
            (16, 0x0000_ffff_0000_ffffu64),
            (8, 0x00ff_00ff_00ff_00ff),
            (4, 0x0f0f_0f0f_0f0f_0f0f),
            (2, 0x3333_3333_3333_3333),
            (1, 0x5555_5555_5555_5555),
        ] {
            x = (x | x << shift) & mask;
        }
        x
    };
    spread(p.x) << 1 | spread(p.y)
}

/// A 64-bit hash of two numbers [Steele 2014, SplitMix].
fn mix(a: u64, b: u64) -> u64 {
    let mut x = a.wrapping_add(b.wrapping_mul(0x9e37_79b9_7f4a_7c15)).wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every box of 1/a × 1/b with a * b = n holds exactly one of n points.
    fn assert_net(points: &[UVec2], log2_n: u32) {
        assert_eq!(points.len(), 1 << log2_n);
        for x_bits in 0..=log2_n {
            let y_bits = log2_n - x_bits;
            let mut seen = vec![false; points.len()];
            for p in points {
                let x = u64::from(p.x) >> (32 - x_bits);
                let y = u64::from(p.y) >> (32 - y_bits);
                let k = (x << y_bits | y) as usize;
                assert!(!std::mem::replace(&mut seen[k], true), "two points in box {k} of {x_bits} and {y_bits} bits");
            }
        }
    }

    #[test]
    fn each_sub_pixel_and_all_together_are_nets_after_the_shuffle() {
        let pattern = Pattern::new(16, 64, [true, true], 7);
        for index in 0..4 {
            let flip = pattern.shuffle(index).flip;
            let points = |keep: &dyn Fn(u32) -> bool| -> Vec<UVec2> {
                pattern.light.iter().filter(|s| keep(s.sub_pixel)).map(|s| s.point ^ flip).collect()
            };
            assert_net(&points(&|_| true), 10);
            for k in 0..16 {
                assert_net(&points(&|s| s == k), 6);
            }
        }
    }

    #[test]
    fn neighbours_in_the_list_are_neighbours_on_the_light() {
        let pattern = Pattern::new(16, 64, [true, true], 1);
        let flip = pattern.shuffle(11).flip;
        for block in pattern.light.chunks(16) {
            let first = block[0].point ^ flip;
            assert!(
                block.iter().all(|s| ((s.point ^ flip) >> 29) == (first >> 29)),
                "a block fills one of 8 × 8 cells"
            );
        }
    }

    #[test]
    fn a_square_number_of_sub_pixels_is_a_grid() {
        assert_eq!(pixel_grid(4), [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)].map(Vec2::from));
        assert_eq!(pixel_grid(1), [Vec2::splat(0.5)]);
        assert!(pixel_grid(7).iter().all(|p| p.min_element() >= 0.0 && p.max_element() < 1.0));
    }
}
