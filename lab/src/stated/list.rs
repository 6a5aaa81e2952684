//! The sentences of the documents that state figures.

/// A sentence of a document. Names of figures stand in braces in place of the numbers.
pub struct Sentence {
    /// The file, from the root of the repository.
    pub document: &'static str,
    pub text: &'static str,
}

const fn figures(text: &'static str) -> Sentence {
    Sentence { document: "docs/figures.md", text }
}

/// All of them.
#[rustfmt::skip]
pub const SENTENCES: &[Sentence] = &[
    figures("| garnet red | {table-5.1 garnet_red ours}, {table-5.1 garnet_red ours whole} | {table-5.1 garnet_red thesis}, {table-5.1 garnet_red thesis whole} | {table-5.1 garnet_red Lafortune}, {table-5.1 garnet_red Lafortune whole} |"),
    figures("| krylon blue | {table-5.1 krylon_blue ours}, {table-5.1 krylon_blue ours whole} | {table-5.1 krylon_blue thesis}, {table-5.1 krylon_blue thesis whole} | {table-5.1 krylon_blue Lafortune}, {table-5.1 krylon_blue Lafortune whole} |"),
    figures("| cayman | {table-5.1 cayman ours}, {table-5.1 cayman ours whole} | {table-5.1 cayman thesis}, {table-5.1 cayman thesis whole} | {table-5.1 cayman Lafortune}, {table-5.1 cayman Lafortune whole} |"),
    figures("| blue paint (its published Lafortune fit) | {table-5.1 blue_paint ours}, {table-5.1 blue_paint ours whole} | {table-5.1 blue_paint thesis}, {table-5.1 blue_paint thesis whole} | {table-5.1 blue_paint Lafortune}, {table-5.1 blue_paint Lafortune whole} |"),
    figures("The presets have no factors, and errors of {samples garnet_red}, {samples krylon_blue} and {samples cayman} %."),
    figures("| preset garnet red | {bytes garnet_red} |"),
    figures("| preset krylon blue | {bytes krylon_blue} |"),
    figures("| preset cayman | {bytes cayman} |"),
    figures("| `model:ggx:alpha=0.2,f0=0.9` | {models ggx views}, {models ggx between} | {models ggx bytes} |"),
    figures("| `model:ward:alpha=0.3,specular=0.3` | {models ward views}, {models ward between} | {models ward bytes} |"),
    figures("| `model:phong:diffuse=0.3,specular=0.3,exponent=50` | {models phong views}, {models phong between} | {models phong bytes} |"),
    figures("The textbook formula for the value is {stability plain} % off at 1e6."),
    figures("| Gaussian::value | {stability Gaussian::value} |"),
    figures("| special::sphere_integral | {stability special::sphere_integral} |"),
    figures("| Gaussian::pdf | {stability Gaussian::pdf} |"),
    figures("| special::cap_integral | {stability special::cap_integral} |"),
    figures("| special::one_minus_cos | {stability special::one_minus_cos} |"),
    figures("| GaussianProduct::integral | {stability GaussianProduct::integral} |"),
    figures("| Folded::pdf | {stability Folded::pdf} |"),
    figures("| Mixture::pdf | {stability Mixture::pdf} |"),
    figures("| special::mean_cosine | {stability special::mean_cosine} |"),
    figures("| material to mixture to sample | {stability material to mixture to sample} |"),
    figures("| material to sample | {stability material to sample} |"),
    figures("| expanded material to sample | {stability expanded material to sample} |"),
    figures("| material with factors to sample | {stability material with factors to sample} |"),
    figures("| Environment::sample | {stability Environment::sample} |"),
    figures("| Mixture::sample_product | {stability Mixture::sample_product} |"),
    figures("| Mixture::reflect | {stability Mixture::reflect} |"),
    figures("| one peak, sharpness 300 | {solver one peak views}, {solver one peak between} | {solver one peak height} | {solver one peak evaluations} | over 1e16 |"),
    figures("| two peaks, 3e4, .3 radians apart | {solver two peaks far apart views}, {solver two peaks far apart between} | {solver two peaks far apart height}, {solver two peaks far apart second height} | {solver two peaks far apart evaluations} | {solver two peaks far apart condition} |"),
    figures("| two peaks, 3e4, .01 radians apart | {solver two peaks that overlap views}, {solver two peaks that overlap between} | {solver two peaks that overlap height}, {solver two peaks that overlap second height} | {solver two peaks that overlap evaluations} | over 1e16 |"),
    figures("| two peaks, 1e6, .3 radians apart | {solver two needles views}, {solver two needles between} | {solver two needles height}, {solver two needles second height} | {solver two needles evaluations} | over 1e16 |"),
    figures("red {furnace red} ± {furnace error} against {furnace closed}."),
    figures("from 12 to {left-out cayman lobes} lobes and garnet red to {left-out garnet_red lobes}."),
    figures("with {left-out cayman error} % error and {left-out cayman albedo} % of the albedo lost"),
    figures("with an error of {left-out krylon_blue error} %."),
];
