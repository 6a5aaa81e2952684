//! The page of `srbf-lab equal-time`, as Markdown.

use super::{ALONE, FIT, WITH_LIGHT};
use srbf_core::Processor;
use srbf_reference_renderer::study::comparison::report::{bias, short};
use srbf_reference_renderer::study::comparison::{Comparison, Curve, Estimate};
use std::fmt::Write;
use std::process::Command;

/// What was measured, and how.
pub struct Measured<'a> {
    pub on_sphere: &'a [Comparison],
    pub on_teapot: &'a [Comparison],
    pub seconds: f64,
    pub repeats: u32,
    pub side: u32,
    /// How long all of it took.
    pub minutes: f64,
    /// Of the source, as git names it.
    pub commit: String,
}

/// At which gain over sampling both and weighting them, sampling them together is worth being the default.
const WORTH: f64 = 1.3;

/// The page.
pub fn page(measured: &Measured<'_>) -> String {
    let mut text = head(measured);
    text += "\n## With samples of the light\n\n";
    text += "`product` is 1. `mis` is the same lobes and one sample of the light by the power heuristic, and so is `NAME+mis` of another sampler; \
             `light` samples the light alone.\n\n";
    text += &table(measured.on_sphere, &WITH_LIGHT);
    text += "\n## Without\n\n`lobes` is 1.\n\n";
    text += &table(measured.on_sphere, &ALONE);
    text += "\n## Where another wins\n\n";
    text += &wins(measured.on_sphere);
    text += "\n## The lobes in place of their table\n\n";
    text += &in_place(measured.on_sphere);
    if !measured.on_teapot.is_empty() {
        text += "\n## Teapot: light and material together\n\n";
        text += &teapot(measured.on_teapot);
    }
    text
}

fn head(measured: &Measured<'_>) -> String {
    let Measured { seconds, repeats, side, minutes, commit, .. } = measured;
    let command: Vec<String> = std::env::args().skip(1).collect();
    format!(
        "# Error against time

Relative mean squared error of every unbiased method after the same time of processors, as a multiple of ours: below 1 the method is better
than ours, and bold where that is certain (two standard errors).

    SRBF_DATA_DIR=... srbf {}

Commit {commit}, {}; {minutes:.0} minutes. The sphere under a forest (`cc0_forest_512`), one scattering, {side} x {side} pixels,
{seconds} s of processors for each picture, {repeats} pictures each; the table is rendered (samples of Cornell's materials are completed first), and the lobes were fitted
to it. Fitting is not counted. Of the pixels the 0.1 % that are worst are apart; [samplers.md](samplers.md) describes the draws of each method.
The networks that stand for MERL's materials and the completed samples take longer to evaluate than lobes, which hides the cost of a draw.
",
        command.join(" "),
        Processor::this()
    )
}

/// What git says of the folder that the command is run in.
pub fn commit() -> String {
    let output = Command::new("git").args(["describe", "--always", "--dirty", "--exclude=*"]).output();
    let found = output.ok().filter(|output| output.status.success()).map(|output| output.stdout);
    found.map_or_else(|| "unknown".to_owned(), |text| String::from_utf8_lossy(&text).trim().to_owned())
}

/// The curve of a method by its name.
fn curve<'a>(comparison: &'a Comparison, name: &str) -> Option<&'a Curve> {
    comparison.curve(name.parse().ok()?)
}

/// Error of a method over that of another, after the same time.
fn ratio(comparison: &Comparison, name: &str, base: &str) -> Option<Estimate> {
    comparison.ratios_to(curve(comparison, name)?, curve(comparison, base)?).equal_time
}

/// Whether it is certain that a ratio is below 1.
fn is_win(ratio: Estimate) -> bool {
    ratio.mean + 2.0 * ratio.error < 1.0
}

/// A row for each material, a column for each method but the first, by which they are judged.
fn table(comparisons: &[Comparison], names: &[&str]) -> String {
    let (base, others) = (names[0], &names[1..]);
    let columns: Vec<String> = others.iter().map(|name| format!("`{name}`")).collect();
    let mut text = format!("| material | {} |\n|---|{}\n", columns.join(" | "), "---|".repeat(others.len()));
    let cell = |ratio: Option<Estimate>| match ratio {
        None => "-".to_owned(),
        Some(r) if is_win(r) => format!("**{}**", short(r.mean)),
        Some(r) => short(r.mean),
    };
    for comparison in comparisons {
        let cells: Vec<String> = others.iter().map(|name| cell(ratio(comparison, name, base))).collect();
        let _ = writeln!(text, "| {} | {} |", comparison.material, cells.join(" | "));
    }
    let mean = |name: &&str| {
        let logs: Vec<f64> =
            comparisons.iter().filter_map(|c| Some(ratio(c, name, base)?.mean.ln())).collect();
        if logs.is_empty() {
            "-".to_owned()
        } else {
            short((logs.iter().sum::<f64>() / logs.len() as f64).exp())
        }
    };
    let means: Vec<String> = others.iter().map(mean).collect();
    let _ = writeln!(text, "| geometric mean | {} |", means.join(" | "));
    text
}

/// Every bold number with what it is made of, and why.
fn wins(comparisons: &[Comparison]) -> String {
    let mut text = "After the name: error after the same time, after the same samples, and how long a sample takes, each over ours.\n\n".to_owned();
    let before = text.len();
    for names in [&WITH_LIGHT[..], &ALONE[..]] {
        let base = names[0];
        for name in &names[1..] {
            let one = |comparison: &Comparison| {
                let ratios = comparison.ratios_to(curve(comparison, name)?, curve(comparison, base)?);
                let (time, samples) = (ratios.equal_time.filter(|r| is_win(*r))?, ratios.equal_samples?);
                let numbers = [time.mean, samples.mean, ratios.time_of_sample?].map(short).join(", ");
                Some(format!("{} ({numbers})", comparison.material))
            };
            let won: Vec<String> = comparisons.iter().filter_map(one).collect();
            if !won.is_empty() {
                let _ =
                    writeln!(text, "* **`{name}`**, beside `{base}`: {}. {}", won.join(", "), reason(name));
            }
        }
    }
    if text.len() == before {
        text += "Nowhere.\n";
    }
    text
}

/// Why a method may be better than lobes.
fn reason(name: &str) -> &'static str {
    match name.trim_end_matches("+mis") {
        "tabulated" | "factored" => {
            "Cells of a table follow a peak more closely than 12 lobes do; the table takes 1 MB, factored 5 kB."
        }
        "rgl" => "The warps of the file were made with these very values, on as fine a grid.",
        "lobes-multi" | "thesis-multi" => {
            "Sixteen directions share a ray of the camera and one look at the material: a sample costs less."
        }
        "guided" => {
            "Its parts have the long tails of GGX, which a Gaussian lobe lacks: they meet bright parts of the light more often."
        }
        "ggx" | "ward" | "phong" => {
            "A draw is cheaper than of 12 lobes. Lobes follow the material, and the rest is the variance of the light, whose bright parts wider tails meet more often."
        }
        "lafortune" => "Nine lobes and a cosine are wide, which is what counts where the light decides.",
        "defensive" => "One direction in twenty of the cosine meets light that the lobes seldom look at.",
        "cosine" | "uniform" => {
            "The draw is the cheapest there is, and the diffuse term, or at krylon_blue light beside the highlight, makes most of the variance."
        }
        "light" => "The material is nearly matte, and the light is not.",
        _ => "The same lobes by another way to share samples.",
    }
}

/// The lobes as the material, beside the table.
fn in_place(comparisons: &[Comparison]) -> String {
    let mut text = format!(
        "`{FIT}` renders the lobes, not the table, which still judges: the error that no number of samples removes is that of the fit. \
         Bias: relative to the brightness of a pixel, root mean square; after `<` a bound where none is certain.\n\n\
         | material | error after the same time, over `product` | time of a sample, over `product` | bias |\n|---|---|---|---|\n"
    );
    for comparison in comparisons {
        if let (Some(fit), Some(product)) = (curve(comparison, FIT), curve(comparison, "product")) {
            let ratios = comparison.ratios_to(fit, product);
            let or_dash = |number: Option<f64>| number.map_or_else(|| "-".to_owned(), short);
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} |",
                comparison.material,
                or_dash(ratios.equal_time.map(|r| r.mean)),
                or_dash(ratios.time_of_sample),
                bias(fit)
            );
        }
    }
    text
}

/// How much sampling light and material together gains with occlusion and light between surfaces.
fn teapot(comparisons: &[Comparison]) -> String {
    let mut text = "Lobes as the material, six scatterings. Error after the same time over that of `product`, and the standard error.\n\n\
                    | material | light | `mis` | `ggx+mis` | `lafortune+mis` |\n|---|---|---|---|---|\n"
        .to_owned();
    let mut least = f64::INFINITY;
    for comparison in comparisons {
        let cell = |name: &str| match ratio(comparison, name, "product") {
            None => "-".to_owned(),
            Some(r) if is_win(r) => format!("**{} ± {}**", short(r.mean), short(r.error)),
            Some(r) => format!("{} ± {}", short(r.mean), short(r.error)),
        };
        let cells = ["mis", "ggx+mis", "lafortune+mis"].map(cell).join(" | ");
        let _ = writeln!(text, "| {} | {} | {cells} |", comparison.material, comparison.environment);
        if let Some(r) = ratio(comparison, "mis", "product") {
            least = least.min(r.mean);
        }
    }
    let verdict = if least >= WORTH {
        "`product` is worth being the default"
    } else {
        "that is too little for `product` to be the default of `srbf render`"
    };
    if least.is_finite() {
        let _ = writeln!(
            text,
            "\nThe least gain over `mis` is {}; at {WORTH} and above it is worth it: {verdict}.",
            short(least)
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::imagined::{curve as curve_of, point};
    use srbf_reference_renderer::study::comparison::ReferenceReport;

    /// Methods with their errors after the same time and samples.
    fn comparison(errors: &[(&str, f64)]) -> Comparison {
        let curve = |&(name, rmse): &(&str, f64)| Curve {
            method: name.parse().unwrap(),
            ..curve_of(vec![point(16, 1.0, rmse)])
        };
        Comparison {
            scene: "sphere",
            material: "paint".into(),
            environment: "forest".into(),
            size: [1, 1],
            curves: errors.iter().map(curve).collect(),
            reference: ReferenceReport::default(),
        }
    }

    fn measured(on_sphere: &[Comparison], on_teapot: &[Comparison]) -> String {
        page(&Measured {
            on_sphere,
            on_teapot,
            seconds: 0.1,
            repeats: 2,
            side: 8,
            minutes: 1.0,
            commit: String::new(),
        })
    }

    #[test]
    fn what_is_better_is_bold_and_has_a_reason() {
        let sphere = comparison(&[
            ("product", 0.1),
            ("mis", 0.2),
            ("lobes", 0.2),
            ("tabulated", 0.1),
            ("fit:product", 0.1),
        ]);
        let text = measured(&[sphere], &[]);
        assert!(text.contains("| paint | - | 4.00 | - |"), "{text}");
        assert!(
            text.contains("| **0.25** |")
                && text.contains("* **`tabulated`**, beside `lobes`: paint (0.25, 0.25, 1.00)"),
            "{text}"
        );
        assert!(!text.contains("NaN"), "{text}");
    }

    #[test]
    fn the_report_says_whether_product_is_worth_it() {
        for (error, says) in [(0.2, "is worth being the default"), (0.105, "too little")] {
            let text = measured(&[], &[comparison(&[("product", 0.1), ("mis", error)])]);
            assert!(text.contains(says), "{error}: {text}");
        }
    }
}
