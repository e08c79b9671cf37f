//! The page: header, table, plot and the side-by-side view.

use super::cards;
use super::columns::{METRICS, Metric};
use super::images::Images;
use super::model::{Comparison, Entry};
use crate::page::scatter::{self, Point};
use crate::page::{frame, text};
use maud::{Markup, html};

/// The whole self-contained page.
pub fn page(report: &Comparison, images: &[Images]) -> String {
    let labels = report.labels();
    let main = html! {
        section #figures.figures { (lead(report, &labels)) (table(report, &labels)) }
        section #plot.framed { h2 { "Error against cost" } (plot_of(report, &labels)) }
        section #compare { (comparison(report, &labels)) }
        section #techniques {
            h2 { "Every technique" }
            (cards::truth(report, &images[0]))
            @for (i, entry) in report.entries.iter().enumerate() {
                (cards::entry(report, entry, &labels[i], i + 1, &images[i + 1]))
            }
        }
    };
    let footer = html! {
        p {
            "The same results as " a href="results.json" { "JSON" } " and " a href="results.csv" { "CSV" }
            "; the images as files in " a href="pictures/" { "pictures" } "."
        }
    };
    frame::page(&report.scene, header(report), main, footer, &[include_str!("compare.js")])
}

fn header(report: &Comparison) -> Markup {
    let truth = &report.truth;
    let links = [
        ("#figures", "Metrics"),
        ("#plot", "Cost"),
        ("#compare", "Compare"),
        ("#techniques", "Techniques"),
        ("results.json", "JSON"),
        ("results.csv", "CSV"),
    ];
    html! {
        (frame::brand(&links))
        h1 { (report.scene) }
        dl.facts {
            div { dt { "Triangles" } dd { (text::count(report.triangles)) } }
            div { dt { "Images" } dd { (report.width) " × " (report.height) } }
            (frame::adapter(&report.adapter, report.software))
            div.wide {
                dt { "Truth" }
                dd {
                    (text::count(truth.light_samples.into())) " shadow rays and " (truth.pixel_samples)
                    " primary rays per pixel, ± " (text::metric(truth.error_estimate)) ", traced in "
                    (text::seconds(truth.seconds))
                }
            }
        }
        (frame::command(&report.command))
        @if report.software { (frame::software_notice()) }
    }
}

/// Index of the entry with the smallest key.
fn least(report: &Comparison, key: impl Fn(&Entry) -> f64) -> usize {
    let keys = report.entries.iter().map(key).enumerate();
    keys.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(i, _)| i)
}

/// The table's result in a sentence.
fn lead(report: &Comparison, labels: &[String]) -> Markup {
    let nearest = least(report, |e| e.metrics.average_error);
    let fastest = least(report, |e| e.cost.total_ms);
    let said = |i: usize| {
        (&labels[i], text::metric(report.entries[i].metrics.average_error), text::ms(report.entries[i].cost.total_ms))
    };
    let ((near, near_error, near_ms), (fast, fast_error, fast_ms)) = (said(nearest), said(fastest));
    html! {
        h2 { "Metrics" }
        @if nearest == fastest {
            p.lead {
                b { (near) } " errs by " b { (near_error) } " on average in the shadow and takes "
                b { (near_ms) "\u{a0}ms" } "."
            }
        } @else {
            p.lead {
                b { (near) } " is nearest to the truth: it errs by " b { (near_error) } " on average in the shadow and "
                "takes " b { (near_ms) "\u{a0}ms" } ". The fastest is " b { (fast) } ", " b { (fast_ms) "\u{a0}ms" }
                " at an error of " b { (fast_error) } "."
            }
        }
    }
}

impl Metric {
    /// The best of all entries as printed, so that equal texts are marked alike; none where all are equal.
    fn best(&self, entries: &[Entry]) -> Option<String> {
        let values = || entries.iter().filter_map(self.value);
        let (least, most) = (values().min_by(f64::total_cmp)?, values().max_by(f64::total_cmp)?);
        let (least, most) = ((self.text)(least), (self.text)(most));
        let best = if self.more_is_better { &most } else { &least };
        (least != most).then(|| best.clone())
    }

    fn cell(&self, entry: &Entry, best: Option<&String>, largest: f64) -> Markup {
        let Some(value) = (self.value)(entry) else {
            return html! { td title="The picture has no such pixels" { (text::DASH) } };
        };
        let text = (self.text)(value);
        let share = (value / largest).clamp(0.0, 1.0);
        html! {
            td class=[(best == Some(&text)).then_some("best")] data-value=(value) {
                (text)
                @if self.bar && share.is_finite() { i.bar style=(format!("--share:{share:.3}")) {} }
            }
        }
    }
}

fn table(report: &Comparison, labels: &[String]) -> Markup {
    let best: Vec<_> = METRICS.iter().map(|c| c.best(&report.entries)).collect();
    let largest = |c: &Metric| report.entries.iter().filter_map(c.value).fold(0.0, f64::max);
    html! {
        div.scroll {
            table {
                thead {
                    tr {
                        th scope="col" { button type="button" { "Technique" } }
                        @for column in &METRICS {
                            th scope="col" title=(column.help) data-more[column.more_is_better] {
                                button type="button" { (column.heading) }
                            }
                        }
                    }
                }
                tbody {
                    @for (i, (entry, label)) in report.entries.iter().zip(labels).enumerate() {
                        tr {
                            th scope="row" data-value=(label) { a href=(format!("#t{}", i + 1)) { (label) } }
                            @for (column, best) in METRICS.iter().zip(&best) {
                                (column.cell(entry, best.as_ref(), largest(column)))
                            }
                        }
                    }
                }
            }
        }
        @if report.entries.len() > 1 {
            p.hint { "The best value of each column is marked. Click a heading to sort; hover over it for an explanation." }
        }
    }
}

fn plot_of(report: &Comparison, labels: &[String]) -> Markup {
    let point = |(i, (entry, label)): (usize, (&Entry, &String))| Point {
        label: label.clone(),
        name: label.clone(),
        labelled: true,
        link: Some(format!("#t{}", i + 1)),
        group: None,
        ms: entry.cost.total_ms,
        error: entry.metrics.average_error,
    };
    let points: Vec<_> = report.entries.iter().zip(labels).enumerate().map(point).collect();
    html! {
        (scatter::plot(&points, &[]))
        @if points.len() > 1 { p.hint { "Filled: no other technique is both faster and nearer to the truth." } }
    }
}

/// The side-by-side view, which the script fills.
fn comparison(report: &Comparison, labels: &[String]) -> Markup {
    let nearest = least(report, |e| e.metrics.average_error) + 1;
    let choice = |id: &str, title: &str, chosen: usize| {
        html! {
            label { span { (title) }
                select id=(id) {
                    option value="0" selected[chosen == 0] { "truth" }
                    @for (i, label) in labels.iter().enumerate() {
                        option value=(i + 1) selected[chosen == i + 1] { (label) }
                    }
                }
            }
        }
    };
    html! {
        h2 { "Side by side" }
        div.controls {
            (choice("left", "Left", 0))
            button #swap type="button" title="Swap left and right" aria-label="Swap left and right" { "⇄" }
            (choice("right", "Right", nearest))
            div.choice role="group" aria-label="What to show" {
                @for (view, title) in [("picture", "Image"), ("visibility", "Visibility"), ("error", "Error")] {
                    button type="button" data-view=(view) aria-pressed=(view == "picture") { (title) }
                }
            }
            div.choice role="group" aria-label="Zoom" {
                @for (zoom, title) in [("1", "Fit"), ("2", "2×"), ("4", "4×"), ("8", "8×"), ("16", "16×")] {
                    button type="button" data-zoom=(zoom) aria-pressed=(zoom == "1") { (title) }
                }
            }
            button #blink type="button" aria-pressed="false" title="Show left and right in turn" { "Blink" }
        }
        div #stage tabindex="0" role="slider" aria-label="Visible part of the left image" aria-valuemin="0"
            aria-valuemax="100" aria-valuenow="50"
            style=(format!("--w:{};--h:{}", report.width, report.height)) {
            canvas {}
            span.name #left-name {}
            span.name #right-name {}
        }
        div.readout {
            output #probe { "Point at the image to read the values under the cursor." }
            div #legend hidden { (cards::color_bar()) }
        }
        p.hint {
            "Drag to wipe. Double-click or Ctrl + wheel zooms; when zoomed, drag off the line to move. "
            "Arrow keys wipe too."
        }
        noscript { p.notice { "The comparison needs JavaScript; tables and images below do not." } }
    }
}
