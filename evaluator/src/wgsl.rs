//! Declarations as WGSL has them: the name before the type.

use crate::calls::{is_of_name, replace_word, split};

/// Types of the text, and what WGSL calls them.
const TYPES: [(&str, &str); 6] =
    [("float", "f32"), ("int", "i32"), ("vec3", "vec3f"), ("UINT", "u32"), ("DATA", "u32"), ("bool", "bool")];

fn type_of(name: &str) -> Option<&str> {
    let plain = TYPES.iter().find(|t| t.0 == name).map(|t| t.1);
    plain.or_else(|| name.starts_with("Srbf").then_some(name))
}

/// `TYPE NAME` as `NAME: TYPE`; `None` if it is no declaration.
fn field(text: &str) -> Option<String> {
    let (kind, name) = text.trim().split_once(' ')?;
    name.chars().all(is_of_name).then(|| type_of(kind).map(|kind| format!("{name}: {kind}")))?
}

/// The whole text, line by line.
pub fn declarations(text: &str) -> String {
    let mut is_struct = false;
    let mut made = String::new();
    for line in text.lines() {
        let (code, comment) = split(line);
        let code = if is_struct && code.starts_with('}') {
            is_struct = false;
            "}".to_owned()
        } else if is_struct {
            let gap = &code[code.trim_end().len()..];
            field(code.trim().trim_end_matches(';')).map_or(code.to_owned(), |f| format!("    {f},{gap}"))
        } else if let Some((head, fields)) = code.strip_prefix("struct").and_then(|rest| rest.split_once('{'))
        {
            match fields.split_once('}') {
                Some((fields, rest)) => {
                    let fields: Vec<String> = fields.split(';').filter_map(field).collect();
                    format!("struct{head}{{ {} }}{}", fields.join(", "), rest.trim_start_matches(';'))
                }
                None => {
                    is_struct = true;
                    code.to_owned()
                }
            }
        } else if let Some(signature) = code.strip_prefix("FN ") {
            function(signature)
        } else {
            statement(code)
        };
        made += format!("{code}{comment}").trim_end();
        made.push('\n');
    }
    made
}

/// The first line of a function, and what stands on it of its body.
fn function(signature: &str) -> String {
    let Some(((kind, rest), (arguments, body))) = signature.split_once(' ').and_then(|(kind, rest)| {
        Some(((kind, rest.split_once('(')?), rest.split_once('(')?.1.split_once(") {")?))
    }) else {
        return signature.to_owned();
    };
    let arguments: Vec<String> = arguments.split(',').filter_map(field).collect();
    let kind = type_of(kind).unwrap_or(kind);
    format!("fn {}({}) -> {kind} {{{}", rest.0, arguments.join(", "), statement(body))
}

/// Statements of one line.
fn statement(code: &str) -> String {
    let mut made = String::new();
    // A declaration begins a line, a block, or the head of a loop.
    let mut rest = code;
    while !rest.is_empty() {
        let blank = rest.len() - rest.trim_start().len();
        let (space, after) = rest.split_at(blank);
        made += space;
        let end = after.find(['{', ';']).map_or(after.len(), |at| at + 1);
        let (part, next) = after.split_at(end);
        made += &declaration(part);
        rest = next;
    }
    for (name, by) in TYPES {
        made = replace_word(&made, &format!("{name}("), &format!("{by}("));
    }
    shifts(&made)
}

/// A statement, or one within the head of a loop, as a `var` if it declares something.
fn declaration(part: &str) -> String {
    let (before, part) = part.strip_prefix("for (").map_or(("", part), |rest| ("for (", rest));
    let declared = |part: &str| {
        let (kind, rest) = part.split_once(' ')?;
        let end = rest.find(|c| !is_of_name(c)).filter(|end| *end > 0)?;
        let (name, rest) = rest.split_at(end);
        let is_one = rest.starts_with(';') || rest.starts_with(" =") && !rest.starts_with(" ==");
        let kind = type_of(kind).filter(|_| is_one)?;
        Some(format!("var {name}: {kind}{rest}"))
    };
    format!("{before}{}", declared(part).unwrap_or_else(|| part.to_owned()))
}

/// Numbers of places are unsigned.
fn shifts(code: &str) -> String {
    let mut made = String::new();
    let mut rest = code;
    while let Some(at) = rest.find(">> ") {
        let digits = rest[at + 3..].chars().take_while(char::is_ascii_digit).count();
        made += &rest[..at + 3 + digits];
        if digits > 0 {
            made.push('u');
        }
        rest = &rest[at + 3 + digits..];
    }
    made + rest
}
