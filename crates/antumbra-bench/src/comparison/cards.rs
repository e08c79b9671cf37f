//! One card per technique: images, metrics, cost.

use super::columns::METRICS;
use super::images::Images;
use super::model::{Comparison, Entry};
use crate::measure::Pass;
use crate::page::{images, text};
use antumbra_metrics::{HEAT_SCALE, heat_color};
use maud::{Markup, html};

/// The card of the reference.
pub fn truth(report: &Comparison, images: &Images) -> Markup {
    let truth = &report.truth;
    html! {
        article.card #t0 {
            header { h3 { "truth" } p.title { "Ray-traced visibility of the light" } }
            div.gallery {
                (gallery(report, 0, images))
                p.note {
                    "The reference of every error: " (text::count(truth.light_samples.into()))
                    " shadow rays per pixel, shared among " (truth.pixel_samples) " primary rays. "
                    "Its own error is estimated at "
                    (text::metric(truth.error_estimate)) "; smaller differences are noise."
                }
            }
        }
    }
}

/// The card of one technique.
pub fn entry(report: &Comparison, entry: &Entry, label: &str, index: usize, images: &Images) -> Markup {
    html! {
        article.card id=(format!("t{index}")) {
            header {
                h3 { (label) }
                p.title { (entry.title) " " span.source { (entry.source) } }
                @if entry.spec != label { code.spec { (entry.spec) } }
                (settings(&entry.settings))
            }
            div.gallery { (gallery(report, index, images)) }
            div.details { (metrics(entry)) (cost(entry)) }
        }
    }
}

fn settings(settings: &serde_json::Value) -> Markup {
    let shown = |value: &serde_json::Value| match value {
        serde_json::Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    html! {
        @if let Some(settings) = settings.as_object().filter(|s| !s.is_empty()) {
            ul.settings { @for (key, value) in settings { li { (key) " " b { (shown(value)) } } } }
        }
    }
}

/// The images, embedded once; the side-by-side view refers to them.
fn gallery(report: &Comparison, index: usize, images: &Images) -> Markup {
    let files: Vec<_> = images.files().collect();
    let name = |kind: &str| match kind {
        "picture" => "Image",
        "visibility" => "Visibility",
        _ => "Error",
    };
    html! {
        @for (kind, file, png) in &files {
            figure {
                img.small[report.width < 400] id=(format!("t{index}-{kind}")) data-open=(index) data-kind=(kind)
                    width=(report.width) height=(report.height)
                    alt=(format!("{} of {}", name(kind), images.slug))
                    src=(images::embedded(png));
                figcaption {
                    span { (name(kind)) } a href=(format!("pictures/{file}")) { "PNG" }
                    @if *kind == "error" { (color_bar()) }
                }
            }
        }
    }
}

/// The legend of the heat map, with numbers.
pub fn color_bar() -> Markup {
    let stops: Vec<String> = (0..=16)
        .map(|i| heat_color((f64::from(i) / 8.0 - 1.0) * HEAT_SCALE))
        .map(|[r, g, b]| format!("rgb({r} {g} {b})"))
        .collect();
    html! {
        div.color-bar {
            i style=(format!("background:linear-gradient(to right,{})", stops.join(","))) {}
            div.ticks {
                span { "−" (HEAT_SCALE) " too dark" } span { "−" (HEAT_SCALE / 2.0) } span { "0" }
                span { "+" (HEAT_SCALE / 2.0) } span { "too light +" (HEAT_SCALE) }
            }
        }
    }
}

fn metrics(entry: &Entry) -> Markup {
    let (c, largest) = (&entry.metrics.counts, text::metric(entry.metrics.max));
    let classes = [("umbra", c.umbra), ("penumbra", c.penumbra), ("lit", c.lit)];
    html! {
        div {
            h4 { "Error" }
            dl.numbers {
                @for metric in &METRICS[..8] {
                    div title=(metric.help) { dt { (metric.heading) } dd { (text::or_dash(metric.of(entry))) } }
                }
                div { dt { "Largest error" } dd { (largest) } }
            }
            p.classes {
                (text::count(c.valid)) " valid pixels: "
                @for (i, (name, pixels)) in classes.iter().enumerate() {
                    @if i > 0 { ", " } (text::percent(*pixels, c.valid)) " " (name)
                }
            }
        }
    }
}

/// Milliseconds and memory, pass by pass.
fn cost(entry: &Entry) -> Markup {
    let own: Vec<&Pass> = entry.cost.passes.iter().filter(|pass| !pass.host).collect();
    let ms = |pass: &Pass| pass.ms.unwrap_or(f64::NAN);
    let all: f64 = own.iter().map(|pass| ms(pass)).sum();
    let width = |pass: &Pass| format!("width:{:.2}%", 100.0 * ms(pass) / all.max(f64::MIN_POSITIVE));
    let swatch = |pass: &Pass| match own.iter().position(|p| std::ptr::eq(*p, pass)) {
        Some(i) => format!("swatch c{}", i % 8),
        None => "swatch h".into(),
    };
    html! {
        div {
            h4 { "Cost" }
            p.total { b { (text::ms(entry.cost.total_ms)) } " ms" b { (text::megabytes(entry.cost.total_bytes)) } " MB" }
            div.passes-bar aria-hidden="true" {
                @for (i, pass) in own.iter().enumerate() {
                    i class=(format!("c{}", i % 8)) style=(width(pass)) title=(pass.name) {}
                }
            }
            table.passes {
                thead { tr { th { "Pass" } th { "ms" } th { "MB" } } }
                tbody {
                    @for pass in &entry.cost.passes {
                        tr.host[pass.host] {
                            th scope="row" {
                                i class=(swatch(pass)) {}
                                (pass.name) @if pass.host { small { " host's, not counted" } }
                            }
                            td { (text::ms(ms(pass))) } td { (text::megabytes(pass.bytes)) }
                        }
                    }
                }
            }
        }
    }
}
