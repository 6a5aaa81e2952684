//! Reader of the XML files of WINDOW and Radiance: the reflected and the transmitted light of both sides, as matrices over patches or as tensor trees.
//!
//! A matrix is that of light from the front or from the back, a column for each incident patch (`Columns`) or a row (`Rows`). A tree
//! (`TensorTree3`, `TensorTree4`) has cells that are finer where values change. A
//! [`Quarter`] is the light that one side shows: light of a reflection from that side, of a transmission from the other. Transmission that is given
//! for both sides is the same function twice, of which the mean is taken; where it is given for one, the other is that with the directions
//! exchanged.
//!
//! Visible light has colours where the file has CIE-X and CIE-Z, or CIE-u and CIE-v, beside it. A band is the mean of a spectrum by its
//! own weights. So X, Y and Z are over those of white, and a grey colour has the same of all three.

mod band;

use crate::ReadError;
use crate::file::decode::decode;
use crate::patches::{Basis, Chroma, ColorTree, PatchMatrix, Ring, Scatter, Tree};
use crate::table::Brdf;
pub use band::Band;
use roxmltree::{Document, Node, ParsingOptions};
use srbf_core::{Quarter, printable};
use std::fmt;

/// Share of the light at the normal that goes straight on, from which a transmission is that of a clear pane.
const CLEAR: f64 = 0.98;

/// Largest value that is believed, 1/sr.
const LARGEST: f64 = 1e6;

/// Bands of the colours of visible light, and the directions of light in a file.
const COLORS: [&str; 4] = ["CIE-X", "CIE-Z", "CIE-u", "CIE-v"];
const DIRECTIONS: [&str; 4] =
    ["Reflection Front", "Transmission Front", "Reflection Back", "Transmission Back"];

/// The quarters of a sheet, as its file has them.
#[derive(Clone, Debug)]
pub struct Window {
    /// The sheet's name in the file.
    pub name: String,
    /// In the order of [`Quarter::ALL`]; `None`: black, or not in the file.
    pub quarters: [Option<Scatter>; 4],
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
        let order = order(root)?;
        let bases = if matches!(order, Order::Tree(_)) { Vec::new() } else { bases(root)? };
        let names: Vec<&str> = all(root, "Wavelength").map(content).collect();
        let is_named = |name: &str| names.iter().any(|own| own.eq_ignore_ascii_case(name));
        let luminance = if band.is_visible() && !is_named(band.name()) { "CIE-Y" } else { band.name() };
        // Of each direction, the luminance and what tells the colour.
        let mut found: [[Option<Values>; 5]; 4] = Default::default();
        for data in all(root, "WavelengthData") {
            let own = all(data, "Wavelength").next().map_or("", content);
            let colors = COLORS.iter().filter(|_| band.is_visible());
            let mut wanted = std::iter::once(&luminance).chain(colors);
            let Some(which) = wanted.position(|name| own.eq_ignore_ascii_case(name)) else { continue };
            for block in all(data, "WavelengthDataBlock") {
                let direction = child(block, "WavelengthDataDirection")?;
                let name = content(direction);
                let Some(place) = DIRECTIONS.iter().position(|own| *own == name) else { continue };
                let slot = &mut found[place][which];
                if slot.is_some() {
                    return Err(at(direction, "this direction for the second time"));
                }
                *slot = Some(values(block, &bases, order)?);
            }
        }
        if found.iter().all(|own| own[0].is_none()) {
            let mut bands: Vec<&str> = Vec::new();
            names.iter().for_each(|name| {
                if !bands.contains(name) {
                    bands.push(name)
                }
            });
            let text = format!(
                "a file of a window (WINDOW, Radiance) without values of the band {}; it has {}",
                printable(band.name()),
                if bands.is_empty() { "none".into() } else { printable(&bands.join(", ")).to_string() }
            );
            return Err(ReadError::Content(text));
        }
        let [front, through, back, back_through] = found.map(scatter);
        let (front, back) = ([front?, through?], [back?, back_through?]);
        let name = all(root, "Name").next().map_or("", content).to_owned();
        Self::new(name, front, back)
    }

    /// Of the light from the front and from the back: reflection, transmission.
    fn new(
        name: String,
        [front, through]: [Option<Scatter>; 2],
        [back, back_through]: [Option<Scatter>; 2],
    ) -> Result<Self, ReadError> {
        if [&through, &back_through].iter().any(|m| m.as_ref().is_some_and(|m| m.straight() > CLEAR)) {
            return Err(ReadError::Content(
                "a clear pane: the light that it transmits goes straight through, within one patch or cell. That is no lobe but a direction alone, which \
                 the renderer has to follow itself"
                    .into(),
            ));
        }
        // A viewer in front sees the light that comes from behind.
        let exchanged = |m: &Option<Scatter>| m.as_ref().and_then(Scatter::reversed);
        let (seen, exchanged_through) = (back_through, exchanged(&through));
        let is_alike =
            |a: &PatchMatrix, b: &PatchMatrix| a.outgoing == b.outgoing && a.incident == b.incident;
        let both =
            seen.as_ref().zip(exchanged_through.as_ref()).filter(|(a, b)| is_alike(&a.matrix, &b.matrix));
        let disagreement = both.map(|(a, b)| a.matrix.distance(&b.matrix));
        let transmission = match both {
            Some((a, b)) => Some(a.mean_with(b)),
            None => seen.or(exchanged_through),
        };
        let other_way = exchanged(&transmission).or(through);
        let mut quarters = [front, transmission, back, other_way];
        quarters.iter_mut().for_each(|own| *own = own.take().filter(Scatter::is_bright));
        if quarters.iter().all(Option::is_none) {
            return Err(ReadError::Content("every value is 0: a sheet that is black".into()));
        }
        let scale = 1.0 / most_light(&quarters);
        let quarters = quarters.map(|own| own.map(|own| own.scaled(scale)));
        Ok(Self { name, quarters, disagreement, scale })
    }

    /// The function of a quarter; `None` of one that is black.
    pub fn brdf(&self, quarter: Quarter) -> Option<Box<dyn Brdf + Send>> {
        self.quarters[quarter as usize].as_ref().map(Scatter::brdf)
    }
}

/// The most light that leaves of any incident patch, over what falls there; 1 at least.
fn most_light(quarters: &[Option<Scatter>; 4]) -> f64 {
    let mut most = 1.0f64;
    // Light from one side is reflected there, and seen through the sheet from the other.
    for (reflected, transmitted) in [(0, 3), (2, 1)] {
        for band in 0..3 {
            let both =
                [&quarters[reflected], &quarters[transmitted]].map(|q| q.as_ref().map(|own| own.band(band)));
            let patches = both.iter().flatten().map(|m| m.incident.len()).max().unwrap_or(0);
            for c in 0..patches {
                let own = both.iter().flatten().filter(|m| c < m.incident.len());
                most = most.max(own.map(|m| m.sum(c)).sum());
            }
        }
    }
    most
}

/// How values stand in a file.
#[derive(Clone, Copy)]
enum Order {
    /// Matrices, a column for each incident patch.
    Columns,
    /// A row for each.
    Rows,
    /// Tensor trees of this number of dimensions.
    Tree(usize),
}

/// Values of a band and a direction.
enum Values {
    Matrix(PatchMatrix),
    Tree(Tree),
}

fn order(root: Node<'_, '_>) -> Result<Order, ReadError> {
    let Some(node) = all(root, "IncidentDataStructure").next() else { return Ok(Order::Columns) };
    match content(node) {
        "Columns" => Ok(Order::Columns),
        "Rows" => Ok(Order::Rows),
        "TensorTree3" => Ok(Order::Tree(3)),
        "TensorTree4" => Ok(Order::Tree(4)),
        other => {
            let text = "where Columns, Rows, TensorTree3 or TensorTree4 was expected";
            Err(at(node, format!("`{}` {text}", printable(other))))
        }
    }
}

/// The values of a block.
fn values(block: Node<'_, '_>, bases: &[(String, Basis)], order: Order) -> Result<Values, ReadError> {
    let rank = match order {
        Order::Columns => return matrix(block, bases, true).map(Values::Matrix),
        Order::Rows => return matrix(block, bases, false).map(Values::Matrix),
        Order::Tree(rank) => rank,
    };
    let basis = child(block, "AngleBasis")?;
    if content(basis) != "LBNL/Shirley-Chiu" {
        return Err(at(
            basis,
            format!("`{}` where LBNL/Shirley-Chiu was expected", printable(content(basis))),
        ));
    }
    let data = child(block, "ScatteringData")?;
    Tree::parse(content(data), rank, -LARGEST..=LARGEST).map(Values::Tree).map_err(|text| at(data, text))
}

/// A direction of light: its luminance, X, Z, u' and v'.
fn scatter([luminance, x, z, u, v]: [Option<Values>; 5]) -> Result<Option<Scatter>, ReadError> {
    let chroma = match (x, z, u, v) {
        (Some(x), Some(z), ..) => Chroma::Xz([x, z]),
        (_, _, Some(u), Some(v)) => Chroma::Uv([u, v]),
        _ => Chroma::Grey,
    };
    match luminance {
        None => Ok(None),
        Some(Values::Matrix(matrix)) => {
            let other = || fault("bands of a colour that have other patches than the visible band".into());
            let chroma = chroma.map(|own| if let Values::Matrix(own) = own { Some(own) } else { None });
            Scatter::of_matrices(matrix, chroma).ok_or_else(other).map(Some)
        }
        Some(Values::Tree(luminance)) => {
            let chroma = chroma.map(|own| if let Values::Tree(own) = own { Some(own) } else { None });
            Ok(Some(Scatter::of_tree(ColorTree { luminance, chroma })))
        }
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
        Window::parse(text.as_bytes(), Band::default())
    }

    #[test]
    fn quarters_are_what_each_side_shows() {
        let (one, two) = (|r: usize, c: usize| 0.01 * (r + 7 * c) as f64 / 49.0, |_: usize, _: usize| 0.1);
        let window = parsed(&file(&[("Transmission Front", &one), ("Reflection Back", &two)])).unwrap();
        assert_eq!((window.name.as_str(), window.scale, window.disagreement), ("cloth", 1.0, None));
        let [front, through, back, back_through] = &window.quarters;
        assert!(front.is_none());
        assert_eq!(back.as_ref().unwrap().matrix.at(3, 4), 0.1);
        // Light from the front is seen behind; directions are exchanged for the viewer in front.
        let back_through = &back_through.as_ref().unwrap().matrix;
        let through = &through.as_ref().unwrap().matrix;
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
        assert_eq!(seen.matrix.reversed().unwrap(), behind.matrix);
        assert!((behind.matrix.at(3, 2) - 0.5 * (one(3, 2) + 0.05)).abs() < 1e-12);
    }

    #[test]
    fn more_light_than_falls_on_it_is_lowered() {
        let bright = |_: usize, _: usize| 0.3;
        let window =
            parsed(&file(&[("Transmission Front", &bright), ("Reflection Front", &bright)])).unwrap();
        assert!((window.scale - 1.0 / (0.6 * std::f64::consts::PI)).abs() < 1e-9, "{}", window.scale);
        let sum: f64 = [0, 3].iter().map(|q| window.quarters[*q].as_ref().unwrap().matrix.sum(2)).sum();
        assert!((sum - 1.0).abs() < 1e-9);
    }

    #[test]
    fn faults_are_named_with_their_place() {
        let flat = |_: usize, _: usize| 0.1;
        let good = file(&[("Transmission Front", &flat)]);
        let cases = [
            (good.replace("Columns", "Sideways"), "Columns, Rows, TensorTree3"),
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

    /// A file of trees of three dimensions: band, direction, data.
    fn trees(blocks: &[(&str, &str, &str)]) -> String {
        let mut text = "<WindowElement><Optical><Layer><DataDefinition><IncidentDataStructure>TensorTree3\
            </IncidentDataStructure></DataDefinition>"
            .to_owned();
        for (band, direction, data) in blocks {
            text += &format!(
                "<WavelengthData><Wavelength unit=\"Integral\">{band}</Wavelength><WavelengthDataBlock>\n\
                 <WavelengthDataDirection>{direction}</WavelengthDataDirection><AngleBasis>LBNL/Shirley-Chiu</AngleBasis>\n\
                 <ScatteringData>{data}</ScatteringData></WavelengthDataBlock></WavelengthData>"
            );
        }
        text + "</Layer></Optical></WindowElement>"
    }

    const UP: [f64; 3] = [0.0, 0.6, 0.8];

    #[test]
    fn trees_are_quarters() {
        // Light goes on towards the same side, or back.
        let (on, back) = ("{.02 .02 .18 .18 0 0 0 0}", "{.1}");
        let window =
            parsed(&trees(&[("Visible", "Transmission Front", on), ("Visible", "Reflection Back", back)]));
        let window = window.unwrap();
        let [None, Some(_), Some(reflected), Some(seen)] = &window.quarters else { panic!("three quarters") };
        let basis = &seen.matrix.incident;
        let ring = (0..basis.len()).find(|n| basis.middle(*n)[2] < 0.6).unwrap();
        assert!(
            (seen.matrix.sum(ring) - 0.1 * std::f64::consts::PI).abs() < 0.01,
            "{}",
            seen.matrix.sum(ring)
        );
        assert!((reflected.matrix.at(5, 100) - 0.1).abs() < 1e-6);
        let brdf = window.brdf(Quarter::BackTransmission).unwrap();
        let values = [[0.05, -0.6, 0.798], [-0.05, 0.6, 0.798]].map(|wo| brdf.evaluate(UP, wo)[0]);
        assert!(values[0] > 3.0 * values[1], "{values:?}");
        // The other way is the same function.
        let other = window.brdf(Quarter::FrontTransmission).unwrap();
        let (wi, wo) = (UP, [0.3, -0.4, 0.866]);
        assert_eq!(brdf.evaluate(wi, wo), other.evaluate(wo, wi));
        let bright = parsed(&trees(&[("Visible", "Transmission Front", "{.5}")])).unwrap();
        assert!((bright.scale - 2.0 / std::f64::consts::PI).abs() < 1e-3, "{}", bright.scale);
    }

    #[test]
    fn faults_of_trees_are_named() {
        let good = trees(&[("Visible", "Transmission Front", "{.1}")]);
        for (text, words) in [
            (good.replace("LBNL/Shirley-Chiu", "LBNL/Klems Full"), "line 2, <AngleBasis>: `LBNL/Klems Full`"),
            (good.replace("{.1}", "{.1 .2}"), "line 3, <ScatteringData>: after 2 numbers"),
            (good.replace("{.1}", "{{{{"), "after 0 numbers of the tree: `}` was expected"),
            (good.replace("TensorTree3", "TensorTree400"), "TensorTree4 was expected"),
            (good.replace("{.1}", "{0}"), "a sheet that is black"),
            (good.replace("<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>", ""), "<AngleBasis> is missing"),
        ] {
            let error = parsed(&text).unwrap_err().to_string();
            assert!(error.contains(words), "{error}: {words}");
        }
        let is_straight = |n: usize| [119, 120, 135, 136].contains(&(n % 256));
        let leaf: String = (0..4096).map(|n| if is_straight(n) { "9 " } else { "0 " }).collect();
        let pane = parsed(&trees(&[("Visible", "Transmission Front", &format!("{{{leaf}}}"))]));
        assert!(pane.unwrap_err().to_string().contains("a clear pane"));
    }

    #[test]
    fn bands_are_colours() {
        let grey = [("Visible", "Reflection Front", "{.1}")];
        let value = |blocks: &[(&str, &str, &str)], band: &str| {
            let window = Window::parse(trees(blocks).as_bytes(), Band::parse(band).unwrap())?;
            Ok::<_, ReadError>(window.brdf(Quarter::FrontReflection).unwrap().evaluate(UP, UP))
        };
        let is = |a: [f64; 3], b: [f64; 3]| (0..3).all(|n| (a[n] - b[n]).abs() < 1e-4);
        assert!(is(value(&grey, "visible").unwrap(), [0.1; 3]));
        // A colour with equal bands, and one at the point of equal energy, is grey.
        let xz = |x: &'static str, z: &'static str| {
            [grey[0], ("CIE-X", "Reflection Front", x), ("CIE-Z", "Reflection Front", z)]
        };
        let uv = |u: &'static str, v: &'static str| {
            [
                ("CIE-Y", "Reflection Front", "{.1}"),
                ("CIE-u", "Reflection Front", u),
                ("CIE-v", "Reflection Front", v),
            ]
        };
        assert!(is(value(&xz("{.1}", "{.1}"), "visible").unwrap(), [0.1; 3]));
        assert!(is(value(&uv("{.2105263}", "{.4736842}"), "visible").unwrap(), [0.1; 3]));
        // X = .12, Y = .1, Z = .05, by both.
        let warm = value(&xz("{.12}", "{.05}"), "visible").unwrap();
        assert!(warm[0] > 1.3 * warm[1] && warm[1] > 1.3 * warm[2], "{warm:?}");
        assert!(is(warm, value(&uv("{.2711864}", "{.5084746}"), "visible").unwrap()), "{warm:?}");
        assert!(is(value(&xz("{.12}", "{.05}"), "cie-x").unwrap(), [0.12; 3]));
        let error = value(&xz("{.12}", "{.05}"), "solar").unwrap_err().to_string();
        assert!(error.contains("the band Solar; it has Visible, CIE-X, CIE-Z"), "{error}");
    }

    #[test]
    fn matrices_have_colours_too() {
        let flat = |value: f64| file(&[("Reflection Front", &move |_: usize, _: usize| value)]);
        let data = |text: &str, band: &str| {
            let (from, to) = (text.find("<WavelengthData>").unwrap(), text.find("</Layer>").unwrap());
            text[from..to].replace("Visible", band)
        };
        let bands = data(&flat(0.12), "CIE-X") + &data(&flat(0.05), "CIE-Z") + "</Layer>";
        let text = flat(0.1).replace("</Layer>", &bands);
        let brdf = parsed(&text).unwrap().brdf(Quarter::FrontReflection).unwrap();
        let [r, g, b] = brdf.evaluate(UP, UP);
        assert!(r > 1.3 * g && g > 1.3 * b, "{r} {g} {b}");
        let other = text.replace("CIE-Z", "CIE-v").replace("CIE-X", "CIE-u").replace("0.05", "0.5084746");
        let other = other.replace("0.12", "0.2711864");
        let brdf = parsed(&other).unwrap().brdf(Quarter::FrontReflection).unwrap();
        let own = brdf.evaluate(UP, UP);
        assert!((own[0] - r).abs() + (own[1] - g).abs() + (own[2] - b).abs() < 1e-4, "{own:?}");
    }
}
