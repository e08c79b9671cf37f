//! Pictures as PNG.

use antumbra_metrics::RgbImage;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use rayon::prelude::*;

use super::{Entry, Report, ReportError, text};

/// The pictures of one entry or of the truth, as PNG.
pub struct Pictures {
    /// Start of the files' names; unique in the report.
    pub slug: String,
    /// The shaded scene.
    pub picture: Vec<u8>,
    /// Visibility as 8-bit grey.
    pub visibility: Vec<u8>,
    /// The heat map; the truth has none.
    pub error: Option<Vec<u8>>,
}

impl Pictures {
    /// Kind, file name and content of each.
    pub fn files(&self) -> impl Iterator<Item = (&'static str, String, &[u8])> {
        let always = [("picture", "", &self.picture[..]), ("visibility", "-visibility", &self.visibility[..])];
        let error = self.error.as_deref().map(|png| ("error", "-error", png));
        always.into_iter().chain(error).map(|(kind, end, png)| (kind, format!("{}{end}.png", self.slug), png))
    }
}

/// Encodes all pictures; the truth's come first.
pub fn encode(report: &Report) -> Result<Vec<Pictures>, ReportError> {
    let truth = &report.truth;
    check(report, "truth", &truth.visibility, &[("picture", &truth.picture)])?;
    for entry in &report.entries {
        check(report, &entry.spec, &entry.visibility, &[("picture", &entry.picture), ("heat map", &entry.heat_map)])?;
    }
    let slugs = slugs(&report.entries);
    let entries = report.entries.par_iter().zip(slugs).map(|(entry, slug)| {
        let error = Some(rgb(&entry.heat_map)?);
        Ok(Pictures { slug, picture: rgb(&entry.picture)?, visibility: grey(report, &entry.visibility)?, error })
    });
    let slug = "truth".to_owned();
    let truth =
        Pictures { slug, picture: rgb(&truth.picture)?, visibility: grey(report, &truth.visibility)?, error: None };
    let entries: Result<Vec<_>, ReportError> = entries.collect();
    Ok(std::iter::once(truth).chain(entries?).collect())
}

fn check(report: &Report, spec: &str, grey: &[f32], pictures: &[(&'static str, &RgbImage)]) -> Result<(), ReportError> {
    let (width, height) = (report.width, report.height);
    let pixels = width as usize * height as usize;
    let fits = |picture: &RgbImage| (picture.width, picture.height, picture.data.len()) == (width, height, pixels * 3);
    let wrong = pictures.iter().find(|(_, picture)| !fits(picture)).map(|(name, _)| *name);
    match wrong.or((grey.len() != pixels).then_some("visibility")) {
        Some(picture) => Err(ReportError::Size { picture, spec: spec.into(), width, height }),
        None => Ok(()),
    }
}

/// One file name an entry; a spec that comes again, or that differs only in odd characters, gets a number.
fn slugs(entries: &[Entry]) -> Vec<String> {
    let mut slugs = vec!["truth".to_owned()];
    for entry in entries {
        let base = text::slug(&entry.spec);
        let numbered = (2..).map(|n| format!("{base}-{n}"));
        let free = std::iter::once(base.clone()).chain(numbered).find(|slug| !slugs.contains(slug));
        slugs.extend(free);
    }
    slugs.split_off(1)
}

fn grey(report: &Report, values: &[f32]) -> Result<Vec<u8>, ReportError> {
    let bytes: Vec<u8> = values.iter().map(|v| (v.clamp(0.0, 1.0) * 255.0).round() as u8).collect();
    png(&bytes, report.width, report.height, ExtendedColorType::L8)
}

/// A picture of half the size, each pixel the mean of up to four.
pub fn halved(picture: &RgbImage) -> RgbImage {
    let (width, height) = (picture.width.div_ceil(2), picture.height.div_ceil(2));
    let at = |x: u32, y: u32, c: u32| {
        let (x, y) = (x.min(picture.width - 1), y.min(picture.height - 1));
        u32::from(picture.data[((y * picture.width + x) * 3 + c) as usize])
    };
    let mean = |x: u32, y: u32, c: u32| {
        let sum: u32 = [(0, 0), (1, 0), (0, 1), (1, 1)].iter().map(|(i, j)| at(2 * x + i, 2 * y + j, c)).sum();
        ((sum + 2) / 4) as u8
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    RgbImage { width, height, data: pixels.flat_map(|(x, y)| [0, 1, 2].map(|c| mean(x, y, c))).collect() }
}

/// A picture as PNG.
pub fn rgb(picture: &RgbImage) -> Result<Vec<u8>, ReportError> {
    png(&picture.data, picture.width, picture.height, ExtendedColorType::Rgb8)
}

fn png(bytes: &[u8], width: u32, height: u32, color: ExtendedColorType) -> Result<Vec<u8>, ReportError> {
    let mut out = Vec::new();
    PngEncoder::new_with_quality(&mut out, CompressionType::Default, FilterType::Adaptive)
        .write_image(bytes, width, height, color)?;
    Ok(out)
}
