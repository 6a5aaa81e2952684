//! Comparisons as a table for people and as CSV for programs.

use crate::out::output;
use crate::study::comparison::error::Bias;
use crate::study::comparison::{Comparison, Curve, Estimate};
use std::fmt::Write;
use std::path::Path;

/// Head of the CSV. `relative_mse` leaves out the 0.1 % of the pixels that are worst, `whole_mse` none; after each, its standard error over
/// repeats. `below_reference` is 1 where the error is no more than the reference's own, and then not known.
const HEAD: &str = "scene,material,environment,method,samples_per_pixel,seconds,relative_mse,standard_error,whole_mse,\
    whole_standard_error,below_reference,reference_mse";

/// Writes every measurement as a line of CSV.
///
/// # Errors
/// Names the file.
pub fn write_csv(path: &Path, comparisons: &[Comparison]) -> anyhow::Result<()> {
    let mut text = format!("{HEAD}\n");
    for comparison in comparisons {
        let case =
            [comparison.scene, &quote(&comparison.material), &quote(&comparison.environment)].join(",");
        for curve in &comparison.curves {
            for p in &curve.points {
                let of = |e: Estimate| format!("{:.6e},{:.6e}", e.mean, e.error);
                let _ = writeln!(
                    text,
                    "{case},{},{},{:.6},{},{},{},{:.6e}",
                    curve.method,
                    p.samples,
                    p.seconds,
                    of(p.mse),
                    of(p.whole_mse),
                    u8::from(p.known().is_none()),
                    comparison.reference.own.trimmed
                );
            }
        }
    }
    output::write(path, text.as_bytes())
}

/// A field of CSV, quoted where it must be (RFC 4180).
fn quote(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

/// Prints the measurements of one comparison, and a summary line for each method.
pub fn print(comparison: &Comparison) {
    println!("{}", comparison.title());
    println!(
        "{:>16} {:>8} {:>9} {:>20} {:>20}",
        "method", "samples", "seconds", "relative MSE", "with worst pixels"
    );
    for curve in &comparison.curves {
        for point in &curve.points {
            let mark = if point.known().is_none() { " *" } else { "" };
            let (samples, seconds) = (point.samples, point.seconds);
            let [mse, whole] =
                [point.mse, point.whole_mse].map(|e| format!("{:.3e} +- {:.0e}", e.mean, e.error));
            println!("{:>16} {samples:>8} {seconds:>9.4} {mse:>20} {whole:>20}{mark}", curve.method);
        }
    }
    println!("{}", reference(comparison));
    println!("{}", summary(comparison));
}

/// How good the reference is, in words.
pub fn reference(comparison: &Comparison) -> String {
    let reference = &comparison.reference;
    let kept = if reference.was_kept { ", kept from before" } else { "" };
    format!(
        "Reference: {} samples a pixel{kept}; its own relative MSE, {:.1e} ({:.1e} with the worst pixels), is taken off; * marks errors below it",
        reference.samples, reference.own.trimmed, reference.own.whole
    )
}

/// A line for each method: slope, time of a sample, error as a multiple of the first method's, bias.
pub fn summary(comparison: &Comparison) -> String {
    let mut text = format!(
        "{:>16} {:>6} {:>10} {:>17} {:>17} {:>9}",
        "method",
        "slope",
        "time of 1",
        format!("MSE at {:.3} s", comparison.common_seconds()),
        "at equal samples",
        "bias"
    );
    for curve in &comparison.curves {
        let ratios = comparison.ratios(curve);
        let of = |ratio: Option<Estimate>| {
            ratio.map_or_else(|| "-".to_owned(), |r| format!("{} x +- {}", short(r.mean), short(r.error)))
        };
        let _ = write!(
            text,
            "\n{:>16} {:>6} {:>10} {:>17} {:>17} {:>9}",
            curve.method,
            or_dash(curve.slope(), 3),
            or_dash(ratios.time_of_sample, 2),
            of(ratios.equal_time),
            of(ratios.equal_samples),
            bias(curve)
        );
    }
    text
}

/// The bias of a method, relative to the brightness: its size if it is certain, else its upper bound.
pub fn bias(curve: &Curve) -> String {
    let percent = |value: f64| format!("{} %", short(100.0 * value));
    match &curve.bias {
        None => "-".to_owned(),
        Some(bias) => bias.certain().map_or_else(|| format!("< {}", percent(Bias::bound(bias))), percent),
    }
}

/// A number of about three digits.
pub fn short(number: f64) -> String {
    let digits = match number.abs() {
        v if v >= 100.0 => 0,
        v if v >= 10.0 => 1,
        v if v >= 0.1 => 2,
        _ => 3,
    };
    format!("{number:.digits$}")
}

/// A number with `digits` digits after the point, or a dash for one that is not known.
pub fn or_dash(number: Option<f64>, digits: usize) -> String {
    number.map_or_else(|| "-".to_owned(), |number| format!("{number:.digits$}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_with_commas_are_quoted() {
        assert_eq!(quote("sky"), "sky");
        assert_eq!(quote("a,\"b\""), "\"a,\"\"b\"\"\"");
    }

    #[test]
    fn numbers_have_about_three_digits() {
        let texts = [0.01234, 0.1234, 1.234, 12.34, 123.4].map(short);
        assert_eq!(texts, ["0.012", "0.12", "1.23", "12.3", "123"]);
    }
}
