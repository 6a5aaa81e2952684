//! The measurements of the survey on one material, as a row.

/// One material. Errors are relative L2 of `f cos`, percent, mean over the views; NaN where the thesis was left out.
#[derive(Clone, Debug)]
pub struct SurveyRow {
    pub name: String,
    /// Ours within 15 degrees of the mirror direction, and beyond; there the median error of the luminance, percent, and that of the
    /// colour. Means over the outgoing directions at 5, 30, 60 and 75 degrees.
    pub peak: f64,
    pub off_peak: f64,
    pub luminance: f64,
    pub chroma: f64,
    /// Our error at the views.
    pub fit: f64,
    /// Our error halfway between.
    pub halfway: f64,
    /// Halfway, our lobes at the views blended by equation 9, and over the two nearest views.
    pub blended: f64,
    pub blended_two: f64,
    /// The thesis's method: at the views; halfway by equation 9; over the two nearest views.
    pub thesis_fit: f64,
    pub eq9: f64,
    pub eq9_two: f64,
    /// Our error at the views where equation 9 is judged.
    pub same_views: f64,
    /// Relative variance of `f cos / pdf` halfway, median and worst view, and the median of the thesis's lobes.
    pub variance_median: f64,
    pub variance_worst: f64,
    pub thesis_variance: f64,
    /// Largest `f cos / pdf` over its mean, halfway.
    pub weight: f64,
    /// The same over all views, halfway and fitted, whatever their angle.
    pub weight_anywhere: f64,
    /// Largest error of an albedo halfway, percent.
    pub energy: f64,
    /// Median of `|ln f(a, b) / f(b, a)|`.
    pub reciprocity: f64,
    /// Part of the data halfway that differs from their mirror image, percent: fits and errors are of one side.
    pub handedness: f64,
    pub bytes: f64,
    /// Of those, the bytes of the table of factors, 0 if there is none; and its largest factor, 1 if there is none.
    pub factor_bytes: f64,
    pub largest_factor: f64,
    pub seconds: f64,
    pub thesis_seconds: f64,
    /// Whether it is a measured table; else a network that was fitted to one.
    pub is_measured: bool,
    /// Visible difference of pictures of a ball; colour that ripples along the view angle, over that of the table; colour from 1.5 to 15
    /// degrees from the mirror direction; and the noise of the table's luminance, percent. See `srbf_fit::judge::appearance`.
    pub visible: f64,
    pub ripple: f64,
    pub skirt: f64,
    pub noise: f64,
    /// Two GGX lobes with a diffuse term, where ours are judged by visible errors: at the peak, and the luminance beyond, percent; the colour.
    pub ggx_peak: f64,
    pub ggx_luminance: f64,
    pub ggx_chroma: f64,
    /// The same of RGL's own table, made so coarse that it has about as many bytes as a material.
    pub rgl_peak: f64,
    pub rgl_luminance: f64,
    pub rgl_chroma: f64,
    pub rgl_bytes: f64,
}

/// The names of the columns.
pub const LEGEND: &str = "fit, halfway: relative L2 of f cos in %, mean over the views and over those in between; \
    peak, off peak: within 15 degrees of the mirror direction and beyond, lumin., chroma: median errors beyond, at 5, 30, 60 and 75 degrees; \
    blend: halfway, our lobes at the views blended by eq. 9 over the 3 or 4 nearest views, and over 2; thesis: the same of \
    its own lobes, halfway between even views; ours there: our fit at those; var: relative variance of f cos / pdf, \
    and weight: largest over mean, views to 80 degrees; anywhere: at any view; factors: bytes of their table, largest: of them; \
    handed: how far the data, halfway, differ from their mirror image, %: fits and errors are of one side; visible: difference of pictures of a ball; ripple: of colour along the view angle, over \
    the table's; skirt: colour from 1.5 to 15 degrees from the mirror; noise: of the table's luminance, %; GGX: two lobes and a \
    diffuse term; RGL: its own table, coarse; with 6 to 11 lobes, or lobes in pairs, ours has more views in the same bytes";

/// Name in CSV, heading, digits after the point, and number.
type Column = (&'static str, &'static str, usize, fn(&SurveyRow) -> f64);

const COLUMNS: [Column; 37] = [
    ("fit_percent", "fit", 2, |r| r.fit),
    ("halfway_percent", "halfway", 2, |r| r.halfway),
    ("peak_percent", "peak", 2, |r| r.peak),
    ("off_peak_percent", "off peak", 2, |r| r.off_peak),
    ("off_peak_luminance_percent", "lumin.", 2, |r| r.luminance),
    ("off_peak_chroma", "chroma", 3, |r| r.chroma),
    ("halfway_over_fit", "ratio", 2, SurveyRow::ratio),
    ("blended_eq9_percent", "blend", 2, |r| r.blended),
    ("blended_two_percent", "blend 2", 2, |r| r.blended_two),
    ("thesis_fit_percent", "thesis", 2, |r| r.thesis_fit),
    ("thesis_eq9_percent", "its eq. 9", 2, |r| r.eq9),
    ("thesis_two_percent", "over 2", 2, |r| r.eq9_two),
    ("at_views_of_eq9_percent", "ours there", 2, |r| r.same_views),
    ("variance_median", "var", 4, |r| r.variance_median),
    ("variance_worst", "worst var", 3, |r| r.variance_worst),
    ("thesis_variance_median", "its var", 3, |r| r.thesis_variance),
    ("largest_weight", "weight", 2, |r| r.weight),
    ("largest_weight_anywhere", "anywhere", 2, |r| r.weight_anywhere),
    ("energy_error_percent", "energy %", 2, |r| r.energy),
    ("reciprocity_median", "recip.", 3, |r| r.reciprocity),
    ("handedness_percent", "handed", 2, |r| r.handedness),
    ("bytes", "bytes", 0, |r| r.bytes),
    ("factor_bytes", "factors", 0, |r| r.factor_bytes),
    ("largest_factor", "largest", 2, |r| r.largest_factor),
    ("seconds", "s", 1, |r| r.seconds),
    ("thesis_seconds", "its s", 1, |r| r.thesis_seconds),
    ("visible_difference", "visible", 3, |r| r.visible),
    ("ripple_over_table", "ripple", 2, |r| r.ripple),
    ("skirt_chroma", "skirt", 3, |r| r.skirt),
    ("noise_percent", "noise", 2, |r| r.noise),
    ("ggx_peak_percent", "GGX peak", 2, |r| r.ggx_peak),
    ("ggx_luminance_percent", "GGX lum.", 2, |r| r.ggx_luminance),
    ("ggx_chroma", "GGX chr.", 3, |r| r.ggx_chroma),
    ("rgl_peak_percent", "RGL peak", 2, |r| r.rgl_peak),
    ("rgl_luminance_percent", "RGL lum.", 2, |r| r.rgl_luminance),
    ("rgl_chroma", "RGL chr.", 3, |r| r.rgl_chroma),
    ("rgl_bytes", "RGL bytes", 0, |r| r.rgl_bytes),
];

impl Default for SurveyRow {
    fn default() -> Self {
        let nan = f64::NAN;
        Self {
            name: String::new(),
            peak: nan,
            off_peak: nan,
            luminance: nan,
            chroma: nan,
            fit: nan,
            halfway: nan,
            blended: nan,
            blended_two: nan,
            thesis_fit: nan,
            eq9: nan,
            eq9_two: nan,
            same_views: nan,
            variance_median: nan,
            variance_worst: nan,
            thesis_variance: nan,
            weight: nan,
            weight_anywhere: nan,
            energy: nan,
            reciprocity: nan,
            handedness: nan,
            bytes: nan,
            factor_bytes: nan,
            largest_factor: nan,
            seconds: nan,
            thesis_seconds: nan,
            is_measured: false,
            visible: nan,
            ripple: nan,
            skirt: nan,
            noise: nan,
            ggx_peak: nan,
            ggx_luminance: nan,
            ggx_chroma: nan,
            rgl_peak: nan,
            rgl_luminance: nan,
            rgl_chroma: nan,
            rgl_bytes: nan,
        }
    }
}

impl SurveyRow {
    /// Error halfway over error at the views.
    pub fn ratio(&self) -> f64 {
        self.halfway / self.fit
    }

    /// The heading of printed lines.
    pub fn header() -> String {
        let columns = COLUMNS.map(|c| format!("{:>10}", c.1));
        format!("{:32} {}", "material", columns.join(" "))
    }

    /// The printed line; `-` for missing numbers.
    pub fn line(&self) -> String {
        line(&self.name, &COLUMNS.map(|c| (c.3)(self)))
    }

    /// The heading of the CSV file.
    pub fn csv_header() -> String {
        format!("material,{}", COLUMNS.map(|c| c.0).join(","))
    }

    /// The line of the CSV file; missing numbers are empty.
    pub fn csv(&self) -> String {
        let field = |v: f64| if v.is_nan() { String::new() } else { format!("{v:.6}") };
        format!("{},{}", self.name, COLUMNS.map(|c| field((c.3)(self))).join(","))
    }

    /// The printed line of a quantile of each column.
    pub fn quantile_line<'a>(name: &str, rows: impl Iterator<Item = &'a Self> + Clone, share: f64) -> String {
        line(name, &COLUMNS.map(|c| quantile(rows.clone().map(c.3).collect(), share)))
    }
}

fn line(name: &str, numbers: &[f64; COLUMNS.len()]) -> String {
    let field = |(v, c): (&f64, &Column)| {
        if v.is_nan() { format!("{:>10}", "-") } else { format!("{v:10.*}", c.2) }
    };
    let fields: Vec<String> = numbers.iter().zip(&COLUMNS).map(field).collect();
    format!("{name:32} {}", fields.join(" "))
}

/// The value that a share of the others does not exceed; NaN counts as largest, and is that of an empty list.
pub fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let index = (share * values.len().saturating_sub(1) as f64).round() as usize;
    values.get(index).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_have_as_many_fields_as_headings_and_no_number_is_dropped() {
        let row = SurveyRow { name: "a".into(), fit: 2.0, halfway: 3.0, ..SurveyRow::default() };
        assert_eq!(row.csv().split(',').count(), SurveyRow::csv_header().split(',').count());
        assert!(row.csv().starts_with("a,2.000000,3.000000,,,,,1.500000,,"), "{}", row.csv());
        assert_eq!(row.line().chars().count(), SurveyRow::header().chars().count());
    }

    #[test]
    fn quantiles() {
        let values = || vec![3.0, 1.0, 2.0];
        assert_eq!([0.0, 0.5, 1.0].map(|s| quantile(values(), s)), [1.0, 2.0, 3.0]);
        assert!(quantile(vec![], 0.5).is_nan());
    }
}
