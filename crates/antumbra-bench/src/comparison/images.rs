//! Images of a comparison as PNG.

use super::model::{Comparison, Entry};
use crate::page::files::ReportError;
use crate::page::images::{grey, rgb};
use crate::page::text;
use antumbra_metrics::RgbImage;
use rayon::prelude::*;

/// The images of one entry or of the reference, as PNG.
pub struct Images {
    /// Start of the files' names; unique in the report.
    pub slug: String,
    image: Vec<u8>,
    visibility: Vec<u8>,
    /// The heat map; the reference has none.
    error: Option<Vec<u8>>,
}

impl Images {
    /// Kind, file name and content of each.
    pub fn files(&self) -> impl Iterator<Item = (&'static str, String, &[u8])> {
        let always = [("picture", "", &self.image[..]), ("visibility", "-visibility", &self.visibility[..])];
        let error = self.error.as_deref().map(|png| ("error", "-error", png));
        always.into_iter().chain(error).map(|(kind, end, png)| (kind, format!("{}{end}.png", self.slug), png))
    }
}

/// Encodes all images; the reference's come first.
pub fn encode(comparison: &Comparison) -> Result<Vec<Images>, ReportError> {
    let Comparison { width, height, truth, entries, .. } = comparison;
    let encoded = |spec: &str, slug: String, image: &RgbImage, visibility: &[f32], heat_map: Option<&RgbImage>| {
        let pixels = *width as usize * *height as usize;
        let fits = |i: &RgbImage| (i.width, i.height, i.data.len()) == (*width, *height, pixels * 3);
        let wrong = |image| ReportError::Size { image, spec: spec.into(), width: *width, height: *height };
        match () {
            () if !fits(image) => return Err(wrong("image")),
            () if !heat_map.is_none_or(fits) => return Err(wrong("heat map")),
            () if visibility.len() != pixels => return Err(wrong("visibility")),
            () => (),
        }
        let (visibility, error) = (grey(*width, *height, visibility)?, heat_map.map(rgb).transpose()?);
        Ok(Images { slug, image: rgb(image)?, visibility, error })
    };
    let first = encoded("truth", "truth".to_owned(), &truth.image, &truth.visibility, None)?;
    let rest = entries
        .par_iter()
        .zip(slugs(entries))
        .map(|(entry, slug)| encoded(&entry.spec, slug, &entry.image, &entry.visibility, Some(&entry.heat_map)));
    Ok(std::iter::once(first).chain(rest.collect::<Result<Vec<_>, _>>()?).collect())
}

/// One file name per entry. A repeated SPEC, or one that differs only in special characters, gets a number.
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
