//! What every page has: style, head, script.

use maud::{DOCTYPE, Markup, PreEscaped, html};

/// A page that needs nothing from outside. `scripts` run after the one that all pages have.
pub fn page(title: &str, header: Markup, main: Markup, footer: Markup, scripts: &[&str]) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) " · Antumbra" }
                style { (PreEscaped(include_str!("style.css"))) }
            }
            body {
                header { (header) }
                main { (main) }
                footer { (footer) }
                script {
                    (PreEscaped(include_str!("page.js")))
                    @for script in scripts { (PreEscaped(script)) }
                }
            }
        }
    };
    page.into_string()
}

/// The name of the house and the way to the page's parts and files.
pub fn brand(links: &[(&str, &str)]) -> Markup {
    html! {
        div.brand {
            span.mark aria-hidden="true" {}
            span { "Antumbra" }
            nav {
                @for (to, name) in links { a href=(to) { (name) } }
                button #scheme type="button" title="Light or dark" aria-label="Light or dark" { "◐" }
            }
        }
    }
}

/// Who computed, as one of the page's facts.
pub fn adapter(name: &str, software: bool) -> Markup {
    html! {
        div.wide {
            dt { "Adapter" }
            dd { (name) @if software { " " span.tag { "software" } } }
        }
    }
}

/// The command line that made the page.
pub fn command(line: &str) -> Markup {
    html! { div.command { code { (line) } button type="button" data-copy { "Copy" } } }
}

/// What milliseconds of a software adapter are worth.
pub fn software_notice() -> Markup {
    html! {
        p.notice {
            b { "Software adapter. " }
            "Absolute milliseconds of a software adapter say nothing about a GPU; compare ratios. "
            "Errors and memory hold everywhere."
        }
    }
}
