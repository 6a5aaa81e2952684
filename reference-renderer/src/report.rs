//! Comparisons as a table for people and as CSV for programs.

use crate::comparison::Comparison;
use crate::output;
use std::fmt::Write;
use std::path::Path;

/// Writes every measurement as a line of CSV; an error that the reference is too poor to tell is empty.
///
/// # Errors
/// Names the file.
pub fn write_csv(path: &Path, comparisons: &[Comparison]) -> anyhow::Result<()> {
    let mut text =
        String::from("material,environment,sampler,samples_per_pixel,seconds,relative_rms_error\n");
    for comparison in comparisons {
        for curve in &comparison.curves {
            for point in &curve.points {
                let fields = [quote(&comparison.material), quote(&comparison.environment)].join(",");
                let (name, samples) = (curve.strategy, point.samples);
                let error = point.known_error().map_or_else(String::new, |error| format!("{error:.6e}"));
                let _ = writeln!(text, "{fields},{name},{samples},{:.6},{error}", point.seconds);
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

/// Prints the measurements of one comparison, and a summary line for each sampler.
pub fn print(comparison: &Comparison) {
    println!("{} on the sphere under {}", comparison.material, comparison.environment);
    let names = comparison.curves.iter().map(|c| format!("  {:>10} s   error", c.strategy));
    println!("  samples/pixel{}", names.collect::<String>());
    let rows = comparison.curves.iter().map(|c| c.points.len()).max().unwrap_or(0);
    for row in 0..rows {
        let points: Vec<_> = comparison.curves.iter().filter_map(|c| c.points.get(row)).collect();
        let cells =
            points.iter().map(|p| format!("  {:>12.3}  {:6}", p.seconds, or_dash(p.known_error(), 4)));
        println!("  {:>13}{}", points[0].samples, cells.collect::<String>());
    }
    let own = comparison.reference_error;
    println!("  error: root mean square over the mean; the reference's own, {own:.4}, is taken off");
    println!("{}", summary(comparison));
}

/// A line for each sampler: slope, time of a sample, and its error as a multiple of the first sampler's.
pub fn summary(comparison: &Comparison) -> String {
    let seconds = comparison.common_seconds();
    let mut text = format!(
        "  sampler          slope   relative time of a sample   error at {seconds:.2} s   at equal samples"
    );
    let per_sample = |curve: &crate::comparison::Curve| {
        curve.points.last().map_or(f64::NAN, |p| p.seconds / f64::from(p.samples))
    };
    for curve in &comparison.curves {
        let [by_time, by_samples] = comparison.error_ratios(curve);
        let cost = per_sample(curve) / per_sample(&comparison.curves[0]);
        let (name, slope) = (curve.strategy, or_dash(curve.slope(), 3));
        let [by_time, by_samples] = [by_time, by_samples].map(|ratio| or_dash(ratio, 2));
        let _ =
            write!(text, "\n  {name:15} {slope:>6}   {cost:>25.2}   {by_time:>13} x   {by_samples:>14} x");
    }
    text
}

/// A number with so many digits after the point, or a dash for one that is not known.
fn or_dash(number: Option<f64>, digits: usize) -> String {
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
}
