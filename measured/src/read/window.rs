//! Reader of the XML files of WINDOW and Radiance: matrices over patches of the reflected and the transmitted light, of both sides.
//!
//! A matrix is that of light from the front or from the back, a column for each incident patch (`Columns`) or a row (`Rows`). A
//! [`Quarter`] is the light that one side shows: light of a reflection from that side, of a transmission from the other. Transmission that is given
//! for both sides is the same function twice, of which the mean is taken; where it is given for one, the other is that with the directions
//! exchanged.

use crate::ReadError;
use crate::file::decode::decode;
use crate::patches::{Basis, OfPatches, PatchMatrix, Ring};
use roxmltree::{Document, Node, ParsingOptions};
use srbf_core::{Quarter, printable};
use std::fmt;

/// Share of the light at the normal that goes straight on, from which a transmission is that of a clear pane.
const CLEAR: f64 = 0.98;

/// Largest value that is believed, 1/sr.
const LARGEST: f64 = 1e6;

/// A part of the spectrum, as files name them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Band {
    /// Weighted by the sensitivity of the eye.
    #[default]
    Visible,
    /// The whole spectrum of the sun.
    Solar,
    /// Near infrared.
    Infrared,
}

impl Band {
    /// The name in a file.
    const fn name(self) -> &'static str {
        match self {
            Self::Visible => "Visible",
            Self::Solar => "Solar",
            Self::Infrared => "NIR",
        }
    }
}

/// The quarters of a sheet, as its file has them.
#[derive(Clone, Debug)]
pub struct Window {
    /// The sheet's name in the file.
    pub name: String,
    /// In the order of [`Quarter::ALL`]; `None`: black, or not in the file.
    pub quarters: [Option<PatchMatrix>; 4],
    /// Relative L2 distance of the transmission from the front and from the back, which are one function of a reciprocal sheet; `None` where the
    /// file has one.
    pub disagreement: Option<f64>,
    /// The factor of all values, so that no incident direction has more light than falls on it; 1 at most.
    pub scale: f64,
}

/// A quarter, in words.
#[must_use]
pub const fn words(quarter: Quarter) -> &'static str {
    match quarter {
        Quarter::FrontReflection => "reflection seen from the front",
        Quarter::FrontTransmission => "transmission seen from the front",
        Quarter::BackReflection => "reflection seen from the back",
        Quarter::BackTransmission => "transmission seen from the back",
    }
}

/// Whether a text is such a file.
pub(super) fn is_window(text: &str) -> bool {
    text.contains("<WindowElement")
}

impl Window {
    /// Parses the bytes of a file.
    ///
    /// # Errors
    /// [`ReadError`], with the element that stopped it; also for tensor trees, for a band that the file lacks, and for a clear pane.
    pub fn parse(bytes: &[u8], band: Band) -> Result<Self, ReadError> {
        let text = decode(bytes)?;
        let options = ParsingOptions { allow_dtd: false, nodes_limit: 200_000, ..ParsingOptions::default() };
        // Radiance's genBSDF prints a line before the file.
        let text = &text[text.find('<').unwrap_or(0)..];
        let document = Document::parse_with_options(text, options).map_err(|error| {
            fault(format!("a file of a window (WINDOW, Radiance) that is no whole XML: {error}"))
        })?;
        let root = document.root_element();
        if !is(root, "WindowElement") {
            return Err(fault(format!("<{}> where <WindowElement> was expected", root.tag_name().name())));
        }
        let bases = bases(root)?;
        let is_columns = match all(root, "IncidentDataStructure").next().map(content) {
            None | Some("Columns") => true,
            Some("Rows") => false,
            Some(other) => return Err(tree_or(other)),
        };
        let (mut front, mut back): ([Option<PatchMatrix>; 2], [Option<PatchMatrix>; 2]) = Default::default();
        let mut bands: Vec<&str> = Vec::new();
        for data in all(root, "WavelengthData") {
            let own = all(data, "Wavelength").next().map_or("", content);
            if !bands.contains(&own) {
                bands.push(own);
            }
            if own != band.name() {
                continue;
            }
            for block in all(data, "WavelengthDataBlock") {
                let direction = child(block, "WavelengthDataDirection")?;
                let slot = match content(direction) {
                    "Transmission Front" => &mut front[1],
                    "Transmission Back" => &mut back[1],
                    "Reflection Front" => &mut front[0],
                    "Reflection Back" => &mut back[0],
                    _ => continue,
                };
                if slot.is_some() {
                    return Err(at(direction, "a second matrix of this direction"));
                }
                *slot = Some(matrix(block, &bases, is_columns)?);
            }
        }
        if [&front, &back].iter().all(|side| side.iter().all(Option::is_none)) {
            let text = format!(
                "a file of a window (WINDOW, Radiance) without a matrix of the band {}; it has {}",
                band.name(),
                if bands.is_empty() { "none".into() } else { printable(&bands.join(", ")).to_string() }
            );
            return Err(ReadError::Content(text));
        }
        let name = all(root, "Name").next().map_or("", content).to_owned();
        Self::new(name, front, back)
    }

    /// Of the light from the front and from the back: reflection, transmission.
    fn new(
        name: String,
        [front, through]: [Option<PatchMatrix>; 2],
        [back, back_through]: [Option<PatchMatrix>; 2],
    ) -> Result<Self, ReadError> {
        let bright = |m: &Option<PatchMatrix>| m.as_ref().is_some_and(|m| m.values.iter().any(|v| *v > 0.0));
        if [&through, &back_through].iter().any(|m| m.as_ref().is_some_and(|m| m.straight() > CLEAR)) {
            return Err(ReadError::Content(
                "a clear pane: the light that it transmits goes straight through, within one patch. That is no lobe but a direction alone, which \
                 the renderer has to follow itself"
                    .into(),
            ));
        }
        // A viewer in front sees the light that comes from behind.
        let exchanged = |m: &Option<PatchMatrix>| m.as_ref().and_then(PatchMatrix::reversed);
        let (seen, exchanged_through) = (back_through, exchanged(&through));
        let both = seen
            .as_ref()
            .zip(exchanged_through.as_ref())
            .filter(|(a, b)| a.outgoing == b.outgoing && a.incident == b.incident);
        let disagreement = both.map(|(a, b)| a.distance(b));
        let transmission = match both {
            Some((a, b)) => Some(a.mean_with(b)),
            None => seen.or(exchanged_through),
        };
        let other_way = exchanged(&transmission).or(through);
        let mut quarters = [front, transmission, back, other_way];
        for quarter in &mut quarters {
            if !bright(quarter) {
                *quarter = None;
            }
        }
        if quarters.iter().all(Option::is_none) {
            return Err(ReadError::Content("every value of its matrices is 0: a sheet that is black".into()));
        }
        // Light from one side is reflected there, and seen through the sheet from the other.
        let mut most = 1.0f64;
        for (reflected, transmitted) in [(0, 3), (2, 1)] {
            let sums = [&quarters[reflected], &quarters[transmitted]];
            let patches = sums.iter().filter_map(|q| q.as_ref().map(|m| m.incident.len())).max().unwrap_or(0);
            for c in 0..patches {
                let sum = |q: &Option<PatchMatrix>| {
                    q.as_ref().filter(|m| c < m.incident.len()).map_or(0.0, |m| m.sum(c))
                };
                most = most.max(sum(sums[0]) + sum(sums[1]));
            }
        }
        let scale = 1.0 / most;
        quarters.iter_mut().flatten().flat_map(|m| &mut m.values).for_each(|v| *v *= scale);
        Ok(Self { name, quarters, disagreement, scale })
    }

    /// The function of a quarter; `None` of one that is black.
    pub fn brdf(&self, quarter: Quarter) -> Option<OfPatches> {
        self.quarters[quarter as usize].as_ref().map(OfPatches::new)
    }
}

fn fault(text: String) -> ReadError {
    ReadError::Content(text)
}

/// The error of an element.
fn at(node: Node<'_, '_>, text: impl fmt::Display) -> ReadError {
    let place = node.document().text_pos_at(node.range().start);
    fault(format!("line {}, <{}>: {text}", place.row, node.tag_name().name()))
}

/// The error of an unknown order of the data.
fn tree_or(order: &str) -> ReadError {
    fault(if order.starts_with("TensorTree") {
        "a tensor tree: its values stand on a grid that is finer where they change. Turn it into a matrix by Radiance's bsdf2klems".into()
    } else {
        format!("<IncidentDataStructure> {order}: Columns, or Rows, was expected")
    })
}

/// Whether an element has a name, whatever its namespace.
fn is(node: Node<'_, '_>, name: &str) -> bool {
    node.is_element() && node.tag_name().name() == name
}

/// Elements of a name within one.
fn all<'a, 'd>(node: Node<'a, 'd>, name: &'static str) -> impl Iterator<Item = Node<'a, 'd>> {
    node.descendants().filter(move |n| is(*n, name))
}

fn content<'a>(node: Node<'a, '_>) -> &'a str {
    node.text().unwrap_or("").trim()
}

fn child<'a, 'd>(node: Node<'a, 'd>, name: &'static str) -> Result<Node<'a, 'd>, ReadError> {
    all(node, name).next().ok_or_else(|| at(node, format!("<{name}> is missing")))
}

fn number(node: Node<'_, '_>, range: std::ops::RangeInclusive<f64>) -> Result<f64, ReadError> {
    let text = content(node);
    let expected = || {
        at(node, format!("`{text}` where a number from {} to {} was expected", range.start(), range.end()))
    };
    text.parse::<f64>().ok().filter(|v| range.contains(v)).ok_or_else(expected)
}

/// The patches that a file defines, by name.
fn bases(root: Node<'_, '_>) -> Result<Vec<(String, Basis)>, ReadError> {
    let mut bases = Vec::new();
    for basis in all(root, "AngleBasis") {
        let mut rings = Vec::new();
        for block in all(basis, "AngleBasisBlock") {
            let angle = |name| Ok::<f64, ReadError>(number(child(block, name)?, 0.0..=90.0)?.to_radians());
            let count = number(child(block, "nPhis")?, 1.0..=Basis::MOST as f64)?;
            let ends = [angle("LowerTheta")?, angle("UpperTheta")?];
            rings.push(Ring { theta: angle("Theta")?, ends, count: count as usize });
        }
        let name = content(child(basis, "AngleBasisName")?).to_owned();
        let made = Basis::new(rings).ok_or_else(|| at(basis, "its rings do not tile the hemisphere"))?;
        bases.push((name, made));
    }
    Ok(bases)
}

/// A matrix.
fn matrix(
    block: Node<'_, '_>,
    bases: &[(String, Basis)],
    is_columns: bool,
) -> Result<PatchMatrix, ReadError> {
    let basis = |name: &'static str| {
        let node = child(block, name)?;
        let wanted = content(node);
        let known = bases.iter().find(|(name, _)| name == wanted).map(|(_, basis)| basis.clone());
        let known = known.or_else(|| (wanted == "LBNL/Klems Full").then(Basis::klems_full));
        known.ok_or_else(|| at(node, format!("{} has no definition in the file", printable(wanted))))
    };
    // Rows and columns of the matrix that is stored, line by line.
    let (rows, columns) = (basis("RowAngleBasis")?, basis("ColumnAngleBasis")?);
    let data = child(block, "ScatteringData")?;
    let wanted = rows.len() * columns.len();
    let mut values = Vec::with_capacity(wanted);
    for word in content(data).split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty()) {
        let value = word.parse::<f64>().ok().filter(|v| (-LARGEST..=LARGEST).contains(v));
        let index = values.len() + 1;
        let expected =
            || at(data, format!("number {index}: `{}` where a value in 1/sr was expected", printable(word)));
        if index > wanted {
            return Err(at(data, format!("more numbers than {} times {}", rows.len(), columns.len())));
        }
        // A dark signal that was subtracted may leave less than nothing.
        values.push(value.ok_or_else(expected)?.max(0.0));
    }
    if values.len() != wanted {
        return Err(at(
            data,
            format!("{} numbers where {} times {} were expected", values.len(), rows.len(), columns.len()),
        ));
    }
    if is_columns {
        return Ok(PatchMatrix { outgoing: rows, incident: columns, values });
    }
    let turned = (0..columns.len()).flat_map(|c| (0..rows.len()).map(move |r| (r, c)));
    let values = turned.map(|(r, c)| values[r * columns.len() + c]).collect();
    Ok(PatchMatrix { outgoing: columns, incident: rows, values })
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLOCK: [(f64, f64, f64, usize); 3] =
        [(0.0, 0.0, 20.0, 1), (40.0, 20.0, 60.0, 4), (75.0, 60.0, 90.0, 2)];

    /// A direction, and its values by row and column.
    type Given<'a> = (&'a str, &'a dyn Fn(usize, usize) -> f64);

    fn file(matrices: &[Given<'_>]) -> String {
        let mut text = "<?xml version=\"1.0\"?>\n<WindowElement xmlns=\"http://windows.lbl.gov\"><Optical><Layer><Material><Name>cloth</Name>\
            </Material><DataDefinition><IncidentDataStructure>Columns</IncidentDataStructure><AngleBasis><AngleBasisName>own</AngleBasisName>"
            .to_owned();
        for (theta, low, high, count) in BLOCK {
            text += &format!(
                "<AngleBasisBlock><Theta>{theta}</Theta><nPhis>{count}</nPhis><ThetaBounds><LowerTheta>{low}</LowerTheta>\
                 <UpperTheta>{high}</UpperTheta></ThetaBounds></AngleBasisBlock>\n"
            );
        }
        text += "</AngleBasis></DataDefinition>";
        for (direction, value) in matrices {
            text += &format!(
                "<WavelengthData><Wavelength unit=\"Integral\">Visible</Wavelength><WavelengthDataBlock><WavelengthDataDirection>{direction}\
                 </WavelengthDataDirection><ColumnAngleBasis>own</ColumnAngleBasis><RowAngleBasis>own</RowAngleBasis><ScatteringDataType>BTDF\
                 </ScatteringDataType><ScatteringData>\n"
            );
            for r in 0..7 {
                (0..7).for_each(|c| text += &format!("{}, ", value(r, c)));
                text.push('\n');
            }
            text += "</ScatteringData></WavelengthDataBlock></WavelengthData>";
        }
        text + "</Layer></Optical></WindowElement>"
    }

    fn parsed(text: &str) -> Result<Window, ReadError> {
        Window::parse(text.as_bytes(), Band::Visible)
    }

    #[test]
    fn quarters_are_what_each_side_shows() {
        let (one, two) = (|r: usize, c: usize| 0.01 * (r + 7 * c) as f64 / 49.0, |_: usize, _: usize| 0.1);
        let window = parsed(&file(&[("Transmission Front", &one), ("Reflection Back", &two)])).unwrap();
        assert_eq!((window.name.as_str(), window.scale, window.disagreement), ("cloth", 1.0, None));
        let [front, through, back, back_through] = &window.quarters;
        assert_eq!(front, &None);
        assert_eq!(back.as_ref().unwrap().at(3, 4), 0.1);
        // Light from the front is seen behind; directions are exchanged for the viewer in front.
        let back_through = back_through.as_ref().unwrap();
        let through = through.as_ref().unwrap();
        assert_eq!(back_through.at(2, 5), one(2, 5));
        let basis = &through.outgoing;
        assert_eq!(through.at(basis.opposite(5).unwrap(), basis.opposite(2).unwrap()), one(2, 5));
    }

    #[test]
    fn transmission_of_both_sides_is_one_function() {
        let (one, other) = (|r: usize, c: usize| 0.05 + 0.001 * (r + c) as f64, |_: usize, _: usize| 0.05);
        let window = parsed(&file(&[("Transmission Front", &one), ("Transmission Back", &other)])).unwrap();
        assert!(window.disagreement.unwrap() > 0.01);
        let [_, Some(seen), _, Some(behind)] = &window.quarters else { panic!("two quarters") };
        assert_eq!(&seen.reversed().unwrap(), behind);
        assert!((behind.at(3, 2) - 0.5 * (one(3, 2) + 0.05)).abs() < 1e-12);
    }

    #[test]
    fn more_light_than_falls_on_it_is_lowered() {
        let bright = |_: usize, _: usize| 0.3;
        let window =
            parsed(&file(&[("Transmission Front", &bright), ("Reflection Front", &bright)])).unwrap();
        assert!((window.scale - 1.0 / (0.6 * std::f64::consts::PI)).abs() < 1e-9, "{}", window.scale);
        let sum: f64 = [0, 3].iter().map(|q| window.quarters[*q].as_ref().unwrap().sum(2)).sum();
        assert!((sum - 1.0).abs() < 1e-9);
    }

    #[test]
    fn faults_are_named_with_their_place() {
        let flat = |_: usize, _: usize| 0.1;
        let good = file(&[("Transmission Front", &flat)]);
        let cases = [
            (good.replace("Columns", "TensorTree4"), "bsdf2klems"),
            (good.replace("Columns", "Sideways"), "Columns, or Rows"),
            (good.replace("Visible", "Solar"), "it has Solar"),
            (good.replace("<nPhis>4</nPhis>", "<nPhis>1e9</nPhis>"), "<nPhis>"),
            (good.replace("<Theta>40</Theta>", "<Theta>nan</Theta>"), "<Theta>: `nan`"),
            (good.replace("<UpperTheta>60", "<UpperTheta>50"), "do not tile"),
            (good.replace("RowAngleBasis>own", "RowAngleBasis>other"), "no definition"),
            (good.replacen("0.1, ", "0.1, 0.2, ", 1), "more numbers than 7 times 7"),
            (good.replacen("0.1, ", "", 1), "48 numbers where 7 times 7"),
            (good.replacen("0.1, ", "x, ", 1), "number 1: `x`"),
            (good.replacen("0.1, ", "nan, ", 1), "number 1: `nan`"),
            (good.replace("0.1, ", "0, "), "a sheet that is black"),
            (good[..good.len() - 20].to_owned(), "no whole XML"),
            ("<html></html>".to_owned(), "<html> where <WindowElement>"),
            (good.replace("<?xml version=\"1.0\"?>", "<!DOCTYPE a [<!ENTITY b \"c\">]>"), "no whole XML"),
        ];
        for (text, words) in cases {
            let error = parsed(&text).unwrap_err().to_string();
            assert!(error.contains(words), "{error}: {words}");
        }
        // A line before the file is no fault.
        assert!(parsed(&format!("Recover using: genBSDF\n{good}")).is_ok());
        let straight = |r: usize, c: usize| if r == c { 2.0 } else { 0.0 };
        let pane = parsed(&file(&[("Transmission Front", &straight), ("Reflection Front", &straight)]));
        assert!(pane.unwrap_err().to_string().contains("a clear pane"));
    }
}
