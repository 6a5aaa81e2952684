//! Tables of other shapes, compressed ones, and questions before a fit: inputs are made here, of one plastic.

use flate2::{Compression, write::GzEncoder};
use srbf_measured::complete::complete;
use srbf_measured::look::Look;
use srbf_measured::read::{Content, Conventions, Intake, Source, read_from};
use std::io::Write;
use std::path::Path;

/// Angles of both directions and of their azimuths' difference in degrees, and f.
type Sample = [f64; 4];

fn direction(theta: f64, phi: f64) -> [f64; 3] {
    let ((st, ct), (sp, cp)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    [st * cp, st * sp, ct]
}

fn plastic() -> Vec<Sample> {
    let source = srbf_measured::read::read(Path::new("model:ggx:alpha=0.35,f0=0.05,diffuse=0.3")).unwrap();
    let Content::Evaluable(brdf) = source.content else { panic!("a model") };
    let mut samples = Vec::new();
    for theta_i in [10.0, 40.0, 70.0] {
        for theta_o in [0.0, 20.0, 40.0, 60.0, 75.0] {
            for turn in [0.0, 45.0, 90.0, 135.0, 180.0] {
                let f = brdf.evaluate(direction(theta_i, 0.0), direction(theta_o, turn))[1];
                samples.push([theta_i, theta_o, turn, f]);
            }
        }
    }
    samples
}

fn lines(head: &str, row: impl Fn(&Sample) -> String) -> String {
    format!("{head}\n{}", plastic().iter().map(|s| row(s) + "\n").collect::<String>())
}

fn plain() -> String {
    lines("theta_i,theta_o,dphi,value", |[i, o, turn, f]| format!("{i},{o},{turn},{f}"))
}

fn read(name: &str, bytes: &[u8], conventions: &Conventions) -> Result<Source, String> {
    read_from(name, bytes, conventions).map_err(|error| {
        let all = std::iter::successors(Some(&error as &dyn std::error::Error), |e| e.source());
        all.map(ToString::to_string).collect::<Vec<_>>().join(": ")
    })
}

fn intake(name: &str, text: &str) -> Intake {
    read(name, text.as_bytes(), &Conventions::default())
        .unwrap_or_else(|e| panic!("{name}: {e}"))
        .intake
        .unwrap()
}

fn notes(intake: &Intake) -> String {
    intake.notes.iter().map(|note| format!("{} ({})\n", note.text, note.option.unwrap_or(""))).collect()
}

/// Whether two sets of samples are the same, in whatever order and frame.
fn is_same(name: &str, a: &Intake, b: &Intake) {
    let key = |row: &srbf_measured::read::Row| {
        let dot: f64 = (0..3).map(|k| row.wi[k] * row.wo[k]).sum();
        [row.wi[2], row.wo[2], dot, row.rgb[1]]
    };
    let sorted = |intake: &Intake| {
        let mut keys: Vec<[i64; 4]> =
            intake.rows.iter().map(|row| key(row).map(|v| (1e4 * v).round() as i64)).collect();
        keys.sort_unstable();
        keys
    };
    let (a, b) = (sorted(a), sorted(b));
    assert_eq!(a.len(), b.len(), "{name}");
    let apart = a.iter().zip(&b).find(|(a, b)| (0..4).any(|k| (a[k] - b[k]).abs() > 1));
    assert!(apart.is_none(), "{name}: {apart:?}");
}

#[test]
fn other_shapes_of_the_same_samples_are_the_same_samples() {
    let expected = intake("plain.csv", &plain());
    assert_eq!(expected.rows.len(), 75);
    let column = |k: usize| plastic().iter().map(|s| s[k].to_string()).collect::<Vec<_>>().join(",");
    let names = ["Incidence", "theta_o", "dphi", "BRDF"];
    let by_column = (0..4).map(|k| format!("{},{}\n", names[k], column(k))).collect::<String>();
    let records: Vec<String> = plastic()
        .iter()
        .map(|[i, o, turn, f]| {
            format!("{{\"theta_i\": {i}, \"theta_o\": {o}, \"dphi\": {turn}, \"value\": {f}}}")
        })
        .collect();
    let block = |at: f64| {
        let rows =
            plastic().into_iter().filter(|s| s[0] == at).map(|[_, o, turn, f]| format!("{o} {turn} {f}\n"));
        rows.collect::<String>()
    };
    let blocks = |mark: &str, names: &str| {
        [10.0, 40.0, 70.0].map(|at| format!("{mark}AOI: {at}\n{names}{}", block(at))).concat()
    };
    let fred = [10.0, 40.0, 70.0].map(|at| {
        let rows = plastic().into_iter().filter(|s| s[0] == at);
        let rows = rows.map(|[_, o, turn, f]| format!("{o}\t{}\t{f}\n", turn + 180.0)).collect::<String>();
        format!("{at}\t0\n{rows}")
    });
    let phase = lines("incidence_angle,emission_angle,phase_angle,brdf", |[i, o, turn, f]| {
        let (a, b) = (direction(*i, 0.0), direction(*o, *turn));
        let dot: f64 = (0..3).map(|k| a[k] * b[k]).sum();
        format!("{i},{o},{},{f}", dot.min(1.0).acos().to_degrees())
    });
    for (name, text) in [
        ("cr.csv", plain().replace('\n', "\r")),
        ("names_again.csv", plain() + "theta_i,theta_o,dphi,value\n"),
        ("column.csv", by_column),
        ("records.json", format!("[{}]", records.join(", "))),
        (
            "columns.json",
            format!(
                "{{\"theta_i\": [{}], \"theta_o\": [{}], \"dphi\": [{}], \"value\": [{}]}}",
                column(0),
                column(1),
                column(2),
                column(3)
            ),
        ),
        ("blocks.txt", blocks("", "theta_o dphi value\n")),
        (
            "comments.txt",
            format!("# AOI: 10\ntheta_o dphi value\n{}", blocks("# ", "").replacen("# AOI: 10\n", "", 1)),
        ),
        ("fred.txt", format!("type bsdf_data\nformat angles=deg bsdf=value scale=1\n{}", fred.concat())),
        ("phase.csv", phase),
        (
            "mueller.csv",
            lines("theta_i,theta_o,dphi,fr11,m12", |[i, o, turn, f]| format!("{i},{o},{turn},{f},0.1")),
        ),
        (
            "ars.csv",
            lines("theta_i,theta_o,dphi,ARS", |[i, o, turn, f]| {
                format!("{i},{o},{turn},{}", f * o.to_radians().cos())
            }),
        ),
    ] {
        is_same(name, &intake(name, &text), &expected);
    }
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(plain().as_bytes()).unwrap();
    let packed = packed.finish().unwrap();
    let source = read("plain.csv.gz", &packed, &Conventions::default()).unwrap();
    is_same("gz", source.intake.as_ref().unwrap(), &expected);
    for cut in (3..packed.len() - 1).step_by(7) {
        assert!(read("plain.csv.gz", &packed[..cut], &Conventions::default()).is_err(), "{cut}");
    }
}

#[test]
fn a_matrix_of_angles_is_the_plane_of_incidence() {
    let text = "AOI in degrees\ntheta_o\\theta_i,10,40\n-40,0.1,0.2\n0,0.3,0.4\n40,0.5,0.6\n";
    let found = intake("matrix.csv", text);
    assert_eq!((found.rows.len(), found.rows[5].rgb[0], found.rows[5].line), (6, 0.6, 5));
    assert!(
        notes(&found).contains("a matrix") && notes(&found).contains("--mirror opposite"),
        "{}",
        notes(&found)
    );
}

#[test]
fn what_may_be_wrong_is_asked_before_a_fit() {
    let along = lines("wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,value", |[i, o, turn, f]| {
        let (a, b) = (direction(*i, 0.0), direction(*o, *turn));
        format!("{},{},{},{},{},{},{f}", -a[0], -a[1], -a[2], b[0], b[1], b[2])
    });
    let error = read("along.csv", along.as_bytes(), &Conventions::default()).err().unwrap();
    assert!(error.contains("--incident along-light") && error.contains("transmission"), "{error}");
    let turned = Conventions { is_along_light: true, ..Conventions::default() };
    let turned = read("along.csv", along.as_bytes(), &turned).unwrap().intake.unwrap();
    is_same("along.csv", &turned, &intake("plain.csv", &plain()));

    let clipped =
        lines("theta_i,theta_o,dphi,value", |[i, o, turn, f]| format!("{i},{o},{turn},{}", f.min(0.11)));
    let found = intake("clipped.csv", &clipped);
    let count = found.rows.iter().filter(|row| row.rgb[0] == 0.11).count();
    let text = notes(&found);
    assert!(
        text.contains(&format!("0.11, stands there {count} times")) && text.contains("--saturated leave-out"),
        "{text}"
    );
    assert!(!notes(&intake("plain.csv", &plain())).contains("saturated"));
    let without = Conventions { is_saturated: true, ..Conventions::default() };
    let without = read("clipped.csv", clipped.as_bytes(), &without).unwrap().intake.unwrap();
    assert_eq!((without.rows.len(), without.left_out_count()), (75 - count, count));

    let decibels =
        lines("theta_i,theta_o,dphi,value", |[i, o, turn, f]| format!("{i},{o},{turn},{}", 10.0 * f.log10()));
    let error = read("decibels.csv", decibels.as_bytes(), &Conventions::default()).err().unwrap();
    assert!(error.contains("decibels"), "{error}");
    let announced = notes(&intake("announced.csv", &format!("points: 80\n{}", plain())));
    assert!(announced.contains("announces 80 rows, and has 75"), "{announced}");
}

#[test]
fn samples_of_a_lidar_leave_the_mirror_side_a_guess() {
    let lidar: String = (0..18).map(|n| format!("{0},{0},0,0.04\n", 5 * n.min(16))).collect();
    let found = intake("lidar.csv", &format!("theta_i,theta_o,dphi,value\n{lidar}"));
    let look = Look::new(&found, None);
    assert!(look.findings.iter().any(|f| f.is_off && f.text.contains("lidar")), "{:?}", look.findings);
    let look = Look::new(&intake("plain.csv", &plain()), None);
    assert!(!look.findings.iter().any(|f| f.is_off), "{:?}", look.findings);
}

#[test]
fn black_is_completed_and_one_sample_is_not() {
    let table = |text: &str| match read("a.csv", text.as_bytes(), &Conventions::default()).unwrap().content {
        Content::Samples(table) => table,
        Content::Evaluable(_) => panic!("samples"),
    };
    let mut random = 1u64;
    let mut noise = || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        1e-6 * ((random >> 33) as f64 / f64::from(1u32 << 31) - 0.5)
    };
    let noisy: String =
        plastic().iter().map(|[i, o, turn, _]| format!("{i},{o},{turn},{}\n", noise())).collect();
    let zero = lines("theta_i,theta_o,dphi,value", |[i, o, turn, _]| format!("{i},{o},{turn},0"));
    for text in [format!("theta_i,theta_o,dphi,value\n{noisy}"), zero] {
        let albedo = complete(&table(&text)).unwrap().report.albedo;
        assert!(albedo.iter().all(|a| a.1[1] > 0.0 && a.1[1] < 1e-6), "{albedo:?}");
    }
    let error = complete(&table("theta_i,theta_o,dphi,value\n10,20,0,0.1\n")).err().unwrap().to_string();
    assert!(error.contains("1 sample") && error.contains('5'), "{error}");
}

#[test]
fn files_of_other_programs_are_named_by_their_first_bytes() {
    for (bytes, word) in [
        (&b"\x89HDF\r\n\x1a\n\0\0"[..], "AxF"),
        (b"MATLAB 5.0 MAT-file, Platform", "writetable"),
        (b"CDF\x01\0\0", "NetCDF"),
        (b"PAR1\x15\0", "read_parquet"),
        (b"v/1\x01\x02\0\0\0", "OpenEXR"),
        (b"\x89PNG\r\n\x1a\n\0", "picture"),
        (b"PK\x03\x04\0\0\0array.npy\0", ".npy"),
        (b"PK\x03\x04\0\0\0xl/workbook.xml", "spreadsheet"),
        (b"NVIDIA ARC MBSDF V1\n", "MDL"),
        (b"OPTIS - Anisotropic BSDF surface file v9.0\n1\n\0\0\0", "mode 1"),
        (b"Recover using: genBSDF\n<?xml version=\"1.0\"?>\n<WindowElement>\n", "WINDOW"),
    ] {
        let error = read("file", bytes, &Conventions::default()).err().unwrap();
        assert!(error.contains(word), "{word}: {error}");
    }
}
