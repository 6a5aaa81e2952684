use super::*;
use crate::judge::seen::Seen;

/// A view without a fault.
fn view(degrees: f64) -> ViewReport {
    ViewReport {
        theta: degrees.to_radians(),
        azimuth: 0.0,
        error: 0.03,
        measure: 0.035,
        is_black: false,
        albedo: [0.5, 0.4, 0.3],
        data_albedo: [0.5, 0.4, 0.3],
        is_albedo_cut: false,
        density: 1.0,
        variance: 0.02,
        largest_weight: 2.5,
        seen: Seen { peak: 0.02, off_peak: 0.06, luminance: 0.04, chroma: 0.02 },
        floor: 0.0,
        negatives: (0.0, 0.0),
    }
}

/// Three views, and two between them.
fn report() -> Report {
    Report {
        views: vec![view(0.0), view(40.0), view(80.0)],
        held_out: vec![view(20.0), view(60.0)],
        ..Report::default()
    }
}

const RECIPROCAL: Reciprocity = Reciprocity { median: 0.05, worst: 0.6, pairs: 400 };
const MADE: Made = Made { lobes: 12, views: 15, has_factors: false, is_isotropic: true };

fn verdict(report: &Report) -> Verdict {
    Verdict::new(report, &RECIPROCAL, Some(MADE))
}

#[test]
fn a_good_fit_has_only_good_in_it_and_no_advice() {
    let found = verdict(&report());
    assert_eq!(found.good.len(), MEASURES.len() + 1, "{found:?}");
    assert!(found.fair.is_empty() && found.off.is_empty() && found.advice.is_empty(), "{found:?}");
}

/// Sets a number of a view.
type Set = fn(&mut ViewReport, f64);

/// The measures with what is off above, and what sets them.
const NOTES: [(&str, f64, Set); 6] = [
    ("L2 off the peak", 0.2, |v, x| v.seen.off_peak = x),
    ("luminance off the peak", 0.15, |v, x| v.seen.luminance = x),
    ("colour off the peak", 0.1, |v, x| v.seen.chroma = x),
    ("variance", 0.25, |v, x| v.variance = x),
    ("largest weight", 18.0, |v, x| v.largest_weight = x),
    ("energy", 0.01, |v, x| v.albedo = v.data_albedo.map(|a| a + x * (1.005 * a + 1e-3))),
];

#[test]
fn what_is_off_is_said_above_its_bound_and_not_below() {
    for (name, most, set) in NOTES {
        for (factor, is_off) in [(0.9, false), (1.1, true)] {
            // One view is enough, whether it was fitted or held out.
            for is_fitted in [true, false] {
                let mut report = report();
                let views = if is_fitted { &mut report.views } else { &mut report.held_out };
                set(&mut views[1], factor * most);
                let found = verdict(&report);
                let said = found.off.iter().filter(|s| s.starts_with(name)).count();
                assert_eq!(said, usize::from(is_off), "{name} {factor}: {found:?}");
                assert_eq!(found.off.len(), said, "{name} {factor}: {found:?}");
                let angle = if is_fitted { "40.0 degrees" } else { "60.0 degrees" };
                assert!(!is_off || found.off[0].contains(angle), "{found:?}");
            }
        }
    }
}

#[test]
fn what_is_black_or_too_dark_or_not_known_is_not_judged() {
    let mut report = report();
    let odd = ViewReport { largest_weight: f64::INFINITY, ..view(85.0) };
    report.views.push(ViewReport { is_black: true, ..odd.clone() });
    report.views.push(ViewReport { error: 0.9, data_albedo: [0.0; 3], ..odd.clone() });
    report.views.push(ViewReport { largest_weight: f64::NAN, ..odd.clone() });
    assert!(verdict(&report).off.is_empty());
    report.views.push(odd);
    let off = verdict(&report).off;
    assert!(off.len() == 1 && off[0].contains("inf at 85.0 degrees"), "{off:?}");
    assert_eq!(Summary::new(&report).to_json()["largest_weight_over_mean"]["worst"], 2.5);
}

#[test]
fn steps_matter_where_there_is_something_to_gain() {
    let ended = |ending, measure, weight| {
        let mut report = Report { ending: Some(ending), ..report() };
        report.views.iter_mut().for_each(|v| v.measure = measure);
        report.views[2].largest_weight = weight;
        report.notes().iter().any(|note| note.contains("ended with its steps"))
    };
    assert!(!ended(Ending::Steps, 0.045, 17.0));
    assert!(ended(Ending::Steps, 0.055, 17.0) && ended(Ending::Steps, 0.045, 19.0));
    assert!(!ended(Ending::Converged, 0.055, 19.0));
}

#[test]
fn advice_follows_what_is_off_and_what_there_is() {
    let mut off_peak = report();
    off_peak.held_out[0].seen.chroma = 0.3;
    let tried = |made: Made, report: &Report| Verdict::new(report, &RECIPROCAL, Some(made)).advice.join("\n");
    assert!(tried(MADE, &off_peak).starts_with("--factors 24x10"));
    assert!(!tried(Made { has_factors: true, ..MADE }, &off_peak).contains("--factors"));
    assert!(!tried(Made { is_isotropic: false, ..MADE }, &off_peak).contains("--factors"));
    assert!(!tried(MADE, &off_peak).contains("--lobes"));
    let with_factors = Made { has_factors: true, ..MADE };
    assert!(tried(with_factors, &off_peak).starts_with("--lobes 18 rather than 12"));
    assert!(!tried(Made { lobes: 64, ..with_factors }, &off_peak).contains("--lobes"));
    let samples = Report { held_out: vec![], views: off_peak.held_out.clone(), ..Report::default() };
    assert!(!tried(MADE, &samples).contains("--factors"));

    let mut between = report();
    between.held_out.iter_mut().for_each(|v| v.error = 0.07);
    assert!(tried(MADE, &between).contains("--views 23 rather than 15"), "{}", tried(MADE, &between));
    let mut spiky = report();
    spiky.views[1].largest_weight = 164.0;
    assert!(tried(MADE, &spiky).starts_with("`Defensive`") && tried(MADE, &spiky).contains("164"));
    // Another method has other choices, or none.
    assert!(Verdict::new(&between, &RECIPROCAL, None).advice.is_empty());
}

#[test]
fn asymmetric_data_are_said() {
    let mut report = report();
    report.views[0].floor = 0.025;
    let fair = verdict(&report).fair;
    assert!(fair.len() == 1 && fair[0].starts_with("asymmetric data: at 0.0 degrees 2.5 %"), "{fair:?}");
    report.views[0].floor = 0.015;
    assert!(verdict(&report).fair.is_empty());
}

#[test]
fn the_median_is_one_of_the_numbers() {
    let views: Vec<_> = [3.0, 1.0, 2.0, 9.0].map(|x| ViewReport { error: x, ..view(10.0 * x) }).into();
    let found = Spread::of(views.iter(), |v| v.error).unwrap();
    assert_eq!((found.median, found.worst), (2.0, 9.0));
    assert!((found.worst_at.to_degrees() - 90.0).abs() < 1e-9);
    assert!(Spread::of(views[..0].iter(), |v| v.error).is_none());
}

/// The words as they are printed.
#[test]
fn the_text_of_a_report() {
    let mut report = report();
    report.held_out[1].seen = Seen { peak: 0.05, off_peak: 0.31, luminance: 0.11, chroma: 0.12 };
    report.views.push(ViewReport { largest_weight: 164.0, variance: 0.9, ..view(86.0) });
    let found = Verdict::new(&report, &Reciprocity { median: 0.12, ..RECIPROCAL }, Some(MADE));
    let text = "\
good relative L2: median 3.0 %, at most 3.0 %, at 60.0 degrees
good luminance off the peak: median 4.0 %, at most 11.0 %, at 60.0 degrees
good energy: median 0.0 %, at most 0.0 %, at 60.0 degrees
fair reciprocity: |ln f(a, b) / f(b, a)| is 0.120 in the median, at most 0.600
off  L2 off the peak: 31.0 % at 60.0 degrees, above 20.0 % at 1 of 6 views; median 6.0 %
off  colour off the peak: 0.120 at 60.0 degrees, above 0.100 at 1 of 6 views; median 0.020
off  variance of f cos / pdf: 0.900 at 86.0 degrees, above 0.250 at 1 of 6 views; median 0.020
off  largest weight over the mean: 164.0 at 86.0 degrees, above 18.0 at 1 of 6 views; median 2.5
try  --factors 24x10: a table of factors is for what is off the peak, 6.0 % of L2 in the median here
try  `Defensive` sampling where the table stays the truth: it bounds the weight, 164 here";
    assert_eq!(found.lines().join("\n"), text);
    assert!(found.lines().iter().all(|line| line.len() <= 110));
}

#[test]
fn values_in_other_units_are_said() {
    for (albedo, word) in
        [(1.0, None), (0.002, None), (2.0, Some("by pi")), (40.0, Some("10^2")), (1e-5, Some("10^4"))]
    {
        let mut report = report();
        report.views.iter_mut().for_each(|view| view.data_albedo = [albedo; 3]);
        let found = verdict(&report).off.into_iter().find(|text| text.starts_with("units"));
        assert_eq!(found.is_some(), word.is_some(), "{albedo}: {found:?}");
        assert!(word.is_none_or(|word| found.unwrap().contains(word)), "{albedo}");
    }
}
