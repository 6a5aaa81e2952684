//! Files that the reader was made for after they were.

use super::*;

/// Name, bytes and right reading of every file.
pub fn files() -> Vec<(&'static str, Vec<u8>, Right)> {
    vec![
        (
            "labview.lvm",
            lines(
                "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\nMulti_Headings\tNo\n\
                 X_Columns\tNo\nTime_Pref\tAbsolute\nOperator\tlab\nDate\t2023/05/11\nTime\t14:03:27,4189453\n***End_of_Header***\t\n\t\n\
                 Channels\t5\nSamples\t75\t75\t75\t75\t75\n***End_of_Header***\t\nTheta_inc\tPhi_inc\tTheta_det\tPhi_det\tBRDF\tComment\n",
                |_, a| {
                    format!(
                        "{}\t{}\t{}\t{}\t{}\t",
                        comma(a.0),
                        comma(0.0),
                        comma(a.1),
                        comma(a.2),
                        comma(a.f())
                    )
                },
            ),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "r_write_table.txt",
            lines("\"theta_i\" \"theta_o\" \"dphi\" \"brdf\"\n", |n, a| {
                format!("\"{}\" {} {} {} {:.7}", n + 1, a.0, a.1, a.2, a.f())
            }),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "pandas_index.csv",
            lines(",theta_i,phi_i,theta_r,phi_r,f_r\n", |n, a| {
                format!("{n},{:?},0.0,{:?},{:?},{}", a.0, a.1, a.2, a.f())
            }),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "writematrix.csv",
            lines("", |_, a| format!("{},0,{},{},{:.5}", a.0, a.1, a.2, a.f())),
            Refused(&["names the columns"]),
        ),
        (
            "writetable.csv",
            lines(
                "theta_in_deg,phi_in_deg,theta_out_deg,phi_out_deg,BRDF_450nm,BRDF_500nm,BRDF_550nm,BRDF_600nm,BRDF_650nm\n",
                |_, a| format!("{},0,{},{}{}", a.0, a.1, a.2, format!(",{:.6}", a.f()).repeat(5)),
            ),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "logger_german.csv",
            {
                let mut bytes = lines(
                    "Messprotokoll;Goniometer 3;;;;;\r\nProbe;Lack, matt;;;;;\r\nDatum;12.03.2024;;;;;\r\n;;;;;;\r\n\
                     Zeit;Lichteinfall [\u{b0}];Detektorwinkel [\u{b0}];Azimut Detektor [\u{b0}];BRDF [1/sr];Temp. [\u{b0}C];Status\r\n",
                    |n, a| {
                        let (minute, second) = (n / 60, n % 60);
                        let f = comma(a.f());
                        format!("12.03.2024 10:{minute:02}:{second:02};{};{};{};{f};21,4;OK\r", a.0, a.1, a.2)
                    },
                );
                bytes.extend(b";;;;;;\r\n;;;;;;\r\n");
                String::from_utf8(bytes).unwrap().chars().map(|c| u32::from(c) as u8).collect()
            },
            Read(75, 0, 1.0, &[]),
        ),
        (
            "french.csv",
            lines(
                "# Laboratoire d'optique, mesure du 3 mai\nangle d'incidence (\u{b0});angle d'observation (\u{b0});azimut (\u{b0});FRDB (sr-1)\n",
                |_, a| format!("{};{};{};{}", a.0, a.1, a.2, comma(a.f())),
            ),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "chinese.csv",
            lines(
                "\u{feff}入射天顶角,入射方位角,观测天顶角,观测方位角,BRDF\n",
                |_, a| format!("{},0,{},{},{:.6}", a.0, a.1, a.2, a.f()),
            ),
            Refused(&["入射天顶角"]),
        ),
        (
            "from_specular.txt",
            {
                let mut text = "CASI Scatter Measurement\nSample: black paint on Al\nWavelength (um): 0.6328\nAOI (deg): 30.0\n\
                                Polarization: unpolarized\n\nDeg_from_spec\tBRDF\tPower(W)\n"
                    .to_owned();
                for n in -20_i32..=8 {
                    let from = 5.0 * f64::from(n);
                    let signed: f64 = 30.0 + from;
                    let f = At(30.0, signed.abs(), if signed < 0.0 { 0.0 } else { 180.0 }).f();
                    let _ = writeln!(text, "{from:.2}\t{f:.6e}\t1.2e-9");
                }
                text.into_bytes()
            },
            Refused(&["Deg_from_spec"]),
        ),
        (
            "theta_phi_blocks.txt",
            {
                let mut text = "Scatter export\nSamples in columns: azimuth\n".to_owned();
                for i in [10.0, 30.0, 50.0] {
                    let _ = writeln!(text, "Incidence angle: {i}\ntheta_o\\phi_o\t0\t45\t90\t135\t180");
                    for o in [5.0, 15.0, 30.0, 45.0, 60.0] {
                        let cells =
                            [0.0, 45.0, 90.0, 135.0, 180.0].map(|phi| format!("\t{:.6}", At(i, o, phi).f()));
                        let _ = writeln!(text, "{o}{}", cells.concat());
                    }
                }
                text.into_bytes()
            },
            Read(75, 0, 1.0, &[]),
        ),
        (
            "lines.jsonl",
            lines("", |n, a| {
                let [r, g, b] = a.rgb();
                format!(
                    "{{\"id\": {n}, \"theta_i\": {:?}, \"phi_i\": 0.0, \"theta_o\": {:?}, \"phi_o\": {:?}, \"r\": {r}, \"g\": {g}, \"b\": {b}}}",
                    a.0, a.1, a.2
                )
            }),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "list.yaml",
            lines("instrument: gonio\nunits: {angle: deg, brdf: 1/sr}\nsamples:\n", |_, a| {
                format!("  - {{theta_i: {}, theta_o: {}, phi: {}, brdf: {:.6}}}", a.0, a.1, a.2, a.f())
            }),
            Refused(&["YAML"]),
        ),
        (
            "markdown.md",
            lines(
                "# Results\n\n| theta_i | theta_o | phi_o | BRDF |\n|--------:|--------:|------:|-----:|\n",
                |_, a| format!("| {} | {} | {} | {:.6} |", a.0, a.1, a.2, a.f()),
            ),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "gnuplot.dat",
            lines("# theta_i theta_o phi_o brdf\n", |n, a| {
                let gap = if n > 0 && n % 25 == 0 { "\n\n" } else { "" };
                format!("{gap}{:.18e} {:.18e} {:.18e} {:.18e}", a.0, a.1, a.2, a.f())
            }),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "geometry_columns.csv",
            {
                let mut text = "Wavelength".to_owned();
                for a in grid() {
                    let _ = write!(text, ",i{:02}_e{:02}_a{:03}.asd", a.0, a.1, a.2);
                }
                for nm in (400..=700).step_by(50) {
                    let _ = write!(text, "\n{nm}");
                    for a in grid() {
                        let _ = write!(text, ",{:.6}", a.f() * PI);
                    }
                }
                text.into_bytes()
            },
            Refused(&["i10_e05_a000.asd"]),
        ),
        (
            "radiance_factor.csv",
            lines("incidence,emission,phase,I/F\n", |_, a| {
                format!("{},{},{:.4},{:.6}", a.0, a.1, a.phase(), a.f() * PI * a.0.to_radians().cos())
            }),
            Read(75, 0, 1.0, &["I/F"]),
        ),
        (
            "origin.txt",
            lines("theta_i\ttheta_o\tphi_o\tBRDF\nrad\trad\trad\t1/sr\n\t\t\tmean of 5\n", |_, a| {
                let [i, o, p] = [a.0, a.1, a.2].map(f64::to_radians);
                format!("{i:.6}\t{o:.6}\t{p:.6}\t{:.6}", a.f())
            }),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "psql.txt",
            {
                let mut bytes = lines(
                    " theta_i | theta_o | phi_o |   brdf   \n---------+---------+-------+----------\n",
                    |_, a| format!(" {:7} | {:7} | {:5} | {:.6}", a.0, a.1, a.2, a.f()),
                );
                bytes.extend(b"(75 rows)\n\n");
                bytes
            },
            Read(75, 0, 1.0, &[]),
        ),
        (
            "elevation.csv",
            lines("sun_elevation,sensor_elevation,relative_azimuth,BRF\n", |_, a| {
                format!("{},{},{},{:.6}", 90.0 - a.0, 90.0 - a.1, a.2, a.f() * PI)
            }),
            Refused(&["elevation", "horizon"]),
        ),
        (
            "cosines.dat",
            lines("mu0 mu dphi brdf\n", |_, a| {
                format!("{:.6} {:.6} {} {:.6}", a.0.to_radians().cos(), a.1.to_radians().cos(), a.2, a.f())
            }),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "light_view.csv",
            lines("red,green,blue,light_x,light_y,light_z,view_x,view_y,view_z\n", |_, a| {
                let ([r, g, b], i, o) = (a.rgb(), direction(a.0, 0.0), direction(a.1, a.2));
                format!(
                    "{r:.6},{g:.6},{b:.6},{:.6},{:.6},{:.6},{:.6},{:.6},{:.6}",
                    i[0], i[1], i[2], o[0], o[1], o[2]
                )
            }),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "merl_loop.csv",
            {
                let mut text = "theta_half,theta_diff,phi_diff,red,green,blue\n".to_owned();
                for n in 0..9 {
                    for m in 0..9 {
                        for (turn, phi) in [0.0_f64, 0.8, 1.6, 2.4].into_iter().enumerate() {
                            let (h, d) =
                                (0.07 * f64::from(n) + 0.01, 0.07 * f64::from(m) + 0.02 * turn as f64 + 0.01);
                            // The difference direction is turned about y by the half angle.
                            let w = [d.sin() * phi.cos(), d.sin() * phi.sin(), d.cos()];
                            let turned = |w: [f64; 3]| {
                                [h.cos() * w[0] + h.sin() * w[2], w[1], h.cos() * w[2] - h.sin() * w[0]]
                            };
                            let (i, o) = (turned(w), turned([-w[0], -w[1], w[2]]));
                            let [r, g, b] = DIFFUSE.map(|share| plastic(i, o, share));
                            let _ = writeln!(text, "{h:.6},{d:.6},{phi:.6},{r:.6},{g:.6},{b:.6}");
                        }
                    }
                }
                text.into_bytes()
            },
            Refused(&["radians?"]),
        ),
        (
            "units_in_cells.csv",
            lines("theta_i;theta_o;phi_o;BRDF\n", |_, a| {
                format!("{} \u{b0};{} \u{b0};{} \u{b0};{} sr^-1", a.0, a.1, a.2, comma(a.f()))
            }),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "fortran.out",
            lines(
                "! BRDF MODEL OUTPUT\n! ANGLES IN DEGREES\n      THETAI      THETAR        DPHI        BRDF\n",
                |n, a| {
                    let number = |v: f64| format!("{:>14}", format!("{v:.5e}").replace('e', "D"));
                    let f = if n == 7 { " *************".to_owned() } else { number(a.f()) };
                    format!("{}{}{}{f}", number(a.0), number(a.1), number(a.2))
                },
            ),
            Read(74, 1, 1.0, &[]),
        ),
        (
            "polarised.csv",
            in_plane("AOI,AOR,BRDF_s,BRDF_p\n", |i, o, f| format!("{i},{o},{:.6},{:.6}", 1.2 * f, 0.8 * f)),
            Read(93, 0, 1.0, &["BRDF_s"]),
        ),
        (
            "mean_deviation.csv",
            lines("theta_i,theta_o,phi_o,mean,std,n\n", |_, a| {
                format!("{},{},{},{:.6},{:.6},5", a.0, a.1, a.2, a.f(), a.f() * 0.02)
            }),
            Read(75, 0, 1.0, &["std"]),
        ),
        (
            "runs.csv",
            lines("theta_i,theta_o,phi_o,BRDF_run1,BRDF_run2,BRDF_run3\n", |_, a| {
                format!("{},{},{},{:.6},{:.6},{:.6}", a.0, a.1, a.2, a.f() * 0.998, a.f(), a.f() * 1.002)
            }),
            Read(75, 0, 1.0, &["BRDF_run1"]),
        ),
        (
            "percent_comments.txt",
            lines("% measured by the students\n% theta_i  phi_i  theta_o  phi_o  brdf\n", |n, a| {
                format!(
                    "{} 0 {} {} {:.6}{}",
                    a.0,
                    a.1,
                    a.2,
                    a.f(),
                    if n % 9 == 4 { " % lamp flickered" } else { "" }
                )
            }),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "gon.csv",
            lines("theta_i [gon],theta_o [gon],phi_o [gon],BRDF [1/sr]\n", |_, a| {
                format!("{:.4},{:.4},{:.4},{:.6}", a.0 / 0.9, a.1 / 0.9, a.2 / 0.9, a.f())
            }),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "remote_sensing.csv",
            lines("SZA,VZA,RAA,BRF_red,BRF_green,BRF_blue\n", |_, a| {
                let [r, g, b] = a.rgb().map(|f| f * PI);
                format!("{},{},{},{r:.6},{g:.6},{b:.6}", a.0, a.1, a.2)
            }),
            Read(75, 0, 1.0, &["divided by pi"]),
        ),
        (
            "igor.itx",
            {
                let mut bytes = lines("IGOR\nWAVES/D\ttheta_i\ttheta_o\tphi_o\tbrdf\nBEGIN\n", |_, a| {
                    format!("\t{}\t{}\t{}\t{:.6}", a.0, a.1, a.2, a.f())
                });
                bytes.extend(b"END\nX SetScale/P x 0,1,\"\", theta_i\n");
                bytes
            },
            Read(75, 0, 1.0, &[]),
        ),
        (
            "cgats.txt",
            {
                let mut bytes = lines(
                    "CGATS.17\nORIGINATOR\t\"GonioSpec\"\nCREATED\t\"2022-02-01\"\nNUMBER_OF_FIELDS\t5\nBEGIN_DATA_FORMAT\n\
                     SAMPLE_ID\tTHETA_I\tTHETA_O\tPHI_O\tBRDF\nEND_DATA_FORMAT\nNUMBER_OF_SETS\t75\nBEGIN_DATA\n",
                    |n, a| format!("{}\t{}\t{}\t{}\t{:.6}", n + 1, a.0, a.1, a.2, a.f()),
                );
                bytes.extend(b"END_DATA\n");
                bytes
            },
            Read(75, 0, 1.0, &[]),
        ),
        (
            "key_value.log",
            lines("", |n, a| {
                format!("[{n:04}] theta_i={} phi_i=0 theta_o={} phi_o={} brdf={:.6}", a.0, a.1, a.2, a.f())
            }),
            Refused(&["theta_i="]),
        ),
        (
            "merged_cells.csv",
            lines("incident,,outgoing,,BRDF,,\ntheta,phi,theta,phi,R,G,B\n", |_, a| {
                let [r, g, b] = a.rgb();
                format!("{},0,{},{},{r:.6},{g:.6},{b:.6}", a.0, a.1, a.2)
            }),
            Read(75, 0, 1.0, &[]),
        ),
        (
            "incidence_below_zero.csv",
            in_plane("Angle of incidence,Detector angle,BRDF\n", |i, o, f| format!("{},{o},{f:.6}", -i)),
            Read(93, 0, 1.0, &[]),
        ),
        (
            "multi_angle.csv",
            {
                let mut text = "Instrument,MA-T6\nSerial,1234\nGeometry,400 nm,450 nm,500 nm,550 nm,600 nm,650 nm,700 nm\n".to_owned();
                for (name, o, phi) in [
                    ("45as-15", 60.0, 180.0),
                    ("45as15", 30.0, 180.0),
                    ("45as25", 20.0, 180.0),
                    ("45as45", 0.0, 0.0),
                    ("45as75", 30.0, 0.0),
                    ("45as110", 65.0, 0.0),
                ] {
                    let _ = writeln!(
                        text,
                        "{name}{}",
                        format!(",{:.2}", At(45.0, o, phi).f() * PI * 100.0).repeat(7)
                    );
                }
                text.into_bytes()
            },
            Refused(&["Geometry"]),
        ),
    ]
}
