//! Files of a comparison.

use super::images::{self, Images};
use super::model::{Comparison, Entry};
use super::{columns, html};
use crate::page::files::{ReportError, json, write_all};
use crate::table::Table;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Writes `index.html`, `results.json`, `results.csv` and `pictures/` into the folder `to`, which is created if
/// necessary. A failure leaves no partial file.
pub fn write(comparison: &Comparison, to: &Path) -> Result<(), ReportError> {
    let images = images::encode(comparison)?;
    let rows = comparison.entries.iter().map(|entry| (comparison, entry));
    let csv = Table::new(&columns::csv(), "", rows).csv()?;
    let mut files = vec![("results.json".to_owned(), document(comparison, &images)?), ("results.csv".into(), csv)];
    for (_, name, png) in images.iter().flat_map(Images::files) {
        files.push((format!("pictures/{name}"), png.to_vec()));
    }
    files.push(("index.html".into(), html::page(comparison, &images).into_bytes())); // last: it links to the others
    write_all(&files, to)
}

#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    comparison: &'a Comparison,
    techniques: Vec<Record<'a>>,
}

/// A technique in the JSON.
#[derive(Serialize)]
struct Record<'a> {
    #[serde(flatten)]
    entry: &'a Entry,
    passes: Vec<Pass<'a>>,
    total_ms: f64,
    total_bytes: u64,
    pictures: BTreeMap<&'static str, String>,
}

#[derive(Serialize)]
struct Pass<'a> {
    name: &'a str,
    ms: Option<f64>,
    bytes: u64,
    host: bool,
}

fn document(comparison: &Comparison, images: &[Images]) -> Result<Vec<u8>, ReportError> {
    let techniques = comparison.entries.iter().zip(&images[1..]).map(|(entry, images)| record(entry, images)).collect();
    json(&Document { comparison, techniques })
}

fn record<'a>(entry: &'a Entry, images: &Images) -> Record<'a> {
    let passes = entry.cost.passes.iter();
    Record {
        entry,
        passes: passes.map(|p| Pass { name: &p.name, ms: p.ms, bytes: p.bytes, host: p.host }).collect(),
        total_ms: entry.cost.total_ms,
        total_bytes: entry.cost.total_bytes,
        pictures: images.files().map(|(kind, name, _)| (kind, format!("pictures/{name}"))).collect(),
    }
}
