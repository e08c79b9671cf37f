//! The page of a suite.

use super::{Context, Findings, Shown, Table, Trial};
use crate::report::{ReportError, frame, lines, pictures, plot, text};
use antumbra_metrics::RgbImage;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use maud::{Markup, html};

/// The whole page, needing nothing else.
pub fn html(context: &Context, findings: &Findings) -> Result<String, ReportError> {
    let thumbnails: Vec<String> = findings.trials.iter().map(thumbnail).collect::<Result<_, _>>()?;
    let galleries: Vec<Markup> = findings.trials.iter().map(runs_of).collect::<Result<_, _>>()?;
    let main = html! {
        @for (i, part) in findings.parts.iter().enumerate() {
            section.figures.framed id=(anchor(i)) {
                h2 { (part.title) }
                p.lead { (part.text) }
                @for shown in &part.shown {
                    @match shown {
                        Shown::Pictures(of) => (pictures_of(findings, of, &thumbnails)),
                        Shown::Runs(of) => (galleries[*of]),
                        Shown::Gallery(pictures) => (gallery(pictures)?),
                        Shown::Table(table) => (drawn_table(table)),
                        Shown::Lines(curves) => (lines::plot(curves)),
                        Shown::Scatter(of) => (plot::scatter(&of.points, &of.groups)),
                    }
                }
            }
        }
    };
    let [json, csv, curves, md] =
        ["json", "csv", "curves.csv", "md"].map(|ending| format!("{}.{ending}", context.suite));
    let footer = html! {
        p {
            "Every measurement as " a href=(json) { "JSON" } " and " a href=(csv) { "CSV" } "; the plots' points as "
            a href=(curves) { "CSV" } "; the tables as "
            a href=(md) { "Markdown" } "."
        }
    };
    Ok(frame::page(context.title, header(context, findings), main, footer, &[]))
}

fn anchor(part: usize) -> String {
    format!("part-{}", part + 1)
}

fn header(context: &Context, findings: &Findings) -> Markup {
    let anchors: Vec<String> = (0..findings.parts.len()).map(|i| format!("#{}", anchor(i))).collect();
    let links: Vec<(&str, &str)> =
        anchors.iter().zip(&findings.parts).map(|(to, part)| (to.as_str(), part.title.as_str())).collect();
    html! {
        (frame::brand(&links))
        h1 { (context.title) }
        dl.facts {
            div { dt { "Paper" } dd { (context.source) } }
            (frame::adapter(&context.adapter, context.software))
            // A study times nothing.
            @if !findings.trials.is_empty() {
                div { dt { "Milliseconds" } dd { (findings.clock()) } }
                div { dt { "Frames" } dd { (context.counted()) } }
            }
        }
        (frame::command(&context.command))
        @if context.software { (frame::software_notice()) }
        p.lead.outcome { (findings.lead) }
    }
}

/// Half of the picture each side, embedded.
fn thumbnail(trial: &Trial) -> Result<String, ReportError> {
    embedded(&pictures::halved(&trial.picture))
}

/// Every picture of a trial that was kept, in its own size, with its error.
fn runs_of(trial: &Trial) -> Result<Markup, ReportError> {
    let kept: Vec<(&str, &RgbImage, f64)> = trial
        .runs
        .iter()
        .filter_map(|run| Some((run.spec.as_str(), run.picture.as_ref()?, run.figures.rmse)))
        .collect();
    if kept.is_empty() {
        return Ok(html! {});
    }
    let shown: Vec<(&str, String, Option<f64>)> = std::iter::once(("truth", &trial.picture, None))
        .chain(kept.into_iter().map(|(spec, picture, rmse)| (spec, picture, Some(rmse))))
        .map(|(name, picture, rmse)| Ok((name, embedded(picture)?, rmse)))
        .collect::<Result<_, ReportError>>()?;
    Ok(html! {
        div.gallery.scenes {
            @for (name, picture, rmse) in &shown {
                figure {
                    img src=(picture) width=(trial.width) height=(trial.height) alt=(format!("{}: {name}", trial.name));
                    figcaption {
                        b { (spelled(name)) }
                        @if let Some(rmse) = rmse { span { "RMSE " (text::figure(*rmse)) } }
                    }
                }
            }
        }
    })
}

fn gallery(pictures: &[(String, String, RgbImage)]) -> Result<Markup, ReportError> {
    let shown: Vec<_> = pictures.iter().map(|(_, _, image)| embedded(image)).collect::<Result<_, _>>()?;
    Ok(html! {
        div.gallery.scenes {
            @for ((name, remark, image), source) in pictures.iter().zip(&shown) {
                figure {
                    img src=(source) width=(image.width) height=(image.height) alt=(name);
                    figcaption { b { (spelled(name)) } span { (remark) } }
                }
            }
        }
    })
}

fn embedded(picture: &RgbImage) -> Result<String, ReportError> {
    Ok(format!("data:image/png;base64,{}", BASE64_STANDARD.encode(pictures::rgb(picture)?)))
}

fn pictures_of(findings: &Findings, of: &[usize], thumbnails: &[String]) -> Markup {
    let shown = of.iter().filter_map(|i| Some((findings.trials.get(*i)?, thumbnails.get(*i)?)));
    html! {
        div.gallery.scenes {
            @for (trial, thumbnail) in shown {
                figure {
                    img src=(thumbnail) width=(trial.width) height=(trial.height) alt=(format!("{}: the truth", trial.name));
                    figcaption {
                        b { (trial.name) }
                        span { (trial.scene) ", " (text::count(trial.triangles as u64)) " triangles" }
                    }
                }
            }
        }
    }
}

fn drawn_table(table: &Table) -> Markup {
    html! {
        div.scroll {
            table {
                thead { tr { @for (head, about) in &table.heads { th scope="col" title=(about) { (head) } } } }
                @for group in &table.groups {
                    tbody {
                        @if !group.title.is_empty() {
                            tr.group { th scope="rowgroup" colspan=(table.heads.len()) { (group.title) } }
                        }
                        @for row in &group.rows {
                            tr {
                                @for (i, cell) in row.iter().enumerate() {
                                    @if i == 0 { th.spelled scope="row" { (spelled(cell)) } } @else { td { (cell) } }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// A SPEC, which may go on in another line after a comma.
fn spelled(spec: &str) -> Markup {
    html! { code { @for part in spec.split_inclusive(',') { (part) wbr; } } }
}
