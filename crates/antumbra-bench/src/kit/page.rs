//! The page of a suite.

use super::report::{Content, Context, GalleryImage, Report};
use crate::page::files::ReportError;
use crate::page::{frame, images, lines, scatter};
use crate::table::breakable;
use maud::{Markup, html};

/// The whole self-contained page.
pub fn html(context: &Context, report: &Report) -> Result<String, ReportError> {
    let main = html! {
        @for (i, section) in report.sections.iter().enumerate() {
            section.figures.framed id=(anchor(i)) {
                h2 { (section.title) }
                p.lead { (section.text) }
                @for content in &section.contents {
                    @match content {
                        Content::Gallery(images) => (gallery(images)?),
                        Content::Table(table) => (table.html()),
                        Content::Lines(curves) => (lines::plot(curves)),
                        Content::Scatter(of) => (scatter::plot(&of.points, of.groups)),
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
    Ok(frame::page(context.title, header(context, report), main, footer, &[]))
}

fn anchor(section: usize) -> String {
    format!("part-{}", section + 1)
}

fn header(context: &Context, report: &Report) -> Markup {
    let anchors: Vec<String> = (0..report.sections.len()).map(|i| format!("#{}", anchor(i))).collect();
    let links: Vec<(&str, &str)> =
        anchors.iter().zip(&report.sections).map(|(to, section)| (to.as_str(), section.title.as_str())).collect();
    html! {
        (frame::brand(&links))
        h1 { (context.title) }
        dl.facts {
            div { dt { "Paper" } dd { (context.source) } }
            (frame::adapter(&context.adapter, context.software))
            // A study has no times.
            @if !report.trials.is_empty() {
                div { dt { "Milliseconds" } dd { (report.clock()) } }
                div { dt { "Frames" } dd { (context.timed_frames()) } }
            }
        }
        (frame::command(&context.command))
        @if context.software { (frame::software_notice()) }
        p.lead.outcome { (report.lead) }
    }
}

/// Embedded images with their captions.
fn gallery(images: &[GalleryImage]) -> Result<Markup, ReportError> {
    let sources: Vec<String> =
        images.iter().map(|i| Ok(images::embedded(&images::rgb(&i.image)?))).collect::<Result<_, ReportError>>()?;
    Ok(html! {
        div.gallery.scenes {
            @for (GalleryImage { name, remark, size, .. }, source) in images.iter().zip(&sources) {
                figure {
                    img src=(source) width=(size[0]) height=(size[1]) alt=(name);
                    figcaption { b { (breakable(name)) } @if !remark.is_empty() { span { (remark) } } }
                }
            }
        }
    })
}
