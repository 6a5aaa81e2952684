//! Visible differences of a fit and its table: pictures of a ball under three lights, rings that stand still with the camera, the
//! surroundings of the highlight, ghosts of it; and the table's own noise, beside which nothing smaller is seen.
//!
//! * *Pictures*: a ball seen from afar, under suns, a spot and a sky. The difference of two colours is that of FLIP
//!   (Andersson et al. 2020): of display colours, the HyAB distance of Lab with Hunt's adjustment, mapped to 0..1; here
//!   point by point, without its filters of contrast and edges. A picture's is the mean over the lit points of the ball up to 80
//!   degrees; the least difference that is seen is 0.06, twice that 0.09.
//! * *Ripple*: a light stands still, and the view is turned. Errors that change their sign from view to view are seen as
//!   rings that move with the camera. Colour and logarithm of luminance have means over 8 degrees of the view to either side. The
//!   measured number is their distance from these means, of the fit and of the table.
//! * *Skirt*: from 1.5 to 15 degrees from the middle of the highlight, which is where the table is brightest.
//! * *Ghosts*: light of the fit beyond that, where the table is darker all round: the visible difference, under a sun there, from the
//!   brightest that the table has within 4 degrees.
//! * *Grain*: how far something is from its own mean over a cone of 3 degrees, away from the peak. Of the table it is noise; grain that the fit
//!   has beyond that shows as lines and corners.
//! * *Bite*: near the normal the highlight of a fit may be brighter on one side than on the other: the largest over the least ratio to the
//!   table, by the azimuth round the mirror direction.
//! * *Ring*: how much the fit's mean round the highlight rises with the angle from its middle, where the table's does not.

use crate::FitError;
use crate::judge::fitted_material::TrackedView;
use crate::judge::measure::chroma;
use crate::judge::method::FittedView;
use crate::numeric::GOLDEN_ANGLE;
use crate::numeric::median::weighted_median;
use crate::table::{Brdf, direction, luminance};
use rayon::prelude::*;
use serde_json::{Value, json};
use srbf_core::Material;
use std::f64::consts::PI;

const SECTION: f64 = 0.618_033_988_75;

/// A highlight is elsewhere than about the mirror direction where the table is brighter by so much.
const ELSEWHERE: f64 = 2.0;

/// Angles of views at which skirt, ghosts and noise are looked at, degrees.
const VIEWS: [f64; 3] = [5.0, 30.0, 60.0];
/// Least cosine of compared directions.
const LEAST_COSINE: f64 = 0.1;
/// Directions of a skirt, and the angles from the middle of the highlight where it begins and ends, degrees.
const SKIRT: usize = 400;
const BEGIN: f64 = 1.5;
const END: f64 = 15.0;
/// Share of the largest channel below 0 from which a channel counts as negative.
const NEGATIVE: f64 = 0.01;
/// Directions at which grain is looked at, those of a cone for a mean, and its half angle, degrees.
const GRAINY: usize = 400;
const CONE: usize = 12;
const CONE_ANGLE: f64 = 3.0;
/// Rings of a ball, points of each, and the angle of the last, degrees.
const RINGS: usize = 20;
const POINTS: usize = 40;
const LAST_RING: f64 = 80.0;
/// Angles of the suns from the viewer, degrees, and their names.
const SUNS: [(f64, &str); 5] = [
    (20.0, "sun at 20 degrees"),
    (60.0, "sun at 60 degrees"),
    (100.0, "sun at 100 degrees"),
    (120.0, "sun at 120 degrees"),
    (140.0, "sun at 140 degrees"),
];
/// Angle of the view, degrees, at which a bite is looked for, those from the mirror direction, and azimuths round it.
const BITE_VIEW: f64 = 5.0;
const BITE_ANGLES: [f64; 4] = [1.0, 2.0, 3.0, 4.0];
const BITE_AZIMUTHS: usize = 16;
/// Steps of the angle from the middle of a highlight over which a ring is looked for, and azimuths of its mean.
const RING_STEPS: usize = 30;
const RING_AZIMUTHS: usize = 8;
/// Displayed luminance of the brightest fifth of a picture begins here, unless a white surface would be brighter than white by more
/// than a factor: then all but the highlight is black to an eye too.
const EXPOSURE: f64 = 0.55;
const MOST_OVER_WHITE: f64 = 300.0;
/// Steps of the turned view, degrees, and steps to either side over which it is averaged.
const STEP: f64 = 0.5;
const SIDE: usize = 16;
/// Largest angle of the turned view, in steps.
const STEPS: usize = 150;

/// Errors beside the highlight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Skirt {
    /// Median relative error of the luminance, the mean over the views at 5, 30 and 60 degrees.
    pub luminance: f64,
    /// Median distance of the colours, likewise.
    pub chroma: f64,
    /// Largest share of the directions of a view where a channel of the fit is negative and none of the table is.
    pub negative: f64,
}

/// How far something is from its own mean along the view angle, in the median over lights that stand still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ripple {
    /// Root mean square of the logarithm of the luminance.
    pub luminance: f64,
    /// Root mean square of the sum of the differences of the shares of the channels.
    pub chroma: f64,
}

/// How far something is from its own mean over a cone, away from the peak.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grain {
    /// Median relative difference of the luminance from the mean over a cone, the mean over the views.
    pub luminance: f64,
    /// That of the colours.
    pub chroma: f64,
    /// The nine tenth quantile of the sum of both.
    pub coarse: f64,
}

/// A fit beside its BRDF.
#[derive(Clone, Debug, PartialEq)]
pub struct Appearance {
    /// Visible difference of the pictures of a ball, by the names of their lights.
    pub pictures: Vec<(&'static str, f64)>,
    /// The same of the table under the suns beside itself, averaged over a cone: what its noise makes.
    pub of_noise: f64,
    /// Whether the table is black under the suns but for its highlight, so that errors away from it are not seen.
    pub is_dark: bool,
    /// Beside the highlight.
    pub skirt: Skirt,
    /// Visible difference of the largest ghost, and the angle of its view, radians.
    pub ghost: (f64, f64),
    /// Along the view angle, of the fit and of the table.
    pub ripple: [Ripple; 2],
    /// Of the fit and of the table.
    pub grain: [Grain; 2],
    /// Largest over least ratio of fit and table round a mirror direction near the normal.
    pub bite: f64,
    /// How many times as bright as nearer to the middle a highlight gets, in the mean round it, at most: of the fit and of the table.
    pub ring: [f64; 2],
}

/// The value of a BRDF with everything that is no value taken as 0, times the cosine.
fn f_cos(brdf: &dyn Brdf, wi: [f64; 3], theta: f64) -> [f64; 3] {
    let (sin, cos) = libm::sincos(theta);
    brdf.evaluate(wi, [-sin, 0.0, cos]).map(|v| if v.is_finite() { v * wi[2] } else { 0.0 })
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A direction at an angle from an axis, turned round it.
fn aside(axis: [f64; 3], angle: f64, turn: f64) -> [f64; 3] {
    let helper = if axis[1].abs() < 0.9 { [0.0, 1.0, 0.0] } else { [1.0, 0.0, 0.0] };
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let u = cross(helper, axis);
    let u = u.map(|v| v / libm::sqrt(dot(u, u)));
    let v = cross(axis, u);
    let ((sin, cos), (st, ct)) = (libm::sincos(angle), libm::sincos(turn));
    [0, 1, 2].map(|k| axis[k] * cos + sin * (u[k] * ct + v[k] * st))
}

/// Directions of a cone, evenly spread.
fn cone(axis: [f64; 3]) -> impl Iterator<Item = [f64; 3]> {
    (0..CONE).map(move |i| {
        let angle = CONE_ANGLE.to_radians() * libm::sqrt((i as f64 + 0.5) / CONE as f64);
        aside(axis, angle, GOLDEN_ANGLE * i as f64)
    })
}

/// The mean over a cone of values that have the cosine in them, times the cosine of its axis.
fn cone_mean(f_cos: impl Fn([f64; 3]) -> [f64; 3], wi: [f64; 3]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for mut d in cone(wi) {
        d[2] = d[2].abs().max(0.02);
        let value = f_cos(d);
        (0..3).for_each(|c| sum[c] += value[c] / d[2] * wi[2] / CONE as f64);
    }
    sum
}

impl Appearance {
    /// Looks at an isotropic material.
    ///
    /// # Errors
    /// [`FitError::Core`] for bytes that are no material.
    pub fn new(brdf: &dyn Brdf, material: &Material<impl AsRef<[u8]> + Sync>) -> Result<Self, FitError> {
        let view = |theta: f64| TrackedView::new(material, theta, 0.0);
        let Pictures { pictures, exposures, of_noise, is_dark } = pictures(brdf, material)?;
        let (mut skirts, mut grains, mut ghost, mut ring) = (Vec::new(), Vec::new(), (0.0, 0.0), [1.0f64; 2]);
        for degrees in VIEWS {
            let theta = degrees.to_radians();
            let (fitted, highlight) = (view(theta)?, BrightPlace::of(brdf, theta));
            let (fit, table) = (|wi| fitted.f_cos(wi), |wi| f_cos(brdf, wi, theta));
            skirts.push(skirt(&table, &fit, &highlight));
            grains.push([grain(&fit, &highlight), grain(&table, &highlight)]);
            ring =
                [ring[0].max(largest_rise(&fit, &highlight)), ring[1].max(largest_rise(&table, &highlight))];
        }
        for degrees in [30.0f64, 45.0, 60.0, 70.0] {
            let theta = degrees.to_radians();
            let found = largest_ghost(brdf, &view(theta)?, theta, &exposures);
            if found > ghost.0 {
                ghost = (found, theta);
            }
        }
        let theta = BITE_VIEW.to_radians();
        let bite = bite(&|wi| f_cos(brdf, wi, theta), &view(theta)?, direction(theta, 0.0));
        let mean =
            |value: &dyn Fn(usize) -> f64| (0..VIEWS.len()).map(value).sum::<f64>() / VIEWS.len() as f64;
        let skirt = Skirt {
            luminance: mean(&|i| skirts[i].luminance),
            chroma: mean(&|i| skirts[i].chroma),
            negative: skirts.iter().map(|s| s.negative).fold(0.0, f64::max),
        };
        let grain = [0, 1].map(|which| Grain {
            luminance: mean(&|i| grains[i][which].luminance),
            chroma: mean(&|i| grains[i][which].chroma),
            coarse: mean(&|i| grains[i][which].coarse),
        });
        let ripple = ripples(brdf, material)?;
        Ok(Self { pictures, of_noise, is_dark, skirt, ghost, ripple, grain, bite, ring })
    }

    /// The table's own noise.
    pub fn noise(&self) -> Grain {
        self.grain[1]
    }

    /// Mean visible difference of the pictures: the one number of a fit.
    pub fn visible(&self) -> f64 {
        self.pictures.iter().map(|p| p.1).sum::<f64>() / self.pictures.len().max(1) as f64
    }

    pub(crate) fn to_json(&self) -> Value {
        let ripple = |r: Ripple| json!({"luminance": r.luminance, "chroma": r.chroma});
        let grain =
            |g: Grain| json!({"luminance": g.luminance, "chroma": g.chroma, "nine_tenths_below": g.coarse});
        let pictures: serde_json::Map<String, Value> =
            self.pictures.iter().map(|(name, v)| ((*name).to_owned(), json!(v))).collect();
        json!({
            "visible_difference": self.visible(),
            "pictures": pictures,
            "visible_difference_of_noise": self.of_noise,
            "is_dark_but_for_highlight": self.is_dark,
            "skirt": {"luminance": self.skirt.luminance, "chroma": self.skirt.chroma, "falsely_negative": self.skirt.negative},
            "ghost": {"visible_difference": self.ghost.0, "view_degrees": self.ghost.1.to_degrees()},
            "ripple": {"fit": ripple(self.ripple[0]), "table": ripple(self.ripple[1])},
            "grain": {"fit": grain(self.grain[0]), "table": grain(self.grain[1])},
            "bite": self.bite,
            "ring": self.ring,
        })
    }
}

/// The highlight of a view: where the table is brightest.
struct BrightPlace {
    /// Its middle: the mirror direction, if the table is not much brighter elsewhere, as a retro-reflector is.
    at: [f64; 3],
    /// The mirror direction.
    mirror: [f64; 3],
}

impl BrightPlace {
    fn of(brdf: &dyn Brdf, theta: f64) -> Self {
        let mirror = direction(theta, 0.0);
        let level =
            |at: [f64; 3]| cone(at).map(|wi| luminance(f_cos(brdf, wi, theta))).sum::<f64>() / CONE as f64;
        let value = |wi: &[f64; 3]| luminance(f_cos(brdf, *wi, theta));
        let back = direction(theta, PI);
        let all = searched().filter(|wi| dot(*wi, mirror) < libm::cos(END.to_radians())).chain([back]);
        let brightest = all.max_by(|a, b| value(a).total_cmp(&value(b))).unwrap_or(back);
        let [at_mirror, elsewhere] = [mirror, brightest].map(level);
        let at = if elsewhere > ELSEWHERE * at_mirror { brightest } else { mirror };
        Self { at, mirror }
    }

    /// Whether a direction is of the highlight, or near to the mirror direction.
    fn has(&self, wi: [f64; 3]) -> bool {
        dot(wi, self.mirror).max(dot(wi, self.at)) > libm::cos(END.to_radians())
    }
}

/// The directions in which ghosts are looked for.
fn searched() -> impl Iterator<Item = [f64; 3]> {
    let angles =
        (-43i32..=43).flat_map(|i| [0.0, 12.0, 40.0f64].map(|azimuth| (2.0 * f64::from(i), azimuth)));
    angles
        .map(|(theta, azimuth)| direction(theta.to_radians(), azimuth.to_radians()))
        .filter(|wi| wi[2] >= 0.02)
}

/// `f cos` of one view.
type FCos<'a> = dyn Fn([f64; 3]) -> [f64; 3] + 'a;

/// Errors from 1.5 to 15 degrees from the highlight's middle, spread evenly over the logarithm of that angle.
fn skirt(table: &FCos<'_>, fit: &FCos<'_>, highlight: &BrightPlace) -> Skirt {
    let (mut luminances, mut chromas, mut negative, mut all) = (Vec::new(), Vec::new(), 0usize, 0usize);
    for i in 0..SKIRT {
        let share = (i as f64 + 0.5) / SKIRT as f64;
        let angle = (BEGIN * libm::pow(END / BEGIN, share)).to_radians();
        let wi = aside(highlight.at, angle, GOLDEN_ANGLE * i as f64);
        if wi[2] < LEAST_COSINE {
            continue;
        }
        let (value, data) = (fit(wi), table(wi));
        let bright = luminance(data);
        if bright > 0.0 {
            luminances.push(((luminance(value) / bright - 1.0).abs(), 1.0));
            chromas.push((chroma(value, data), 1.0));
        }
        let least = |rgb: [f64; 3]| rgb[0].min(rgb[1]).min(rgb[2]);
        let most = value[0].max(value[1]).max(value[2]);
        negative += usize::from(least(value) < -NEGATIVE * most && least(data) > 0.0);
        all += 1;
    }
    let negative = negative as f64 / all.max(1) as f64;
    Skirt { luminance: weighted_median(luminances), chroma: weighted_median(chromas), negative }
}

/// How far a view is from its own mean over a cone.
fn grain(f_cos: &FCos<'_>, highlight: &BrightPlace) -> Grain {
    let (mut luminances, mut chromas, mut sums) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..GRAINY {
        let z = libm::sqrt((i as f64 + 0.5) / GRAINY as f64);
        let r = libm::sqrt(1.0 - z * z);
        let (sin, cos) = libm::sincos(GOLDEN_ANGLE * i as f64);
        let wi = [r * cos, r * sin, z];
        if z < 0.17 || highlight.has(wi) {
            continue;
        }
        let (data, mean) = (f_cos(wi), cone_mean(f_cos, wi));
        if luminance(data) > 0.0 {
            let apart = ((luminance(mean) / luminance(data) - 1.0).abs(), chroma(mean, data));
            luminances.push((apart.0, 1.0));
            chromas.push((apart.1, 1.0));
            sums.push(apart.0 + apart.1);
        }
    }
    sums.sort_by(f64::total_cmp);
    let coarse = sums.get(sums.len() * 9 / 10).copied().unwrap_or(0.0);
    Grain { luminance: weighted_median(luminances), chroma: weighted_median(chromas), coarse }
}

/// Largest visible difference of the fit, beyond the skirt, from the brightest that the table has within 4 degrees, where the fit is brighter.
/// The exposure is that of a ball under the sun that stands nearest.
fn largest_ghost(brdf: &dyn Brdf, fitted: &TrackedView<'_>, theta: f64, exposures: &[(f64, f64)]) -> f64 {
    let highlight = BrightPlace::of(brdf, theta);
    let data = |wi: [f64; 3]| luminance(f_cos(brdf, wi, theta));
    let wo = direction(theta, PI);
    let mut most: f64 = 0.0;
    for wi in searched().filter(|wi| !highlight.has(*wi)) {
        let phase = libm::acos(dot(wi, wo).clamp(-1.0, 1.0));
        let nearest = exposures.iter().min_by(|a, b| (a.0 - phase).abs().total_cmp(&(b.0 - phase).abs()));
        let scale = nearest.map_or(0.0, |sun| sun.1);
        let seen = |bright: f64, dark: f64| visible([bright * scale; 3], [dark.max(0.0) * scale; 3]);
        let value = luminance(fitted.f_cos(wi));
        // Most directions have none: the table is asked for where there may be one.
        let here = data(wi);
        if value > here && seen(value, here) > most {
            let near = (0..8).map(|n| data(aside(wi, 4f64.to_radians(), f64::from(n) * PI / 4.0)));
            let near = near.fold(here, f64::max);
            most = if value > near { most.max(seen(value, near)) } else { most };
        }
    }
    most
}

/// Largest over least ratio of fit and table by the azimuth round a direction, in the mean over angles from it.
fn bite(table: &FCos<'_>, fitted: &TrackedView<'_>, middle: [f64; 3]) -> f64 {
    let ratio = |n: usize| {
        let mut sums = [0.0; 2];
        for degrees in BITE_ANGLES {
            let wi = aside(middle, degrees.to_radians(), 2.0 * PI * n as f64 / BITE_AZIMUTHS as f64);
            sums[0] += luminance(fitted.f_cos(wi)).max(0.0);
            sums[1] += luminance(table(wi)).max(0.0);
        }
        (sums[0] + 1e-9) / (sums[1] + 1e-9)
    };
    let ratios: Vec<f64> = (0..BITE_AZIMUTHS).map(ratio).collect();
    let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    ratios.iter().copied().fold(0.0, f64::max) / least
}

/// How many times as bright as nearer to the middle of a highlight its surroundings get, in the mean round it.
fn largest_rise(f_cos: &FCos<'_>, highlight: &BrightPlace) -> f64 {
    let (mut least, mut most) = (f64::INFINITY, 1.0f64);
    for step in 0..=RING_STEPS {
        let angle = (END * (step as f64 / RING_STEPS as f64).powi(2)).to_radians();
        let around = (0..RING_AZIMUTHS).map(|n| {
            let wi = aside(highlight.at, angle, 2.0 * PI * (n as f64 + 0.5) / RING_AZIMUTHS as f64);
            if wi[2] > 0.0 { luminance(f_cos(wi)).max(0.0) } else { 0.0 }
        });
        let mean = around.sum::<f64>() / RING_AZIMUTHS as f64 + 1e-9;
        most = most.max(mean / least);
        least = least.min(mean);
    }
    most
}

/// What turns with the view is compared with its own mean: of the fit, and of the table.
fn ripples(brdf: &dyn Brdf, material: &Material<impl AsRef<[u8]> + Sync>) -> Result<[Ripple; 2], FitError> {
    let lights: Vec<[f64; 3]> = [0.0f64, 20.0, 40.0, 60.0]
        .iter()
        .flat_map(|theta| {
            [0.0f64, 45.0, 90.0, 135.0, 180.0].map(|phi| direction(theta.to_radians(), phi.to_radians()))
        })
        .collect();
    let thetas: Vec<f64> = (0..=STEPS).map(|n| (STEP * n as f64).to_radians()).collect();
    type Column = Vec<[[f64; 3]; 2]>;
    let columns = thetas.par_iter().map(|&theta| -> Result<Column, FitError> {
        let view = TrackedView::new(material, theta, 0.0)?;
        Ok(lights.iter().map(|&wi| [view.f_cos(wi), f_cos(brdf, wi, theta)]).collect())
    });
    let columns = columns.collect::<Result<Vec<_>, _>>()?;
    let ripple = |which: usize| {
        let (mut luminances, mut chromas) = (Vec::new(), Vec::new());
        for (light, &wi) in lights.iter().enumerate() {
            let values: Vec<[f64; 3]> = columns.iter().map(|column| column[light][which]).collect();
            let log: Vec<f64> = values.iter().map(|v| libm::log(luminance(*v).max(1e-7))).collect();
            let share = |c: usize| -> Vec<f64> {
                let all = |v: &[f64; 3]| v.iter().map(|v| v.abs()).sum::<f64>().max(1e-9);
                values.iter().map(|v| v[c] / all(v)).collect()
            };
            let (log, shares) = (left_over(&log), [0, 1, 2].map(|c| left_over(&share(c))));
            let (mut squares, mut count) = ([0.0; 2], 0.0f64);
            for (n, &theta) in thetas.iter().enumerate() {
                if dot(wi, direction(theta, 0.0)) < libm::cos(END.to_radians()) {
                    squares[0] += log[n] * log[n];
                    squares[1] += (0..3).map(|c| shares[c][n].abs()).sum::<f64>().powi(2);
                    count += 1.0;
                }
            }
            luminances.push((libm::sqrt(squares[0] / count.max(1.0)), 1.0));
            chromas.push((libm::sqrt(squares[1] / count.max(1.0)), 1.0));
        }
        Ripple { luminance: weighted_median(luminances), chroma: weighted_median(chromas) }
    };
    Ok([ripple(0), ripple(1)])
}

/// Numbers without their mean over some to either side; beyond the ends they go on as mirrored through them.
fn left_over(numbers: &[f64]) -> Vec<f64> {
    let last = numbers.len() as isize - 1;
    let at = |n: isize| match n {
        n if n < 0 => 2.0 * numbers[0] - numbers[(-n) as usize],
        n if n > last => 2.0 * numbers[last as usize] - numbers[(2 * last - n) as usize],
        n => numbers[n as usize],
    };
    let side = SIDE as isize;
    let mean = |n: isize| (n - side..=n + side).map(at).sum::<f64>() / (2.0 * SIDE as f64 + 1.0);
    (0..=last).map(|n| at(n) - mean(n)).collect()
}

/// Lights of a picture: directions and radiances.
#[derive(Clone)]
struct Lights {
    name: &'static str,
    all: Vec<([f64; 3], [f64; 3])>,
}

impl Lights {
    /// A sun at an angle from the viewer, above and to the right.
    fn sun(name: &'static str, degrees: f64) -> Self {
        let (sin, cos) = libm::sincos(degrees.to_radians());
        Self { name, all: vec![([0.8 * sin, 0.6 * sin, cos], [1.0; 3])] }
    }

    /// A lamp of some degrees across.
    fn spot() -> Self {
        let Self { all, .. } = Self::sun("", 50.0);
        let part = |i: usize| {
            (aside(all[0].0, 0.09 * libm::sqrt((i as f64 + 0.5) / 12.0), GOLDEN_ANGLE * i as f64), [1.0; 3])
        };
        Self { name: "spot", all: (0..12).map(part).collect() }
    }

    /// A sky that is brighter and bluer above, over warm ground, with a window.
    fn sky() -> Self {
        let part = |i: usize| {
            let y = 1.0 - 2.0 * (i as f64 + 0.5) / 96.0;
            let (sin, cos) = libm::sincos(GOLDEN_ANGLE * i as f64);
            let r = libm::sqrt(1.0 - y * y);
            let d = [r * cos, y, r * sin];
            let above = 0.5 + 0.5 * y;
            let window = if dot(d, [0.48, 0.6, 0.64]) > 0.93 { 4.0 } else { 0.0 };
            (d, [0.35 + 0.45 * above, 0.3 + 0.6 * above, 0.22 + 0.9 * above].map(|v| v + window))
        };
        Self { name: "sky", all: (0..96).map(part).collect() }
    }
}

/// A light, and the visible difference of the ball under it.
type Picture = (&'static str, f64);

/// The pictures in numbers.
struct Pictures {
    pictures: Vec<Picture>,
    /// Angles of the suns from the viewer, radians, and the factors on light that their exposures are.
    exposures: Vec<(f64, f64)>,
    /// Visible difference of the table under the suns beside itself without its noise.
    of_noise: f64,
    /// Whether the table is black under all suns but for its highlight.
    is_dark: bool,
}

fn pictures(brdf: &dyn Brdf, material: &Material<impl AsRef<[u8]> + Sync>) -> Result<Pictures, FitError> {
    let mut lights = SUNS.map(|(degrees, name)| Lights::sun(name, degrees)).to_vec();
    lights.extend([Lights::spot(), Lights::sky()]);
    // Rings of equal area, up to the last.
    let sin = libm::sin(LAST_RING.to_radians());
    let theta = |ring: usize| libm::asin(sin * libm::sqrt((ring as f64 + 0.5) / RINGS as f64));
    /// Colours of a point: of the fit, of the table, of that without its noise; none where no light comes to it.
    type Point = Option<[[f64; 3]; 3]>;
    let ring = |ring: usize| -> Result<Vec<Vec<Point>>, FitError> {
        let theta = theta(ring);
        let (sin, cos) = libm::sincos(theta);
        let view = TrackedView::new(material, theta, 0.0)?;
        let of_light = |(n, lights): (usize, &Lights)| -> Vec<Point> {
            let point = |i: usize| {
                // Azimuths of the rings differ, so that no two look the same.
                let (sp, cp) =
                    libm::sincos(std::f64::consts::TAU * (i as f64 / POINTS as f64 + SECTION * ring as f64));
                let normal = [sin * cp, sin * sp, cos];
                // The viewer is at +z, and at -x of the frame of the point.
                let x = [cos * cp, cos * sp, -sin];
                let y = [-sp, cp, 0.0];
                let mut point = None;
                for (light, radiance) in &lights.all {
                    let wi = [dot(*light, x), dot(*light, y), dot(*light, normal)];
                    if wi[2] <= 1e-3 {
                        continue;
                    }
                    let data = f_cos(brdf, wi, theta);
                    let smooth =
                        if n < SUNS.len() { cone_mean(|wi| f_cos(brdf, wi, theta), wi) } else { data };
                    let sums = point.get_or_insert([[0.0; 3]; 3]);
                    for (sum, value) in sums.iter_mut().zip([view.f_cos(wi), data, smooth]) {
                        (0..3).for_each(|c| sum[c] += value[c] * radiance[c]);
                    }
                }
                point
            };
            (0..POINTS).map(point).collect()
        };
        Ok(lights.iter().enumerate().map(of_light).collect())
    };
    let rings = (0..RINGS).into_par_iter().map(ring).collect::<Result<Vec<_>, _>>()?;
    let (mut differences, mut exposures) = (Vec::new(), Vec::new());
    let (mut of_noise, mut is_dark) = (0.0, true);
    for (n, light) in lights.iter().enumerate() {
        let points: Vec<[[f64; 3]; 3]> =
            rings.iter().flat_map(|ring| ring[n].iter().flatten().copied()).collect();
        let mut bright: Vec<f64> = points.iter().map(|p| luminance(p[1])).filter(|l| *l > 0.0).collect();
        bright.sort_by(f64::total_cmp);
        let wanted = EXPOSURE / bright.get(bright.len() * 4 / 5).copied().unwrap_or(1.0).max(1e-12);
        // A white surface that faces all of the light.
        let white = light.all.iter().map(|(_, radiance)| luminance(*radiance)).sum::<f64>() / PI;
        let scale = wanted.min(MOST_OVER_WHITE / white);
        is_dark &= n >= SUNS.len() || scale < wanted;
        exposures.extend(SUNS.get(n).map(|(degrees, _)| (degrees.to_radians(), scale)));
        let mean = |which: usize| {
            points.iter().map(|p| visible(p[which].map(|v| v * scale), p[1].map(|v| v * scale))).sum::<f64>()
                / points.len().max(1) as f64
        };
        differences.push((light.name, mean(0)));
        if n < SUNS.len() {
            of_noise += mean(2) / SUNS.len() as f64;
        }
    }
    Ok(Pictures { pictures: differences, exposures, of_noise, is_dark })
}

/// Visible difference of two linear sRGB colours as a display shows them, 0 to 1.
fn visible(a: [f64; 3], b: [f64; 3]) -> f64 {
    // Of the Lab distance, its power, and where it is mapped to; of FLIP.
    const POWER: f64 = 0.7;
    const KNEE: f64 = 0.4;
    const AT_KNEE: f64 = 0.95;
    let distance = |a: [f64; 3], b: [f64; 3]| {
        let (a, b) = (hunt_lab(a), hunt_lab(b));
        libm::pow((a[0] - b[0]).abs() + libm::hypot(a[1] - b[1], a[2] - b[2]), POWER)
    };
    let most = distance([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let (found, knee) = (distance(a, b), KNEE * most);
    if found < knee {
        found * AT_KNEE / knee
    } else {
        (AT_KNEE + (found - knee) / (most - knee) * (1.0 - AT_KNEE)).min(1.0)
    }
}

/// Lab of a linear sRGB colour within the range of a display, its chroma by the lightness (Hunt).
fn hunt_lab(rgb: [f64; 3]) -> [f64; 3] {
    let [r, g, b] = rgb.map(|v| v.clamp(0.0, 1.0));
    // Over the white of sRGB.
    let xyz = [
        (0.412_456_4 * r + 0.357_576_1 * g + 0.180_437_5 * b) / 0.950_47,
        0.212_672_9 * r + 0.715_152_2 * g + 0.072_175 * b,
        (0.019_333_9 * r + 0.119_192 * g + 0.950_304_1 * b) / 1.088_83,
    ];
    let [x, y, z] = xyz.map(|v| {
        const DELTA: f64 = 6.0 / 29.0;
        if v > DELTA * DELTA * DELTA { libm::cbrt(v) } else { v / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    });
    let lightness = 116.0 * y - 16.0;
    [lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_the_same_has_no_visible_difference_and_black_beside_white_the_most() {
        assert_eq!(visible([0.3, 0.2, 0.1], [0.3, 0.2, 0.1]), 0.0);
        assert!(visible([0.0; 3], [1.0; 3]) > 0.9);
        // A step of the display, and one that is seen.
        let grey = |v: f64| visible([v; 3], [0.3; 3]);
        assert!(
            grey(0.303) < 0.03 && grey(0.36) > 0.05 && grey(0.36) < 0.2,
            "{} {}",
            grey(0.303),
            grey(0.36)
        );
    }

    #[test]
    fn a_straight_line_has_nothing_left_over_and_a_ring_has_all() {
        let line: Vec<f64> = (0..=STEPS).map(|n| 0.1 * n as f64).collect();
        assert!(left_over(&line).iter().all(|v| v.abs() < 1e-9));
        let ring = |n: usize| libm::sin(std::f64::consts::TAU * n as f64 / 12.0);
        let rings: Vec<f64> = (0..=STEPS).map(ring).collect();
        let most = left_over(&rings).iter().map(|v| v.abs()).fold(0.0, f64::max);
        assert!((0.9..1.2).contains(&most), "{most}");
    }

    #[test]
    fn aside_is_at_that_angle() {
        for axis in [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.6, 0.0, 0.8]] {
            for turn in [0.0, 1.0, 4.0] {
                let d = aside(axis, 0.3, turn);
                assert!((dot(d, axis) - libm::cos(0.3)).abs() < 1e-12 && (dot(d, d) - 1.0).abs() < 1e-12);
            }
        }
    }
}
