//! The time of a reader grows with its text, not with its square.

use srbf_measured::read::{Conventions, Source, read_from};
use std::time::{Duration, Instant};

/// Four times the text may take this many times the time; a square takes 16 times.
const MOST: u32 = 8;

/// Times below this are noise. Squares of these sizes take seconds.
const NOISE: Duration = Duration::from_millis(250);

fn read(text: &str) -> Result<Source, String> {
    read_from("a.csv", text.as_bytes(), &Conventions::default()).map_err(|error| {
        let source = std::error::Error::source(&error).map(ToString::to_string);
        source.unwrap_or_else(|| error.to_string())
    })
}

/// The shortest time of two, as other programs run beside this one.
fn time(text: &str) -> Duration {
    let one = || {
        let start = Instant::now();
        let _ = read(text);
        start.elapsed()
    };
    (0..2).map(|_| one()).min().unwrap_or_default()
}

/// Compares the times of a text and of one four times as long.
fn grows_with(what: &str, size: usize, make: impl Fn(usize) -> String) {
    let (short, long) = (time(&make(size)), time(&make(4 * size)));
    println!("{what}: {short:?}, of four times the text {long:?}");
    assert!(long < NOISE.max(MOST * short), "{what}: {short:?}, of four times the text {long:?}");
}

/// Columns of these names and a row.
fn columns(first: &str, count: usize, name: impl Fn(usize) -> String) -> String {
    let names: Vec<String> = (0..count).map(name).collect();
    let row = vec!["20"; count + first.split(',').count()].join(",");
    format!("{first},{}\n{row}\n", names.join(","))
}

#[test]
fn names_of_columns() {
    grows_with("names", 6000, |n| columns("theta_i,theta_o,value", n, |i| format!("n{i}")));
    grows_with("wavelengths", 6000, |n| {
        columns("theta_i,theta_o", n, |i| format!("{}nm", 380.0 + 400.0 * i as f64 / n as f64))
    });
    let read = read(&columns("theta_i,theta_o,value", 24_000, |i| format!("n{i}"))).unwrap();
    assert_eq!(read.intake.unwrap().rows.len(), 1);
}

#[test]
fn text_without_names() {
    // All different: equal ones end a search early.
    let matrix = |lines: usize, columns: usize, separator: &str| {
        let row = |i: usize| {
            let numbers = (0..columns).map(|j| (0.5 + (i * columns + j) as f64).to_string());
            numbers.collect::<Vec<_>>().join(separator)
        };
        (0..lines).map(row).collect::<Vec<_>>().join("\n")
    };
    for separator in [",", " ", "\t", "; "] {
        grows_with("a matrix without names", 500, |n| matrix(100, n, separator));
    }
    let error = read(&matrix(1000, 1000, ",")).err().unwrap();
    assert!(error.starts_with("no line names the columns") && error.contains("`0.5,1.5,2.5,"), "{error}");
    let words = |n: usize| (0..n).map(|i| format!("word{i}")).collect::<Vec<_>>().join(",");
    grows_with("words in one line", 6000, words);
    grows_with("words in one line of 10 MB", 300_000, words);
    let error = read(&words(1_000_000)).err().unwrap();
    assert!(error.ends_with("the first 262144 fields are looked at"), "{error}");
    grows_with("separators alone", 2_500_000, |n| ",".repeat(n));
}

#[test]
fn lines_of_samples() {
    grows_with("a wavelength a line", 100_000, |n| {
        let line = |x: f64| format!("{},10,{},0.1\n", 80.0 * x, 380.0 + 400.0 * x);
        let lines = (0..n).map(|i| line(i as f64 / n as f64));
        ["theta_i,theta_o,wavelength,value\n".to_owned()].into_iter().chain(lines).collect()
    });
}

#[test]
fn a_message_is_short_however_long_a_name_is() {
    let long = "x".repeat(1_000_000);
    for text in [
        format!("theta_i,theta_o,{long},{long}\n1,2,3,4\n"),
        format!("theta_i,theta_o,azimuth{long},value\n1,2,3,4\n"),
        format!("theta_i,theta_o,{long}\n1,2,3\n"),
    ] {
        let error = read(&text).err().unwrap();
        assert!(error.contains("xxx") && error.len() < 400, "{} bytes: {}", error.len(), &error[..200]);
    }
}
