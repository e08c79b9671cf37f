//! The tables of a suite as text: Markdown to paste into a document, and lines for the terminal.

use super::{Context, Findings, Shown, Table};
use crate::table;

/// Everything but the plots.
pub fn document(context: &Context, findings: &Findings) -> String {
    let Context { suite, title, source, adapter, command, .. } = context;
    let software = if context.software { ", a software adapter: its milliseconds say nothing about a GPU" } else { "" };
    let clock = match findings.trials.is_empty() {
        true => String::new(),
        false => format!(" Milliseconds: {}, {}.", findings.clock(), context.counted()),
    };
    let mut text = format!(
        "## {title} [{source}]\n\nMeasured on {}{software}.{clock} Made by\n\n    {command}\n\n{}\n",
        escaped(adapter),
        findings.lead
    );
    for part in &findings.parts {
        let tables = part.shown.iter().filter_map(|shown| match shown {
            Shown::Table(table) => Some(markdown(table)),
            _ => None,
        });
        let tables: Vec<String> = tables.collect();
        if !tables.is_empty() {
            text += &format!("\n### {}\n\n{}\n\n{}", part.title, part.text, tables.join("\n"));
        }
    }
    text + &format!(
        "\nPlots and pictures are in `{suite}.html`, every measurement in `{suite}.csv` and `{suite}.json`.\n"
    )
}

fn markdown(table: &Table) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut text = line(table.heads.iter().map(|(head, _)| escaped(head)).collect());
    text += &format!("|---|{}\n", "--:|".repeat(table.heads.len().saturating_sub(1)));
    for group in &table.groups {
        if !group.title.is_empty() {
            let rest = table.heads.iter().skip(1).map(|_| String::new());
            text += &line(std::iter::once(format!("**{}**", escaped(&group.title))).chain(rest).collect());
        }
        for row in &group.rows {
            // A name is a SPEC, which is typed.
            let name = row.first().map(|name| format!("`{name}`"));
            text += &line(name.into_iter().chain(row.iter().skip(1).map(|cell| escaped(cell))).collect());
        }
    }
    text
}

/// Text in which Markdown sees nothing.
fn escaped(text: &str) -> String {
    text.chars().flat_map(|c| ['|', '*', '_', '<', '`'].contains(&c).then_some('\\').into_iter().chain([c])).collect()
}

/// The tables of a suite for the terminal.
pub fn terminal(findings: &Findings) -> String {
    let mut text = String::new();
    for part in &findings.parts {
        for shown in &part.shown {
            if let Shown::Table(table) = shown {
                text += &format!("{}\n\n{}\n", part.title, lines(table));
            }
        }
    }
    if findings.clock().contains('*') { text + table::WALL } else { text }
}

/// All groups with common columns; their titles on lines of their own.
fn lines(table: &Table) -> String {
    let heads = table.heads.iter().map(|(head, _)| (*head).to_owned()).collect();
    let rows: Vec<Vec<String>> =
        std::iter::once(heads).chain(table.groups.iter().flat_map(|g| g.rows.iter().cloned())).collect();
    let aligned = table::aligned(&rows);
    let mut lines = aligned.lines();
    let mut text = format!("{}\n", lines.next().unwrap_or_default());
    for group in &table.groups {
        text += &format!("{}\n", group.title);
        text.extend(lines.by_ref().take(group.rows.len()).map(|line| format!("{line}\n")));
    }
    text
}
