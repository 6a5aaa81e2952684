use super::*;
use crate::read::Mirror;

const HEADER: &str = "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,r,g,b";

fn parse(text: &str) -> Result<Intake, ReadError> {
    super::parse(text.as_bytes(), &Conventions::default())
}

/// The one sample that all spellings below are.
fn is_the_sample(text: &str) {
    let intake = parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    let row = intake.rows[0];
    let across = row.wi[0] * row.wo[0] + row.wi[1] * row.wo[1];
    assert!((row.wi[2] - 0.8).abs() < 1e-6 && (row.wo[2] - 0.6).abs() < 1e-6, "{text}: {row:?}");
    assert!((across + 0.48).abs() < 1e-6, "{text}: {row:?}");
    let expected = if (row.rgb[0] - row.rgb[1]).abs() < 1e-6 { [0.25; 3] } else { [1.0, 2.0, 3.0] };
    assert!((0..3).all(|c| (row.rgb[c] - expected[c]).abs() < 1e-6), "{text}: {row:?}");
}

#[test]
fn one_sample_in_many_layouts_is_one_sample() {
    let (i, o) = (0.6f64.asin().to_degrees(), 0.8f64.asin().to_degrees());
    let comma = |v: f64| v.to_string().replace('.', ",");
    let (ic, oc) = (comma(i), comma(o));
    let (ir, or) = (i.to_radians(), o.to_radians());
    for text in [
        format!("{HEADER}\n0.6,0,0.8,-0.8,0,0.6,1,2,3\n"),
        "\u{feff}b, g, r, wo_z,wo_y,wo_x, wi_x,wi_y,wi_z\n\n# a comment\n 3, 2 ,1,0.6,0,-0.8,0.6,0,0.8\n"
            .into(),
        format!("theta_i,phi_i,theta_o,phi_o,R,G,B\r\n{i},30,{o},210,1,2,3\r\n"),
        format!("theta_i;phi_i;theta_o;phi_o;value\n{ic};30;{oc};210;0,25\n"),
        format!("theta_i\tphi_i\ttheta_r\tphi_r\tBRDF\n{ic}\t30\t{oc}\t210\t2,5E-01\n"),
        format!("sep=;\ntheta_i;phi_i;theta_o;phi_o;value\n{i};30;{o};210;0.25\n"),
        format!(
            "\"theta_i\",\"phi_i\",\"theta_o\",\"phi_o\",\"value\"\n\"{ic}\",\"30\",\"{oc}\",\"210\",\"0,25\"\n"
        ),
        format!("# theta_i phi_i theta_o phi_o value\n{i} 30 {o} 210 0.25\n"),
        format!("  theta_i   phi_i   theta_o  phi_o   value\n  {i}   30   {o}  210  0.25\n"),
        format!("theta_i,phi_i,theta_o,phi_o,value\ndeg,deg,deg,deg,1/sr\n{i},30,{o},210,0.25\n"),
        format!("theta_i,phi_i,theta_o,phi_o,value\nrad,rad,rad,rad,1/sr\n{ir},0,{or},3.14159265,0.25\n"),
        format!("theta_i [rad],phi_i [rad],theta_o [rad],phi_o [rad],value\n{ir},0,{or},3.14159265,0.25\n"),
        format!(
            "Sample: red\nInstrument,gonio 3\nDate;1.2.2024\n\ntheta_i,phi_i,theta_o,phi_o,value,sigma,comment\n{i},30,{o},210,0.25,0.1,ok\n"
        ),
        format!("AOI: {i}\ntheta,phi,BRDF\n{o},180,0.25\n"),
        format!("theta_i,theta_o,dphi,value\n{i},{o},180,0.25\n"),
        format!("Incident_angle,Measure_angle,532nm\n{i},{o},0.25\n"),
        format!("theta_i,phi_i,theta_o,phi_o,0.45um,0.55um,0.65um\n{i},30,{o},210,0.25,0.25,0.25\n"),
        format!("theta_i,phi_i,theta_o,phi_o,BRDF (%)\n{i},30,{o},210,25\n"),
        format!("theta_i,phi_i,theta_o,phi_o,value,\n{i},30,{o},210,0.25,\n"),
        format!("theta_i|phi_i|theta_o|phi_o|value\n{i}|30|{o}|210|0.25\n"),
        format!("sza,saa,vza,vaa,brf\n{i},30,{o},210,0.7853982\n"),
        format!("theta_s,phi_s,theta_v,phi_v,f\n{i},30,{o},210,0.25\n"),
        format!("theta_i,phi_i,theta_s,phi_s,f\n{i},30,{o},210,0.25\n"),
        format!(
            "theta_i,phi_i,theta_o,phi_o,wavelength,value\n{i},30,{o},210,450,0.25\n{i},30,{o},210,550,0.25\n{i},30,{o},210,650,0.25\n"
        ),
        format!("-{i}")
            .replace(&format!("-{i}"), &format!("theta_i,phi_i,theta_o,phi_o,value\n{i},0,-{o},0,0.25\n")),
    ] {
        is_the_sample(&text);
    }
    // The same from Excel in UTF-16.
    let text = format!("theta_i\tphi_i\ttheta_o\tphi_o\tvalue\r\n{ic}\t30\t{oc}\t210\t0,25\r\n");
    let wide: Vec<u8> =
        [0xff, 0xfe].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    assert_eq!(super::parse(&wide, &Conventions::default()).unwrap().rows.len(), 1);
}

#[test]
fn what_is_taken_for_granted_is_said() {
    for (text, word) in [
        ("Incident_angle,Measure_angle,550nm\n10,10,0.2\n10,-30,0.1\n", "--mirror opposite"),
        ("theta_i,phi_i,theta_o,phi_o,905nm\n20,0,30,180,0.1\n", "one wavelength"),
        ("theta_i,phi_i,theta_o,phi_o,value,sigma\n20,0,30,180,0.1,0.01\n", "sigma"),
        ("theta_i,theta_o,phi_o,value\n20,30,180,0.1\n", "one azimuth"),
        ("theta_i,phi_i,theta_o,phi_o,value\n20,0,-30,0,0.1\n", "below 0"),
    ] {
        let intake = parse(text).unwrap();
        let said = |note: &super::super::Note| format!("{} {}", note.text, note.option.unwrap_or(""));
        assert!(intake.notes.iter().any(|note| said(note).contains(word)), "{text}: {:?}", intake.notes);
    }
}

#[test]
fn what_cannot_be_read_names_what_stopped_it() {
    let rows = "\n20,0,30,180,1\n";
    for (text, word) in [
        (format!("theta_i,phi_i,theta_o,phi_o,r,g{rows}"), "r,g,b"),
        (format!("theta_i,phi_i,theta_o,phi_o,value,value{rows}"), "twice"),
        (format!("theta_i,phi_i,foo,phi_o,value{rows}"), "outgoing"),
        (format!("theta_i,phi_i,theta_o,phi_o,Messung{rows}"), "`Messung`"),
        (format!("theta_i,phi_i,theta_o,phi_o,400nm,NaN,700nm{rows}"), "NaN"),
        (format!("theta_i,phi_i,theta_o,phi_o,-inf,450,700{rows}"), "-inf"),
        (format!("theta_i,phi_i,theta_o,Azimut Tisch,value{rows}"), "`Azimut Tisch`"),
        (format!("theta_h,theta_d,value{rows}"), "three columns"),
        (format!("theta_i,phi_i,theta_o,phi_o,BRDF1,BRDF2{rows}"), "`BRDF1` and `BRDF2`"),
        (format!("theta_i,phi_i,theta_o,phi_o,log10(BRDF){rows}"), "logarithms"),
        (format!("theta_i,foo,bar{rows}"), "not known: `foo`, `bar`"),
        ("20,0,30,180,1\n20,0,40,180,1\n".into(), "names the columns"),
        (String::new(), "empty"),
        ("theta_i,phi_i,theta_o,phi_o,value\n20,0,30,180,x\n".into(), "line 2"),
        ("theta_i,phi_i,theta_o,phi_o,value\n20,0,30,180,1\n20,0,3\n".into(), "line 3"),
        (
            "theta_i,theta_o,dphi,value\n20,30,180,1\nlamp replaced\n20,40,180,1\n".into(),
            "line 3: `lamp replaced`",
        ),
        ("theta_i,theta_o,dphi,value\nlamp replaced\n".into(), "line 2: `lamp replaced`"),
        ("sun elevation,view zenith,dphi,value\n20,30,180,1\n".into(), "horizon"),
        ("mu0,mu,value\n0.2,0.3,1\n".into(), "an azimuth is needed"),
        ("mu0,mu,dphi,value\n0.2,0.3,3.1,1\n".into(), "--angles radians"),
        ("mu0,mu,dphi,value\n0.2,1.3,180,1\n".into(), "line 2: 1.3 is no cosine"),
        ("AOI: 30\nfrom specular,value\n10,1\n".into(), "mirror direction"),
        ("theta_i,phi_i,theta_o,phi_o,value\n20,0,30,180,0,25\n".into(), "separated by ;"),
        ("theta_i,phi_i,theta_o,phi_o,value\n20,0,300,180,1\n".into(), "line 2: theta 300"),
        ("theta_i,phi_i,theta_o,phi_o,value\n0.2,0,0.3,1.5,1\n0.2,0,0.4,1.5,1\n".into(), "--angles radians"),
        (format!("{HEADER}\n0,0,2,0,0,1,0,0,0\n"), "unit vector"),
        (format!("{HEADER}\n1,2,3\n"), "line 2: 3 columns"),
        (format!("{HEADER}\n0,0,1,0,0,1,NaN,0,0\n"), "no samples: 1 row without a number (line 2)"),
        (format!("{HEADER}\n0,0,-1,0,0,1,0,0,0\n"), "transmission"),
        (format!("{HEADER}\n"), "no samples"),
        ("a\u{1b}[31m;b".into(), "byte 1"),
    ] {
        let error = parse(&text).unwrap_err().to_string();
        assert!(error.contains(word), "{text}: {error}");
    }
}

#[test]
fn conventions_of_the_caller_decide() {
    let text = "theta_i,phi_i,theta_o,phi_o,value\n0.5,0,0.9,0,0.2\n";
    let radians = Conventions { angles: Some(crate::read::Angles::Radians), ..Conventions::default() };
    let row = super::parse(text.as_bytes(), &radians).unwrap().rows[0];
    assert!((row.wi[2] - 0.5f64.cos()).abs() < 1e-12 && row.wo[0] > 0.0);
    let all = Conventions {
        mirror: Some(Mirror::Equal),
        values: Some(crate::read::Values::CosineOutgoing),
        divide: 2.0,
        ..radians
    };
    let row = super::parse(text.as_bytes(), &all).unwrap().rows[0];
    assert!((row.rgb[0] - 0.1 / 0.9f64.cos()).abs() < 1e-12 && row.wo[0] < 0.0, "{row:?}");
    let plane = "theta_i,theta_o,value\n30,40,0.2\n";
    for (mirror, sign) in [(None, -1.0), (Some(Mirror::Equal), -1.0), (Some(Mirror::Opposite), 1.0)] {
        let row = super::parse(plane.as_bytes(), &Conventions { mirror, ..Conventions::default() })
            .unwrap()
            .rows[0];
        assert!(row.wi[0] * row.wo[0] * sign > 0.0, "{mirror:?}: {row:?}");
    }
}

#[test]
fn rows_that_are_no_samples_are_counted_by_line() {
    let text = "theta_i,phi_i,theta_o,phi_o,value\n20,0,30,180,0.1\n20,0,90,180,0.1\n20,0,160,180,0.1\n20,0,40,180,\n\
                20,0,50,180,-1\n20,0,55,180,0.12\n";
    let intake = parse(text).unwrap();
    assert_eq!(intake.rows.iter().map(|row| row.line).collect::<Vec<_>>(), [2, 7]);
    let of = |reason: Reason| {
        intake.left_out.iter().find(|left| left.reason == reason).map(|left| left.lines.clone())
    };
    assert_eq!(of(Reason::Horizon), Some(vec![3]));
    assert_eq!(of(Reason::Transmission), Some(vec![4]));
    assert_eq!(of(Reason::NoNumber), Some(vec![5]));
    assert_eq!(of(Reason::Sentinel(-1.0)), Some(vec![6]));
    assert_eq!(intake.left_out_count(), 4);
}
