//! Rewriting of calls, words and numbers in a text. It imports nothing.

/// A line as code and comment.
pub fn split(line: &str) -> (&str, &str) {
    line.find("//").map_or((line, ""), |at| line.split_at(at))
}

/// Replaces every call of a function, the last one first, so that what stands inside another is done before it.
pub fn rewrite(text: &str, name: &str, make: impl Fn(&[&str]) -> String) -> String {
    let mut text = text.to_owned();
    let open = format!("{name}(");
    while let Some(at) = text.rfind(&open) {
        let first = at + open.len();
        let (mut depth, mut start, mut arguments, mut end) = (0, first, Vec::new(), text.len());
        for (i, c) in text[first..].char_indices().map(|(i, c)| (first + i, c)) {
            match c {
                '(' | '[' => depth += 1,
                ',' if depth == 0 => {
                    arguments.push(text[start..i].trim());
                    start = i + 1;
                }
                ')' if depth == 0 => {
                    arguments.push(text[start..i].trim());
                    end = i + 1;
                    break;
                }
                ')' | ']' => depth -= 1,
                _ => {}
            }
        }
        let made = make(&arguments);
        text.replace_range(at..end, &made);
    }
    text
}

/// Whether a character may stand in a name.
pub fn is_of_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// Replaces a word, where it is a whole one; it may end in a character of no name, such as a bracket.
pub fn replace_word(text: &str, word: &str, by: &str) -> String {
    let mut made = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find(word) {
        let (before, after) = (&rest[..at], &rest[at + word.len()..]);
        let ends = !word.ends_with(is_of_name) || !after.starts_with(is_of_name);
        let is_whole = !before.ends_with(is_of_name) && ends;
        made.push_str(before);
        made.push_str(if is_whole { by } else { word });
        rest = after;
    }
    made + rest
}

/// Gives every floating-point number the suffix that C++ asks for.
pub fn suffix_numbers(code: &str) -> String {
    let mut made = String::with_capacity(code.len());
    let mut rest = code;
    while let Some(at) = rest.find(|c: char| c.is_ascii_digit()) {
        let is_of_word = rest[..at].ends_with(|c: char| is_of_name(c) || c == '.');
        let tail = &rest[at..];
        let digits = |text: &str| text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
        let mut end = digits(tail);
        let mut is_float = false;
        if tail[end..].starts_with('.') {
            is_float = true;
            end += 1 + digits(&tail[end + 1..]);
        }
        if tail[end..].starts_with('e') {
            is_float = true;
            end += 2 + digits(&tail[end + 2..]);
        }
        made.push_str(&rest[..at + end]);
        if is_float && !is_of_word {
            made.push('f');
        }
        rest = &tail[end..];
    }
    made + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calls_in_calls_are_rewritten() {
        let swap = |a: &[&str]| format!("<{} {}>", a[1], a[0]);
        assert_eq!(rewrite("x = F(a, F(b[1, 2], c(d, e)));", "F", swap), "x = <<c(d, e) b[1, 2]> a>;");
    }

    #[test]
    fn words_are_whole_ones() {
        assert_eq!(replace_word("vec3 a_vec3 vec3(1)", "vec3", "V"), "V a_vec3 V(1)");
    }

    #[test]
    fn numbers_get_their_suffix() {
        let text = "1.0 + a2 * 3 - 1e-30 / b.x1 - 2.5e3, 1023u";
        assert_eq!(suffix_numbers(text), "1.0f + a2 * 3 - 1e-30f / b.x1 - 2.5e3f, 1023u");
    }
}
