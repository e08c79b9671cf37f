//! Tables made of columns: one declaration per column serves HTML, Markdown, the terminal and CSV.

use maud::{Markup, html};

/// A column of a table whose rows are made of `R`.
pub struct Column<R> {
    heading: Heading,
    cell: Box<dyn Fn(&R) -> String>,
}

/// Heading of a column.
#[derive(Clone, Copy)]
pub struct Heading {
    /// Short name.
    pub name: &'static str,
    /// Explanation.
    pub help: &'static str,
    /// Unit; empty for numbers without one and for names.
    pub unit: &'static str,
}

/// Declares a column: heading, explanation, unit, cell of a row.
pub fn column<R>(
    name: &'static str,
    help: &'static str,
    unit: &'static str,
    cell: impl Fn(&R) -> String + 'static,
) -> Column<R> {
    Column { heading: Heading { name, help, unit }, cell: Box::new(cell) }
}

/// A table of text. The first column has names, the others numbers.
pub struct Table {
    /// Headings of the columns.
    pub headings: Vec<Heading>,
    /// Rows under their titles.
    pub groups: Vec<Group>,
}

/// Rows under a common title.
pub struct Group {
    /// The title; may be empty.
    pub title: String,
    /// One cell per column in each row.
    pub rows: Vec<Vec<String>>,
}

fn cells<R>(columns: &[Column<R>], row: &R) -> Vec<String> {
    columns.iter().map(|column| (column.cell)(row)).collect()
}

impl Table {
    /// A table of titled groups of rows.
    pub fn grouped<R, Rows: IntoIterator<Item = R>>(
        columns: &[Column<R>],
        groups: impl IntoIterator<Item = (String, Rows)>,
    ) -> Table {
        let group = |(title, rows): (String, Rows)| Group {
            title,
            rows: rows.into_iter().map(|row| cells(columns, &row)).collect(),
        };
        let headings = columns.iter().map(|column| column.heading).collect();
        Table { headings, groups: groups.into_iter().map(group).collect() }
    }

    /// A table of a single group under this title, which may be empty.
    pub fn new<R>(columns: &[Column<R>], title: impl Into<String>, rows: impl IntoIterator<Item = R>) -> Table {
        Table::grouped(columns, [(title.into(), rows)])
    }

    /// All rows, without titles.
    pub fn rows(&self) -> impl Iterator<Item = &Vec<String>> {
        self.groups.iter().flat_map(|group| &group.rows)
    }

    /// The table of a page. Explanation and unit are tooltips of the headings.
    pub fn html(&self) -> Markup {
        let tip = |h: &Heading| match h.unit {
            "" => h.help.to_owned(),
            unit => format!("{} [{unit}]", h.help),
        };
        html! {
            div.scroll {
                table {
                    thead { tr { @for heading in &self.headings { th scope="col" title=(tip(heading)) { (heading.name) } } } }
                    @for group in &self.groups {
                        tbody {
                            @if !group.title.is_empty() {
                                tr.group { th scope="rowgroup" colspan=(self.headings.len()) { (group.title) } }
                            }
                            @for row in &group.rows {
                                tr {
                                    @for (i, cell) in row.iter().enumerate() {
                                        @if i == 0 { th.spelled scope="row" { (breakable(cell)) } } @else { td { (cell) } }
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }

    /// The table in Markdown.
    pub fn markdown(&self) -> String {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let mut text = line(self.headings.iter().map(|heading| escaped(heading.name)).collect());
        text += &format!("|---|{}\n", "--:|".repeat(self.headings.len().saturating_sub(1)));
        for group in &self.groups {
            if !group.title.is_empty() {
                let mut cells = vec![String::new(); self.headings.len()];
                cells[0] = format!("**{}**", escaped(&group.title));
                text += &line(cells);
            }
            for row in &group.rows {
                // The name is a SPEC, which a user types.
                let cell = |(i, cell): (usize, &String)| if i == 0 { format!("`{cell}`") } else { escaped(cell) };
                text += &line(row.iter().enumerate().map(cell).collect());
            }
        }
        text
    }

    /// The table for a terminal: aligned columns, titles on lines of their own.
    pub fn terminal(&self) -> String {
        let headings = self.headings.iter().map(|heading| heading.name.to_owned()).collect();
        let rows: Vec<&Vec<String>> = std::iter::once(&headings).chain(self.rows()).collect();
        let length = |row: &Vec<String>, c: usize| row.get(c).map_or(0, |cell| cell.chars().count());
        let width = |c| rows.iter().map(|row| length(row, c)).max().unwrap_or(0);
        let widths: Vec<usize> = (0..self.headings.len()).map(width).collect();
        let mut text = line(&headings, &widths);
        for group in &self.groups {
            if !group.title.is_empty() {
                text += &format!("{}\n", group.title);
            }
            text.extend(group.rows.iter().map(|row| line(row, &widths)));
        }
        text
    }

    /// The table as CSV, without the titles.
    pub fn csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(self.headings.iter().map(|heading| heading.name))?;
        self.rows().try_for_each(|row| writer.write_record(row))?;
        writer.into_inner().map_err(|e| e.into_error().into())
    }
}

/// Cells of a terminal's line: the first column is left-aligned, numbers are right-aligned.
fn line(row: &[String], widths: &[usize]) -> String {
    let cells = row.iter().zip(widths).enumerate().map(|(c, (cell, &width))| match c {
        0 => format!("{cell:<width$}"),
        _ => format!("{cell:>width$}"),
    });
    cells.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
}

/// Text without Markdown's special characters.
pub(crate) fn escaped(text: &str) -> String {
    text.chars().flat_map(|c| ['|', '*', '_', '<', '`'].contains(&c).then_some('\\').into_iter().chain([c])).collect()
}

/// A SPEC, which may continue on another line after a comma.
pub(crate) fn breakable(spec: &str) -> Markup {
    html! { code { @for part in spec.split_inclusive(',') { (part) wbr; } } }
}
