//! `srbf convert`.

use super::convention_args::ConventionArgs;
use crate::out::output;
use crate::out::print::shown;
use crate::truth::measured::MeasuredMaterial;
use crate::truth::sheets::sheet_in;
use crate::truth::stored::{StoredMaterial, is_fit};
use anyhow::{Context, bail};
use srbf_core::{Quarter, Sheet};
use srbf_fit::patches::{Basis, PatchMatrix};
use srbf_fit::read::{Content, Conventions, Source, Spectra, merl, read_with, rgl, sheet_of};
use srbf_fit::table::{Brdf, Symmetry};
use srbf_fit::{export, klems_of, klems_of_sheet};
use std::path::{Path, PathBuf};

/// Writes a measured BRDF, a model or a fit in the format of another program.
///
/// From any file that `srbf fit` reads, and from `.srbf` files of isotropic surfaces, to the format of the ending of OUTPUT:
///
/// .binary (MERL): 90 x 90 x 180 cells, each the value at its centre. Readers interpolate between them: f cos of a smooth model comes back
/// within 0.5 % of relative L2 (GGX, roughness 0.1), of a diffuse one exactly. A cell is one value for a pair of directions and the
/// same exchanged; the mean of both is stored, which takes measured tables 3 to 13 % away, as they are not quite reciprocal. Negative channels, of colours outside the gamut, become 0. Cells that a
/// MERL file has not measured stay marked so.
///
/// .bsdf (RGL): f cos at 59 outgoing directions by 128 x 128 half vectors, in RGB; comes back within 0.5 % for the same model. Of anisotropic
/// surfaces 22 angles by 13 azimuths over half a turn, and 64 x 64 half vectors.
/// Samples that are spectra have them there too, and fits with --wavelengths: a linear map from colours, at most 64 wavelengths; 4 MB each.
/// Mitsuba's `measured` reads colours in its RGB variants, spectra in its spectral ones, and draws by f cos itself: the relative variance is .002 up to 75 degrees, and .06 at 85.
///
/// .csv (ours, see docs/csv.md) and .astm (Cornell, three channels): samples. Those of a file of samples stay as they are; of all else,
/// 16 outgoing directions by some 1300 incident ones. At the samples nothing is lost; between them nothing is said. Samples and models
/// with spectra, and such fits with --wavelengths, become a .csv of one column for each wavelength; .astm has their colours.
///
/// Of a sheet, a .csv has samples of all quarters, with heights below 0 behind it. A quarter alone has a name: FIT.srbf:front-transmission.
///
/// .xml (WINDOW, Radiance): means over the 145 patches of Klems, of visible light. A sheet has all its quarters there, all else the reflection
/// of the front.
///
/// Not possible: .brdf (Cornell) holds spectra, which a colour does not tell; .srbf is a fit, by `srbf fit`; .binary and .astm of anisotropic surfaces.
/// Samples become .binary or .bsdf by what `srbf fit` completes them to. After .binary and .bsdf the file is read again, and how far it is off
/// is printed.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The measured BRDF or the model, as `srbf fit` reads it, or a fit
    #[arg(value_name = "FILE|MODEL|FIT.srbf")]
    input: PathBuf,
    /// The file to write: .binary, .bsdf, .csv, .astm or .xml
    #[arg(value_name = "OUTPUT")]
    output: PathBuf,
    #[command(flatten)]
    conventions: ConventionArgs,
}

/// The formats that can be written.
#[derive(Clone, Copy)]
enum Format {
    Merl,
    Rgl,
    Csv,
    Astm,
    Window,
}

impl Format {
    /// The one that a name ends in.
    fn of(path: &Path) -> anyhow::Result<Self> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        let name = shown(path);
        Ok(match ending.as_str() {
            "binary" => Self::Merl,
            "bsdf" => Self::Rgl,
            "csv" => Self::Csv,
            "astm" => Self::Astm,
            "xml" => Self::Window,
            "srbf" => bail!("output {name}: lobes are fitted, by `srbf fit FILE -o {name}`"),
            "brdf" => bail!(
                "output {name}: .brdf holds spectra, which three channels do not tell; .astm holds those"
            ),
            _ => bail!("output {name}: a name that ends in .binary, .bsdf, .csv, .astm or .xml is expected"),
        })
    }
}

/// Of samples that stay as they are.
const READ: &str = "as they were read";

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    let format = Format::of(&args.output)?;
    output::check_place(&args.output)?;
    if let Format::Window = format {
        return write_window(&args).with_context(|| shown(&args.input));
    }
    if let Format::Csv = format
        && let Some(sheet) = sheet_in(&args.input)?
    {
        return write_sheet(&args.output, &sheet).with_context(|| shown(&args.input));
    }
    let source = source(&args.input, &args.conventions.conventions())?;
    let named = || shown(&args.input);
    match format {
        Format::Merl | Format::Rgl => write_grid(&args.output, format, source),
        Format::Csv => write_samples(&args.output, source, true),
        Format::Astm | Format::Window => write_samples(&args.output, source, false),
    }
    .with_context(named)
}

/// The file that was read, or the lobes of a fit.
fn source(input: &Path, conventions: &Conventions) -> anyhow::Result<Source> {
    if !is_fit(input) {
        return Ok(read_with(input, conventions)?);
    }
    let StoredMaterial { name, material } = StoredMaterial::load(&input.to_string_lossy())?;
    // A wavelength takes 4 MB of a .bsdf, which RGB variants of Mitsuba do not open then.
    let map = material.spectral_map().filter(|_| conventions.wavelengths.is_some());
    let map = map.map(|map| Spectra::of_map(map, conventions.wavelengths));
    let spectra = map.transpose().with_context(|| shown(input))?;
    Ok(Source::evaluable(Box::new(export::Lobes(material)), name, String::new()).with_spectra(spectra))
}

/// Writes the means over patches: of a sheet, or of the reflection of anything else.
fn write_window(args: &Args) -> anyhow::Result<()> {
    let name = args.input.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let conventions = args.conventions.conventions();
    let basis = Basis::klems_full();
    let quarters = if is_fit(&args.input) {
        match sheet_in(&args.input)? {
            Some(sheet) => klems_of_sheet(&sheet)?,
            None => {
                let stored = StoredMaterial::load(&args.input.to_string_lossy())?;
                [Some(klems_of(&stored.material)?), None, None, None]
            }
        }
    } else if let Some(sheet) = sheet_of(&args.input, &conventions, false)? {
        sheet.quarters.each_ref().map(|source| match &source.as_ref()?.content {
            Content::Evaluable(brdf) => Some(PatchMatrix::of(&basis, &basis, |wi, wo| {
                srbf_fit::table::luminance(brdf.evaluate(wi, wo))
            })),
            Content::Samples(_) => None,
        })
    } else {
        let material = MeasuredMaterial::new(read_with(&args.input, &conventions)?)?;
        let value = |wi, wo| srbf_fit::table::luminance(material.brdf().evaluate(wi, wo));
        [Some(PatchMatrix::of(&basis, &basis, value)), None, None, None]
    };
    let text = export::window(&name, &quarters);
    output::write(&args.output, text.as_bytes())?;
    let count = quarters.iter().flatten().count();
    println!("{}: {} bytes, {count} matrices of 145 x 145 patches", shown(&args.output), text.len());
    Ok(())
}

/// Writes samples of all quarters of a sheet.
fn write_sheet(output: &Path, sheet: &Sheet<Vec<u8>>) -> anyhow::Result<()> {
    let lobes = Quarter::ALL.map(|quarter| sheet.quarter(quarter).map(export::Lobes));
    let (text, count) =
        export::csv_of_sheet(lobes.each_ref().map(|own| own.as_ref().map(|own| own as &dyn Brdf)))?;
    output::write(output, text.as_bytes())?;
    let quarters = lobes.iter().flatten().count();
    println!(
        "{}: {count} samples of {quarters} quarters, chosen here; `srbf fit --sheet` reads them all",
        shown(output)
    );
    Ok(())
}

/// Writes samples: those that were read, or those of a BRDF; `is_csv`: with spectra where there are some.
fn write_samples(output: &Path, source: Source, is_csv: bool) -> anyhow::Result<()> {
    if let (true, Content::Evaluable(brdf)) = (is_csv, &source.content)
        && brdf.symmetry() != Symmetry::Isotropic
    {
        let (text, count, are) = match (source.own_spectra(), &source.intake) {
            (Some(own), _) => (export::csv_of_spectra(own), own.samples.len(), READ),
            (None, Some(intake)) => (export::csv_of_rows(&intake.rows), intake.rows.len(), READ),
            (None, None) => {
                let (text, count) = export::csv_of_turned(brdf.as_ref());
                (text, count, "chosen here")
            }
        };
        output::write(output, text.as_bytes())?;
        println!("{}: {count} samples at outgoing directions over the hemisphere, {are}", shown(output));
        return Ok(());
    }
    let spectra = source.spectra().filter(|_| is_csv).cloned();
    // Of very many samples, some alone have kept their spectra.
    let own = source.own_spectra().filter(|_| is_csv).cloned();
    let (table, are) = match source.content {
        Content::Samples(table) => (table, READ.to_owned()),
        Content::Evaluable(brdf) => match export::measured(brdf.as_ref())? {
            (table, 0.0) => (table, "chosen here".to_owned()),
            (table, left_out) => (
                table,
                format!("chosen here; {:.0} % of them were not measured, and are left out", 100.0 * left_out),
            ),
        },
    };
    let text = match &own {
        Some(own) => export::csv_of_spectra(own),
        None if is_csv => export::csv(&table, spectra.as_ref()),
        None => export::astm(&table),
    };
    output::write(output, text.as_bytes())?;
    let count = own
        .as_ref()
        .map_or_else(|| table.views.iter().map(|view| view.samples.len()).sum(), |own| own.samples.len());
    let of = match &spectra {
        Some(spectra) if own.is_some() => format!(" of {}", spectra.text()),
        Some(spectra) => format!(
            " of {}, by the colours, off by {:.1} % (relative L2)",
            spectra.text(),
            100.0 * spectra.errors.error
        ),
        None => String::new(),
    };
    println!("{}: {count} samples{of} at {} outgoing directions, {are}", shown(output), table.views.len());
    Ok(())
}

/// Writes a grid of values, reads it again, and says how far it is off.
fn write_grid(output: &Path, format: Format, source: Source) -> anyhow::Result<()> {
    if let Content::Samples(_) = source.content {
        println!("samples: completed first, to have a value for every pair of directions");
    }
    let spectra = source.spectra().filter(|spectra| !spectra.is_grey).cloned();
    let material = MeasuredMaterial::new(source)?;
    if !material.gaps.is_empty() {
        // Samples are all completed; of a table, MERL has a mark for cells that were not measured.
        let is_marked = matches!(format, Format::Merl) && material.completed.is_none();
        let there =
            if is_marked { "those cells stay marked" } else { "values there are completed, not measured" };
        println!("note {}; {there}", material.gaps);
    }
    let (bytes, back): (Vec<u8>, Box<dyn Brdf>) = if let Format::Rgl = format {
        let bytes = export::rgl(material.brdf(), spectra.as_ref())?;
        if let Some(Spectra { wavelengths, errors, .. }) = &spectra {
            println!(
                "spectra: {} wavelengths, by the colours; those of the samples are off by {:.1} % (relative L2)",
                wavelengths.len(),
                100.0 * errors.error
            );
        }
        let back = rgl::parse(&bytes)?;
        (bytes, Box::new(back))
    } else {
        let file = export::merl(material.brdf())?;
        if file.negatives > 0.0 {
            println!("note {:.2} % of the numbers were negative, and are 0", 100.0 * file.negatives);
        }
        let back = merl::parse(&file.bytes)?;
        (file.bytes, Box::new(back))
    };
    output::write(output, &bytes)?;
    let errors = export::difference(back.as_ref(), material.brdf())?
        .map(|(degrees, error)| format!("{:.2} % at {degrees:.0}", 100.0 * error));
    println!(
        "{}: {} bytes; read again, f cos is off by {} degrees (relative L2)",
        shown(output),
        bytes.len(),
        errors.join(", ")
    );
    Ok(())
}
