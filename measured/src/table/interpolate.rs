//! Weights and albedo of scattered samples.
//!
//! The samples of a view and their mirror images are joined by a Delaunay triangulation of the sphere (a planar one of the
//! stereographic projection: circles stay circles). It reaches out to ghost samples on the horizon, every 5 degrees, which repeat
//! the f of the nearest sample. The triangles are cut fine and summed:
//!
//! * the *weight* of a sample is the integral of its barycentric coordinate (its hat) times the cosine, over its own
//!   cosine: so the sum of `weight f cos` is the integral of f, interpolated linearly, times the cosine;
//! * the *albedo* interpolates the logarithm of f instead. Between a peak and what surrounds it the samples do not say how
//!   the peak falls off. A straight line makes one sample on a mirror spike a cone 20 degrees wide (cayman at 80 degrees:
//!   an albedo above 4); a straight line of the logarithm falls off at the rate at which the neighbours demand it. In
//!   smooth places the two agree. One sample that is above its neighbours by `SPIKE` or more is not repeated to
//!   the horizon.
//!
//! So one sample on a spike fixes its height, and its neighbours, through the albedo that the fit is held to, its width.

use super::Sample;
use std::collections::HashMap;
use std::f64::consts::PI;

/// Ratio to its highest neighbour from which a sample counts as a lone spike.
const SPIKE: f64 = 10.0;

/// Ghost samples on the horizon.
const GHOSTS: usize = 72;

/// Each triangle is cut into the square of this many.
const CUTS: usize = 6;

/// f below this share of the view's mean counts as this: the logarithm of 0 is not a number, and of noise is noise.
const FLOOR: f64 = 1e-3;

/// Where all is black, f counts as this in logarithms.
pub(crate) const LEAST: f64 = 1e-30;

/// A direction with the logarithm of f there.
pub(crate) struct Node {
    /// The sample that it stands for.
    pub sample: usize,
    pub direction: [f64; 3],
    pub log_rgb: [f64; 3],
}

/// Samples and ghosts, ready to be joined by triangles.
pub(crate) struct Net {
    pub nodes: Vec<Node>,
    /// The sample that stands for each sample: itself, or one with the same direction.
    owner: Vec<usize>,
    /// How many samples each one stands for.
    copies: Vec<f64>,
}

/// Which samples have one direction.
pub struct Owners {
    /// The sample that stands for each sample: itself, or one with the same direction.
    pub owner: Vec<usize>,
    /// Those that stand for themselves, and all samples, sorted by direction.
    representative: Vec<usize>,
    order: Vec<usize>,
}

/// Directions are one if their x are closer than a tenth of this, and they themselves closer than this, in radians.
const ONE: f64 = 1e-5;
/// The distance alone, in a view of more than `MANY` samples. The triangulation takes a time that grows with the square of the samples on
/// one line, or circle: .4 s for the 31 416 of a plane that this leaves apart, and 42 s for ten times as many.
const ONE_OF_MANY: f64 = 1e-4;
const MANY: usize = 20_000;
/// They are looked for in strips of y that are a little wider than that, by this factor.
const STRIP: f64 = 1.1;

/// Finds the samples that have one direction.
pub fn owners(samples: &[Sample]) -> Owners {
    let (one, along) = if samples.len() > MANY { (ONE_OF_MANY, ONE_OF_MANY) } else { (ONE, 0.1 * ONE) };
    let mut representative: Vec<usize> = Vec::with_capacity(samples.len());
    // Places among the representatives, by strip: all samples of a plane share their x.
    let mut strips: HashMap<i64, Vec<usize>> = HashMap::new();
    let mut order: Vec<usize> = (0..samples.len()).collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (&samples[a].direction, &samples[b].direction);
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
    });
    let mut owner = vec![0; samples.len()];
    for &n in &order {
        let d = samples[n].direction;
        let strip = (d[1] / (STRIP * one)).floor() as i64;
        let found = |strip: i64| {
            let mut near = strips
                .get(&strip)?
                .iter()
                .rev()
                .map(|&place| (place, &samples[representative[place]].direction))
                .take_while(|(_, r)| d[0] - r[0] < along);
            near.find(|(_, r)| distance_squared(r, &d) < one * one).map(|(place, _)| place)
        };
        // The last one, as if all were gone through from the end.
        let twin = [strip - 1, strip, strip + 1].into_iter().filter_map(found).max();
        owner[n] = match twin {
            Some(place) => representative[place],
            None => {
                strips.entry(strip).or_default().push(representative.len());
                representative.push(n);
                n
            }
        };
    }
    Owners { owner, representative, order }
}

/// Makes the nodes of a view.
pub(crate) fn net(samples: &[Sample]) -> Net {
    // Nodes: one for each different direction, and its mirror image. What shares a direction shares its weight.
    let Owners { owner, representative, order } = owners(samples);
    let mut copies = vec![0.0f64; samples.len()];
    let mut sum = vec![[0.0f64; 3]; samples.len()];
    for n in order {
        copies[owner[n]] += 1.0;
        (0..3).for_each(|c| sum[owner[n]][c] += samples[n].rgb[c]);
    }
    let mut mean = [0.0f64; 3];
    for &r in &representative {
        (0..3).for_each(|c| mean[c] += sum[r][c] / copies[r] / representative.len() as f64);
    }
    let logs = |r: usize| {
        let mut log = [0.0; 3];
        (0..3).for_each(|c| log[c] = libm::log((sum[r][c] / copies[r]).max(FLOOR * mean[c]).max(LEAST)));
        log
    };
    let mut nodes: Vec<Node> = Vec::with_capacity(2 * representative.len() + GHOSTS);
    for &r in &representative {
        let d = samples[r].direction;
        nodes.push(Node { sample: r, direction: d, log_rgb: logs(r) });
        if d[1] > 1e-7 {
            nodes.push(Node { sample: r, direction: [d[0], -d[1], d[2]], log_rgb: logs(r) });
        }
    }

    // Lone spikes are not repeated to the horizon: the highest of their neighbours is.
    let mut calm: Vec<Node> = Vec::with_capacity(nodes.len());
    let first = triangulate(&nodes);
    let level = |n: &Node| n.log_rgb.iter().sum::<f64>() / 3.0;
    let mut highest = vec![f64::NEG_INFINITY; samples.len()];
    let mut highest_log = vec![[0.0; 3]; samples.len()];
    for triangle in first.chunks_exact(3) {
        for (i, j) in [(0, 1), (1, 2), (2, 0), (1, 0), (2, 1), (0, 2)] {
            let (a, b) = (&nodes[triangle[i]], &nodes[triangle[j]]);
            if a.sample != b.sample && level(b) > highest[a.sample] {
                highest[a.sample] = level(b);
                highest_log[a.sample] = b.log_rgb;
            }
        }
    }
    for n in &nodes {
        let h = highest[n.sample];
        let spike = h.is_finite() && level(n) > h + libm::log(SPIKE);
        let log_rgb = if spike { highest_log[n.sample] } else { n.log_rgb };
        calm.push(Node { sample: n.sample, direction: n.direction, log_rgb });
    }
    for g in 0..GHOSTS {
        let d = super::direction(PI / 2.0, 2.0 * PI * g as f64 / GHOSTS as f64);
        if let Some(&Node { sample, log_rgb, .. }) = nearest(&d, &calm) {
            nodes.push(Node { sample, direction: d, log_rgb });
        }
    }
    Net { nodes, owner, copies }
}

/// Sets the weights of the samples and returns the albedo.
pub(crate) fn weigh(samples: &mut [Sample]) -> [f64; 3] {
    let Net { nodes, owner, copies } = net(samples);
    // Sum over the cut triangles.
    let mut albedo = [0.0f64; 3];
    let mut weight = vec![0.0f64; samples.len()];
    for triangle in triangulate(&nodes).chunks_exact(3) {
        let corners = [&nodes[triangle[0]], &nodes[triangle[1]], &nodes[triangle[2]]];
        for_each_cut(&corners, |bary, cosine, solid_angle| {
            for (corner, b) in corners.iter().zip(bary) {
                weight[corner.sample] += b * cosine * solid_angle;
            }
            for (c, a) in albedo.iter_mut().enumerate() {
                let log: f64 = corners.iter().zip(bary).map(|(corner, b)| b * corner.log_rgb[c]).sum();
                *a += libm::exp(log) * cosine * solid_angle;
            }
        });
    }
    for (n, s) in samples.iter_mut().enumerate() {
        s.weight = weight[owner[n]] / copies[owner[n]] / s.direction[2];
    }
    albedo
}

/// The node nearest to a direction.
pub(crate) fn nearest<'a>(d: &[f64; 3], nodes: &'a [Node]) -> Option<&'a Node> {
    let distance = |n: &Node| distance_squared(&n.direction, d);
    nodes.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

pub(crate) fn distance_squared(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum()
}

/// Delaunay triangulation of directions on the hemisphere: corners, three by three. Empty for fewer than three.
pub(crate) fn triangulate(nodes: &[Node]) -> Vec<usize> {
    let project = |n: &Node| {
        let d = n.direction;
        delaunator::Point { x: d[0] / (1.0 + d[2]), y: d[1] / (1.0 + d[2]) }
    };
    delaunator::triangulate(&nodes.iter().map(project).collect::<Vec<_>>()).triangles
}

/// Calls with the barycentric coordinates, cosine and solid angle of each small triangle of one between three nodes.
fn for_each_cut(corners: &[&Node; 3], mut each: impl FnMut([f64; 3], f64, f64)) {
    let [a, b, c] = corners.map(|n| n.direction);
    let sub = |p: [f64; 3], q: [f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let (u, v) = (sub(b, a), sub(c, a));
    // Twice the area, along the normal of the flat triangle.
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let n = CUTS as f64;
    for i in 0..CUTS {
        for j in 0..CUTS - i {
            // One upright small triangle, and one upside down except at the end of the row.
            for third in [1.0 / 3.0, 2.0 / 3.0].into_iter().take(if i + j + 1 < CUTS { 2 } else { 1 }) {
                let (s, t) = ((i as f64 + third) / n, (j as f64 + third) / n);
                let bary = [1.0 - s - t, s, t];
                let mut p = [0.0; 3];
                (0..3).for_each(|k| p[k] = bary[0] * a[k] + bary[1] * b[k] + bary[2] * c[k]);
                let length_squared = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
                let length = libm::sqrt(length_squared);
                let projected = (normal[0] * p[0] + normal[1] * p[1] + normal[2] * p[2]).abs() / length;
                each(bary, p[2].max(0.0) / length, 0.5 * projected / (n * n) / length_squared);
            }
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::table::direction;

    /// Samples of one view, of a value of the direction.
    pub(crate) fn grid(f: impl Fn([f64; 3]) -> f64) -> Vec<Sample> {
        let mut samples = vec![];
        for theta in (0..80).step_by(8) {
            for phi in 0..=18 {
                let d = direction(f64::from(theta).to_radians(), f64::from(10 * phi).to_radians());
                samples.push(Sample { direction: d, rgb: [f(d); 3], weight: 0.0 });
            }
        }
        samples
    }

    /// Samples that share a direction, or nearly, have the owner that going through all before them finds; planes share their x.
    #[test]
    fn owners_are_those_of_all_before_them() {
        let mut random = crate::numeric::random::Random::new(5);
        let mut samples = grid(|_| 1.0);
        for n in 0..600 {
            let d = match n % 3 {
                0 => direction(1.57 - 1e-5 * random.uniform(), 1.57 + 1e-5 * random.uniform()),
                1 => direction(1e-4 * random.uniform(), PI / 2.0),
                _ => samples[n / 3].direction.map(|x| x + 4e-6 * random.uniform()),
            };
            samples.push(Sample { direction: d, ..samples[0] });
        }
        let found = owners(&samples);
        let mut before: Vec<usize> = Vec::new();
        for &n in &found.order {
            let d = samples[n].direction;
            let twin = before.iter().rev().find(|&&r| {
                let r = &samples[r].direction;
                d[0] - r[0] < 1e-6 && distance_squared(r, &d) < 1e-10
            });
            assert_eq!(found.owner[n], twin.copied().unwrap_or(n), "{d:?}");
            if twin.is_none() {
                before.push(n);
            }
        }
        assert!((100..samples.len() - 100).contains(&before.len()), "{} of {}", before.len(), samples.len());
    }

    /// Samples of the plane at an azimuth, up to the horizon on both sides.
    fn plane(phi: f64, count: usize) -> Vec<Sample> {
        let at = |n: usize| direction(PI * (n as f64 / count as f64 - 0.5), phi);
        (0..count).map(|n| Sample { direction: at(n), rgb: [0.1; 3], weight: 0.0 }).collect()
    }

    /// The triangulation takes the square of their number.
    #[test]
    fn few_samples_of_one_plane_stay_apart() {
        for phi in [0.0, PI / 2.0, 1.0] {
            for count in [40_000, 300_000] {
                let apart = owners(&plane(phi, count)).representative.len();
                assert!((5_000..=32_000).contains(&apart), "{apart} of {count} at {phi}");
            }
        }
    }

    /// All of the plane across that of incidence have one x, by which twins are looked for first.
    #[test]
    fn samples_of_one_x_are_joined_as_fast_as_others() {
        let time = |phi: f64| {
            let samples = plane(phi, 200_000);
            let one = || {
                let start = std::time::Instant::now();
                assert!(owners(&samples).representative.len() > 5_000);
                start.elapsed()
            };
            (0..3).map(|_| one()).min().unwrap()
        };
        let (across, along) = (time(PI / 2.0), time(0.0));
        println!("{across:?}, {along:?}");
        assert!(across < 10 * along, "{across:?}, along the plane of incidence {along:?}");
    }

    #[test]
    fn a_constant_has_the_albedo_pi_times_it_and_weights_that_agree() {
        let mut samples = grid(|_| 0.25);
        let albedo = weigh(&mut samples);
        let sum: f64 = samples.iter().map(|s| s.weight * s.rgb[0] * s.direction[2]).sum();
        assert!((albedo[0] - 0.25 * PI).abs() < 3e-3, "{albedo:?}");
        assert!((sum - albedo[0]).abs() < 1e-9, "{sum} {albedo:?}");
        assert!(samples.iter().all(|s| s.weight > 0.0));
    }

    #[test]
    fn a_spike_of_one_sample_stays_below_one() {
        let mirror = direction(72f64.to_radians(), 0.0);
        let mut samples = grid(|d| if distance_squared(&d, &mirror) < 1e-6 { 600.0 } else { 0.02 });
        let sum = |s: &[Sample]| s.iter().map(|s| s.weight * s.rgb[0] * s.direction[2]).sum::<f64>();
        let albedo = weigh(&mut samples);
        assert!(sum(&samples) > 1.0 && albedo[0] < 0.9 && albedo[0] > 0.02 * PI, "{albedo:?}");
    }

    #[test]
    fn few_and_repeated_samples_are_weighed_too() {
        let d = [direction(0.3, 0.2), direction(0.3, 0.2), direction(0.8, 2.0)];
        for n in 1..=3 {
            let mut samples: Vec<Sample> =
                d[..n].iter().map(|&direction| Sample { direction, rgb: [0.1; 3], weight: 0.0 }).collect();
            let albedo = weigh(&mut samples);
            assert!((albedo[0] - 0.1 * PI).abs() < 2e-3, "{n}: {albedo:?}");
            let sum: f64 = samples.iter().map(|s| s.weight * 0.1 * s.direction[2]).sum();
            assert!((sum - albedo[0]).abs() < 1e-9, "{n}: {sum}");
        }
    }
}
