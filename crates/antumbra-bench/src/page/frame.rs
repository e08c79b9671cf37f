//! Frame of every page: style, head, script.

use maud::{DOCTYPE, Markup, PreEscaped, html};

/// A self-contained page. `scripts` run after the script of all pages.
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

/// The project's name and links to the page's sections and files.
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

/// The adapter, as one of the page's facts.
pub fn adapter(name: &str, software: bool) -> Markup {
    html! {
        div.wide {
            dt { "Adapter" }
            dd { (name) @if software { " " span.tag { "software" } } }
        }
    }
}

/// The command line that produced the page.
pub fn command(line: &str) -> Markup {
    html! { div.command { code { (line) } button type="button" data-copy { "Copy" } } }
}

/// Notice about milliseconds of a software adapter.
pub fn software_notice() -> Markup {
    html! {
        p.notice {
            b { "Software adapter. " }
            "Absolute milliseconds of a software adapter say nothing about a GPU; compare ratios. "
            "Errors and memory hold everywhere."
        }
    }
}
