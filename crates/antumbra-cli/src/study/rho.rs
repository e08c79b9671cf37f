//! How many texels a penumbra of so many pixels needs [Shen 2011, figure 9]: the paper's binary search, an image metric
//! in the place of twelve people.

use super::disk::{Disk, Picture};
use super::fit;
use crate::bench::kit::{Findings, Group, Part, Shown, Table};
use crate::error::CliError;
use crate::progress::{self, Progress};
use crate::report::lines::{Curve, Lines, Spot};
use antumbra::techniques::pvssm::rho::{Cubic, DYNAMIC, STATIC, texels};

/// Mean FLIP error in the penumbra that nobody minds: the one at which the study of still pictures finds as many texels
/// as the paper's people wanted for a penumbra of eight pixels.
pub const THRESHOLD: f64 = 0.1;
/// Places of the map's grid, in texels: pictures of a map that nobody has placed, and the frames of a moving one.
const SHIFTS: [[f64; 2]; 5] = [[0.13, 0.71], [0.41, 0.29], [0.66, 0.93], [0.87, 0.52], [0.05, 0.17]];
/// The search ends where what is left of its range is this narrow.
const NARROW: f64 = 1.02;

/// What one width of a penumbra came to.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// Pixels.
    pub penumbra: f64,
    /// Texels where nothing moves, and where the occluder does.
    pub still: f64,
    pub moving: f64,
}

/// The errors of maps of which the box covers `rho` texels: the mean over places of the grid, and, where the occluder
/// moves over the grid, what changes from frame to frame besides.
fn errors(disk: &Disk, reference: &Picture, rho: f64) -> [f64; 2] {
    let pictures = SHIFTS.map(|shift| disk.picture(rho, shift));
    let mean = |values: &mut dyn Iterator<Item = f64>, count: usize| values.sum::<f64>() / count as f64;
    let still = mean(&mut pictures.iter().map(|p| p.flip(reference)), pictures.len());
    let flicker = mean(&mut pictures.windows(2).map(|p| p[0].flip(&p[1])), pictures.len() - 1);
    [still, still + flicker]
}

/// The fewest texels whose error is within the threshold: `which` is 0 for still pictures, 1 for moving ones.
fn needed(disk: &Disk, reference: &Picture, threshold: f64, which: usize) -> Result<f64, CliError> {
    let (mut low, mut high) = (0.25f64, 2.0 * disk.penumbra.max(1.0));
    while high / low > NARROW {
        progress::check_cancelled()?;
        let middle = (low * high).sqrt();
        if errors(disk, reference, middle)[which] > threshold {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok((low * high).sqrt())
}

/// Searches for every power of two up to `most` pixels.
pub fn search(threshold: f64, most: u32) -> Result<Vec<Found>, CliError> {
    let widths: Vec<u32> = (0..10).map(|k| 1 << k).filter(|n| *n <= most).collect();
    let progress = Progress::new("Searching");
    let one = |(i, n): (usize, &u32)| {
        let disk = Disk { penumbra: f64::from(*n) };
        let reference = disk.reference();
        let [still, moving] = [0, 1].map(|which| needed(&disk, &reference, threshold, which));
        progress.set((i + 1) as f32 / widths.len() as f32);
        Ok(Found { penumbra: disk.penumbra, still: still?, moving: moving? })
    };
    widths.iter().enumerate().map(one).collect()
}

/// The setting that makes `pvssm` use a polynomial.
pub fn spec(cubic: [f64; 4]) -> String {
    let [a, b, c, d] = cubic;
    format!("pvssm:rho=own,c0={a:.4},c1={b:.4},c2={c:.4},c3={d:.5}")
}

/// Puts what was found beside the paper's polynomials.
pub fn findings(found: &[Found], threshold: f64) -> Findings {
    let fitted = [|f: &Found| f.moving, |f: &Found| f.still]
        .map(|of| fit::cubic(&found.iter().map(|f| (f.penumbra.log2(), of(f))).collect::<Vec<_>>()));
    let at = |cubic: &[f64; 4], n: f64| cubic.iter().rev().fold(0.0, |sum, c| sum * n.log2() + c);
    let rows = found.iter().map(|f| {
        let cells = [
            f.moving,
            at(&fitted[0], f.penumbra),
            texels(DYNAMIC, f.penumbra),
            f.still,
            at(&fitted[1], f.penumbra),
            texels(STATIC, f.penumbra),
        ];
        std::iter::once(f.penumbra.to_string()).chain(cells.map(|v| format!("{v:.2}"))).collect()
    });
    let heads = vec![
        ("pixels", "Width of the penumbra"),
        ("moving", "Texels that it needs where the occluder moves"),
        ("fitted", "The cubic through these"),
        ("paper", "The paper's polynomial for moving scenes"),
        ("still", "Texels that it needs where nothing moves"),
        ("fitted", "The cubic through these"),
        ("paper", "The paper's polynomial for still scenes"),
    ];
    let table = Table { heads, groups: vec![Group { title: String::new(), rows: rows.collect() }] };
    let lead = format!(
        "Texels that a penumbra needs for a FLIP error of {threshold}: {} where casters move, {} where they rest.",
        spec(fitted[0]),
        spec(fitted[1])
    );
    let part = Part {
        title: "Texels over pixels (figure 9)".into(),
        text: format!(
            "A disk's soft shadow, seen from the light's centre; the fewest texels over the filter's width with which \
             the picture's mean FLIP error in the penumbra is at most {threshold}, against a picture of about a thousand \
             texels. Where the occluder moves, what changes between frames counts as well. Twelve people answered the \
             paper's question; it says that they hardly differed up to 64 pixels. The search goes up to twice the pixels, as \
             the paper's does."
        ),
        shown: vec![Shown::Lines(curves(found, &fitted)), Shown::Table(table)],
    };
    Findings { lead, parts: vec![part], ratios: Vec::new(), trials: Vec::new() }
}

fn curves(found: &[Found], fitted: &[[f64; 4]; 2]) -> Lines {
    let curve = |label: &str, color: usize, dashed: bool, y: &dyn Fn(&Found) -> f64| {
        let spot = |f: &Found| {
            let note = format!("{label}, {} pixels: {:.2} texels", f.penumbra, y(f));
            Spot { x: f.penumbra, y: y(f), note }
        };
        Curve { label: label.to_owned(), color, dashed, points: found.iter().map(spot).collect() }
    };
    let own = |cubic: [f64; 4]| move |f: &Found| cubic.iter().rev().fold(0.0, |sum, c| sum * f.penumbra.log2() + c);
    let paper = |cubic: Cubic| move |f: &Found| texels(cubic, f.penumbra);
    Lines {
        x: "width of the penumbra in pixels".into(),
        y: "texels over the filter's width".into(),
        less_is_better: false,
        curves: vec![
            curve("moving, by FLIP", 0, false, &|f| f.moving),
            curve("moving, fitted", 0, true, &own(fitted[0])),
            curve("moving, the paper's", 1, true, &paper(DYNAMIC)),
            curve("still, by FLIP", 2, false, &|f| f.still),
            curve("still, fitted", 2, true, &own(fitted[1])),
            curve("still, the paper's", 3, true, &paper(STATIC)),
        ],
        guides: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wider_penumbrae_need_more_texels_and_moving_ones_more_than_still_ones() {
        let found = search(THRESHOLD, 16).unwrap();
        println!("{found:?}");
        assert_eq!(found.len(), 5);
        assert!(found.iter().all(|f| f.moving > f.still), "{found:?}");
        assert!(found.windows(2).all(|f| f[1].moving > f[0].moving && f[1].still > f[0].still), "{found:?}");
        // The threshold is set by this point of the paper's curve.
        let eight = found.iter().find(|f| f.penumbra == 8.0).expect("searched");
        assert!((eight.still / texels(STATIC, 8.0) - 1.0).abs() < 0.1, "{eight:?}");
    }

    #[test]
    fn the_fitted_polynomial_is_a_setting() {
        let spec = spec([0.5, 1.25, -0.0625, 0.001]);
        assert!(spec.parse::<antumbra::Spec>().is_ok(), "{spec}");
    }
}
