//! The page: head, table, plot and the frame of the comparison.

use antumbra_metrics::Figures;
use maud::{Markup, html};

use super::pictures::Pictures;
use super::plot::{self, Point};
use super::{Entry, Report, cards, frame, text};

/// The whole page, needing nothing else.
pub fn html(report: &Report, pictures: &[Pictures]) -> String {
    let labels = report.labels();
    let main = html! {
        section #figures.figures { (lead(report, &labels)) (table(report, &labels)) }
        section #plot.framed { h2 { "Error against cost" } (plot_of(report, &labels)) }
        section #compare { (comparison(report, &labels)) }
        section #techniques {
            h2 { "Every technique" }
            (cards::truth(report, &pictures[0]))
            @for (i, entry) in report.entries.iter().enumerate() {
                (cards::entry(report, entry, &labels[i], i + 1, &pictures[i + 1]))
            }
        }
    };
    let footer = html! {
        p {
            "The same figures as " a href="results.json" { "JSON" } " and " a href="results.csv" { "CSV" }
            "; the pictures as files in " a href="pictures/" { "pictures" } "."
        }
    };
    frame::page(&report.scene, header(report), main, footer, &[include_str!("compare.js")])
}

fn header(report: &Report) -> Markup {
    let truth = &report.truth;
    let links = [
        ("#figures", "Figures"),
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
            div { dt { "Pictures" } dd { (report.width) " × " (report.height) } }
            (frame::adapter(&report.adapter, report.software))
            div.wide {
                dt { "Truth" }
                dd {
                    (text::count(truth.light_samples.into())) " shadow rays and " (truth.pixel_samples)
                    " sub-pixels a pixel, ± " (text::figure(truth.error_estimate)) ", traced in "
                    (text::seconds(truth.seconds))
                }
            }
        }
        (frame::command(&report.command))
        @if report.software { (frame::software_notice()) }
    }
}

/// Index of the entry with the smallest key.
fn least(report: &Report, key: impl Fn(&Entry) -> f64) -> usize {
    let keys = report.entries.iter().map(key).enumerate();
    keys.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(i, _)| i)
}

/// What the table says, in a sentence.
fn lead(report: &Report, labels: &[String]) -> Markup {
    let nearest = least(report, |e| e.figures.average_error);
    let fastest = least(report, |e| e.total_ms);
    let said = |i: usize| {
        (&labels[i], text::figure(report.entries[i].figures.average_error), text::ms(report.entries[i].total_ms))
    };
    let ((near, near_error, near_ms), (fast, fast_error, fast_ms)) = (said(nearest), said(fastest));
    html! {
        h2 { "Figures" }
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

/// A column of numbers: title, explanation, value, as text, and whether more is better.
struct Column {
    title: &'static str,
    about: &'static str,
    value: fn(&Entry) -> Option<f64>,
    text: fn(f64) -> String,
    more_is_better: bool,
    bar: bool,
}

/// A mean over a class without pixels is no figure.
fn of_class(pixels: u64, value: f64) -> Option<f64> {
    (pixels > 0).then_some(value)
}

const COLUMNS: [Column; 9] = {
    const fn figure(title: &'static str, about: &'static str, value: fn(&Entry) -> Option<f64>) -> Column {
        Column { title, about, value, text: text::figure, more_is_better: false, bar: false }
    }
    [
        Column {
            bar: true,
            ..figure("Average error", "Mean |error| where the truth is under 0.999: shadow and penumbra", |e| {
                of_class(e.figures.counts.shadowed, e.figures.average_error)
            })
        },
        figure("RMSE", "Root of the mean squared error, all valid pixels", |e| Some(e.figures.rmse)),
        figure("p99", "|error| that 99 % of the valid pixels do not exceed", |e| Some(e.figures.p99)),
        figure("Leak", "Light in the umbra: mean visibility where the truth is under 0.001", |e| {
            of_class(e.figures.counts.umbra, e.figures.leak)
        }),
        figure("Acne", "False darkness: mean of 1 - visibility where the truth is over 0.999", |e| {
            of_class(e.figures.counts.lit, e.figures.acne)
        }),
        Column {
            more_is_better: true,
            ..figure("SSIM", "Structural similarity; 1 is equal", |e| Some(e.figures.ssim))
        },
        figure("FLIP", "Mean FLIP error: what the eye notices; 0 is equal", |e| Some(e.figures.flip)),
        Column {
            text: text::ms,
            bar: true,
            ..figure("ms", "GPU milliseconds of the shadow alone", |e| Some(e.total_ms))
        },
        Column {
            text: |bytes| text::megabytes(bytes as u64),
            ..figure("MB", "GPU memory that the technique owns, 10⁶ bytes", |e| Some(e.total_bytes as f64))
        },
    ]
};

impl Column {
    /// The best of all entries, as it is printed, so that equals are marked alike; none where all are equal.
    fn best(&self, entries: &[Entry]) -> Option<String> {
        let values = || entries.iter().filter_map(self.value);
        let (least, most) = (values().min_by(f64::total_cmp)?, values().max_by(f64::total_cmp)?);
        let (least, most) = ((self.text)(least), (self.text)(most));
        let best = if self.more_is_better { &most } else { &least };
        (least != most).then(|| best.clone())
    }

    fn cell(&self, entry: &Entry, best: Option<&String>, largest: f64) -> Markup {
        let Some(value) = (self.value)(entry) else {
            return html! { td title="The picture has no such pixels" { "–" } };
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

fn table(report: &Report, labels: &[String]) -> Markup {
    let best: Vec<_> = COLUMNS.iter().map(|c| c.best(&report.entries)).collect();
    let largest = |c: &Column| report.entries.iter().filter_map(c.value).fold(0.0, f64::max);
    html! {
        div.scroll {
            table {
                thead {
                    tr {
                        th scope="col" { button type="button" { "Technique" } }
                        @for column in &COLUMNS {
                            th scope="col" title=(column.about) data-more[column.more_is_better] {
                                button type="button" { (column.title) }
                            }
                        }
                    }
                }
                tbody {
                    @for (i, (entry, label)) in report.entries.iter().zip(labels).enumerate() {
                        tr {
                            th scope="row" data-value=(label) { a href=(format!("#t{}", i + 1)) { (label) } }
                            @for (column, best) in COLUMNS.iter().zip(&best) {
                                (column.cell(entry, best.as_ref(), largest(column)))
                            }
                        }
                    }
                }
            }
        }
        @if report.entries.len() > 1 {
            p.hint { "The best of each column is marked. Click a heading to sort; rest on it for what it means." }
        }
    }
}

fn plot_of(report: &Report, labels: &[String]) -> Markup {
    let point = |(i, (entry, label)): (usize, (&Entry, &String))| {
        let Figures { average_error: error, .. } = entry.figures;
        let link = Some(format!("#t{}", i + 1));
        Point {
            label: label.clone(),
            name: label.clone(),
            labelled: true,
            link,
            group: None,
            ms: entry.total_ms,
            error,
        }
    };
    let points: Vec<_> = report.entries.iter().zip(labels).enumerate().map(point).collect();
    html! {
        (plot::scatter(&points, &[]))
        @if points.len() > 1 { p.hint { "Filled: nothing else is both faster and nearer to the truth." } }
    }
}

/// The frame that the script fills.
fn comparison(report: &Report, labels: &[String]) -> Markup {
    let nearest = least(report, |e| e.figures.average_error) + 1;
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
                @for (view, title) in [("picture", "Picture"), ("visibility", "Visibility"), ("error", "Error")] {
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
        div #stage tabindex="0" role="slider" aria-label="How much of the left picture is seen" aria-valuemin="0"
            aria-valuemax="100" aria-valuenow="50"
            style=(format!("--w:{};--h:{}", report.width, report.height)) {
            canvas {}
            span.name #left-name {}
            span.name #right-name {}
        }
        div.readout {
            output #probe { "Point at the picture to read the values under the cursor." }
            div #legend hidden { (cards::color_bar()) }
        }
        p.hint {
            "Drag to wipe. Double-click or Ctrl + wheel zooms; when zoomed, drag off the line to move. "
            "Arrow keys wipe too."
        }
        noscript { p.notice { "The comparison needs JavaScript; tables and pictures below do not." } }
    }
}
