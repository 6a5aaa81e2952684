//! Lines of text as a block.

use super::{Strip, WIDTH};
use crate::out::panel::{FONT, Failure, register_font};
use anyhow::anyhow;
use plotters::prelude::*;

/// Height of a line and of its letters, free pixels on each side, and letters in a line.
const LINE: u32 = 20;
const LETTERS: u32 = 14;
const MARGIN: u32 = 12;
const COLUMNS: usize = 145;

/// Draws lines; a longer one continues in the next, below its second word.
///
/// # Errors
/// Faults of the font.
pub fn draw(lines: &[String]) -> anyhow::Result<Strip> {
    let lines: Vec<String> = lines.iter().flat_map(|line| wrapped(line)).collect();
    let mut block = Strip::white([WIDTH, 2 * MARGIN + LINE * lines.len() as u32]);
    write(&mut block, &lines).map_err(|error| anyhow!("cannot write the verdict: {error}"))?;
    Ok(block)
}

fn write(block: &mut Strip, lines: &[String]) -> Result<(), Failure> {
    register_font()?;
    let root = BitMapBackend::with_buffer(&mut block.rgb, block.size.into()).into_drawing_area();
    let style = TextStyle::from((FONT, LETTERS).into_font()).color(&BLACK);
    for (n, line) in lines.iter().enumerate() {
        root.draw_text(line, &style, (MARGIN as i32, (MARGIN + LINE * n as u32) as i32))?;
    }
    root.present()?;
    Ok(())
}

fn wrapped(line: &str) -> Vec<String> {
    let indent = " ".repeat(5);
    let mut lines = vec![String::new()];
    // The label is as wide as the indent, so that its spaces are kept.
    let (label, text) = line.split_at_checked(indent.len()).unwrap_or(("", line));
    for word in text.split_whitespace() {
        let last = lines.len() - 1;
        if lines[last].chars().count() + word.chars().count() >= COLUMNS - indent.len() {
            lines.push(word.to_owned());
        } else {
            let space = if lines[last].is_empty() { "" } else { " " };
            lines[last] += &format!("{space}{word}");
        }
    }
    let label = |n: usize| if n == 0 { label } else { &indent };
    lines.iter().enumerate().map(|(n, text)| format!("{}{text}", label(n))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_go_on_below_their_text_and_nothing_is_lost() {
        let line = format!("off  {}", "word ".repeat(60).trim_end());
        let found = wrapped(&line);
        assert_eq!(found.len(), 3);
        assert!(found[0].starts_with("off  word") && found[1].starts_with("     word"));
        assert!(found.iter().all(|line| line.len() <= COLUMNS));
        assert_eq!(found.join(" ").matches("word").count(), 60);
        assert_eq!(wrapped(""), [""]);
        let block = draw(&[line]).unwrap();
        assert_eq!(block.size, [WIDTH, 2 * MARGIN + 3 * LINE]);
        assert!(block.rgb.iter().filter(|&&v| v < 128).count() > 1000, "no letters");
    }
}
