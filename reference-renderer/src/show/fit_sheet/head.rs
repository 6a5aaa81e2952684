//! The head of the picture: the name of the material, the sentence of the verdict, and the names of curves and points.

use super::{ACCENT, FAIR, GOOD, INK, LETTERS, MARGIN, QUIET, Strip, Subject, WIDTH, text};
use crate::out::panel::FONT;
use crate::out::wrap::wrapped;
use plotters::prelude::*;

/// Height of the name, of its letters, and of a line, pixels.
const NAME: u32 = 56;
const LARGE: u32 = 32;
const LINE: u32 = 28;

/// Letters in a line, and their width over their height.
const COLUMNS: usize = 60;
const WIDE: f32 = 0.602;

/// How a verdict begins, and its colour.
const USES: [(&str, RGBColor); 3] = [("do not use it", ACCENT), ("use it with care", FAIR), ("use it", GOOD)];

/// The sentence of a verdict: the line that has no kind.
fn sentence(verdict: &[String]) -> Option<(&str, &str, RGBColor)> {
    verdict.iter().find_map(|line| {
        let (start, colour) = USES.into_iter().find(|(start, _)| line.starts_with(start))?;
        Some((start, &line[start.len()..], colour))
    })
}

/// Draws the head.
///
/// # Errors
/// Faults of the font.
pub fn draw(subject: &Subject<'_>) -> anyhow::Result<Strip> {
    let found = sentence(subject.verdict);
    let lines =
        found.map_or_else(String::new, |(start, rest, _)| wrapped(&format!("{start}{rest}"), COLUMNS));
    let lines: Vec<&str> = lines.lines().map(str::trim_start).collect();
    let mut block = Strip::paper([WIDTH, NAME + LINE * (lines.len() as u32 + 2)]);
    block.draw(|root| {
        let style = TextStyle::from((FONT, LARGE).into_font()).color(&ACCENT);
        root.draw_text(&cut(subject.name), &style, (MARGIN as i32, 14))?;
        for (n, line) in lines.iter().enumerate() {
            text(root, line, INK, [MARGIN, NAME + LINE * n as u32])?;
        }
        // Over the same letters.
        if let Some((start, _, colour)) = found {
            for shift in [0, 1] {
                text(root, start, colour, [MARGIN + shift, NAME])?;
            }
        }
        let below = NAME + LINE * lines.len() as u32 + LINE / 2;
        let mut left = MARGIN;
        for (name, colour, is_point) in entries(subject) {
            let middle = (below + LETTERS / 2) as i32;
            let (from, to) = (left as i32, left as i32 + 28);
            if is_point {
                root.draw(&Circle::new((from + 14, middle), 5, colour.filled()))?;
            } else {
                root.draw(&PathElement::new([(from, middle), (to, middle)], colour.stroke_width(4)))?;
            }
            text(root, name, QUIET, [left + 38, below])?;
            left += 38 + (name.len() as f32 * WIDE * LETTERS as f32) as u32 + 28;
        }
        text(root, "f cos, 1/sr", QUIET, [left, below])
    })?;
    Ok(block)
}

/// A name that fits into a line.
fn cut(name: &str) -> String {
    let most = ((WIDTH - 2 * MARGIN) as f32 / (WIDE * LARGE as f32)) as usize;
    match name.char_indices().nth(most) {
        Some((end, _)) => format!("{}...", &name[..end].chars().take(most - 3).collect::<String>()),
        None => name.to_owned(),
    }
}

/// The names of curves and points, with colour, and whether they are points.
fn entries<'a>(subject: &Subject<'a>) -> Vec<(&'a str, RGBColor, bool)> {
    let mut entries = vec![("fit", ACCENT, false)];
    if let Some(against) = &subject.against {
        entries.push((against.name, QUIET, false));
        if against.samples.is_some() {
            entries.push(("samples", INK, true));
        }
    }
    entries
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sentence_of_a_verdict_is_found_and_names_are_cut() {
        let lines = ["note a", "do not use it as a whole: b", "good c"].map(str::to_owned);
        assert_eq!(sentence(&lines), Some(("do not use it", " as a whole: b", ACCENT)));
        assert_eq!(sentence(&["use it".to_owned()]), Some(("use it", "", GOOD)));
        assert_eq!(sentence(&["use it with care".to_owned()]), Some(("use it with care", "", FAIR)));
        assert_eq!(sentence(&["off  c".to_owned()]), None);
        assert_eq!(cut("paint"), "paint");
        assert!(cut(&"é".repeat(100)).ends_with("...") && cut(&"é".repeat(100)).chars().count() < 42);
    }
}
