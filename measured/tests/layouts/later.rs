//! Files that were made when the reader had learnt the first ones.

use super::*;

/// Name, bytes and right reading of every file.
pub fn files() -> Vec<(&'static str, Vec<u8>, Right)> {
    let angles = [0.0, 45.0, 90.0, 135.0, 180.0];
    vec![
        (
            "index_blocks.dat",
            {
                let mut text = "# theta_o phi_o brdf\n".to_owned();
                for i in [10.0, 30.0, 50.0] {
                    let _ = writeln!(text, "\n\n# theta_i = {i} deg");
                    for o in [5.0, 15.0, 30.0, 45.0, 60.0] {
                        for phi in angles {
                            let _ = writeln!(text, "{o} {phi} {:.6}", At(i, o, phi).f());
                        }
                    }
                }
                text.into_bytes()
            },
            Read(75, 0, 1.0, &[]),
        ),
        (
            "three_lines.csv",
            lines(
                "Incident,,Reflected,,BRDF\nzenith,azimuth,zenith,azimuth,\ndeg,deg,deg,deg,sr-1\n",
                |_, a| format!("{},0,{},{},{:.6}", a.0, a.1, a.2, a.f()),
            ),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "measurements.json",
            {
                let one = |a: At| {
                    format!(
                        "{{\"theta_i\": {}, \"theta_o\": {}, \"phi\": {}, \"brdf\": {:.6}}}",
                        a.0,
                        a.1,
                        a.2,
                        a.f()
                    )
                };
                let all: Vec<String> = grid().into_iter().map(one).collect();
                format!("{{\"instrument\": \"gonio\", \"measurements\": [{}]}}", all.join(",\n")).into_bytes()
            },
            Read(75, 0, 1.0, &[]),
        ),
        (
            "nested.jsonl",
            lines("", |_, a| {
                format!(
                    "{{\"incident\": {{\"theta\": {}, \"phi\": 0}}, \"outgoing\": {{\"theta\": {}, \"phi\": {}}}, \"brdf\": {:.6}}}",
                    a.0,
                    a.1,
                    a.2,
                    a.f()
                )
            }),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "long_names.csv",
            lines(
                "Illumination zenith (deg),Viewing zenith (deg),Relative azimuth (deg),BRDF @ 550 nm (1/sr)\n",
                |_, a| format!("{},{},{},{:.6}", a.0, a.1, a.2, a.f()),
            ),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "ini_comments.tsv",
            lines("; exported 2021-04-01\n; lamp: xenon\ntheta_i\ttheta_o\tphi_o\tbrdf\n", |_, a| {
                format!("{}\t{}\t{}\t{:.6}", a.0, a.1, a.2, a.f())
            }),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "columns_of_incidence.csv",
            {
                let mut text = "Detector angle,AOI=10,AOI=30,AOI=50\n".to_owned();
                for n in -15_i32..=15 {
                    let signed = 5.0 * f64::from(n);
                    let f = |i: f64| At(i, signed.abs(), if n < 0 { 0.0 } else { 180.0 }).f();
                    let _ = writeln!(text, "{signed},{:.6},{:.6},{:.6}", f(10.0), f(30.0), f(50.0));
                }
                text.into_bytes()
            },
            Read(93, 0, 1.0, &["matrix"]),
        ),
        (
            "long_spectra.txt",
            {
                let mut text = "AOI\tview angle\tview azimuth\twavelength (nm)\tBRDF (1/sr)\n".to_owned();
                for a in grid() {
                    for nm in [450, 550, 650] {
                        let _ = writeln!(text, "{}\t{}\t{}\t{nm}\t{:.6}", a.0, a.1, a.2, a.f());
                    }
                }
                text.into_bytes()
            },
            Read(75, 0, 1.0, &[]),
        ),
        (
            "greek.csv",
            lines("\u{3b8}i (\u{b0});\u{3b8}r (\u{b0});\u{3c6} (\u{b0});fr (sr\u{207b}\u{b9})\n", |_, a| {
                format!("{};{};{};{}", comma(a.0), comma(a.1), comma(a.2), comma(a.f()))
            }),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "incident_x.tsv",
            lines(
                "incident_x\tincident_y\tincident_z\treflected_x\treflected_y\treflected_z\tbrdf\n",
                |_, a| {
                    let (i, o) = (direction(a.0, 0.0), direction(a.1, a.2));
                    format!(
                        "{:.7}\t{:.7}\t{:.7}\t{:.7}\t{:.7}\t{:.7}\t{:.6}",
                        i[0],
                        i[1],
                        i[2],
                        o[0],
                        o[1],
                        o[2],
                        a.f()
                    )
                },
            ),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "sections.ini",
            lines("[instrument]\nname = gonio\n\n", |n, a| {
                format!(
                    "[sample {n}]\ntheta_i = {}\ntheta_o = {}\nphi_o = {}\nbrdf = {:.6}\n",
                    a.0,
                    a.1,
                    a.2,
                    a.f()
                )
            }),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "python_repr.txt",
            {
                let one = |a: At| {
                    format!(
                        "{{'theta_i': {:?}, 'theta_o': {:?}, 'phi_o': {:?}, 'brdf': {:.6}}}",
                        a.0,
                        a.1,
                        a.2,
                        a.f()
                    )
                };
                let all: Vec<String> = grid().into_iter().map(one).collect();
                format!("[{}]", all.join(", ")).into_bytes()
            },
            Read(75, 0, 1.0, &[]),
        ),
        (
            "inserts.sql",
            lines("CREATE TABLE brdf (theta_i REAL, theta_o REAL, phi_o REAL, f REAL);\n", |_, a| {
                format!(
                    "INSERT INTO brdf (theta_i, theta_o, phi_o, f) VALUES ({}, {}, {}, {:.6});",
                    a.0,
                    a.1,
                    a.2,
                    a.f()
                )
            }),
            Refused(&["INSERT"]),
        ),
        (
            "italian.csv",
            lines("angolo di incidenza;angolo di osservazione;azimut relativo;BRDF (sr-1)\n", |_, a| {
                format!("{};{};{};{}", a.0, a.1, a.2, comma(a.f()))
            }),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "milli.csv",
            lines("theta_i,theta_o,phi_o,BRDF [10^-3 1/sr]\n", |_, a| {
                format!("{},{},{},{:.4}", a.0, a.1, a.2, 1e3 * a.f())
            }),
            Refused(&["10^-3"]),
        ),
        (
            "totals.csv",
            {
                let mut bytes = lines("theta_i;theta_o;phi_o;BRDF\n", |_, a| {
                    format!("{};{};{};{}", a.0, a.1, a.2, comma(a.f()))
                });
                bytes.extend("Mean;;;0,1319\nMax;;;0,2210\n".bytes());
                bytes
            },
            Read(75, 0, 1.0, &["below the numbers"]),
        ),
    ]
}
