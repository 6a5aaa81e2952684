//! A self-contained page of HTML: headings, paragraphs, tables, and pictures within the file itself.
//!
//! It asks nothing of a network: its style and its pictures are in it. All text is escaped.
//!
//! ```text
//! let mut page = Page::new("Error against run time");
//! page.heading("garnet_red");
//! page.paragraph("Sphere under haze.");
//! page.table(&Table { caption, head, rows: vec![vec![Cell::text("lobes"), Cell::number("1.00")]] });
//! page.row(&[Figure::new(png_of_first, "lobes"), Figure::new(png_of_second, "cosine")]);
//! page.write(path)?;
//! ```

use crate::out::output;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use srbf_core::printable_lines;
use std::path::Path;

/// Legible in a window 1280 pixels wide; a table or row that is wider is scrolled by itself.
const STYLE: &str = "\
:root { color-scheme: light; }
body { font: 16px/1.5 system-ui, sans-serif; color: #1a1a1a; background: #fff; max-width: 1240px; margin: 0 auto; padding: 0 16px 48px; }
h1 { font-size: 28px; margin: 24px 0 8px; }
h2 { font-size: 22px; margin: 36px 0 8px; border-bottom: 1px solid #ccc; }
h3 { font-size: 17px; margin: 24px 0 6px; }
p { max-width: 860px; margin: 8px 0; }
pre { background: #f4f4f4; padding: 8px 12px; overflow-x: auto; font-size: 14px; }
.wide { overflow-x: auto; margin: 12px 0; }
table { border-collapse: collapse; font-size: 14px; font-variant-numeric: tabular-nums; }
caption { caption-side: top; text-align: left; padding: 4px 0; color: #444; }
th, td { padding: 3px 10px; border-bottom: 1px solid #e2e2e2; text-align: left; }
td { max-width: 300px; }
thead th { border-bottom: 2px solid #888; vertical-align: bottom; }
th.number, td.number { text-align: right; }
td.number { white-space: nowrap; }
tbody tr:hover { background: #f3f7fb; }
.row { display: flex; flex-wrap: wrap; gap: 8px; margin: 12px 0; align-items: flex-start; }
figure { margin: 0; min-width: 0; max-width: 100%; }
figure img { display: block; margin-bottom: 4px; max-width: 100%; height: auto; }
figure img.pixels { image-rendering: pixelated; }
figcaption { font-size: 14px; line-height: 1.3; color: #333; }
details { margin: 12px 0; }
summary { cursor: pointer; font-weight: 600; }
";

/// A page that is made from top to bottom.
pub struct Page {
    title: String,
    body: Vec<Markup>,
}

/// A picture with its caption.
pub struct Figure {
    /// The bytes of PNG files, one above the other.
    pngs: Vec<Vec<u8>>,
    caption: String,
    /// How wide it is shown, in pixels; by itself as wide as it is.
    width: Option<u32>,
}

/// A table: what its columns are called, and its rows.
pub struct Table {
    /// What stands above it; may be empty.
    pub caption: String,
    pub head: Vec<Cell>,
    pub rows: Vec<Vec<Cell>>,
}

/// A cell of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cell {
    text: String,
    is_number: bool,
    is_bold: bool,
}

impl Cell {
    /// A word: it stands on the left.
    pub fn text(text: impl Into<String>) -> Self {
        Self { text: text.into(), is_number: false, is_bold: false }
    }

    /// A number: it stands on the right.
    pub fn number(text: impl Into<String>) -> Self {
        Self { is_number: true, ..Self::text(text) }
    }

    /// The same in bold, if so it should be.
    pub fn bold_if(self, is_bold: bool) -> Self {
        Self { is_bold, ..self }
    }

    fn class(&self) -> Option<&'static str> {
        self.is_number.then_some("number")
    }
}

impl Figure {
    /// A picture as large as it is, of the bytes of a PNG file.
    pub fn new(png: Vec<u8>, caption: impl Into<String>) -> Self {
        Self { pngs: vec![png], caption: caption.into(), width: None }
    }

    /// The same, `width` pixels wide; its own pixels then are squares.
    pub fn wide(self, width: u32) -> Self {
        Self { width: Some(width), ..self }
    }

    /// The same with another picture below it.
    pub fn above(mut self, png: Vec<u8>) -> Self {
        self.pngs.push(png);
        self
    }

    fn markup(&self) -> Markup {
        let class = self.width.map(|_| "pixels");
        let style = self.width.map(|width| format!("width: {width}px"));
        html! {
            figure style=[style] {
                @for png in &self.pngs {
                    @let source = format!("data:image/png;base64,{}", STANDARD.encode(png));
                    img src=(source) alt=(self.caption) class=[class] width=[self.width];
                }
                @if !self.caption.is_empty() { figcaption { (self.caption) } }
            }
        }
    }
}

impl Table {
    fn markup(&self) -> Markup {
        html! {
            div.wide { table {
                @if !self.caption.is_empty() { caption { (self.caption) } }
                thead { tr { @for cell in &self.head { th class=[cell.class()] { (cell.text) } } } }
                tbody { @for row in &self.rows { tr { @for cell in row {
                    td class=[cell.class()] { @if cell.is_bold { strong { (cell.text) } } @else { (cell.text) } }
                } } } }
            } }
        }
    }
}

impl Page {
    /// A page with a title, which is its first heading.
    pub fn new(title: impl Into<String>) -> Self {
        let title = title.into();
        Self { body: vec![html! { h1 { (title) } }], title }
    }

    /// A heading of a part.
    pub fn heading(&mut self, text: &str) {
        self.body.push(html! { h2 { (text) } });
    }

    /// A heading within a part.
    pub fn subheading(&mut self, text: &str) {
        self.body.push(html! { h3 { (text) } });
    }

    /// A paragraph.
    pub fn paragraph(&mut self, text: &str) {
        self.body.push(html! { p { (text) } });
    }

    /// Lines as they are, such as a command.
    pub fn lines(&mut self, text: &str) {
        self.body.push(html! { pre { (text) } });
    }

    /// A table.
    pub fn table(&mut self, table: &Table) {
        self.body.push(table.markup());
    }

    /// A table that is shown when its title is clicked.
    pub fn folded(&mut self, title: &str, table: &Table) {
        self.body.push(html! { details { summary { (title) } (table.markup()) } });
    }

    /// Pictures side by side; the rest continues below.
    pub fn row(&mut self, figures: &[Figure]) {
        self.body.push(html! { div.row { @for figure in figures { (figure.markup()) } } });
    }

    /// The page.
    pub fn to_html(&self) -> String {
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="generator" content="srbf";
                    title { (self.title) }
                    style { (PreEscaped(STYLE)) }
                }
                body { @for part in &self.body { (part) "\n" } }
            }
        };
        // No text of a stranger turns the order of reading.
        printable_lines(&page.into_string()).to_string()
    }

    /// Writes the page.
    ///
    /// # Errors
    /// Names the file.
    pub fn write(&self, path: &Path) -> anyhow::Result<()> {
        output::write(path, self.to_html().as_bytes())
    }
}

/// What of a page would be asked of a network, for tests: addresses, and sources that are not in the page itself.
#[cfg(test)]
pub fn asked_of_a_network(html: &str) -> Vec<String> {
    let addresses = ["http://", "https://", "url(", "@import", "<link", "<script"];
    let mut found: Vec<String> =
        addresses.iter().filter(|text| html.contains(*text)).map(|text| (*text).to_owned()).collect();
    for name in ["src=", "href=", "srcset="] {
        let outside = html.split(name).skip(1).filter(|rest| !rest.starts_with("\"data:image/png;base64,"));
        found.extend(outside.map(|rest| format!("{name}{}", rest.chars().take(60).collect::<String>())));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page() -> Page {
        let mut page = Page::new("a <b> & c");
        page.heading("\"part\"");
        page.subheading("within");
        page.paragraph("1 < 2");
        page.paragraph("\u{202e}backwards");
        page.lines("srbf compare\n  --spp 1");
        page.table(&Table {
            caption: "of <numbers>".into(),
            head: vec![Cell::text("sampler"), Cell::number("error")],
            rows: vec![vec![Cell::text("<i>"), Cell::number("1.5").bold_if(true)]],
        });
        page.folded("more <", &Table { caption: String::new(), head: vec![], rows: vec![] });
        page.row(&[
            Figure::new(vec![1, 2, 3], "\"><script>"),
            Figure::new(vec![0; 4], "").above(vec![5]).wide(320),
        ]);
        page
    }

    #[test]
    fn all_text_is_escaped_and_all_parts_are_there() {
        let html = page().to_html();
        assert!(html.starts_with("<!DOCTYPE html>"));
        for expected in [
            "<title>a &lt;b&gt; &amp; c</title>",
            "<h1>a &lt;b&gt; &amp; c</h1>",
            "<h2>&quot;part&quot;</h2>",
            "<p>1 &lt; 2</p>",
            "<p>\\u{202e}backwards</p>",
            "<pre>srbf compare\n  --spp 1</pre>",
            "<caption>of &lt;numbers&gt;</caption>",
            "<th class=\"number\">error</th>",
            "<td>&lt;i&gt;</td><td class=\"number\"><strong>1.5</strong></td>",
            "src=\"data:image/png;base64,AQID\" alt=\"&quot;&gt;&lt;script&gt;\"",
            "<figure style=\"width: 320px\"><img src=\"data:image/png;base64,AAAAAA==\" alt=\"\" class=\"pixels\" width=\"320\">",
            "src=\"data:image/png;base64,BQ==\"",
            "<details><summary>more &lt;</summary>",
        ] {
            assert!(html.contains(expected), "{expected}: {html}");
        }
    }

    #[test]
    fn nothing_is_asked_of_a_network() {
        assert_eq!(asked_of_a_network(&page().to_html()), [""; 0]);
        let outside = "<img src=\"picture.png\"><a href=\"https://x\">";
        assert_eq!(asked_of_a_network(outside).len(), 3);
    }
}
