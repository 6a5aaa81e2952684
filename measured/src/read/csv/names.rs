//! The content of a column, by its name in any usual spelling.

/// Which of the two directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Incident,
    Outgoing,
    /// `s`: the scattered direction beside an `i`, the source beside a `v` or an `r`.
    Either,
}

/// The content of a column.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Role {
    /// Angle from the normal.
    Theta(Side),
    /// Angle from the normal of a direction that is not named.
    ThetaAlone,
    /// Azimuth.
    Phi(Side),
    /// Difference of the azimuths, or the one azimuth that there is.
    DeltaPhi,
    /// Angle between the two directions.
    Phase,
    /// Azimuth of a direction that the name does not say in a known word.
    OddPhi,
    /// The angle by which the sample is turned about its normal.
    Turn,
    /// A part of a unit vector: 0 x, 1 y, 2 z.
    Vector(Side, usize),
    /// Angle of the half vector from the normal.
    ThetaHalf,
    /// Angle between the half vector and a direction, if there is one of the half vector.
    ThetaDifference,
    /// Azimuth about the half vector.
    PhiDifference,
    /// The cosine of an angle from the normal.
    Cosine(Side),
    /// An angle from the horizon, or one from the normal of which that is said.
    Elevation,
    /// One value.
    Value,
    /// One of two polarisations of the value: 0 s, 1 p.
    Polarised(usize),
    /// One of several measurements of the value.
    Repeated,
    /// A channel of linear sRGB.
    Rgb(usize),
    /// X, Y or Z.
    Xyz(usize),
    /// The wavelength of a row, where each has one.
    Wavelength,
    /// A logarithm of the value, or decibels.
    Logarithm,
    /// A value at a wavelength.
    At(f64),
    /// A number that is a wavelength only in a series of them.
    Numbered(f64),
    /// A name that is no number, where a wavelength was meant.
    NoWavelength,
    /// Anything else.
    Other,
}

impl Role {
    /// The content of a column of that role, in words; `None` where the name alone does not tell.
    pub fn words(&self) -> Option<&'static str> {
        Some(match self {
            Self::Theta(Side::Incident) => "incident angle",
            Self::Theta(Side::Outgoing) => "outgoing angle",
            Self::Theta(Side::Either) | Self::ThetaAlone => "angle",
            Self::Phi(Side::Incident) => "incident azimuth",
            Self::Phi(Side::Outgoing) => "outgoing azimuth",
            Self::Phi(Side::Either) | Self::OddPhi => "azimuth",
            Self::Phase => "phase angle",
            Self::Turn => "turn of the sample",
            Self::DeltaPhi => "azimuth",
            Self::Vector(Side::Incident, _) => "incident vector",
            Self::Vector(Side::Outgoing, _) => "outgoing vector",
            Self::Vector(Side::Either, _) => "vector",
            Self::ThetaHalf => "half angle",
            Self::ThetaDifference | Self::PhiDifference => "difference angle",
            Self::Cosine(_) => "cosine",
            Self::Elevation => "elevation",
            Self::Value => "value",
            Self::Polarised(_) => "one polarisation",
            Self::Repeated => "one of several measurements",
            Self::Rgb(_) => "channel",
            Self::Xyz(_) => "tristimulus",
            Self::Wavelength => "wavelength",
            Self::Logarithm => "logarithm",
            Self::At(_) => "at a wavelength",
            Self::Numbered(_) | Self::NoWavelength | Self::Other => return None,
        })
    }
}

/// A unit that a name carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    Degrees,
    Radians,
    /// Of which a right angle has 100.
    Gon,
    Percent,
}

/// What values of a column are beside f.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Beside {
    /// f times the cosine of the outgoing direction: angle-resolved scatter.
    CosineOutgoing,
    /// pi f: a reflectance factor.
    Pi,
    /// pi f times the cosine of the incident direction: the radiance factor of planets.
    PiCosineIncident,
}

const INCIDENT: &str = "i in inc inci incident incidence incoming input l light src source sun sol solar lamp illumination illum \
    irradiation ill incid ein einfall einfalls lichteinfall lichteinfalls lichtquelle laser licht beleuchtung beleuchtungs einstrahlung einstrahl \
    incidencia incidente incidenza 入射 太阳 光源 éclairage eclairage éclairement lumière";
const OUTGOING: &str = "o out outgoing output r refl reflected reflection v view viewer viewing cam camera det detector d \
    sensor satellite rec receive receiver receiving e em emission emitted exit measure measured measurement obs observation observer \
    scat sct scatter scattered scattering emergent emergence aus ausfall ausfalls beobachter beobachtungs betrachtungs detektor \
    reflexion reflexions réflexion streu \
    beobachtung betrachtung betrachter detektion mess messung messkopf reflektiert sicht blick observación observacion \
    观测 观察 出射 反射 探测 受光 reflexión osservazione riflessione visée visee vision capteur empfänger";
const POLAR: &str = "theta zenith zenit zen polar inclination th tht vertical 天顶角 天頂角 天顶 角";
const AZIMUTH: &str = "azimuthal azimuth azimutal azimut acimut azim azi phi az 方位角 方位";
/// Angles that some count from the horizon, and some from the normal.
const ELEVATION: &str = "elevation elev altitude grazing glancing";
/// Before the number of a repeated measurement.
const REPEATED: &str =
    "run rep repeat repetition trial scan shot meas measurement messung mesure wiederholung";
/// A mean of measurements.
const MEAN: &str = "mean avg average median mittel mittelwert moyenne media";
/// Names of the angle by which a sample is turned.
const TURNS: &str = "rotation samplerotation rotationsample samplerot rotsample sampleazimuth azimuthsample samplephi phisample sampleturn turn \
    stagerotation rotationstage tablerotation turntable turntableangle samplepsi psi samplerotationangle rotationangle anglerotation \
    rotationofsample rotationofthesample orientation sampleorientation probendrehung drehung dreh probendreh \
    rotationéchantillon rotationechantillon rotación rotacion rotazione";
/// Names of a reflectance factor: pi f.
const FACTORS: &str = "brf hdrf reff reflectancefactor";
/// Names of the radiance factor of planets, pi f times the cosine of the incident direction; `I/F` is another.
const RADIANCE_FACTORS: &str = "iof radf";
const VALUES: &str = "value val values f fr brdf bsdf y luminance lum grey gray intensity reflectance rho \
    reflectancefactor radiance brdfvalue brf hdrf reff reflectancefactor iof radf frdb fdrb wert valeur bidir brdfsr fbrdf signal data messwert ars ccbrdf cosinecorrectedbrdf";
/// Angles in German, Spanish and Italian.
const ANGLES: [&str; 8] = ["winkel", "Winkel", "ángulo", "Ángulo", "angulo", "Angulo", "angolo", "Angolo"];
/// Names of the channels, in six languages.
const CHANNELS: [&str; 3] =
    ["r red rot rouge rojo rosso vermelho", "g green grün vert verde", "b blue blau bleu azul blu"];
/// Before a channel or a wavelength.
const BEFORE: &str = "brdf bsdf brf hdrf reff value reflectance refl linear lin srgb rgb f fr xyz r";
const BEFORE_WAVELENGTH: &str =
    "wavelength lambda \u{3bb} \u{3c1} wl w brdf bsdf value reflectance refl f fr r nm l";

/// What values of that name are, where they are not f.
pub(super) fn beside(name: &str) -> Option<Beside> {
    let all = words(name);
    let bare: String =
        all.iter().filter(|word| !matches!(word.as_str(), "1" | "sr")).map(String::as_str).collect();
    if matches!(bare.as_str(), "ars" | "ccbrdf" | "cosinecorrectedbrdf") {
        return Some(Beside::CosineOutgoing);
    }
    let is_named = |names: &str| has(names, &bare) || all.iter().any(|word| has(names, word));
    if is_over(name) || is_named(RADIANCE_FACTORS) {
        return Some(Beside::PiCosineIncident);
    }
    (is_named(FACTORS) || bare.contains("reflectancefactor")).then_some(Beside::Pi)
}

/// Whether a name is `I/F`.
fn is_over(name: &str) -> bool {
    name.trim().eq_ignore_ascii_case("i/f")
}

/// Digits from which on a number is a wavelength without a unit.
const WAVELENGTH_DIGITS: usize = 3;

/// A name and the unit that it carries, or that stands in brackets after it.
pub(super) fn unit(name: &str) -> Option<Unit> {
    let name = name.to_lowercase();
    if name.contains('\u{b0}') {
        return Some(Unit::Degrees);
    }
    let of = |word: &str| match word {
        "deg" | "degs" | "degree" | "degrees" | "grad" | "\u{b0}" => Some(Unit::Degrees),
        "rad" | "rads" | "radian" | "radians" => Some(Unit::Radians),
        "gon" | "gons" | "gradian" | "gradians" => Some(Unit::Gon),
        "percent" | "pct" => Some(Unit::Percent),
        _ => None,
    };
    let percent = name.contains('%').then_some(Unit::Percent);
    percent.or_else(|| words(&name).iter().find_map(|word| of(word)))
}

/// The content of a column of that name.
pub(super) fn role(name: &str) -> Role {
    let name = name.trim();
    if name.is_empty() {
        return Role::Other;
    }
    if name.parse::<f64>().is_ok_and(|number| !number.is_finite()) {
        return Role::NoWavelength;
    }
    // Articles of French, and what German joins.
    let with = |name: String, a: &str, b: &str| if name.contains(a) { name.replace(a, b) } else { name };
    let apart =
        ["d'", "l'", "d\u{2019}", "l\u{2019}"].iter().fold(name.to_owned(), |name, a| with(name, a, " "));
    let name = &ANGLES.iter().fold(apart, |name, a| with(name, a, " angle"));
    let plain = name.trim().to_lowercase();
    let is_unit = |w: &String| {
        matches!(
            w.as_str(),
            "deg"
                | "degs"
                | "degree"
                | "grad"
                | "degrees"
                | "rad"
                | "rads"
                | "radian"
                | "radians"
                | "gon"
                | "gons"
                | "gradian"
                | "gradians"
                | "sr"
                | "1"
                | "sterad"
        )
    };
    let is_filler = |w: &String| {
        matches!(
            w.as_str(),
            "of" | "the"
                | "de"
                | "di"
                | "del"
                | "della"
                | "to"
                | "toward"
                | "towards"
                | "direction"
                | "dir"
                | "angles"
                | "angle"
                | "vec"
        )
    };
    let all = words(name);
    let has_angle = all.iter().any(|w| w == "angle" || w == "angles")
        || matches!(unit(name), Some(Unit::Degrees | Unit::Radians | Unit::Gon));
    let bare: Vec<String> = all.iter().filter(|w| !is_unit(w)).cloned().collect();
    let kept: String = bare.iter().filter(|w| !is_filler(w)).map(String::as_str).collect();
    let joined: String = bare.concat();
    match joined.as_str() {
        "aoi" | "angleofincidence" | "sza" => return Role::Theta(Side::Incident),
        "vza" | "aos" | "aor" | "aoe" | "angleofscatter" => return Role::Theta(Side::Outgoing),
        "saa" => return Role::Phi(Side::Incident),
        "vaa" => return Role::Phi(Side::Outgoing),
        "raa" => return Role::DeltaPhi,
        // Cosines, as codes of radiative transfer name them.
        "mu0" | "umu0" | "mui" => return Role::Cosine(Side::Incident),
        "mu" | "umu" | "muo" | "mur" | "muv" => return Role::Cosine(Side::Outgoing),
        _ => {}
    }
    let length = ["nm", "um", "\u{b5}m", "\u{3bc}m"].iter().find_map(|unit| joined.strip_suffix(unit));
    if has(
        "wavelength wavelengths lambda wl wellenlänge longueurdonde longueuronde",
        length.unwrap_or(&joined),
    ) {
        return Role::Wavelength;
    }
    if is_over(name) {
        return Role::Value;
    }
    if has(TURNS, &kept) || has(TURNS, &joined) || joined == "sampleangle" {
        return Role::Turn;
    }
    if let Some(part) = part(&all) {
        return part;
    }
    if is_logarithm(&plain, &kept) {
        return Role::Logarithm;
    }
    if let Some(found) = spectral(&plain) {
        return found;
    }
    match joined.as_str() {
        "thetah" | "thetahalf" | "halfangle" | "halftheta" => return Role::ThetaHalf,
        "thetadiff" | "thetadifference" | "differenceangle" => return Role::ThetaDifference,
        "phidiff" | "phidifference" => return Role::PhiDifference,
        "phase" | "phaseangle" | "phasenwinkel" => return Role::Phase,
        "incidence" => return Role::Theta(Side::Incident),
        "receive" | "emission" | "emergence" => return Role::Theta(Side::Outgoing),
        _ => {}
    }
    if let Some(side) = kept.strip_suffix('a').filter(|rest| rest.len() > 2).and_then(side) {
        return Role::Phi(side);
    }
    if let Some(rest) = kept.strip_prefix("cosine").or_else(|| kept.strip_prefix("cos")) {
        let of = around(rest, POLAR).unwrap_or_else(|| rest.to_owned());
        return side(&of).map_or(Role::Other, Role::Cosine);
    }
    if around(&kept, ELEVATION).is_some_and(|rest| rest.is_empty() || side(&rest).is_some()) {
        return Role::Elevation;
    }
    // Before azimuths: azul begins as one.
    if kept.len() > 2
        && let Some(channel) = CHANNELS.iter().position(|names| has(names, &kept))
    {
        return Role::Rgb(channel);
    }
    let relative = [
        "relative",
        "relativo",
        "relativa",
        "relatif",
        "relativ",
        "relativer",
        "rel",
        "delta",
        "d",
        "difference",
        "differenz",
        "differenza",
        "diferencia",
        "différence",
        "diff",
        "相对",
        "iv",
        "io",
        "ir",
    ];
    if let Some(rest) = around(&kept, AZIMUTH) {
        return match side(&rest) {
            Some(side) if rest != "d" || kept.starts_with("phi") => Role::Phi(side),
            _ if rest.is_empty() || relative.contains(&rest.as_str()) => Role::DeltaPhi,
            // Shorter words may be the end of any name.
            _ if kept.contains("azim") || kept.contains("acim") || kept.starts_with("phi") => Role::OddPhi,
            _ => Role::Other,
        };
    }
    if kept.is_empty() && has_angle {
        return Role::ThetaAlone;
    }
    if let Some(rest) = around(&kept, POLAR) {
        return match side(&rest) {
            Some(side) => Role::Theta(side),
            None if rest.is_empty() => Role::ThetaAlone,
            None => Role::Other,
        };
    }
    if let (true, Some(side)) = (has_angle, side(&kept)) {
        return Role::Theta(side);
    }
    if let Some(vector) = vector(&kept).or_else(|| vector_by_axis(&kept)) {
        return vector;
    }
    channel(&kept).unwrap_or(Role::Other)
}

/// Whether a word is in a list.
fn has(list: &str, word: &str) -> bool {
    list.split(' ').any(|known| known == word)
}

/// A name without the word that it begins or ends with.
fn around(name: &str, of: &str) -> Option<String> {
    of.split(' ').find_map(|q| name.strip_prefix(q).or_else(|| name.strip_suffix(q))).map(str::to_owned)
}

fn side(name: &str) -> Option<Side> {
    // theta_i_1 and the like are no spelling of anything.
    match name {
        "s" => Some(Side::Either),
        _ if has(INCIDENT, name) => Some(Side::Incident),
        _ if has(OUTGOING, name) => Some(Side::Outgoing),
        _ => None,
    }
}

fn vector(name: &str) -> Option<Role> {
    let axis = ["x", "y", "z"].iter().position(|axis| name.ends_with(axis))?;
    let rest = &name[..name.len() - 1];
    let bare = rest.strip_prefix("omega").or_else(|| rest.strip_prefix('w')).unwrap_or(rest);
    side(bare).filter(|_| !bare.is_empty()).map(|side| Role::Vector(side, axis))
}

/// `x_i`, `z_out`: the axis first.
fn vector_by_axis(name: &str) -> Option<Role> {
    let axis = ["x", "y", "z"].iter().position(|axis| name.starts_with(axis))?;
    side(&name[1..]).map(|side| Role::Vector(side, axis))
}

fn channel(name: &str) -> Option<Role> {
    let xyz = ["x", "y", "z"];
    let middle = MEAN.split(' ').find_map(|mean| name.strip_suffix(mean).or_else(|| name.strip_prefix(mean)));
    if has(VALUES, middle.unwrap_or(name)) && name != "y" || middle == Some("") {
        return Some(Role::Value);
    }
    let of = |bare: &str| {
        let rgb = CHANNELS.iter().position(|names| has(names, bare)).map(Role::Rgb);
        rgb.or_else(|| xyz.iter().position(|x| *x == bare).map(Role::Xyz))
    };
    BEFORE.split(' ').chain([""]).find_map(|before| {
        name.strip_prefix(before).and_then(of).or_else(|| name.strip_suffix(before).and_then(of))
    })
}

/// A value of one polarisation, or one of several measurements: `BRDF_s`, `BRDF run 2`.
fn part(words: &[String]) -> Option<Role> {
    let (value, rest) = words.split_first()?;
    if !has(VALUES, value) || value == "y" {
        return None;
    }
    let count = rest.len();
    let has_unit = count >= 2
        && matches!([rest[count - 2].as_str(), rest[count - 1].as_str()], ["1", "sr"] | ["sr", "1"]);
    let rest = rest[..count - if has_unit { 2 } else { 0 }].iter();
    let rest: String =
        rest.filter(|word| !has("pol polarised polarized", word)).map(String::as_str).collect();
    let bare = rest.trim_end_matches(|c: char| c.is_ascii_digit());
    match rest.as_str() {
        "s" | "te" | "perpendicular" | "senkrecht" | "spol" => Some(Role::Polarised(0)),
        "p" | "tm" | "parallel" | "ppol" => Some(Role::Polarised(1)),
        _ if bare.len() < rest.len() && has(REPEATED, bare) => Some(Role::Repeated),
        _ => None,
    }
}

/// Whether a name is that of a logarithm of the value: `log10(BRDF)`, `BRDF [dB]`.
fn is_logarithm(plain: &str, kept: &str) -> bool {
    let before = ["log10", "log", "lg", "ln"].iter().find_map(|log| kept.strip_prefix(log));
    let is_value = |name: &str| has(VALUES, name) && !name.is_empty();
    before.is_some_and(is_value)
        || ["[db]", "(db)", "_db", " db", "decibel"].iter().any(|end| plain.ends_with(end))
}

/// A value at a wavelength: a number with nothing but a unit or a plain word about it. A unit or three digits make it a wavelength.
fn spectral(plain: &str) -> Option<Role> {
    let micro = ["um", "\u{b5}m", "\u{3bc}m", "micron", "microns"];
    let plain = ["1/sr", "sr^-1", "sr-1", "sr\u{207b}\u{b9}"]
        .iter()
        .fold(plain.to_owned(), |name, unit| name.replace(unit, ""));
    let without: String = plain.chars().filter(|c| !" _-[](){}/=:@".contains(*c)).collect();
    let (bare, unit) = match without.strip_suffix("nm") {
        Some(bare) => (bare.to_owned(), Some(1.0)),
        None => match micro.iter().find_map(|unit| without.strip_suffix(unit)) {
            Some(bare) => (bare.to_owned(), Some(1e3)),
            None => (without.clone(), None),
        },
    };
    let number = |text: &str| text.replace(',', ".").parse::<f64>().ok();
    let starts = BEFORE_WAVELENGTH.split(' ').filter_map(|before| bare.strip_prefix(before));
    let found = std::iter::once(bare.as_str()).chain(starts).find_map(number)?;
    let digits = bare.chars().filter(char::is_ascii_digit).count();
    Some(match found {
        w if !w.is_finite() => Role::NoWavelength,
        w if unit.is_some() || digits >= WAVELENGTH_DIGITS => Role::At(w * unit.unwrap_or(1.0)),
        w => Role::Numbered(w),
    })
}

/// The words of a name, in lower case: at changes of case, at signs, at brackets. Greek letters are words.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = vec![String::new()];
    let mut last = ' ';
    for c in name.chars() {
        let greek = match c {
            '\u{3b8}' | '\u{3d1}' | '\u{398}' => Some("theta"),
            '\u{3c6}' | '\u{3d5}' | '\u{3a6}' => Some("phi"),
            '\u{3bb}' => Some("lambda"),
            '\u{394}' | '\u{3b4}' => Some("delta"),
            '\u{3c9}' => Some("w"),
            '\u{3c1}' => Some("rho"),
            _ => None,
        };
        // Of units: `sr⁻¹`.
        let c = if c == '\u{b9}' { '1' } else { c };
        if let Some(word) = greek {
            words.extend([word.to_owned(), String::new()]);
        } else if !c.is_alphanumeric() {
            words.push(String::new());
        } else {
            if c.is_uppercase() && last.is_lowercase() {
                words.push(String::new());
            }
            if let Some(word) = words.last_mut() {
                word.extend(c.to_lowercase());
            }
        }
        last = c;
    }
    words.retain(|word| !word.is_empty());
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_spellings_are_known() {
        use Role::*;
        use Side::*;
        for (names, role) in [
            (
                "theta_i|thetaI|Theta In|theta_i [deg]|\u{3b8}i|\u{3b8}_i (\u{b0})|AOI|Angle d'incidence|Incident_angle|theta_l|light zenith|\
              Angle of incidence|incident_theta|theta_in_rad|zenith_i|sza|Incidence Angle",
                Theta(Incident),
            ),
            (
                "theta_o|thetaO|theta_r|THETA_V|Measure_angle|scatter angle|view zenith|theta_out|detector angle|vza|\
              reflected polar angle",
                Theta(Outgoing),
            ),
            ("Einfallswinkel|Einfallswinkel [°]|Incidence (deg)|Lichtquelle Zenitwinkel", Theta(Incident)),
            (
                "Beobachtungswinkel|Ausfallswinkel (Grad)|Scatter (deg)|angle de réflexion|Detektorwinkel",
                Theta(Outgoing),
            ),
            ("Einfallsazimut|Azimut Beleuchtung", Phi(Incident)),
            (
                "Azimut Beobachtung [°]|azimut observación|azimut d'observation|Beobachtungsazimut",
                Phi(Outgoing),
            ),
            ("Azimut Goniometerkopf|azimuth of table", OddPhi),
            (
                "rotation|Rotation [deg]|sample rotation|sample angle|SampleRotation|stage_rotation|sample azimuth (deg)|psi|Drehwinkel [°]",
                Turn,
            ),
            ("angle|angle [deg]", ThetaAlone),
            ("cos_i|cosThetaI|mu0", Cosine(Incident)),
            ("cos_theta_o|mu", Cosine(Outgoing)),
            ("sun_elevation|elevation|grazing angle", Elevation),
            ("入射天顶角|入射角", Theta(Incident)),
            ("观测天顶角|受光角", Theta(Outgoing)),
            ("相对方位角|方位角", DeltaPhi),
            ("BRDF_s|BRDF TE [1/sr]", Polarised(0)),
            ("BRDF p-pol", Polarised(1)),
            ("BRDF_run_1|value rep 2", Repeated),
            ("mean|BRDF mean|FRDB (sr-1)|I/F", Value),
            ("BRF_red", Rgb(0)),
            ("Lichteinfall [°]|theta_i [gon]", Theta(Incident)),
            ("emission|AOR", Theta(Outgoing)),
            ("theta_s", Theta(Either)),
            ("theta", ThetaAlone),
            ("phi_i|phiI|azimuth_i|Incident azimuth|\u{3c6}_i|light azimuth angle", Phi(Incident)),
            ("phi_o|phi_r|phi_v|view azimuth|azimuth_out|PhiOut", Phi(Outgoing)),
            (
                "azimut relativo|relativer Azimut|phi|dphi|delta_phi|\u{394}\u{3c6}|relative azimuth|azimuth",
                DeltaPhi,
            ),
            ("wi_x|wix|ix|l_x|light_x|Wi.x|in_x|w_i_x", Vector(Incident, 0)),
            ("wo_z|oz|v_z|view z|out_z", Vector(Outgoing, 2)),
            ("value|BRDF|brdf [1/sr]|f_r|reflectance|BRDF (sr-1)|f", Value),
            ("ángulo de incidencia|angolo di incidenza", Theta(Incident)),
            ("ángulo de observación|angolo di osservazione", Theta(Outgoing)),
            ("r|R|red|brdf_r|linear R|rot|rouge|rojo", Rgb(0)),
            ("grün|vert|verde", Rgb(1)),
            ("b|blue|f_b|blau|bleu|azul|blu", Rgb(2)),
            ("X|x", Xyz(0)),
            ("Y", Xyz(1)),
            ("wavelength|lambda|\u{3bb}|wavelength [nm]|Wavelength_nm|Wavelength (\u{b5}m)", Wavelength),
            (
                "400|400nm| 400 nm |wl_400|lambda400|\u{3bb}=400 nm|brdf_400nm|BRDF @ 400 nm (1/sr)|0.4um|0.4 \u{b5}m",
                At(400.0),
            ),
            ("NaN|inf|-inf|nan nm", NoWavelength),
            ("theta_h|halfangle", ThetaHalf),
            ("src_a|sun_a", Phi(Incident)),
            ("view_a|phi_d", Phi(Outgoing)),
            ("to-sun-zenith|Solar Zenith Angle|incidence", Theta(Incident)),
            ("to-sensor-zenith|sensor zenith|receive", Theta(Outgoing)),
            ("to-sun-azimuth", Phi(Incident)),
            ("SolZen", Theta(Incident)),
            ("x_i|xi", Vector(Incident, 0)),
            ("phase angle", Phase),
            ("Azimutdifferenz|phi_iv", DeltaPhi),
            ("phi_tilt", OddPhi),
            ("log10(BRDF)|ln f|BRDF [dB]|brdf_db|log_brdf", Logarithm),
            ("fr11|BRDF11|11", Numbered(11.0)),
            ("sigma|weight|comment|sample|uncertainty|date|n_x|index|std|BRDF_std", Other),
        ] {
            for name in names.split('|') {
                let found = super::role(name);
                let close = matches!((&found, &role), (At(a), At(b)) if (a - b).abs() < 1e-9 || (a - 0.4).abs() < 1e-9);
                assert!(found == role || close, "{name}: {found:?}, not {role:?}");
            }
        }
        assert_eq!(unit("theta_i [deg]"), Some(Unit::Degrees));
        assert_eq!(unit("\u{3b8} (\u{b0})"), Some(Unit::Degrees));
        assert_eq!(unit("theta_rad"), Some(Unit::Radians));
        assert_eq!(unit("theta_i"), None);
        assert_eq!(unit("theta_i [gon]"), Some(Unit::Gon));
        assert_eq!(beside("BRF_red"), Some(Beside::Pi));
        assert_eq!(beside("I/F"), Some(Beside::PiCosineIncident));
        assert_eq!(beside("ARS [1/sr]"), Some(Beside::CosineOutgoing));
        assert_eq!((beside("BRDF"), beside("reflectance")), (None, None));
        assert_eq!(unit("BRDF %"), Some(Unit::Percent));
    }
}
