//! Lines that are broken at spaces, so that they fit into the columns of a terminal or of a picture.

/// Words that begin a line and say its kind: the rest of the line is a column of its own.
const LABELS: [&str; 11] =
    ["good", "fair", "off", "note", "try", "check", "data", "use", "do", "wrote", "next"];

/// Columns of a short label and the space behind it.
const LABEL: usize = 5;

/// Breaks lines that have more than `width` letters. Their rest stands below their text: below the second column of a list, behind a label, or as
/// far in as the line. A word that is longer than a line is broken behind a comma, or stays whole.
pub fn wrapped(text: &str, width: usize) -> String {
    let lines: Vec<String> = text.split('\n').map(|line| wrapped_line(line, width)).collect();
    lines.join("\n")
}

fn wrapped_line(line: &str, width: usize) -> String {
    if line.chars().count() <= width {
        return line.to_owned();
    }
    let hang = if 2 * hang(line) > width { 2 } else { hang(line) };
    let (mut wrapped, mut column) = (String::new(), 0);
    let mut rest = line;
    while !rest.is_empty() {
        let gap = rest.len() - rest.trim_start_matches(' ').len();
        let word = part(rest[gap..].split(' ').next().unwrap_or_default(), width, [column + gap, hang]);
        let letters = word.chars().count();
        if !wrapped.trim_start_matches(' ').is_empty() && column + gap + letters > width {
            wrapped += "\n";
            wrapped += &" ".repeat(hang);
            column = hang;
        } else {
            wrapped += &rest[..gap];
            column += gap;
        }
        wrapped += word;
        column += letters;
        rest = &rest[gap + word.len()..];
    }
    wrapped.trim_end_matches(' ').to_owned()
}

/// A word that fits into a line from the second column on; of a longer one the part up to a comma that fits into the room at the first
/// column, or into a line.
fn part(word: &str, width: usize, columns: [usize; 2]) -> &str {
    let [here, next] = columns.map(|column| width.saturating_sub(column));
    if word.chars().count() <= next {
        return word;
    }
    let up_to = |room: usize| {
        let commas = word.char_indices().take(room).filter(|(_, letter)| *letter == ',');
        commas.map(|(place, _)| &word[..=place]).last()
    };
    up_to(here).or_else(|| up_to(next)).unwrap_or(word)
}

/// The column at which a line goes on.
fn hang(line: &str) -> usize {
    let own = line.len() - line.trim_start_matches(' ').len();
    let text = &line[own..];
    let label = text.split(' ').next().unwrap_or_default();
    if own == 0 && LABELS.contains(&label) {
        return LABEL.max(label.len() + 1);
    }
    // A list: its second column begins behind two spaces, or behind a colon.
    let name = text.strip_prefix("- ").and_then(|rest| rest.find(": "));
    let Some(end) = name.map(|colon| colon + 3).or_else(|| text.find("  ")) else { return own };
    let gap = text[end..].len() - text[end..].trim_start_matches(' ').len();
    own + text[..end].chars().count() + gap
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_go_on_below_their_text_and_nothing_is_lost() {
        let words = "one two three four five six seven eight nine ten";
        for (begin, hang) in [
            ("off  ", 5),
            ("check ", 6),
            ("", 0),
            ("    ", 4),
            ("  --json      ", 14),
            ("  - red: ", 9),
            ("name        ", 12),
        ] {
            let line = format!("{begin}{words}");
            let found = wrapped(&line, 30);
            assert!(found.lines().count() > 1 && found.lines().all(|line| line.len() <= 30), "{found}");
            let next = found.lines().nth(1).unwrap();
            assert_eq!(next.len() - next.trim_start().len(), hang, "{found}");
            let all = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
            assert_eq!(all(&found), all(&line));
            assert_eq!(wrapped(&found, 30), found);
        }
        assert_eq!(wrapped("a\n\nb  c\n", 30), "a\n\nb  c\n");
        // A column that leaves no room, and a word that is too long.
        let far = format!("{}  {words}", "x".repeat(40));
        assert!(wrapped(&far, 44).lines().skip(1).all(|line| line.starts_with("  ") && line.len() <= 44));
        assert_eq!(wrapped(&"y".repeat(90), 44), "y".repeat(90));
        assert_eq!(wrapped("  one two,three,four five", 12), "  one two,\n  three,four\n  five");
        assert_eq!(wrapped("é é é é", 3), "é é\né é");
    }
}
