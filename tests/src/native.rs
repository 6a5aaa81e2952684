//! The C library as its users get it: built by cargo, linked by the C and C++ compilers of the machine.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

/// The root of the repository.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the package is a folder of the workspace")
}

/// The folder of cargo's builds for this test: the folder above `release/deps`.
fn target() -> PathBuf {
    let test = std::env::current_exe().expect("a test knows where it is");
    let mut folders = test.ancestors();
    // target/PROFILE/deps/NAME; the profile is whatever the test was built with.
    folders.nth(3).expect("cargo runs tests from target/PROFILE/deps").to_owned()
}

/// Builds the C library with the fits in the release profile, and returns the folder that holds `libsrbf_fit.a` and `libsrbf_fit.so`.
///
/// With the whole workspace and its examples, which have the features of tests: `cargo test` has compiled all but the library itself, and
/// the level is capped as that of a test is. `.ci/checks/20-install` tries the library as a C program's build makes it. Cargo serialises the builds that several
/// tests ask for.
pub fn library() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        build_library(&target(), "release", &["--release", "--workspace", "--lib", "--examples"])
    })
}

/// Builds the C library with the panic that only tests have, without fits and unoptimised, which takes seconds; in a folder
/// of its own, so that the two never mix.
pub fn library_with_planted_panic() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let options = ["--package", "srbf-fit-capi", "--no-default-features", "--features", "std,planted-panic"];
    FOLDER.get_or_init(|| build_library(&target().join("planted-panic"), "debug", &options))
}

fn build_library(target: &Path, profile: &str, options: &[&str]) -> PathBuf {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.current_dir(root()).args(["build", "--offline"]);
    command.args(options).arg("--target-dir").arg(target);
    // A folder named by the triple would be somewhere else.
    command.env_remove("CARGO_BUILD_TARGET");
    run(&mut command);
    let folder = target.join(profile);
    for name in ["libsrbf_fit.a", "libsrbf_fit.so"] {
        assert!(folder.join(name).is_file(), "cargo did not make {}", folder.join(name).display());
    }
    folder
}

/// A language that the header is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// C11.
    C,
    /// C++17.
    Cpp,
}

/// A compiler for C or C++ on this machine.
#[derive(Clone, Debug)]
pub struct Compiler {
    /// The command, such as `gcc`.
    pub command: &'static str,
    /// The language.
    pub language: Language,
}

/// The compilers of the machine for a language: gcc and clang where both are installed.
///
/// # Panics
/// If there is none: the C interface cannot be tested without a compiler.
pub fn compilers(language: Language) -> Vec<Compiler> {
    let candidates = match language {
        Language::C => ["gcc", "clang", "cc"],
        Language::Cpp => ["g++", "clang++", "c++"],
    };
    let works = |command: &&str| {
        Command::new(command).arg("--version").output().is_ok_and(|output| output.status.success())
    };
    let mut found: Vec<_> = candidates.into_iter().filter(works).collect();
    if found.len() > 1 {
        // `cc` and `c++` are one of the others by another name.
        found.retain(|command| !["cc", "c++"].contains(command));
    }
    assert!(
        !found.is_empty(),
        "no compiler for {language:?}: install one of {candidates:?} (Debian: apt-get install gcc g++)"
    );
    found.into_iter().map(|command| Compiler { command, language }).collect()
}

/// How a program is linked with the library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Link {
    /// `libsrbf_fit.a` and the libraries of the system that it needs.
    Static,
    /// `libsrbf_fit.so`, found again at run time.
    Shared,
}

impl Compiler {
    /// A command of the compiler with the standard of the language, every warning an error, and our headers.
    pub fn strict(&self) -> Command {
        let mut command = Command::new(self.command);
        command.arg(match self.language {
            Language::C => "-std=c11",
            Language::Cpp => "-std=c++17",
        });
        command.args(["-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O1", "-g"]);
        command.arg("-I").arg(root().join("include")).arg("-I").arg(root().join("tests/c"));
        command
    }

    /// Whether the compiler knows an option, such as a standard that is newer than it may be.
    pub fn takes(&self, option: &str) -> bool {
        let mut command = self.strict();
        command.args([option, "-fsyntax-only", "-x", if self.language == Language::C { "c" } else { "c++" }]);
        command.arg("/dev/null").output().is_ok_and(|output| output.status.success())
    }

    /// Compiles one source file of `tests/c` and links it with the library in `folder`. Returns: the program.
    pub fn program(&self, source: &str, folder: &Path, link: Link, options: &[&str]) -> PathBuf {
        let place = target().join("tests-c");
        std::fs::create_dir_all(&place).expect("the target folder can be written");
        let name = source.replace(['/', '.'], "-");
        let variant = folder.parent().and_then(Path::file_name).unwrap_or_default().to_string_lossy();
        let program = place.join(format!("{name}-{}-{link:?}-{variant}", self.command));
        let mut command = self.strict();
        command.args(options).arg(root().join("tests/c").join(source)).arg("-o").arg(&program);
        match link {
            // What `rustc --print native-static-libs` says for a staticlib on Linux with glibc.
            Link::Static => command.arg(folder.join("libsrbf_fit.a")).args([
                "-lutil",
                "-lrt",
                "-lpthread",
                "-lm",
                "-ldl",
                "-lc",
            ]),
            Link::Shared => {
                command.arg(folder.join("libsrbf_fit.so")).arg(format!("-Wl,-rpath,{}", folder.display()));
                command.args(["-lm", "-lpthread"])
            }
        };
        run(&mut command);
        program
    }
}

/// Runs a command; its standard output if it succeeded.
///
/// # Panics
/// If it fails, with everything it printed.
pub fn run(command: &mut Command) -> String {
    let Output { status, stdout, stderr } =
        command.output().unwrap_or_else(|error| panic!("{command:?} did not start: {error}"));
    let (stdout, stderr) = (String::from_utf8_lossy(&stdout), String::from_utf8_lossy(&stderr));
    assert!(status.success(), "{command:?}\n{status}\n{stdout}\n{stderr}");
    stdout.into_owned()
}

/// Runs a program that [`Compiler::program`] made.
pub fn run_program(program: &Path, arguments: &[&OsStr]) -> String {
    run(Command::new(program).args(arguments).current_dir(root()))
}
