//! Which goals the fits of a survey meet, and which materials miss them.

use super::row::{Row, quantile};

/// A goal for every material: what it says, and whether one meets it.
type Goal = (&'static str, fn(&Row) -> bool);

const EACH: [Goal; 4] = [
    ("worst relative variance <= 0.3 over views to 80 degrees", |r| r.variance_worst <= 0.3),
    ("largest weight <= 20 times the mean", |r| r.weight <= 20.0),
    ("energy within 1 %", |r| r.energy <= 1.0),
    ("at most 4096 bytes", |r| r.bytes <= 4096.0),
];

const EACH_BESIDE_THESIS: [Goal; 2] = [
    ("never worse than the thesis's eq. 9 at the same views", |r| r.same_views <= r.eq9),
    ("8 times better than eq. 9 where that exceeds 30 %", |r| r.eq9 <= 30.0 || 8.0 * r.same_views <= r.eq9),
];

/// A goal for the median: what it says, what is measured, and the most that meets it.
type MedianGoal = (&'static str, fn(&Row) -> f64, f64);

const MEDIAN: [MedianGoal; 3] = [
    ("median error halfway, %", |r| r.halfway, 5.0),
    ("median of error halfway over error at the views", Row::ratio, 1.2),
    ("median relative variance", |r| r.variance_median, 0.02),
];

/// Names that are listed at most.
const LISTED: usize = 12;

/// Prints a line for every goal.
pub fn print(rows: &[Row], beside_thesis: bool) {
    for (text, number, most) in MEDIAN {
        let median = quantile(rows.iter().map(number).collect(), 0.5);
        let verdict = if median <= most { "met   " } else { "missed" };
        println!("{verdict} {text}: {median:.4}, goal {most}");
    }
    EACH.iter().for_each(|goal| println!("{}", verdict(goal, rows)));
    if beside_thesis {
        EACH_BESIDE_THESIS.iter().for_each(|goal| println!("{}", verdict(goal, rows)));
    }
}

fn verdict((text, meets): &Goal, rows: &[Row]) -> String {
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
        let row = |name: &str, energy| Row { name: name.into(), energy, ..Row::default() };
        let rows = [row("good", 0.5), row("bad", 2.0), row("unknown", f64::NAN)];
        let text = verdict(&EACH[2], &rows);
        assert!(text.starts_with("missed") && text.contains("by 2 of 3: bad, unknown"), "{text}");
        assert!(verdict(&EACH[2], &rows[..1]).starts_with("met"));
    }
}
