//! Gain and price of rows of 16-bit numbers: `cargo run --release -p srbf-benches --example rows16`.
//!
//! Each number of the views of a preset but its angles is rounded to 65536 steps over the range that the file allows; angles stay as
//! they are, as their digits count by the root of the sharpness. The error is that of values, relative to the largest value of the
//! same outgoing direction, over 200 outgoing directions between and upon the views, and 500 incident ones each, of which half are
//! drawn from the lobes.

use srbf_benches::harness::Table;
use srbf_benches::{GARNET_RED, Random};
use srbf_core::{Line, Material, Mixture, PlaneLobe, View};

/// Ranges as the file has them: logarithms of sharpness, of luminance, of squeeze; colour differences.
const SHARPNESS: [f32; 2] = [-100.0, 26.5];
const LUMINANCE: [f32; 2] = [-126.0, 60.0];
const SQUEEZE: [f32; 2] = [-5.0, 6.64];
const DIFFERENCE: [f32; 2] = [-16.0, 16.0];

fn main() {
    let heads = ["bytes", "of 16 bits", "file's range: largest, mean", "preset's own: largest, mean"];
    let mut table = Table::new("preset", heads);
    for (name, bytes) in [
        ("garnet_red", GARNET_RED),
        ("cayman", &include_bytes!("../../presets/cayman.srbf")[..]),
        ("krylon_blue", &include_bytes!("../../presets/krylon_blue.srbf")[..]),
    ] {
        let material = Material::from_bytes(bytes).expect("a valid material");
        let (lobes, views) = (material.view_lobe_count(), material.view_count());
        // Of five numbers of a lobe four, and the four of a head.
        let saved = 2 * views * (4 * lobes + 4);
        let wide = [SHARPNESS, LUMINANCE, SQUEEZE, DIFFERENCE];
        let errors = [error(&material, wide), error(&material, own(&material))];
        let [wide, own] = errors.map(|[largest, mean]| format!("{largest:.1e} {mean:.1e}"));
        table.row(name, [bytes.len().to_string(), (bytes.len() - saved).to_string(), wide, own]);
    }
    table.print();
}

/// The lobes of a view.
fn lobes_of<'a>(material: &'a Material<&'static [u8]>, view: usize) -> impl Iterator<Item = PlaneLobe> + 'a {
    (0..material.view_lobe_count()).filter_map(move |k| material.view_lobe(view, k))
}

/// The ranges that the numbers of a preset have, which a head of its own would store.
fn own(material: &Material<&'static [u8]>) -> [[f32; 2]; 4] {
    let mut ranges = [[f32::INFINITY, f32::NEG_INFINITY]; 4];
    let mut see = |which: usize, number: f32| {
        // What stands for none needs no step of its own.
        if number > -126.0 {
            ranges[which] = [ranges[which][0].min(number), ranges[which][1].max(number)];
        }
    };
    for view in 0..material.view_count() {
        for lobe in lobes_of(material, view) {
            see(0, lobe.log2_sharpness);
            see(1, lobe.log2_luminance);
            lobe.color_differences.into_iter().for_each(|d| see(3, d));
        }
        see(1, material.view_log2_diffuse(view).expect("a view"));
        see(2, material.view_log2_squeeze(view).expect("a view"));
        let differences = material.view_diffuse_color_differences(view).expect("a view");
        differences.into_iter().for_each(|d| see(3, d));
    }
    ranges
}

/// The nearest of 65536 numbers over a range; what stands for none stays, and 0, which a view at the normal must have for its squeeze.
fn rounded(number: f32, [low, high]: [f32; 2]) -> f32 {
    if number <= -126.0 || number == 0.0 || high <= low {
        return number;
    }
    let step = (high - low) / 65535.0;
    ((number - low) / step).round() * step + low
}

/// The same material of rounded numbers.
fn of_16_bits(material: &Material<&'static [u8]>, ranges: [[f32; 2]; 4]) -> Material<Vec<u8>> {
    let [sharpness, luminance, squeeze, difference] = ranges;
    let every = 0..material.view_count();
    let lobes: Vec<Vec<PlaneLobe>> = every
        .clone()
        .map(|view| {
            let of = |lobe: PlaneLobe| PlaneLobe {
                log2_sharpness: rounded(lobe.log2_sharpness, sharpness),
                log2_luminance: rounded(lobe.log2_luminance, luminance),
                color_differences: lobe.color_differences.map(|d| rounded(d, difference)),
                ..lobe
            };
            lobes_of(material, view).map(of).collect()
        })
        .collect();
    let view = |v: usize| {
        Some(View {
            theta: material.view_theta(v)?,
            log2_squeeze: rounded(material.view_log2_squeeze(v)?, squeeze),
            log2_diffuse: rounded(material.view_log2_diffuse(v)?, luminance),
            diffuse_color_differences: material
                .view_diffuse_color_differences(v)?
                .map(|d| rounded(d, difference)),
            lobes: &lobes[v],
        })
    };
    let views: Vec<View<'_>> = every.map(|v| view(v).expect("a view")).collect();
    let (squeezed, mirrored) = (material.squeezed_count(), material.mirrored_count());
    let line = Line { views: &views, squeezed, mirrored, factors: None };
    let mut bytes = vec![0; line.encoded_len("")];
    line.encode("", &mut bytes).expect("a valid material");
    Material::from_bytes(bytes).expect("a valid material")
}

/// The largest and the mean error.
fn error(material: &Material<&'static [u8]>, ranges: [[f32; 2]; 4]) -> [f64; 2] {
    let other = of_16_bits(material, ranges);
    let mut random = Random(8);
    let (mut largest, mut sum, mut count) = (0f64, 0f64, 0);
    let mut mixture = Mixture::<64>::empty();
    for _ in 0..200 {
        let wo = random.direction();
        material.prepare(wo, &mut mixture).expect("a direction");
        let mut values = Vec::new();
        for i in 0..500 {
            let u = [random.uniform(), random.uniform(), random.uniform()];
            let wi = match mixture.sample_direction(u) {
                Some(drawn) if i % 2 == 0 => drawn,
                _ => random.direction(),
            };
            values.push((material.evaluate(wo, wi), other.evaluate(wo, wi)));
        }
        let peak = values.iter().fold(0f32, |peak, (value, _)| peak.max(value.max_element()));
        for (value, rounded) in values {
            let off = f64::from((value - rounded).abs().max_element() / peak);
            largest = largest.max(off);
            sum += off;
            count += 1;
        }
    }
    [largest, sum / f64::from(count)]
}
