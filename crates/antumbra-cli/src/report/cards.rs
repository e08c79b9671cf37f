//! One card a technique: pictures, figures, cost.

use antumbra_metrics::{HEAT_SCALE, heat_color};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use maud::{Markup, html};

use super::pictures::Pictures;
use super::{Entry, Pass, Report, text};

/// The truth's own card.
pub fn truth(report: &Report, pictures: &Pictures) -> Markup {
    let truth = &report.truth;
    html! {
        article.card #t0 {
            header { h3 { "truth" } p.title { "Ray-traced visibility of the light" } }
            div.gallery {
                (gallery(report, 0, pictures))
                p.note {
                    "What every figure is measured by: " (text::count(truth.light_samples.into()))
                    " shadow rays a pixel, shared among " (truth.pixel_samples) " sub-pixels. "
                    "Its own error is estimated at "
                    (text::figure(truth.error_estimate)) "; differences below that mean nothing."
                }
            }
        }
    }
}

/// The card of one technique.
pub fn entry(report: &Report, entry: &Entry, label: &str, index: usize, pictures: &Pictures) -> Markup {
    html! {
        article.card id=(format!("t{index}")) {
            header {
                h3 { (label) }
                p.title { (entry.title) " " span.source { (entry.source) } }
                @if entry.spec != label { code.spec { (entry.spec) } }
                (settings(&entry.settings))
            }
            div.gallery { (gallery(report, index, pictures)) }
            div.details { (figures(entry)) (cost(entry)) }
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

/// The pictures, embedded once; the comparison takes them from here.
fn gallery(report: &Report, index: usize, pictures: &Pictures) -> Markup {
    let files: Vec<_> = pictures.files().collect();
    let name = |kind: &str| match kind {
        "picture" => "Picture",
        "visibility" => "Visibility",
        _ => "Error",
    };
    html! {
        @for (kind, file, png) in &files {
            figure {
                img.small[report.width < 400] id=(format!("t{index}-{kind}")) data-open=(index) data-kind=(kind)
                    width=(report.width) height=(report.height)
                    alt=(format!("{} of {}", name(kind), pictures.slug))
                    src=(format!("data:image/png;base64,{}", BASE64_STANDARD.encode(png)));
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

fn figures(entry: &Entry) -> Markup {
    let (f, c) = (&entry.figures, &entry.figures.counts);
    let or_dash = |pixels: u64, value: f64| if pixels > 0 { text::figure(value) } else { "–".into() };
    let rows = [
        ("Average error", "in shadow", or_dash(c.shadowed, f.average_error)),
        ("RMSE", "all valid pixels", text::figure(f.rmse)),
        ("99th percentile", "of |error|", text::figure(f.p99)),
        ("Largest error", "", text::figure(f.max)),
        ("Leak", "light in the umbra", or_dash(c.umbra, f.leak)),
        ("Acne", "darkness where lit", or_dash(c.lit, f.acne)),
        ("SSIM", "1 is equal", text::figure(f.ssim)),
        ("FLIP", "0 is equal", text::figure(f.flip)),
    ];
    let classes = [("umbra", c.umbra), ("penumbra", c.penumbra), ("lit", c.lit)];
    html! {
        div {
            h4 { "Error" }
            dl.numbers {
                @for (name, about, value) in rows { div { dt { (name) " " small { (about) } } dd { (value) } } }
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
    let own: Vec<&Pass> = entry.passes.iter().filter(|pass| !pass.host).collect();
    let all: f64 = own.iter().map(|pass| pass.ms).sum();
    let width = |pass: &Pass| format!("width:{:.2}%", 100.0 * pass.ms / all.max(f64::MIN_POSITIVE));
    let swatch = |pass: &Pass| match own.iter().position(|p| std::ptr::eq(*p, pass)) {
        Some(i) => format!("swatch c{}", i % 8),
        None => "swatch h".into(),
    };
    html! {
        div {
            h4 { "Cost" }
            p.total { b { (text::ms(entry.total_ms)) } " ms" b { (text::megabytes(entry.total_bytes)) } " MB" }
            div.passes-bar aria-hidden="true" {
                @for (i, pass) in own.iter().enumerate() {
                    i class=(format!("c{}", i % 8)) style=(width(pass)) title=(pass.name) {}
                }
            }
            table.passes {
                thead { tr { th { "Pass" } th { "ms" } th { "MB" } } }
                tbody {
                    @for pass in &entry.passes {
                        tr.host[pass.host] {
                            th scope="row" {
                                i class=(swatch(pass)) {}
                                (pass.name) @if pass.host { small { " host's, not counted" } }
                            }
                            td { (text::ms(pass.ms)) } td { (text::megabytes(pass.bytes)) }
                        }
                    }
                }
            }
        }
    }
}
