use super::*;
use crate::complete::CompletionReport;
use crate::complete::Gaps;
use crate::complete::held_out::HeldOut;
use crate::judge::measure::RegionErrors;

/// A view without a fault.
fn view(degrees: f64) -> ViewReport {
    ViewReport {
        theta: degrees.to_radians(),
        azimuth: 0.0,
        error: 0.03,
        measure: 0.035,
        is_black: false,
        is_contradicted: false,
        albedo: [0.5, 0.4, 0.3],
        data_albedo: [0.5, 0.4, 0.3],
        is_albedo_cut: false,
        density: 1.0,
        variance: 0.02,
        largest_weight: 2.5,
        regions: RegionErrors { peak: 0.02, off_peak: 0.06, luminance: 0.04, chroma: 0.02 },
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

fn verdict(report: &Report) -> Verdict {
    Verdict::of_material(report, &RECIPROCAL)
}

#[test]
fn a_good_fit_has_only_good_in_it_and_no_advice() {
    let found = verdict(&report());
    assert_eq!(found.good.len(), CRITERIA.len() + 1, "{found:?}");
    assert!(found.fair.is_empty() && found.off.is_empty() && found.advice.is_empty(), "{found:?}");
}

/// Sets a number of a view.
type Set = fn(&mut ViewReport, f64);

/// The criteria with the bound above which they are off, and a setter.
const NOTES: [(&str, f64, Set); 6] = [
    ("L2 off the peak", 0.2, |v, x| v.regions.off_peak = x),
    ("luminance off the peak", 0.15, |v, x| v.regions.luminance = x),
    ("colour off the peak", 0.1, |v, x| v.regions.chroma = x),
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
    report.views.push(ViewReport { is_contradicted: true, ..odd.clone() });
    report.views.push(ViewReport { error: 0.9, data_albedo: [0.0; 3], ..odd.clone() });
    report.views.push(ViewReport { largest_weight: f64::NAN, ..odd.clone() });
    assert!(verdict(&report).off.is_empty());
    report.views.push(odd);
    let off = verdict(&report).off;
    assert!(off.len() == 1 && off[0].contains("inf at 85.0 degrees"), "{off:?}");
    assert_eq!(Summary::new(&report).to_json()["largest_weight_over_mean"]["worst"], 2.5);
}

#[test]
fn advice_is_what_helps_whatever_the_fit() {
    let mut spiky = report();
    spiky.views[1].largest_weight = 164.0;
    let advice = |report: &Report| verdict(report).advice.join("\n");
    assert!(advice(&spiky).starts_with("`Defensive`") && advice(&spiky).contains("164"));
    // Fits by other methods have other choices, or none.
    assert!(Verdict::new(&spiky, &RECIPROCAL).advice.is_empty());
    // More lobes, views or factors are not known to help.
    let mut off_peak = report();
    off_peak.held_out[0].regions.chroma = 0.3;
    off_peak.held_out[1].error = 0.3;
    assert!(advice(&off_peak).is_empty());
}

/// A fit as it looks.
fn looks(visible: f64) -> Appearance {
    use crate::judge::appearance::{Grain, Ripple, Skirt};
    Appearance {
        pictures: vec![("sun at 20 degrees", 0.5 * visible), ("sky", 1.5 * visible)],
        of_noise: 0.01,
        is_dark: false,
        skirt: Skirt { luminance: 0.05, chroma: 0.03, negative: 0.0 },
        ghost: (0.02, 0.5),
        ripple: [Ripple { luminance: 0.02, chroma: 0.015 }, Ripple { luminance: 0.02, chroma: 0.014 }],
        grain: [Grain { luminance: 0.02, chroma: 0.01, coarse: 0.05 }; 2],
        bite: 1.1,
        ring: [1.0; 2],
    }
}

#[test]
fn the_sentence_says_whether_to_use_it_and_what_is_seen() {
    let said = |appearance: Appearance| {
        let report = Report { appearance: Some(appearance), ..report() };
        verdict(&report).lines().remove(0)
    };
    assert!(
        said(looks(0.03)).starts_with("use it: balls differ by 0.030 from the table's, by 0.045 under a sky")
    );
    assert!(said(looks(0.15)).starts_with("use it with care"));
    assert!(said(looks(0.3)).starts_with("do not use it"));
    let mut ringed = looks(0.03);
    ringed.ripple[0].chroma = 0.03;
    assert!(said(ringed.clone()).contains("rings of colour"));
    // Errors that the table has too are not the fit's.
    ringed.ripple[1].chroma = 0.03;
    assert!(said(ringed).starts_with("use it: "));
    let mut ghostly = looks(0.03);
    ghostly.ghost = (0.4, 1.0);
    assert!(said(ghostly).contains("light where the table is darker, viewed at 57 degrees"));
    let mut fringed = looks(0.03);
    fringed.skirt.negative = 0.4;
    assert!(said(fringed).contains("fringe"));
    let mut shaped = looks(0.03);
    (shaped.grain[0].coarse, shaped.bite, shaped.ring) = (0.1, 2.0, [1.3, 1.0]);
    let text = said(shaped.clone());
    assert!(
        text.contains("lines and corners") && text.contains("lacks a side") && text.contains("a ring"),
        "{text}"
    );
    // Lines that the table has too are not the fit's.
    (shaped.grain[1].coarse, shaped.bite, shaped.ring) = (0.1, 1.0, [1.3, 1.2]);
    assert!(said(shaped).starts_with("use it: "));
    assert!(verdict(&report()).sentence.is_none());
}

#[test]
fn noise_of_the_table_is_no_error_of_the_fit_and_is_said() {
    let mut noisy = Report { appearance: Some(looks(0.03)), ..report() };
    noisy.held_out[0].regions.luminance = 0.2;
    assert!(verdict(&noisy).off[0].starts_with("luminance off the peak"));
    noisy.appearance = noisy.appearance.map(|mut found| {
        found.grain[1].luminance = 0.1;
        found
    });
    let found = verdict(&noisy);
    assert!(
        found.off.is_empty() && found.fair.iter().any(|line| line.starts_with("noisy data")),
        "{found:?}"
    );
}

#[test]
fn the_sentence_is_about_samples_where_there_are_some() {
    let said = |error: f64| {
        let samples_left_out = HeldOut { error, logarithm: 0.1 };
        let completion = Some(CompletionReport { samples_left_out, ..CompletionReport::default() });
        verdict(&Report { appearance: Some(looks(0.03)), completion, ..report() }).lines().remove(0)
    };
    assert!(
        said(0.1).starts_with("use it: samples that are left out are 10 % off; balls differ by 0.030 from those of the completed"),
        "{}",
        said(0.1)
    );
    assert!(said(0.23).starts_with("use it with care: samples that are left out are 23 % off"));
    assert!(said(1e-4).starts_with("use it: samples that are left out are less than 1 % off"));
}

#[test]
fn what_was_not_measured_is_said_in_the_sentence_too() {
    let said = |share: f64, is_of_table: bool| {
        let gaps = Gaps { shares: vec![(0.0, share - 0.05), (40.0, share + 0.05)], is_of_table };
        verdict(&Report { appearance: Some(looks(0.03)), gaps: Some(gaps), ..report() }).lines()
    };
    let half = said(0.5, true);
    let expected = "do not use it as a whole: about half of the table was not measured \
        (most of it at views of 40 degrees); there the fit is a guess; beside the table with its gaps filled, balls differ";
    assert!(half[0].starts_with(expected), "{half:?}");
    assert!(half.iter().any(|line| line.starts_with("off  no value: 50 %")), "{half:?}");
    let fifth = said(0.2, false);
    assert!(
        fifth[0].starts_with("use it with care: about a fifth of all pairs of directions were not"),
        "{fifth:?}"
    );
    assert!(fifth.iter().any(|line| line.starts_with("fair no sample within 20 degrees: 20 %")), "{fifth:?}");
    assert!(said(0.05, true).iter().all(|line| !line.contains("no value")));
}

#[test]
fn a_mirror_is_judged_by_its_highlight() {
    let mut mirror = Report { appearance: Some(Appearance { is_dark: true, ..looks(0.5) }), ..report() };
    mirror.views.iter_mut().chain(&mut mirror.held_out).for_each(|v| v.regions.off_peak = 0.7);
    let lines = verdict(&mirror).lines();
    assert_eq!(lines[0], "use it: the table is a highlight over black, and that is 3.0 % off");
    assert!(lines.iter().all(|line| !line.starts_with("off")), "{lines:?}");
    assert!(lines.iter().any(|line| line.starts_with("fair dark: ")), "{lines:?}");
    mirror.held_out.iter_mut().for_each(|v| v.error = 0.3);
    assert!(verdict(&mirror).lines()[0].starts_with("do not use it: "));
}

#[test]
fn noise_that_is_loud_is_the_tables_and_not_the_fits() {
    let mut noisy = looks(0.12);
    (noisy.grain[1].luminance, noisy.of_noise) = (0.1, 0.08);
    let said = |found: &Appearance| {
        verdict(&Report { appearance: Some(found.clone()), ..report() }).lines().remove(0)
    };
    assert!(
        said(&noisy).starts_with("use it, and not the table, which is noisy: 10 % off"),
        "{}",
        said(&noisy)
    );
    noisy.of_noise = 0.01;
    let said = said(&noisy);
    assert!(
        said.starts_with("use it with care") && said.contains("; the table is noisy: 10 % off"),
        "{said}"
    );
}

#[test]
fn grazing_views_are_not_judged_by_what_is_seen() {
    let mut steep = report();
    steep.views[2] =
        ViewReport { error: 0.5, regions: RegionErrors { chroma: 0.9, ..view(0.0).regions }, ..view(85.0) };
    assert!(verdict(&steep).off.is_empty());
}

#[test]
fn asymmetric_data_are_said() {
    let mut report = report();
    report.views[0].floor = 0.025;
    let fair = verdict(&report).fair;
    assert!(
        fair.len() == 1 && fair[0].starts_with("asymmetric data: at 0.0 degrees they differ by 2.5 %"),
        "{fair:?}"
    );
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

/// The words as they are printed. Visible errors are of the views up to 80 degrees, five of six; variances and weights are of all.
#[test]
fn the_text_of_a_report() {
    let mut report = report();
    report.held_out[1].regions = RegionErrors { peak: 0.05, off_peak: 0.31, luminance: 0.11, chroma: 0.12 };
    report.views.push(ViewReport { largest_weight: 164.0, variance: 0.9, ..view(86.0) });
    let found = Verdict::of_material(&report, &Reciprocity { median: 0.12, ..RECIPROCAL });
    let text = "\
good relative L2: median 3.0 %, at most 3.0 %, at 60.0 degrees
good luminance off the peak: median 4.0 %, at most 11.0 %, at 60.0 degrees
good energy: median 0.0 %, at most 0.0 %, at 60.0 degrees
fair reciprocity: |ln f(a, b) / f(b, a)| is 0.120 in the median, at most 0.600
off  L2 off the peak: 31.0 % at 60.0 degrees, above 20.0 % at 1 of 5 views; median 6.0 %
off  colour off the peak: 0.120 at 60.0 degrees, above 0.100 at 1 of 5 views; median 0.020
off  variance of f cos / pdf: 0.900 at 86.0 degrees, above 0.250 at 1 of 6 views; median 0.020
off  largest weight over the mean: 164.0 at 86.0 degrees, above 18.0 at 1 of 6 views; median 2.5
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
