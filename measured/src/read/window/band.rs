//! Parts of the spectrum that a file of a window has values of.

/// Most bytes of a name.
const MOST: usize = 32;

/// A part of the spectrum, by its name in a file.
///
/// ```
/// use srbf_measured::read::window::Band;
///
/// assert_eq!(Band::parse("visible"), Ok(Band::default()));
/// assert_eq!(Band::parse("infrared")?.name(), "NIR");
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Band {
    name: [u8; MOST],
    count: usize,
}

impl Default for Band {
    /// The visible light, weighted by the sensitivity of the eye.
    fn default() -> Self {
        Self::of("Visible")
    }
}

impl Band {
    /// `visible`, `solar` (the whole spectrum of the sun), `infrared` (the near one), or a name as it stands in a file.
    ///
    /// # Errors
    /// The expected form.
    pub fn parse(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let text = if text.eq_ignore_ascii_case("infrared") { "NIR" } else { text };
        let fits = !text.is_empty() && text.len() <= MOST;
        let known = ["Visible", "Solar", "NIR"].into_iter().find(|name| name.eq_ignore_ascii_case(text));
        let expected = || {
            format!(
                "visible, solar, infrared, or the name of a band in the file, of up to {MOST} bytes, is expected"
            )
        };
        fits.then(|| Self::of(known.unwrap_or(text))).ok_or_else(expected)
    }

    /// Of a name that is short enough.
    fn of(text: &str) -> Self {
        let mut name = [0; MOST];
        name[..text.len()].copy_from_slice(text.as_bytes());
        Self { name, count: text.len() }
    }

    /// The name in a file.
    pub fn name(&self) -> &str {
        std::str::from_utf8(&self.name[..self.count]).unwrap_or_default()
    }

    /// Whether it is the visible light, of which a file may have colours.
    pub fn is_visible(&self) -> bool {
        *self == Self::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_short() {
        assert_eq!(Band::parse(" Solar ").map(|band| band.name().to_owned()), Ok("Solar".into()));
        assert_eq!(Band::parse("CIE-X").map(|band| band.name().to_owned()), Ok("CIE-X".into()));
        for odd in ["", "  ", &"x".repeat(33)] {
            assert!(Band::parse(odd).is_err(), "{odd}");
        }
    }
}
