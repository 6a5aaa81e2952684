//! Scratch.
#![allow(missing_docs)]
use srbf_fit::complete::complete;
use srbf_fit::read::{self, Content};
use srbf_fit::table::Brdf;
use srbf_fit::{Settings, fit};
use std::path::Path;
fn dir(theta: f64, phi: f64) -> [f64; 3] {
    let (t, p) = (theta.to_radians(), phi.to_radians());
    [t.sin() * p.cos(), t.sin() * p.sin(), t.cos()]
}
fn cpu() -> f64 {
    let s = std::fs::read_to_string("/proc/self/stat").unwrap();
    let f: Vec<&str> = s.rsplit(')').next().unwrap().split_whitespace().collect();
    (f[11].parse::<f64>().unwrap() + f[12].parse::<f64>().unwrap()) / 100.0
}
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let a: Vec<String> = std::env::args().skip(1).collect();
    let source = read::read(Path::new(&a[1]))?;
    let Content::Samples(table) = &source.content else { return Err("not samples".into()) };
    if a[0].starts_with("cv") {
        use srbf_fit::baselines::evaluated::Completed;
        let settings = Settings::default();
        let tracked = srbf_fit::Tracked(&settings);
        let method: &dyn srbf_fit::judge::method::Method = if a[0] == "cv" { &Completed } else { &tracked };
        let cv = srbf_fit::judge::cross::cross_validate(table, method)?;
        println!("{} {} means {:.4?} folds {:.3?} views {:.3?} cpu {:.1}", a[0], a[1], cv.means(), cv.folds, cv.left_out.iter().map(|v| v.1).collect::<Vec<_>>(), cpu());
        return Ok(());
    }
    let t = cpu();
    let c = complete(table)?;
    let r = &c.report;
    println!("completion {:.2} s: {:?} samples {} points {} outliers {} width {:.4} exponent {:.3} lengths {:?} noise {} left out: samples {:.4} {:.4} views {:?} model alone {:.4} {:.4}",
        cpu() - t, r.family, r.samples, r.points, r.outliers.len(), r.width, r.exponent, r.lengths, r.noise, r.samples_left_out.error, r.samples_left_out.logarithm,
        r.views_left_out.as_ref().map(|v| (v.error, v.logarithm)), r.model_alone.error, r.model_alone.logarithm);
    for o in r.outliers.iter().take(12) {
        let v = &table.views[o.view];
        let s = &v.samples[o.sample];
        println!("  outlier view {:.0} sample {} direction {:.2?} rgb {:.4?} ratio {:.3}", v.theta.to_degrees(), o.sample, s.direction, s.rgb, o.ratio);
    }
    for at in a.iter().skip(2) {
        let v: Vec<f64> = at.split(',').map(|v| v.parse().unwrap()).collect();
        let f = c.evaluate(dir(v[0], v[1]), dir(v[2], v[3]));
        println!("  f({at}) = {:.4} {:.4} {:.4}", f[0], f[1], f[2]);
    }
    println!("peak, f cos:");
    for t in [0.0, 5.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0] {
        let f = c.evaluate(dir(t, 0.0), dir(t, 180.0)).map(|v| v * t.to_radians().cos());
        println!("  {t:4} {:9.4} {:9.4} {:9.4}", f[0], f[1], f[2]);
    }
    if a[0] == "fit" {
        let t = cpu();
        let fit = fit(table, &Settings::default(), |_| {})?;
        println!("fit cpu {:.2} with completion", cpu() - t);
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
        let own: Vec<f64> = fit.report.views.iter().map(|v| v.error).collect();
        let held: Vec<f64> = fit.report.held_out.iter().map(|v| v.error).collect();
        println!("own views mean {:.4}; held out of completion mean {:.4}", mean(&own), mean(&held));
    }
    Ok(())
}
