//! One environment: radiance, density, samples, and refusals.

use glam::{DVec3, Vec3};
use srbf_core::{Environment, Error, environment_len, luminance};
use srbf_tests::inputs::{Random, UNIFORM};
use srbf_tests::maps::{Map, Moments, bright};
use srbf_tests::oracle;
use srbf_tests::statistics::{chi_square, sidak};
use srbf_tests::tolerance::Worst;
use std::f64::consts::{PI, TAU};

/// Maps of all kinds of sizes.
fn maps() -> Vec<Map> {
    let mut maps = vec![Map::sky(), Map::constant()];
    maps.extend(
        [(16, 8, 5, 2), (16, 8, 0, 0), (16, 7, 15, 3), (64, 32, 10, 31)]
            .map(|(w, h, x, y)| Map::pixel(w, h, x, y)),
    );
    maps.extend(
        [(1, 2), (2, 1), (3, 1), (5, 3), (16, 8), (64, 33), (300, 149), (1, 1000), (3000, 2)]
            .map(|(w, h)| Map::noise(w, h)),
    );
    maps
}

/// Directions everywhere, on the axes, and round the poles, where alone there is no azimuth.
fn directions(random: &mut Random) -> Vec<Vec3> {
    let mut all: Vec<Vec3> = (0..4000).map(|_| random.direction()).collect();
    all.extend([Vec3::X, Vec3::Y].into_iter().flat_map(|d| [d, -d]));
    for scale in [1e-20, 1e-12, 1e-7, 1e-4, 1e-3, 1e-2] {
        all.extend((0..20).map(|_| {
            let d = random.direction();
            Vec3::new(scale * d.x, scale * d.y, 1f32.copysign(d.z)).normalize()
        }));
        all.extend([Vec3::new(-1.0, scale, 0.0), Vec3::new(-1.0, -scale, scale)].map(Vec3::normalize));
    }
    all
}

#[test]
fn radiance_and_density_are_those_of_the_map() {
    let mut random = Random(61);
    let mut worst = Worst::new("Environment::radiance");
    let mut of_samples = Worst::new("Environment::pdf of a sample");
    let mut of_power = Worst::new("Environment::power");
    for map in maps() {
        for turn in [0.0, 0.7, -2.0, 31.0] {
            let environment = map.environment().turned(turn);
            let digits = 128.0 + (map.width + map.height()) as f64;
            let power = map.power();
            of_power.see((f64::from(environment.power()) / power - 1.0).abs(), || map.name.clone());
            for d in directions(&mut random) {
                let (want, largest) = map.radiance(d.as_dvec3(), f64::from(turn));
                let (got, pdf) = environment.radiance_and_pdf(d);
                assert_eq!((got, pdf), (environment.radiance(d), environment.pdf(d)));
                let pdf_error = (f64::from(pdf) - oracle::luminance(want) / power).abs() * power;
                let error = (got.as_dvec3() - want).abs().max_element().max(pdf_error);
                worst
                    .see(error / (largest.max(1e-30) * digits), || format!("{}, turn {turn}, {d}", map.name));
            }
            let ends = UNIFORM.into_iter().flat_map(|a| UNIFORM.map(|b| [a, b, UNIFORM[5]]));
            let others: Vec<[f32; 3]> = (0..4000).map(|_| random.three()).collect();
            for u in ends.chain(others) {
                let sample = environment.sample(u);
                let d = sample.direction.as_dvec3();
                assert!((d.length() - 1.0).abs() < 3e-7, "{}: {u:?} gives {d}", map.name);
                let (_, largest) = map.radiance(d, f64::from(turn));
                let error = f64::from((sample.pdf - environment.pdf(sample.direction)).abs()) * power;
                of_samples.see(error / (largest.max(1e-30) * digits), || format!("{}, {u:?}", map.name));
                let ratio =
                    f64::from(luminance(sample.radiance) / sample.pdf) / f64::from(environment.power());
                assert!((ratio - 1.0).abs() < 2e-6, "{}: {u:?} gives {sample:?}", map.name);
            }
        }
    }
    let measured = [worst, of_samples, of_power];
    for worst in &measured {
        println!("{:30} {:.2e}, {}", worst.name, worst.error, worst.place);
    }
    let failures: Vec<String> = measured.iter().filter_map(Worst::failure).collect();
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

/// The midpoint of each cell has the mean of its corners.
#[test]
fn the_density_integrates_to_one() {
    let mut worst = Worst::new("integral of Environment::pdf");
    for map in maps() {
        let environment = map.environment();
        let (width, height) = (map.width, map.height());
        let edge = |row: usize| {
            let row = (row as f64 - 0.5).clamp(0.0, height as f64);
            if row == height as f64 - 0.5 {
                -(0.5 * PI / height as f64).cos()
            } else {
                (PI * row / height as f64).cos()
            }
        };
        let mut sum = 0.0;
        for row in 0..=height {
            let [upper, lower] = [edge(row), if row == height { -1.0 } else { edge(row + 1) }];
            let z = 0.5 * (upper + lower);
            for column in 0..width {
                let phi = TAU * (0.5 - (column + 1) as f64 / width as f64);
                let r = (1.0 - z * z).sqrt();
                let d = DVec3::new(r * phi.cos(), r * phi.sin(), z).as_vec3();
                sum += f64::from(environment.pdf(d)) * (upper - lower) * TAU / width as f64;
            }
        }
        worst.see((sum - 1.0).abs() / (128 + width + height) as f64, || map.name.clone());
    }
    println!("{:30} {:.2e}, {}", worst.name, worst.error, worst.place);
    assert_eq!(worst.failure(), None);
}

/// Bins of azimuth and height, eight and six to a pixel, of which each gets its share by the midpoints of many parts.
fn chi(map: &Map, scale: f64, seed: u64) -> f64 {
    let environment = map.environment();
    let (columns, rows) = ((3 * map.width + 1).clamp(7, 203), (3 * map.height() + 1).clamp(5, 101));
    const PARTS: usize = 24;
    let samples = 400_000;
    let mut expected = vec![0.0; columns * rows];
    for (bin, share) in expected.iter_mut().enumerate() {
        for part in 0..PARTS * PARTS {
            let at =
                |i: usize, part: usize, n: usize| (i as f64 + (part as f64 + 0.5) / PARTS as f64) / n as f64;
            let phi = TAU * at(bin % columns, part % PARTS, columns);
            // Bins of equal height would be blind at the poles: of equal angles.
            let edge = |i: usize| (PI * i as f64 / rows as f64).cos();
            let (upper, lower) = (edge(bin / columns), edge(bin / columns + 1));
            let z = upper + (lower - upper) * (((part / PARTS) as f64 + 0.5) / PARTS as f64);
            let r = (1.0 - z * z).sqrt();
            let d = DVec3::new(r * phi.cos(), r * phi.sin(), z).as_vec3();
            let area = (upper - lower) * TAU / columns as f64 / (PARTS * PARTS) as f64;
            *share += f64::from(environment.pdf(d)).powf(scale) * area;
        }
    }
    let whole: f64 = expected.iter().sum();
    expected.iter_mut().for_each(|share| *share *= f64::from(samples) / whole);
    let (mut observed, mut random) = (vec![0.0; expected.len()], Random(seed));
    for _ in 0..samples {
        let d = environment.sample(random.three()).direction.as_dvec3();
        let phi = d.y.atan2(d.x).rem_euclid(TAU) / TAU;
        let theta = d.x.hypot(d.y).atan2(d.z) / PI;
        let (column, row) = ((phi * columns as f64) as usize, (theta * rows as f64) as usize);
        observed[row.min(rows - 1) * columns + column.min(columns - 1)] += 1.0;
    }
    chi_square(&observed, &expected).p
}

#[test]
fn samples_follow_the_density() {
    let maps: Vec<Map> =
        maps().into_iter().filter(|map| map.pixels.len() < 20_000 && map.width < 1000).collect();
    let level = sidak(0.01, maps.len());
    for (i, map) in maps.iter().enumerate() {
        let p = chi(map, 1.0, 700 + i as u64);
        println!("{}: p = {p:.3}", map.name);
        assert!(p > level, "{}: p = {p:e}", map.name);
    }
    // A density that is a little off is seen.
    assert!(chi(&Map::noise(16, 8), 0.95, 3) < level);
}

/// A hint changes nothing, and reads nothing outside, whatever the numbers are.
#[test]
fn asking_for_cells_changes_no_draw() {
    let mut random = Random(31);
    for map in maps() {
        let environment = map.environment();
        for _ in 0..1000 {
            let u = random.three();
            let drawn = environment.sample(u);
            environment.prefetch(u);
            assert_eq!(environment.sample(u), drawn);
        }
        for outside in [-1.0, 1.0, 1e30, f32::NAN, f32::INFINITY] {
            environment.prefetch([outside; 3]);
        }
    }
}

/// Both estimate the integral of each channel.
#[test]
fn light_is_the_same_by_its_own_draws_and_by_uniform_ones() {
    for map in [Map::sky(), Map::noise(16, 8), Map::noise(64, 33)] {
        let environment = map.environment().turned(1.0);
        let (mut own, mut uniform, mut random) = (Moments::default(), Moments::default(), Random(71));
        for _ in 0..400_000 {
            let sample = environment.sample(random.three());
            own.see(f64::from(sample.radiance.x / sample.pdf));
            uniform.see(f64::from(environment.radiance(random.direction()).x) * 4.0 * PI);
        }
        let error = own.error().hypot(uniform.error());
        assert!((own.mean() - uniform.mean()).abs() < 3.5 * error, "{}: {own:?} {uniform:?}", map.name);
        assert!(own.variance() < uniform.variance());
    }
}

#[test]
fn the_map_is_seen_from_inside() {
    let mut map = Map::pixel(16, 8, 12, 4);
    map.pixels[12] = [0.5; 3];
    let environment = map.environment();
    let towards = |x: f32, y: f32, z: f32| bright(environment.radiance(Vec3::new(x, y, z).normalize()));
    // A quarter turn to the right of the centre, just below the horizon.
    let (side, down) = ((0.5 * TAU / 16.0).sin() as f32, (0.5 * PI / 8.0).sin() as f32);
    assert!(towards(-side, -1.0, -down) > 0.95 && towards(-side, 1.0, -down) < 1e-6);
    assert!(towards(-0.01, -0.1, 1.0) > 0.2 && towards(0.0, 0.0, -1.0) < 1e-6);
    // A quarter turn to the left puts it in the centre.
    let turned = map.environment().turned(0.5 * PI as f32);
    assert!(bright(turned.radiance(Vec3::new(1.0, -side, -down).normalize())) > 0.95);
}

#[test]
fn maps_that_are_none_are_refused() {
    let made = |width: usize, pixels: &[[f32; 3]]| {
        Environment::new(width, pixels, vec![0; 1 << 12]).map(|e| e.power())
    };
    let white = [1.0; 3];
    assert!(made(4, &[white; 8]).is_ok());
    for (width, count) in [(0, 0), (0, 1), (4, 0), (4, 7), (usize::MAX, 1), (70_000, 70_000)] {
        assert_eq!(made(width, &vec![white; count]), Err(Error::MapSize), "{width}, {count}");
    }
    for (width, height) in
        [(0, 1), (1, 0), (65_536, 1), (1, 65_536), (usize::MAX, 2), (65_535, 65_535), (8192, 4097)]
    {
        assert_eq!(environment_len(width, height), Err(Error::MapSize), "{width} x {height}");
    }
    for (width, height) in [(1, 1), (65_535, 1), (1, 65_535), (8192, 4096)] {
        assert!(environment_len(width, height).is_ok(), "{width} x {height}");
    }
    let black = [0.0; 3];
    assert_eq!(made(2, &[black; 4]), Err(Error::BlackMap));
    assert_eq!(made(2, &[[1e-33; 3]; 4]), Err(Error::BlackMap));
    for bad in [f32::NAN, -1e-30, f32::INFINITY, f32::NEG_INFINITY, 1.1e30] {
        let mut pixels = [white; 8];
        pixels[6][1] = bad;
        assert_eq!(made(4, &pixels), Err(Error::Radiance { column: 2, row: 1 }), "{bad}");
    }
    let needed = environment_len(4, 2).unwrap();
    let mut memory = vec![7; needed - 1];
    let refused = Environment::new(4, &[white; 8], &mut memory[..]).err();
    assert_eq!(refused, Some(Error::Memory { needed, available: needed - 1 }));
    assert!(memory.iter().all(|&word| word == 7));
    // Dim and bright ones, and sums that are both.
    for bright in [1e-29, 1e30] {
        let mut pixels = [[bright; 3]; 8];
        pixels[3] = [0.0, 1e-30, 0.0];
        let environment = Environment::new(4, &pixels, vec![0; needed]).unwrap();
        let sample = environment.sample([0.4, 0.5, 0.6]);
        assert!(sample.pdf.is_finite() && sample.radiance.is_finite() && environment.power().is_finite());
        assert!((environment.radiance(Vec3::X).y / bright - 1.0).abs() < 1e-5 || bright < 1e-20);
    }
}

#[test]
fn a_stored_table_is_read_back_and_a_damaged_one_refused() {
    let map = Map::noise(7, 5);
    let environment = map.environment();
    let table = environment.table().to_vec();
    let again = Environment::from_table(&table[..]).unwrap();
    assert_eq!((again.width(), again.height(), again.power()), (7, 5, environment.power()));
    let mut random = Random(81);
    for _ in 0..1000 {
        let u = random.three();
        assert_eq!(again.sample(u), environment.sample(u));
    }
    // Memory that begins anywhere.
    let mut memory = vec![0; environment_len(7, 5).unwrap() + 3];
    let shifted = Environment::new(7, &map.pixels, &mut memory[3..]).unwrap();
    assert_eq!(shifted.table(), &table[..]);

    let mut known = 0;
    let refused = |words: &[u32]| Environment::from_table(words).err() == Some(Error::Table);
    for length in 0..table.len() {
        assert!(refused(&table[..length]), "cut at {length}");
    }
    assert!(refused(&[&table[..], &[0; 16]].concat()));
    let mut damaged = table.clone();
    for word in (0..table.len()).filter(|word| !(6..16).contains(word)) {
        for bit in 0..32 {
            damaged[word] ^= 1 << bit;
            assert!(refused(&damaged), "word {word}, bit {bit}");
            // With a checksum that fits: the numbers read have no NaN, and nothing panics.
            if word > 5 {
                let sum = checksum(&damaged);
                let kept = [damaged[4], damaged[5]];
                damaged[4..6].copy_from_slice(&sum);
                if let Ok(environment) = Environment::from_table(&damaged[..]) {
                    let (u, d) = (random.three(), random.direction());
                    let sample = environment.sample(u);
                    assert!(!sample.direction.is_nan() && !sample.pdf.is_nan(), "word {word}, bit {bit}");
                    assert!(!environment.radiance(d).is_nan(), "word {word}, bit {bit}");
                    known += 1;
                }
                damaged[4..6].copy_from_slice(&kept);
            }
            damaged[word] ^= 1 << bit;
        }
    }
    assert!(known > 0);
    // A threshold that does not fit the powers, by a hundredth of a cell's draws.
    let mut moved = 0;
    for index in 0..environment.cell_count() {
        let mut unfit = table.clone();
        let threshold = table.len() - 16 * (environment.cell_count() - index) + 15;
        let kept = f32::from_bits(unfit[threshold]);
        unfit[threshold] = (if kept > 0.5 { kept - 0.01 } else { kept + 0.01 }).to_bits();
        let sum = checksum(&unfit);
        unfit[4..6].copy_from_slice(&sum);
        // Draws that a cell hands on to itself stay there.
        if environment.cell(index).unwrap().other != index {
            assert!(refused(&unfit), "cell {index} keeps {kept}");
            moved += 1;
        }
    }
    assert!(moved > 10, "{moved} cells hand on");
    // No direction makes it panic.
    for d in [Vec3::NAN, Vec3::ZERO, Vec3::splat(f32::INFINITY), Vec3::new(1e30, -1e30, 0.0), Vec3::MIN] {
        let _ = environment.radiance(d);
    }
}

/// FNV-1a of the words behind the head, and of the size and the power in it.
fn checksum(table: &[u32]) -> [u32; 2] {
    let words = table[1..4].iter().chain(&table[16..]);
    let sum = words
        .fold(0xcbf2_9ce4_8422_2325_u64, |sum, &word| (sum ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3));
    [sum as u32, (sum >> 32) as u32]
}

#[test]
fn cells_say_how_draws_are_shared_out() {
    for map in maps() {
        let environment = map.environment();
        let count = environment.cell_count();
        assert_eq!(count, map.width * (map.height() + 1));
        assert_eq!(environment.cell(count), None);
        // The draws that a cell keeps, and those from others, are its share of all draws.
        let cells: Vec<_> = (0..count).map(|i| environment.cell(i).unwrap()).collect();
        let mut draws: Vec<f64> = cells.iter().map(|cell| f64::from(cell.kept)).collect();
        cells.iter().for_each(|cell| draws[cell.other] += 1.0 - f64::from(cell.kept));
        for (index, cell) in cells.iter().enumerate() {
            // In draws of a cell. What f32 rounds in each cell may add up in one: that which fills up the last.
            let apart = (draws[index] - cell.share * count as f64).abs();
            let rounding = f64::from(f32::EPSILON) * (count as f64 + draws[index]);
            assert!(apart < rounding, "{}, cell {index}: {cell:?} {apart}", map.name);
        }
        let sum: f64 = cells.iter().map(|cell| cell.share).sum();
        assert!((sum - 1.0).abs() < 1e-6, "{}: {sum}", map.name);
        // A draw whose first number hits a cell is in it, or in the other.
        for index in [0, count / 3, count / 2, count - 1] {
            let cell = cells[index];
            for place in [0.25, 0.75] {
                let u = ((index as f64 + place) / count as f64) as f32;
                let sample = environment.sample([u, 0.0, 0.5]);
                let own = if place < f64::from(cell.kept) { index } else { cell.other };
                // Rows of cells end at the centres of pixels.
                let down =
                    f64::from(sample.direction.z).clamp(-1.0, 1.0).acos() / PI * map.height() as f64 + 0.5;
                let row = (own / map.width) as f64;
                let is_near_edge = (f64::from(u) * count as f64 - (index as f64 + place)).abs() > 0.1;
                assert!(
                    is_near_edge || (down > row - 1e-2 && down < row + 1.01),
                    "{}: {down} {row}",
                    map.name
                );
            }
        }
    }
}
