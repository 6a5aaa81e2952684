//! Dev.
use srbf_fit::judge::report::{ViewReport, mean_error};
use srbf_fit::read::{Content, neural, read};
use srbf_fit::table::evaluation_views;
use srbf_fit::{FactorNodes, Settings, TrackedLobes, fit_content};
fn main() {
    let data = std::env::var("SRBF_DATA_DIR").unwrap();
    let get = |k: &str| std::env::var(k).ok();
    let mut settings = Settings::default();
    if let Some(l) = get("LOBES") { settings.lobes = l.parse().unwrap(); }
    if let Some(l) = get("VIEWS") { settings.views = Some(l.parse().unwrap()); }
    if let Some(f) = get("FACTORS") {
        settings.factors = match f.as_str() { "none" => FactorNodes::None, "chosen" => FactorNodes::Chosen, _ => { let (a, b) = f.split_once('x').unwrap(); FactorNodes::Given([a.parse().unwrap(), b.parse().unwrap()]) } };
    }
    for name in std::env::args().skip(1) {
        let content = if let Some(n) = name.strip_prefix("n:") {
            let names = std::fs::read_to_string(format!("{data}/merl/nbrdf_merl80_names.txt")).unwrap();
            let i = names.split_whitespace().position(|x| x == n).unwrap();
            Content::Evaluable(Box::new(neural::parse(&std::fs::read(format!("{data}/merl/nbrdf_merl80.f32le")).unwrap()).unwrap().into_iter().nth(i).unwrap()))
        } else { read(std::path::Path::new(&format!("{data}/rgl/{name}_rgb.bsdf"))).unwrap().content };
        let Content::Evaluable(brdf) = &content else { panic!() };
        let fit = fit_content(&content, &settings, |_| {}).unwrap();
        let lobes = TrackedLobes { bytes: fit.bytes.clone() };
        std::fs::write(format!("/work/tmp/try-{}.srbf", name.replace("n:", "")), &fit.bytes).unwrap();
        let m = srbf_core::Material::from_bytes(&fit.bytes).unwrap();
        let placed = lobes.knots().unwrap();
        let half = evaluation_views::judging_table(brdf.as_ref(), &evaluation_views::halfway(&placed)).unwrap();
        let between: Vec<ViewReport> = half.views.iter().map(|v| ViewReport::judge(&lobes, v).unwrap()).collect();
        let low: Vec<&ViewReport> = between.iter().filter(|v| v.theta.to_degrees() <= 80.0).collect();
        let worst = |f: fn(&ViewReport) -> f64| low.iter().map(|v| f(v)).fold(0.0, f64::max);
        let table = evaluation_views::judging_table(brdf.as_ref(), &[0.0f64, 5.0, 30.0, 60.0, 75.0].map(f64::to_radians)).unwrap();
        let seen: Vec<ViewReport> = table.views.iter().map(|v| ViewReport::judge(&lobes, v).unwrap()).collect();
        let join = |f: &dyn Fn(&ViewReport) -> String| seen.iter().map(f).collect::<Vec<_>>().join(" ");
        println!("{name:24} half {:5.2} | off {} | lum {} | chr {} | peak {} | var {:.3} wt {:.1} en {:.2} | {} B {:?} max {:.2} {:.1} s",
            100.0 * mean_error(&between), join(&|v| format!("{:.0}", 100.0 * v.seen.off_peak)), join(&|v| format!("{:.0}", 100.0 * v.seen.luminance)), join(&|v| format!("{:.2}", v.seen.chroma)), join(&|v| format!("{:.1}", 100.0 * v.seen.peak)),
            worst(|v| v.variance), worst(|v| v.largest_weight), 100.0 * worst(ViewReport::energy_error), fit.bytes.len(), m.factor_nodes(), m.largest_factor(), fit.report.seconds);
    }
}
