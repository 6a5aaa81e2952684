//! Writer of the XML of WINDOW and Radiance: matrices over the 145 patches of Klems, visible light.

use crate::patches::PatchMatrix;
use std::fmt::Write;

/// The direction of each quarter in a file, by the side that light comes from, and the places of the quarters that viewers see.
const DIRECTIONS: [(&str, usize); 4] =
    [("Transmission Front", 3), ("Transmission Back", 1), ("Reflection Front", 0), ("Reflection Back", 2)];

/// Writes the matrices of a sheet, in the order of [`Quarter::ALL`](srbf_core::Quarter::ALL). A quarter that is missing is black, and is
/// not written. All have the patches of [`Basis::klems_full`](crate::patches::Basis::klems_full).
pub fn window(name: &str, quarters: &[Option<PatchMatrix>; 4]) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- written by srbf -->\n<WindowElement xmlns=\"http://windows.lbl.gov\" \
         xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" xsi:schemaLocation=\"http://windows.lbl.gov/BSDF-v1.4.xsd\">\n\
         <WindowElementType>System</WindowElementType>\n<FileType>BSDF</FileType>\n<Optical>\n<Layer>\n\t<Material>\n",
    );
    // Writing to a String cannot fail.
    let _ = write!(
        text,
        "\t\t<Name>{}</Name>\n\t\t<Manufacturer>srbf</Manufacturer>\n\t\t<DeviceType>Other</DeviceType>\n\t</Material>\n\t<DataDefinition>\n\
         \t\t<IncidentDataStructure>Columns</IncidentDataStructure>\n",
        escaped(name)
    );
    if let Some(matrix) = quarters.iter().flatten().next() {
        text += "\t\t<AngleBasis>\n\t\t\t<AngleBasisName>LBNL/Klems Full</AngleBasisName>\n";
        for ring in matrix.outgoing.rings() {
            let [low, high] = ring.ends.map(degrees);
            let _ = write!(
                text,
                "\t\t\t<AngleBasisBlock>\n\t\t\t\t<Theta>{}</Theta>\n\t\t\t\t<nPhis>{}</nPhis>\n\t\t\t\t<ThetaBounds>\n\
                 \t\t\t\t\t<LowerTheta>{low}</LowerTheta>\n\t\t\t\t\t<UpperTheta>{high}</UpperTheta>\n\t\t\t\t</ThetaBounds>\n\
                 \t\t\t</AngleBasisBlock>\n",
                degrees(ring.theta),
                ring.count
            );
        }
        text += "\t\t</AngleBasis>\n";
    }
    text += "\t</DataDefinition>\n";
    for (direction, place) in DIRECTIONS {
        let Some(matrix) = &quarters[place] else { continue };
        let _ = write!(
            text,
            "\t<WavelengthData>\n\t\t<LayerNumber>System</LayerNumber>\n\t\t<Wavelength unit=\"Integral\">Visible</Wavelength>\n\
             \t\t<SourceSpectrum>CIE Illuminant D65 1nm.ssp</SourceSpectrum>\n\
             \t\t<DetectorSpectrum>ASTM E308 1931 Y.dsp</DetectorSpectrum>\n\t\t<WavelengthDataBlock>\n\
             \t\t\t<WavelengthDataDirection>{direction}</WavelengthDataDirection>\n\
             \t\t\t<ColumnAngleBasis>LBNL/Klems Full</ColumnAngleBasis>\n\t\t\t<RowAngleBasis>LBNL/Klems Full</RowAngleBasis>\n\
             \t\t\t<ScatteringDataType>{}</ScatteringDataType>\n\t\t\t<ScatteringData>\n",
            if direction.starts_with('T') { "BTDF" } else { "BRDF" }
        );
        for row in matrix.values.chunks(matrix.incident.len()) {
            let row: Vec<String> = row.iter().map(|v| format!("{v:.5e}")).collect();
            text += &row.join(", ");
            text.push('\n');
        }
        text += "\t\t\t</ScatteringData>\n\t\t</WavelengthDataBlock>\n\t</WavelengthData>\n";
    }
    text + "</Layer>\n</Optical>\n</WindowElement>\n"
}

/// An angle as files have it: .5 is the finest.
fn degrees(radians: f64) -> f64 {
    libm::round(radians.to_degrees() * 1e6) / 1e6
}

/// A text within an element.
fn escaped(text: &str) -> String {
    let text: String = text.chars().filter(|c| !c.is_control()).collect();
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patches::Basis;
    use crate::read::window::{Band, Window};

    #[test]
    fn what_is_written_is_read() {
        let basis = Basis::klems_full();
        let matrix =
            |bright: f64| PatchMatrix::of(&basis, &basis, |wi, wo| bright * (0.1 + 0.02 * (wi[1] + wo[0])));
        let through = matrix(1.0);
        let quarters = [Some(matrix(0.5)), through.reversed(), None, Some(through)];
        let text = window("a & <b>", &quarters);
        let read = Window::parse(text.as_bytes(), Band::default()).unwrap();
        assert_eq!((read.name.as_str(), read.scale), ("a & <b>", 1.0));
        assert!(read.disagreement.unwrap() < 1e-4);
        for (written, found) in quarters.iter().zip(&read.quarters) {
            match (written, found) {
                (Some(a), Some(b)) => {
                    assert_eq!((&a.outgoing, &a.incident), (&b.matrix.outgoing, &b.matrix.incident));
                    assert!(a.distance(&b.matrix) < 1e-4);
                }
                (a, b) => assert!(a.is_none() && b.is_none()),
            }
        }
    }
}
