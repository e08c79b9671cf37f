//! The scene of the paper's user study [Shen 2011, section 5.1], in closed form: a disk over a parallel floor, both
//! parallel to a square light, seen from the light's centre. Its soft shadow is the disk's map, filtered by a box whose
//! width in pixels is that of the penumbra.

use antumbra_metrics::{Image, metrics};

/// A disk whose penumbra has a width in pixels.
#[derive(Clone, Copy, Debug)]
pub struct Disk {
    /// Width of the box and of the penumbra, pixels.
    pub penumbra: f64,
}

/// An image of a quarter of the shadow, from its centre outwards, with edges of every direction.
#[derive(Clone, Debug)]
pub struct Shadow {
    /// Pixels per side.
    pub side: u32,
    /// Visible fraction, row by row.
    pub visibility: Vec<f32>,
}

/// Texels per pixel of the reference for penumbrae of this width: about a thousand over the box.
fn finest(penumbra: f64) -> f64 {
    (1024.0 / penumbra).clamp(2.0, 48.0)
}

impl Disk {
    /// Radius of the disk, pixels: every width leaves some umbra.
    fn radius(&self) -> f64 {
        0.6 * self.penumbra + 16.3
    }

    /// Pixels per side of the image.
    pub fn side(&self) -> u32 {
        (self.radius() + 0.5 * self.penumbra + 6.0).ceil() as u32
    }

    /// The shadow by a map without perceptible error.
    pub fn reference(&self) -> Shadow {
        self.shadow(finest(self.penumbra) * self.penumbra, [0.37, 0.61])
    }

    /// The shadow by a map of which the box covers `rho` texels per side. The map's grid is moved by `shift` texels.
    ///
    /// Texels are squares that the box cuts, each occluded as its centre is [Shen 2011, eq. 2]. An interpolated
    /// summed-area table integrates this piecewise constant function exactly.
    pub fn shadow(&self, rho: f64, shift: [f64; 2]) -> Shadow {
        let (texel, reach) = (self.penumbra / rho, 0.5 * self.penumbra);
        let side = self.side();
        // Texels from -reach to side + reach, and one more for the shift.
        let count = ((f64::from(side) + 2.0 * reach) / texel).ceil() as usize + 3;
        let origin = shift.map(|s| -reach - (1.0 + s) * texel);
        let row = count + 1;
        let mut table = vec![0.0f64; row * row];
        for j in 0..count {
            let y = origin[1] + (j as f64 + 0.5) * texel;
            let mut sum = 0.0;
            for i in 0..count {
                let x = origin[0] + (i as f64 + 0.5) * texel;
                sum += f64::from(u8::from(x.hypot(y) < self.radius()));
                table[(j + 1) * row + i + 1] = table[j * row + i + 1] + sum;
            }
        }
        let below = |x: f64, y: f64| {
            let at = |v: f64| (v.floor().clamp(0.0, (count - 1) as f64), v);
            let ((i, x), (j, y)) = (at(x), at(y));
            let (fx, fy, k) = (x - i, y - j, j as usize * row + i as usize);
            let low = table[k] * (1.0 - fx) + table[k + 1] * fx;
            let high = table[k + row] * (1.0 - fx) + table[k + row + 1] * fx;
            low * (1.0 - fy) + high * fy
        };
        let pixel = |place: u32| {
            let p = [f64::from(place % side) + 0.5, f64::from(place / side) + 0.5];
            let edge = |axis: usize, by: f64| (p[axis] + by - origin[axis]) / texel;
            let (left, right, top, bottom) = (edge(0, -reach), edge(0, reach), edge(1, -reach), edge(1, reach));
            let hidden = below(right, bottom) - below(left, bottom) - below(right, top) + below(left, top);
            (1.0 - hidden / (rho * rho)).clamp(0.0, 1.0) as f32
        };
        Shadow { side, visibility: (0..side * side).map(pixel).collect() }
    }
}

impl Shadow {
    /// Mean FLIP error against another shadow, over its penumbra.
    pub fn flip(&self, reference: &Shadow) -> f64 {
        let image = |p| Image::new(self.side, self.side, p).expect("both images have one size");
        let penumbra: Vec<bool> = reference.visibility.iter().map(|v| (0.005..0.995).contains(v)).collect();
        let found = metrics(image(&self.visibility), image(&reference.visibility), &penumbra);
        found.expect("every shadow has a penumbra").flip
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_the_sum_over_cut_texels() {
        let (disk, rho, shift) = (Disk { penumbra: 7.0 }, 3.3, [0.2, 0.9]);
        let shadow = disk.shadow(rho, shift);
        let texel = 7.0 / rho;
        for place in [0, 40, 417, 899] {
            let p = [place % shadow.side, place / shadow.side].map(|v| f64::from(v) + 0.5);
            let mut hidden = 0.0;
            // Every texel that could be near, one by one.
            for (i, j) in (0..80).flat_map(|j| (0..80).map(move |i| (i, j))) {
                let low = [i, j].map(f64::from);
                let low = [0, 1].map(|a| -3.5 + (low[a] - 1.0 - shift[a]) * texel);
                let shared = |a: usize| ((low[a] + texel).min(p[a] + 3.5) - low[a].max(p[a] - 3.5)).max(0.0);
                if (low[0] + 0.5 * texel).hypot(low[1] + 0.5 * texel) < disk.radius() {
                    hidden += shared(0) * shared(1);
                }
            }
            let got = f64::from(shadow.visibility[place as usize]);
            assert!(
                (got - (1.0 - hidden / 49.0)).abs() < 1e-6,
                "pixel {p:?}: {got} instead of {}",
                1.0 - hidden / 49.0
            );
        }
    }

    #[test]
    fn finer_maps_are_nearer_to_the_reference() {
        let disk = Disk { penumbra: 16.0 };
        let reference = disk.reference();
        let errors = [1.5, 4.0, 12.0, 48.0].map(|rho| disk.shadow(rho, [0.3, 0.7]).flip(&reference));
        assert!(errors.windows(2).all(|e| e[1] < e[0]), "{errors:?}");
        assert!(errors[3] < 0.03, "{errors:?}");
    }
}
