// The examples of the documentation: blocks of code in Markdown. Included by the build script too, hence no `//!`.

/// Documents whose blocks of Rust, C and C++ are compiled and run.
pub const DOCUMENTS: [&str; 7] = [
    "docs/any-light.md",
    "docs/blends.md",
    "docs/integrate.md",
    "docs/use-from-c.md",
    "docs/use-from-cpp.md",
    "docs/use-from-rust.md",
    "docs/verbs.md",
];

/// A block of code.
pub struct CodeBlock {
    /// Line of the document at which the code begins, from 1.
    pub line: usize,
    /// What stands in it.
    pub code: String,
}

/// The blocks of a language, as the line that opens them names it.
pub fn blocks(text: &str, language: &str) -> Vec<CodeBlock> {
    let mut found = Vec::new();
    let mut lines = text.lines().enumerate();
    while let Some((n, line)) = lines.next() {
        let Some(name) = line.strip_prefix("```") else { continue };
        let code: Vec<&str> = lines.by_ref().map(|l| l.1).take_while(|l| !l.starts_with("```")).collect();
        if name == language {
            found.push(CodeBlock { line: n + 2, code: code.join("\n") });
        }
    }
    found
}
