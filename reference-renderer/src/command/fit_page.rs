//! A fit as one page of HTML: the verdict, the picture, and the tables.

use crate::command::view_table;
use crate::out::output;
use crate::out::page::{Cell, Figure, Page, Table};
use srbf_fit::judge::report::{Report, ViewReport};
use std::path::Path;

/// The content of a page.
pub struct Subject<'a> {
    /// The name of the material.
    pub name: &'a str,
    /// Lines of the verdict.
    pub words: &'a [String],
    /// The report, if the fit was judged.
    pub report: Option<&'a Report>,
    /// The picture, a PNG file.
    pub picture: &'a Path,
    /// What to do next.
    pub next: Option<&'a str>,
}

/// Writes the page.
///
/// # Errors
/// Names the file that cannot be read or written.
pub fn write(path: &Path, subject: &Subject<'_>) -> anyhow::Result<()> {
    let mut page = Page::new(subject.name);
    if !subject.words.is_empty() {
        page.table(&verdict(subject.words));
    }
    if let Some(next) = subject.next {
        page.paragraph("Next:");
        page.lines(next);
    }
    page.heading("Picture");
    let png = output::read_back(subject.picture)?;
    page.row(&[Figure::new(png, "")]);
    if let Some(report) = subject.report {
        page.heading("Errors");
        page.paragraph(&view_table::LEGEND.replace('\n', " "));
        for (name, views) in [("Fitted views", &report.views), ("Views in between", &report.held_out)] {
            if !views.is_empty() {
                page.subheading(name);
                page.table(&errors(views));
            }
        }
    }
    page.write(path)
}

/// The lines of a verdict: their kind, and the sentence.
fn verdict(words: &[String]) -> Table {
    let row = |line: &String| {
        let (label, text) = line.split_once(' ').unwrap_or(("", line));
        vec![Cell::text(label).bold_if(true), Cell::text(text.trim())]
    };
    let head = vec![Cell::text(""), Cell::text("Verdict")];
    Table { caption: String::new(), head, rows: words.iter().map(row).collect() }
}

/// A row a view.
fn errors(views: &[ViewReport]) -> Table {
    let cells = |texts: Vec<String>| texts.into_iter().map(Cell::number).collect();
    Table {
        caption: String::new(),
        head: cells(view_table::names()),
        rows: views.iter().map(|view| cells(view_table::cells(view))).collect(),
    }
}
