//! Readers of what optics programs call BSDF data: a grid of scatter angles for each angle of incidence.
//!
//! Zemax (`PlaneSymmetrical`, `Asymmetrical`, `Asymmetrical4D`): scatter angles are a radius and an azimuth about the mirror direction,
//! azimuth 0 towards the normal. LightTools: angles from the normal, the light at an azimuth of 90 degrees. Both state the total share of
//! the light that is scattered (TIS), which is kept to be compared with. Of a sample that was turned there is a grid for each turn.

use super::conventions::Conventions;
use super::intake::{Intake, Reading};
use super::reason::Reason;
use super::spectrum::rgb_of_xyz;
use super::words::Words;
use crate::ReadError;
use crate::file::decode::decode;
use crate::row::turned_back;
use crate::table::direction;
use std::f64::consts::PI;

/// Most angles of one kind.
const MOST: usize = 100_000;

/// The grid that the head of a file states.
#[derive(Default)]
struct Head {
    symmetry: String,
    content: String,
    scatter: String,
    rotations: Vec<f64>,
    incidence: Vec<f64>,
    azimuths: Vec<f64>,
    radials: Vec<f64>,
}

fn fail<T>(text: impl Into<String>) -> Result<T, ReadError> {
    Err(ReadError::Content(text.into()))
}

impl Head {
    /// Up to `DataBegin`.
    fn read(words: &mut Words<'_>) -> Result<Self, ReadError> {
        let mut head = Self::default();
        loop {
            let angles = |words: &mut Words<'_>| {
                let count = words.count("how many angles there are", MOST)?;
                words.numbers(count, "an angle in degrees")
            };
            let key = words.word("DataBegin")?;
            match key {
                "Symmetry" => head.symmetry = words.word("a symmetry")?.to_owned(),
                "SpectralContent" => head.content = words.word("a spectral content")?.to_owned(),
                "ScatterType" => head.scatter = words.word("a type of scatter")?.to_owned(),
                "SampleRotation" => head.rotations = angles(words)?,
                "AngleOfIncidence" => head.incidence = angles(words)?,
                "ScatterAzimuth" => head.azimuths = angles(words)?,
                "ScatterRadial" => head.radials = angles(words)?,
                "DataBegin" => break,
                _ => {}
            }
        }
        if head.azimuths.is_empty() || head.radials.is_empty() {
            return fail("ScatterAzimuth and ScatterRadial have to name angles before DataBegin");
        }
        match head.content.as_str() {
            "Monochrome" | "XYZ" => Ok(head),
            other => fail(format!("SpectralContent `{other}`; Monochrome and XYZ are read")),
        }
    }

    /// How many tables of one incidence there are, one for each channel.
    fn channels(&self) -> usize {
        if self.content == "XYZ" { 3 } else { 1 }
    }

    /// The directions of a value of a LightTools table. The light is at an azimuth of 90 degrees in the frame of the scatter angles, which
    /// turns with the plane of incidence or not; `None` where there is one plane alone.
    fn pair(&self, part: &LightToolsTable, at: usize, frame: Option<bool>) -> [[f64; 3]; 2] {
        let (azimuth, radial) =
            (self.azimuths[at / self.radials.len()], self.radials[at % self.radials.len()]);
        let wi = direction(part.incidence.to_radians(), PI / 2.0);
        let wo = direction(radial.to_radians(), azimuth.to_radians());
        let turned = |d| turned_back(d, -part.plane.to_radians());
        match frame {
            None => [wi, wo],
            Some(true) => [turned(wi), turned(wo)],
            Some(false) => [turned(wi), wo],
        }
    }

    fn values(&self, words: &mut Words<'_>) -> Result<Vec<(usize, f64)>, ReadError> {
        let count = self.azimuths.len().saturating_mul(self.radials.len());
        if count > 10_000_000 {
            return fail(format!("{count} scatter angles; at most 10000000 are read"));
        }
        (0..count).map(|_| words.number("a value of the table").map(|v| (words.line(), v))).collect()
    }
}

/// Parses the bytes of a Zemax file.
///
/// # Errors
/// [`ReadError`], with the line of the fault, and for content beyond an isotropic reflection.
pub fn zemax(bytes: &[u8], conventions: &Conventions) -> Result<Intake, ReadError> {
    let text = decode(bytes)?;
    let mut words = Words::new(&text, &["#", "!"]);
    let head = Head::read(&mut words)?;
    const SYMMETRIES: [&str; 4] =
        ["PlaneSymmetrical", "Asymmetrical", "Asymmetrical4D", "PlaneSymmetrical4D"];
    if !SYMMETRIES.iter().any(|known| known.eq_ignore_ascii_case(&head.symmetry)) {
        return fail(format!(
            "Zemax BSDF of symmetry `{}`: PlaneSymmetrical, Asymmetrical and Asymmetrical4D are read",
            head.symmetry
        ));
    }
    let first = head.rotations.first().copied().unwrap_or(0.0);
    let is_turned = |angle: &f64| libm::remainder(angle - first, 360.0).abs() > 1e-6;
    let is_turned = head.rotations.iter().any(is_turned);
    let rotations = if is_turned { head.rotations.clone() } else { vec![first] };
    if head.incidence.is_empty() {
        return fail("AngleOfIncidence has to name angles before DataBegin");
    }
    let mut reading = Reading::new("Zemax BSDF", conventions);
    let is_transmission = head.scatter == "BTDF";
    let mut tables: Vec<Vec<Vec<(usize, f64)>>> = Vec::new();
    let mut totals = Vec::new();
    for channel in 0..head.channels() {
        // The head ends where the table of the first channel begins.
        if channel > 0 {
            next_channel(&mut words)?;
        }
        let mut of_channel = Vec::new();
        // The angle of incidence is faster than the rotation of the sample.
        for _ in 0..rotations.len() * head.incidence.len() {
            match words.word("TIS")? {
                "TIS" => {}
                other => return Err(words.odd(other, "TIS, one for each angle of incidence")),
            }
            let total = words.number("a share of the light")?;
            if channel + 1 == head.channels().min(2) {
                totals.push(total);
            }
            of_channel.push(head.values(&mut words)?);
        }
        tables.push(of_channel);
    }
    for (a, &incidence) in head.incidence.iter().enumerate() {
        let of: Vec<f64> = totals.iter().skip(a).step_by(head.incidence.len()).copied().collect();
        reading.state(incidence, of.iter().sum::<f64>() / of.len() as f64);
    }
    if is_turned {
        reading.note(format!(
            "{} rotations of the sample, taken as turns anticlockwise as seen from above: azimuths are counted from the sample",
            rotations.len()
        ));
    }
    for (n, (&rotation, &incidence)) in
        rotations.iter().flat_map(|r| head.incidence.iter().map(move |i| (r, i))).enumerate()
    {
        // A whole turn is the first rotation again.
        let is_again = |before: &f64| libm::remainder(rotation - before, 360.0).abs() < 1e-6;
        if rotations[..n / head.incidence.len()].iter().any(is_again) {
            continue;
        }
        let theta = incidence.to_radians();
        for (at, &(line, _)) in tables[0][n].iter().enumerate() {
            if is_transmission {
                reading.leave_out(Reason::Transmission, line);
                continue;
            }
            let (azimuth, radial) =
                (head.azimuths[at / head.radials.len()], head.radials[at % head.radials.len()]);
            // The mirror direction is one sample, and the last azimuth may be the first again.
            let is_first = at < head.radials.len();
            let is_copy = radial == 0.0 || libm::remainder(azimuth - head.azimuths[0], 360.0).abs() < 1e-6;
            if is_turned && is_copy && !is_first {
                continue;
            }
            let cells: Vec<f64> = tables.iter().map(|channel| channel[n][at].1).collect();
            let rgb = if let [x, y, z] = cells[..] { rgb_of_xyz([x, y, z]) } else { [cells[0]; 3] };
            let pair = [direction(theta, PI), about_mirror(theta, radial, azimuth)];
            let pair = if is_turned { pair.map(|d| turned_back(d, rotation.to_radians())) } else { pair };
            push(&mut reading, line, pair, rgb, &cells);
        }
    }
    reading.finish()
}

/// Passes over the end of a channel, up to the table of the next.
fn next_channel(words: &mut Words<'_>) -> Result<(), ReadError> {
    loop {
        match words.word("DataBegin of the next channel")? {
            "DataBegin" => return Ok(()),
            "DataEnd" => {}
            name if name.starts_with("Tristimulus") => {}
            other => return Err(words.odd(other, "DataEnd, and DataBegin of the next channel")),
        }
    }
}

/// Adds a sample of a grid, whose cells behind the surface are part of it, and no transmission.
fn push(reading: &mut Reading, line: usize, pair: [[f64; 3]; 2], rgb: [f64; 3], cells: &[f64]) {
    if pair[1][2] > 0.0 {
        reading.push(line, pair, rgb, cells);
    }
}

/// A direction by its angle from the mirror direction, and the azimuth about that, 0 towards the normal; degrees. The light is at -x.
pub(super) fn about_mirror(theta: f64, radial: f64, azimuth: f64) -> [f64; 3] {
    let [x, y, z] = direction(radial.to_radians(), azimuth.to_radians());
    let (sin, cos) = libm::sincos(theta);
    [z * sin - x * cos, y, z * cos + x * sin]
}

/// Parses the bytes of a LightTools file.
///
/// # Errors
/// As [`zemax`].
pub fn lighttools(bytes: &[u8], conventions: &Conventions) -> Result<Intake, ReadError> {
    let text = decode(bytes)?;
    let mut words = Words::new(&text, &["#", "!"]);
    let head = Head::read(&mut words)?;
    let mut reading = Reading::new("LightTools BSDF", conventions);
    let mut parts: Vec<LightToolsTable> = Vec::new();
    let mut block = LightToolsTable { is_front: true, is_reflection: true, ..LightToolsTable::default() };
    let mut back = 0;
    while let Some(key) = words.next() {
        match key {
            "AOI" => block.incidence = words.number("an angle of incidence")?,
            "POI" => block.plane = words.number("an azimuth of incidence")?,
            "Side" => block.is_front = words.word("Front or Back")? == "Front",
            "ScatterType" => block.is_reflection = words.word("BRDF or BTDF")? == "BRDF",
            "TristimulusValue" => {
                let name = words.word("TrisX, TrisY or TrisZ")?;
                block.channel = ["TrisX", "TrisY", "TrisZ"]
                    .iter()
                    .position(|known| *known == name)
                    .ok_or_else(|| words.odd(name, "TrisX, TrisY or TrisZ"))?;
            }
            "TIS" => {
                block.total = words.number("a share of the light")?;
                block.values = head.values(&mut words)?;
                let done = std::mem::replace(
                    &mut block,
                    LightToolsTable { is_front: true, is_reflection: true, ..LightToolsTable::default() },
                );
                match (done.is_front, done.is_reflection) {
                    (true, true) => parts.push(done),
                    (_, false) => {
                        done.values.iter().for_each(|v| reading.leave_out(Reason::Transmission, v.0))
                    }
                    (false, true) => back += done.values.len(),
                }
            }
            "DataEnd" => break,
            _ => {}
        }
    }
    if back > 0 {
        reading.note(format!("{back} values of the back of the sample are not read"));
    }
    let is_turned = |part: &LightToolsTable| libm::remainder(part.plane - parts[0].plane, 360.0).abs() > 1e-6;
    let is_turned = parts.iter().any(is_turned);
    // Scatter azimuths may be counted from the plane of incidence or from the sample: where light is scattered to tells.
    let brightness = |is_of_plane: bool| {
        let of = |part: &LightToolsTable| {
            let each = part.values.iter().enumerate().filter(|v| v.1.1 > 0.0);
            each.map(|(at, (_, value))| {
                let [wi, wo] = head.pair(part, at, Some(is_of_plane));
                value * (wi[2] * wo[2] - wi[0] * wo[0] - wi[1] * wo[1])
            })
            .sum::<f64>()
        };
        parts.iter().map(of).sum::<f64>()
    };
    let frame = is_turned.then(|| brightness(true) >= brightness(false));
    if let Some(is_of_plane) = frame {
        reading.note(format!(
            "there is more than one plane of incidence: by where light is scattered to, scatter azimuths are counted from {}",
            if is_of_plane { "that plane" } else { "the sample" }
        ));
    }
    for part in parts.chunks(head.channels()).filter(|part| part.len() == head.channels()) {
        let first = &part[0];
        let total = part[part.len() / 2].total;
        reading.state(first.incidence, total);
        for (at, &(line, _)) in first.values.iter().enumerate() {
            let cells: Vec<f64> = part.iter().map(|channel| channel.values[at].1).collect();
            let rgb = if let [x, y, z] = cells[..] { rgb_of_xyz([x, y, z]) } else { [cells[0]; 3] };
            let pair = head.pair(first, at, frame);
            push(&mut reading, line, pair, rgb, &cells);
        }
    }
    reading.finish()
}

/// One table of a LightTools file.
#[derive(Default)]
struct LightToolsTable {
    incidence: f64,
    plane: f64,
    is_front: bool,
    is_reflection: bool,
    channel: usize,
    total: f64,
    values: Vec<(usize, f64)>,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cosine lobe about the mirror direction, as a program would write it.
    fn zemax_text() -> String {
        let (incidence, azimuths, radials) = ([0.0, 30.0, 60.0], [0.0, 90.0, 180.0], [0.0, 20.0, 45.0]);
        let list = |name: &str, angles: &[f64]| {
            format!(
                "{name} {}\n{}\n",
                angles.len(),
                angles.iter().map(f64::to_string).collect::<Vec<_>>().join("\t")
            )
        };
        let mut text = "# made\nSource Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\nScatterType BRDF\n".to_owned();
        text += "SampleRotation 1\n0\n";
        text += &(list("AngleOfIncidence", &incidence) + &list("ScatterAzimuth", &azimuths));
        text += &(list("ScatterRadial", &radials) + "\nMonochrome\nDataBegin\n");
        for _ in incidence {
            text += "TIS 0.5\n";
            for _ in azimuths {
                text += &radials.map(|r: f64| (0.1 * r.to_radians().cos()).to_string()).join("\t");
                text += "\n";
            }
        }
        text + "DataEnd\n"
    }

    #[test]
    fn scatter_angles_are_about_the_mirror_direction() {
        let intake = zemax(zemax_text().as_bytes(), &Conventions::default()).unwrap();
        assert_eq!(intake.stated, [(0.0, 0.5), (30.0, 0.5), (60.0, 0.5)]);
        assert!(intake.is_light_fixed);
        for row in &intake.rows {
            let mirror = [-row.wi[0], -row.wi[1], row.wi[2]];
            let cos: f64 = (0..3).map(|k| mirror[k] * row.wo[k]).sum();
            assert!((row.rgb[0] - 0.1 * cos).abs() < 1e-9, "{row:?}");
        }
        // 45 degrees beyond the mirror direction of 60 degrees are behind the surface.
        assert_eq!(intake.rows.len(), 26);
        assert!(intake.left_out.is_empty());
    }

    #[test]
    fn damage_and_what_is_not_read_is_said() {
        for (from, to, word) in [
            ("PlaneSymmetrical", "Symmetrical5D", "PlaneSymmetrical"),
            ("Monochrome\nScatterType", "Spectral\nScatterType", "SpectralContent"),
            ("SampleRotation 1\n0", "SampleRotation 2\n0 90", "TIS, one for each"),
            ("AngleOfIncidence 3", "AngleOfIncidence 999999999", "how many angles"),
            ("TIS 0.5", "TOS 0.5", "TIS"),
            ("ScatterType BRDF", "ScatterType BTDF", "transmission"),
        ] {
            let text = zemax_text().replacen(from, to, 1);
            let error = zemax(text.as_bytes(), &Conventions::default()).unwrap_err().to_string();
            assert!(error.contains(word), "{to}: {error}");
        }
        let text = zemax_text();
        for cut in (0..text.len() - 30).step_by(7) {
            assert!(zemax(&text.as_bytes()[..cut], &Conventions::default()).is_err(), "{cut}");
        }
    }

    #[test]
    fn a_rotation_of_the_sample_turns_both_directions_back() {
        let text = zemax_text().replace("SampleRotation 1\n0", "SampleRotation 3\n0 90 360");
        let body = text[text.find("TIS").unwrap()..text.find("DataEnd").unwrap()].to_owned();
        let text = text.replace("DataEnd", &(body.repeat(2) + "DataEnd"));
        let intake = zemax(text.as_bytes(), &Conventions::default()).unwrap();
        // A whole turn is the first again, and the mirror direction is one sample.
        let once = 26 - 2 * 3;
        assert_eq!(intake.rows.len(), 2 * once);
        for (a, b) in intake.rows[..once].iter().zip(&intake.rows[once..]) {
            let turned = |d: [f64; 3]| [d[1], -d[0], d[2]];
            let is_close = |a: [f64; 3], b: [f64; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-12);
            assert!(is_close(turned(a.wi), b.wi) && is_close(turned(a.wo), b.wo), "{a:?} {b:?}");
        }
        assert_eq!(intake.stated.len(), 3);
    }

    #[test]
    fn planes_of_incidence_of_lighttools_turn_the_light() {
        let head = "Symmetry Asymmetric\nSpectralContent Monochrome\nScatterAzimuth 4\n0 90 180 270\nScatterRadial 2\n0 30\nDataBegin\n";
        let block = |plane: &str, values: &str| {
            format!("AOI 30\nPOI {plane}\nSide Front\nWavelength 550\nScatterType BRDF\nTIS .3\n{values}\n")
        };
        let of_plane = ".1 .1 .1 .1 .1 .1 .1 .9";
        for (plane, second, from) in [
            ("90", of_plane, "that plane"),
            ("90", ".1 .9 .1 .1 .1 .1 .1 .1", "the sample"),
            ("270", of_plane, "that plane"),
            ("270", ".1 .1 .1 .1 .1 .9 .1 .1", "the sample"),
        ] {
            let text = head.to_owned() + &block("0", of_plane) + &block(plane, second) + "DataEnd\n";
            let intake = lighttools(text.as_bytes(), &Conventions::default()).unwrap();
            assert!(
                intake.notes.iter().any(|note| note.text.contains(from)),
                "{plane} {from}: {:?}",
                intake.notes
            );
            for row in intake.rows.iter().filter(|row| row.rgb[0] > 0.5) {
                let mirror = [-row.wi[0], -row.wi[1], row.wi[2]];
                assert!((0..3).all(|k| (mirror[k] - row.wo[k]).abs() < 1e-9), "{row:?}");
            }
        }
    }

    #[test]
    fn lighttools_has_the_light_at_90_degrees() {
        let text = "Symmetry Asymmetric\nSpectralContent Monochrome\nScatterAzimuth 4\n0 90 180 270\nScatterRadial 2\n0 30\nDataBegin\n\
                    AOI 30\nPOI 0\nSide Front\nWavelength 550\nScatterType BRDF\nTIS .3\n.1 .1 .1 .1 .1 .1 .1 .9\n\
                    AOI 30\nPOI 0\nSide Front\nWavelength 550\nScatterType BTDF\nTIS .3\n.1 .1 .1 .1 .1 .1 .1 .9\nDataEnd\n";
        let intake = lighttools(text.as_bytes(), &Conventions::default()).unwrap();
        assert_eq!((intake.rows.len(), intake.left_out_count(), intake.stated.len()), (8, 8, 1));
        let brightest = intake.rows.iter().max_by(|a, b| a.rgb[0].total_cmp(&b.rgb[0])).unwrap();
        let mirror = [-brightest.wi[0], -brightest.wi[1], brightest.wi[2]];
        assert!((0..3).all(|k| (mirror[k] - brightest.wo[k]).abs() < 1e-9), "{brightest:?}");
    }
}
