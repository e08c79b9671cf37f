//! The report's files, all of them or none.

use std::collections::BTreeMap;
use std::path::Path;
use std::{fs, io};

use serde::Serialize;

use super::pictures::{self, Pictures};
use super::{Entry, Report, ReportError, page};

/// Writes `index.html`, `results.json`, `results.csv` and `pictures/` into the folder `to`, which is made where it is
/// missing. Everything is written aside and then moved into place, so that a failure leaves nothing half written.
pub fn write(report: &Report, to: &Path) -> Result<(), ReportError> {
    let pictures = pictures::encode(report)?;
    let mut files = vec![("results.json".to_owned(), json(report, &pictures)?)];
    files.push(("results.csv".into(), csv(report)?));
    for (_, name, png) in pictures.iter().flat_map(Pictures::files) {
        files.push((format!("pictures/{name}"), png.to_vec()));
    }
    files.push(("index.html".into(), page::html(report, &pictures).into_bytes())); // last: it links to the others

    place(&files, to)
}

/// Puts files into a folder, which is made where it is missing; the last one comes when all others are there.
pub fn place(files: &[(String, Vec<u8>)], to: &Path) -> Result<(), ReportError> {
    let is_new = !to.exists();
    let written = place_aside_first(files, to);
    if written.is_err() && is_new {
        let _ = fs::remove_dir(to); // the failure itself is the news
    }
    written
}

fn place_aside_first(files: &[(String, Vec<u8>)], to: &Path) -> Result<(), ReportError> {
    let at = |path: &Path| {
        let path = path.to_owned();
        move |source: io::Error| ReportError::Write { path, source }
    };
    fs::create_dir_all(to).map_err(at(to))?;
    let aside = tempfile::Builder::new().prefix(".report-").tempdir_in(to).map_err(at(to))?;
    let make_folder = |file: &Path| fs::create_dir_all(file.parent().unwrap_or(to));
    for (name, content) in files {
        let file = aside.path().join(name);
        make_folder(&file).and_then(|()| fs::write(&file, content)).map_err(at(&to.join(name)))?;
    }
    for (name, _) in files {
        let file = to.join(name);
        make_folder(&file).and_then(|()| fs::rename(aside.path().join(name), &file)).map_err(at(&file))?;
    }
    Ok(())
}

/// An entry as JSON has it: with the places of its pictures.
#[derive(Serialize)]
struct Record<'a> {
    #[serde(flatten)]
    entry: &'a Entry,
    pictures: BTreeMap<&'static str, String>,
}

fn json(report: &Report, pictures: &[Pictures]) -> Result<Vec<u8>, ReportError> {
    #[derive(Serialize)]
    struct Document<'a> {
        #[serde(flatten)]
        report: &'a Report,
        techniques: Vec<Record<'a>>,
    }
    let places = |p: &Pictures| -> BTreeMap<_, _> {
        p.files().map(|(kind, name, _)| (kind, format!("pictures/{name}"))).collect()
    };
    let records = report.entries.iter().zip(&pictures[1..]);
    let techniques = records.map(|(entry, p)| Record { entry, pictures: places(p) }).collect();
    let mut json = serde_json::to_vec_pretty(&Document { report, techniques })?;
    json.push(b'\n');
    Ok(json)
}

/// A row a technique.
#[derive(Serialize)]
struct Row<'a> {
    technique: &'a str,
    spec: &'a str,
    average_error: f64,
    rmse: f64,
    p99: f64,
    max: f64,
    leak: f64,
    acne: f64,
    ssim: f64,
    flip: f64,
    total_ms: f64,
    total_bytes: u64,
    valid: u64,
    shadowed: u64,
    penumbra: u64,
    umbra: u64,
    lit: u64,
    scene: &'a str,
    width: u32,
    height: u32,
    triangles: u64,
    adapter: &'a str,
}

fn csv(report: &Report) -> Result<Vec<u8>, ReportError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for entry in &report.entries {
        let (f, c) = (&entry.figures, &entry.figures.counts);
        writer.serialize(Row {
            technique: &entry.technique,
            spec: &entry.spec,
            average_error: f.average_error,
            rmse: f.rmse,
            p99: f.p99,
            max: f.max,
            leak: f.leak,
            acne: f.acne,
            ssim: f.ssim,
            flip: f.flip,
            total_ms: entry.total_ms,
            total_bytes: entry.total_bytes,
            valid: c.valid,
            shadowed: c.shadowed,
            penumbra: c.penumbra,
            umbra: c.umbra,
            lit: c.lit,
            scene: &report.scene,
            width: report.width,
            height: report.height,
            triangles: report.triangles,
            adapter: &report.adapter,
        })?;
    }
    Ok(writer.into_inner().expect("a vector takes everything"))
}
