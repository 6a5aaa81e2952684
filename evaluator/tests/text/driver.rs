//! The text as a program: `values.cpp`, compiled and asked.

use srbf_evaluator::{Language, blend_text};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The strictest C++ compiler, with the stand-in for Metal's library where it is needed.
pub fn compiler(language: Language) -> Command {
    let mut compiler = Command::new("g++");
    compiler.args(["-std=c++17", "-Wall", "-Wextra", "-Werror"]);
    if language == Language::Metal {
        compiler.args(["-D__METAL__", "-Wno-unused-function"]).arg("-I");
        compiler.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/metal"));
    }
    compiler
}

/// `values.cpp` with the text of a language, in a process that answers.
pub struct Program {
    child: Child,
}

impl Program {
    pub fn compile(language: Language, folder: &str, options: &[&str]) -> Self {
        Self::compile_with(language, folder, options, &[])
    }

    /// The same, run with arguments.
    pub fn compile_with(language: Language, folder: &str, options: &[&str], arguments: &[&str]) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(folder);
        std::fs::create_dir_all(&folder).expect("the target folder can be written");
        std::fs::write(folder.join("text"), blend_text(language)).expect("the target folder can be written");
        let program = folder.join("values");
        let mut compiler = compiler(language);
        compiler.args(options).arg("-I").arg(&folder).arg("-o").arg(&program);
        compiler.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/values.cpp"));
        assert!(compiler.status().expect("g++ is installed").success(), "{language:?} does not compile");
        let mut command = Command::new(program);
        let child = command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        Self { child: child.expect("the program runs") }
    }

    /// The program's answer about a material or a sheet, for nine rows of numbers: eighteen rows, or the word that `srbf_check` finds wrong.
    ///
    /// # Errors
    /// If the program has ended: it prints why.
    pub fn ask(&mut self, bytes: &[u8], given: &[Vec<f32>]) -> std::io::Result<Result<Vec<Vec<f32>>, i32>> {
        let n = given[0].len();
        let mut sent = (bytes.len() as u32).to_le_bytes().to_vec();
        sent.extend(bytes);
        sent.extend((n as u32).to_le_bytes());
        sent.extend(given.iter().flatten().flat_map(|v| v.to_le_bytes()));
        self.child.stdin.as_mut().expect("a pipe").write_all(&sent)?;
        let answer = self.child.stdout.as_mut().expect("a pipe");
        let mut wrong = [0; 4];
        answer.read_exact(&mut wrong)?;
        if wrong != [0; 4] {
            return Ok(Err(i32::from_le_bytes(wrong)));
        }
        let mut numbers = vec![0; 18 * 4 * n];
        answer.read_exact(&mut numbers)?;
        let numbers: Vec<f32> = numbers.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
        Ok(Ok(numbers.chunks(n.max(1)).map(<[f32]>::to_vec).collect()))
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        drop(self.child.stdin.take());
        // It ends by itself.
        let _ = self.child.wait();
    }
}
