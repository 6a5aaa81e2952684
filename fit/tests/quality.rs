//! How good fits are, without data: three models, each error within a tenth of a stated value. Worse fails, and so does better: then
//! the stated value is stale, and the figures in `docs/figures.md` with it.
//!
//! `cargo test --release -p srbf-fit --test quality -- --nocapture` prints the errors, and the gain of each optional stage.

use srbf_fit::read::Content;
use srbf_fit::table::Brdf;
use srbf_fit::{FactorNodes, Settings, fit_content};
use std::path::Path;
use std::sync::LazyLock;

/// A flake paint: over a grey base a ring of colours round a highlight, which no sum of lobes makes.
struct Ring;

impl Brdf for Ring {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let sum = [0, 1, 2].map(|k| wi[k] + wo[k]);
        let half = sum[2] / sum.iter().map(|v| v * v).sum::<f64>().sqrt();
        let angle = half.min(1.0).acos();
        let highlight = 2.0 * (400.0 * (half - 1.0)).exp();
        [0.30, 0.38, 0.46].map(|at: f64| 0.05 + highlight + 0.15 * (-(angle - at).powi(2) / 0.004).exp())
    }
}

/// Fewer lobes, views and starts than by default: a few seconds in all.
fn settings() -> Settings {
    // Small tables of factors: larger ones do what pairs of lobes do.
    Settings { lobes: 6, views: Some(8), starts: 4, exchanges: 6, bytes: 3600, ..Settings::default() }
}

fn model(name: &str) -> Content {
    srbf_fit::read::read(Path::new(name)).unwrap().content
}

fn models() -> [(&'static str, Content); 3] {
    [
        ("ggx", model("model:ggx:alpha=0.15,ior=1.5,diffuse=0.2/0.1/0.05")),
        ("phong", model("model:phong:diffuse=0.1,specular=0.5/0.3/0.1,exponent=200")),
        ("ring", Content::Evaluable(Box::new(Ring))),
    ]
}

/// The measure halfway between the views, percent, mean; and its relative L2 part.
fn errors(content: &Content, settings: &Settings) -> [f64; 2] {
    let fit = fit_content(content, settings, |_| {}).unwrap();
    let views = &fit.report.held_out;
    let mean = |sum: f64| 100.0 * sum / views.len() as f64;
    [mean(views.iter().map(|v| v.measure).sum()), mean(views.iter().map(|v| v.error).sum())]
}

/// The errors of all models with all stages, fitted once for both tests.
static WITH_ALL: LazyLock<Vec<[f64; 2]>> =
    LazyLock::new(|| models().iter().map(|model| errors(&model.1, &settings())).collect());

fn geometric_mean(errors: &[[f64; 2]]) -> f64 {
    (errors.iter().map(|error| error[0].ln()).sum::<f64>() / errors.len() as f64).exp()
}

#[test]
fn errors_are_as_stated() {
    let stated = [1.643, 1.003, 2.963];
    let models = models();
    for ((name, _), found) in models.iter().zip(WITH_ALL.iter()) {
        println!("{name}: measure {:.3} %, relative L2 {:.3} %", found[0], found[1]);
    }
    for ((name, _), (found, stated)) in models.iter().zip(WITH_ALL.iter().zip(stated)) {
        assert!((found[0] / stated - 1.0).abs() < 0.1, "{name}: {:.3} %, stated {stated} %", found[0]);
    }
}

#[test]
fn optional_stages_pay() {
    let all = settings();
    let stages: [(&str, Settings, f64); 2] = [
        ("pairs beside the plane", Settings { mirrored: Some(0), ..all.clone() }, 1.02),
        ("factors", Settings { factors: FactorNodes::None, ..all.clone() }, 1.2),
    ];
    let models = models();
    let with = geometric_mean(&WITH_ALL);
    println!("all stages: measure {with:.3} %, geometric mean of three models");
    for (name, without, least) in stages {
        let found: Vec<[f64; 2]> = models.iter().map(|model| errors(&model.1, &without)).collect();
        let gain = geometric_mean(&found) / with;
        println!("without {name}: {gain:.3} times that");
        assert!(gain > least, "{name} buys {gain:.3}, at least {least} expected");
    }
}
