//! Texels that a penumbra needs by its width in pixels [Shen 2011, figure 9]: the paper's binary search with an image
//! metric in place of twelve people.

use super::disk::{Disk, Shadow};
use super::fit;
use crate::kit::{Context, Report, Section};
use crate::page::lines::{Curve, Lines, Point};
use crate::table::{Table, column};
use crate::{Error, Monitor};
use antumbra::techniques::pvssm::rho::{Cubic, DYNAMIC, STATIC, texels};

/// Imperceptible mean FLIP error in the penumbra. At this error the study of still images finds as many texels as the
/// paper's people wanted for a penumbra of eight pixels.
pub const THRESHOLD: f64 = 0.1;
/// Offsets of the map's grid, in texels: of still maps, and of the frames of a moving one.
const SHIFTS: [[f64; 2]; 5] = [[0.13, 0.71], [0.41, 0.29], [0.66, 0.93], [0.87, 0.52], [0.05, 0.17]];
/// Ratio of the bounds at which the search ends.
const NARROW: f64 = 1.02;

/// Result for one width of a penumbra.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// Width of the penumbra, pixels.
    pub penumbra: f64,
    /// Texels for a static scene.
    pub still: f64,
    /// Texels for a moving occluder.
    pub moving: f64,
}

/// Errors of maps of which the box covers `rho` texels: the mean over offsets of the grid, and for a moving occluder
/// that plus the mean change between frames.
fn errors(disk: &Disk, reference: &Shadow, rho: f64) -> [f64; 2] {
    let shadows = SHIFTS.map(|shift| disk.shadow(rho, shift));
    let mean = |values: &mut dyn Iterator<Item = f64>, count: usize| values.sum::<f64>() / count as f64;
    let still = mean(&mut shadows.iter().map(|s| s.flip(reference)), shadows.len());
    let flicker = mean(&mut shadows.windows(2).map(|s| s[0].flip(&s[1])), shadows.len() - 1);
    [still, still + flicker]
}

/// The fewest texels whose error is within the threshold: `which` is 0 for static scenes, 1 for a moving occluder.
fn needed(disk: &Disk, reference: &Shadow, threshold: f64, which: usize, monitor: &dyn Monitor) -> Result<f64, Error> {
    let (mut low, mut high) = (0.25f64, 2.0 * disk.penumbra.max(1.0));
    while high / low > NARROW {
        monitor.check()?;
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
pub fn search(threshold: f64, most: u32, monitor: &dyn Monitor) -> Result<Vec<Found>, Error> {
    let widths: Vec<u32> = (0..10).map(|k| 1 << k).filter(|n| *n <= most).collect();
    let progress = monitor.task("Searching");
    let one = |(i, n): (usize, &u32)| {
        let disk = Disk { penumbra: f64::from(*n) };
        let reference = disk.reference();
        let [still, moving] = [0, 1].map(|which| needed(&disk, &reference, threshold, which, monitor));
        progress((i + 1) as f32 / widths.len() as f32);
        Ok(Found { penumbra: disk.penumbra, still: still?, moving: moving? })
    };
    widths.iter().enumerate().map(one).collect()
}

/// The SPEC of `pvssm` with this polynomial.
pub fn spec(cubic: [f64; 4]) -> String {
    let [a, b, c, d] = cubic;
    format!("pvssm:rho=own,c0={a:.4},c1={b:.4},c2={c:.4},c3={d:.5}")
}

/// The cubic of log2 at a width.
fn cubic_at(cubic: &[f64; 4], pixels: f64) -> f64 {
    cubic.iter().rev().fold(0.0, |sum, c| sum * pixels.log2() + c)
}

/// Circumstances of the study, for its files; `command` is the command line.
pub fn context(command: String) -> Context {
    Context {
        suite: "rho",
        title: "Texels that a penumbra needs",
        source: "Shen 2011",
        adapter: "the CPU, in double precision".to_owned(),
        software: false,
        command,
        frames: 1,
    }
}

/// The results beside the paper's polynomials.
pub fn report(found: &[Found], threshold: f64) -> Report {
    let [moving, still] = [|f: &Found| f.moving, |f: &Found| f.still]
        .map(|of| fit::cubic(&found.iter().map(|f| (f.penumbra.log2(), of(f))).collect::<Vec<_>>()));
    let number = |heading, help, value: Box<dyn Fn(&Found) -> f64>| {
        column(heading, help, "texels", move |f: &&Found| format!("{:.2}", value(f)))
    };
    let columns = [
        column("pixels", "Width of the penumbra", "pixels", |f: &&Found| f.penumbra.to_string()),
        number("moving", "Needed by a moving occluder", Box::new(|f| f.moving)),
        number("fitted", "The cubic through these", Box::new(move |f| cubic_at(&moving, f.penumbra))),
        number("paper", "The paper's polynomial for moving scenes", Box::new(|f| texels(DYNAMIC, f.penumbra))),
        number("still", "Needed by a static scene", Box::new(|f| f.still)),
        number("fitted", "The cubic through these", Box::new(move |f| cubic_at(&still, f.penumbra))),
        number("paper", "The paper's polynomial for static scenes", Box::new(|f| texels(STATIC, f.penumbra))),
    ];
    let lead = format!(
        "Texels that a penumbra needs for a FLIP error of {threshold}: {} where casters move, {} where they are static.",
        spec(moving),
        spec(still)
    );
    let text = format!(
        "A disk's soft shadow, seen from the light's centre; the fewest texels over the filter's width with which the \
         image's mean FLIP error in the penumbra is at most {threshold}, against an image of about a thousand texels. For \
         a moving occluder the change between frames counts as well. Twelve people answered the paper's question; it \
         reports small differences between them up to 64 pixels. The search goes up to twice the pixels, as the paper's \
         does."
    );
    let contents = vec![curves(found, [moving, still]).into(), Table::new(&columns, "", found).into()];
    let section = Section::new("Texels over pixels (figure 9)", text, contents);
    Report { lead, sections: vec![section], ratios: Vec::new(), trials: Vec::new() }
}

fn curves(found: &[Found], [moving, still]: [[f64; 4]; 2]) -> Lines {
    let curve = |label: &str, color: usize, y: &dyn Fn(&Found) -> f64| {
        let note = |f: &Found| format!("{label}, {} pixels: {:.2} texels", f.penumbra, y(f));
        Curve::new(label, color, found.iter().map(|f| Point::new(f.penumbra, y(f), note(f))))
    };
    let own = |cubic: [f64; 4]| move |f: &Found| cubic_at(&cubic, f.penumbra);
    let paper = |cubic: Cubic| move |f: &Found| texels(cubic, f.penumbra);
    let curves = [
        curve("moving, by FLIP", 0, &|f| f.moving),
        curve("moving, fitted", 0, &own(moving)).dashed(true),
        curve("moving, the paper's", 1, &paper(DYNAMIC)).dashed(true),
        curve("still, by FLIP", 2, &|f| f.still),
        curve("still, fitted", 2, &own(still)).dashed(true),
        curve("still, the paper's", 3, &paper(STATIC)).dashed(true),
    ];
    Lines::new("width of the penumbra in pixels", "texels over the filter's width", curves)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wider_penumbrae_need_more_texels_and_moving_ones_more_than_still_ones() {
        let found = search(THRESHOLD, 16, &crate::Silent::default()).unwrap();
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
