//! Which goals the fits of a survey meet, and which materials miss them.

use super::row::{SurveyRow, quantile};

/// A goal for every material: its text, and whether one meets it.
type Goal = (&'static str, fn(&SurveyRow) -> bool);

const EACH: [Goal; 4] = [
    ("worst relative variance <= 0.3 over views to 80 degrees", |r| r.variance_worst <= 0.3),
    ("largest weight <= 20 times the mean", |r| r.weight <= 20.0),
    ("energy within 1 %", |r| r.energy <= 1.0),
    ("at most 4096 bytes, 8000 with a table of factors", |r| {
        r.bytes <= if r.factor_bytes > 0.0 { 8000.0 } else { 4096.0 }
    }),
];

const EACH_BESIDE_THESIS: [Goal; 2] = [
    ("never worse than the thesis's eq. 9 at the same views", |r| r.same_views <= r.eq9),
    ("8 times better than eq. 9 where that exceeds 30 %", |r| r.eq9 <= 30.0 || 8.0 * r.same_views <= r.eq9),
];

/// A goal for a quantile: its text, its number, the quantile, and the most that meets it.
type QuantileGoal = (&'static str, fn(&SurveyRow) -> f64, f64, f64);

const QUANTILES: [QuantileGoal; 6] = [
    ("median error halfway, %", |r| r.halfway, 0.5, 3.7),
    ("error halfway of 90 % of the materials, %", |r| r.halfway, 0.9, 5.2),
    ("median of error halfway over error at the views", SurveyRow::ratio, 0.5, 1.2),
    ("median error of luminance off the peak, %", |r| r.luminance, 0.5, 6.0),
    ("median error of colour off the peak", |r| r.chroma, 0.5, 0.03),
    ("median relative variance", |r| r.variance_median, 0.5, 0.02),
];

/// Names that are listed at most.
const LISTED: usize = 12;

/// Prints a line for every goal.
pub fn print(rows: &[SurveyRow], beside_thesis: bool) {
    QUANTILES.iter().for_each(|goal| println!("{}", quantile_verdict(goal, rows)));
    EACH.iter().for_each(|goal| println!("{}", verdict(goal, rows)));
    if beside_thesis {
        EACH_BESIDE_THESIS.iter().for_each(|goal| println!("{}", verdict(goal, rows)));
    }
}

fn quantile_verdict(&(text, number, share, most): &QuantileGoal, rows: &[SurveyRow]) -> String {
    let found = quantile(rows.iter().map(number).collect(), share);
    let verdict = if found <= most { "met   " } else { "missed" };
    format!("{verdict} {text}: {found:.4}, goal {most}")
}

fn verdict((text, meets): &Goal, rows: &[SurveyRow]) -> String {
    let missing: Vec<&str> = rows.iter().filter(|r| !meets(r)).map(|r| r.name.as_str()).collect();
    if missing.is_empty() {
        return format!("met    {text}: all {}", rows.len());
    }
    let more =
        if missing.len() > LISTED { format!(" and {} more", missing.len() - LISTED) } else { String::new() };
    let listed = missing[..missing.len().min(LISTED)].join(", ");
    format!("missed {text}: by {} of {}: {listed}{more}", missing.len(), rows.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_material_that_misses_a_goal_is_named() {
        let row = |name: &str, energy| SurveyRow { name: name.into(), energy, ..SurveyRow::default() };
        let rows = [row("good", 0.5), row("bad", 2.0), row("unknown", f64::NAN)];
        let text = verdict(&EACH[2], &rows);
        assert!(text.starts_with("missed") && text.contains("by 2 of 3: bad, unknown"), "{text}");
        assert!(verdict(&EACH[2], &rows[..1]).starts_with("met"));
    }

    #[test]
    fn a_quantile_meets_its_goal_or_misses_it() {
        let rows = [3.0, 3.6, 9.0].map(|halfway| SurveyRow { halfway, ..SurveyRow::default() });
        assert!(quantile_verdict(&QUANTILES[0], &rows).starts_with("met    median error halfway, %: 3.6000"));
        assert!(quantile_verdict(&QUANTILES[1], &rows).starts_with("missed"));
        // A missing number meets no goal.
        assert!(quantile_verdict(&QUANTILES[3], &rows).starts_with("missed"));
    }

    #[test]
    fn a_table_of_factors_has_bytes_of_its_own() {
        let row = |bytes, factor_bytes| SurveyRow { bytes, factor_bytes, ..SurveyRow::default() };
        let meets = |row| EACH[3].1(&row);
        assert!(meets(row(4096.0, 0.0)) && meets(row(7900.0, 1144.0)));
        assert!(!meets(row(4100.0, 0.0)) && !meets(row(8100.0, 1144.0)));
    }
}
