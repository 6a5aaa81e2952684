//! A figure as text, and whether two are the same.

/// The result of a command.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    pub name: String,
    /// With the digits that documents show.
    pub value: String,
    /// Whether every digit counts; else the last one may differ by one, as chance and instruction sets round it.
    is_exact: bool,
}

impl Figure {
    /// A count.
    pub fn count(name: impl Into<String>, value: usize) -> Self {
        Self { name: name.into(), value: value.to_string(), is_exact: true }
    }

    /// A number with `digits` digits after the point.
    pub fn rounded(name: impl Into<String>, value: f64, digits: usize) -> Self {
        Self { name: name.into(), value: format!("{value:.digits$}"), is_exact: false }
    }

    /// A small number with two digits and a power of ten.
    pub fn small(name: impl Into<String>, value: f64) -> Self {
        Self { name: name.into(), value: format!("{value:.1e}"), is_exact: false }
    }

    /// One that is kept in the table.
    pub fn kept(name: &str, value: &str) -> Self {
        Self { name: name.to_owned(), value: value.to_owned(), is_exact: false }
    }

    /// Whether a document that states this is right.
    pub fn is(&self, stated: &str) -> bool {
        let (Ok(here), Ok(there)) = (self.value.parse::<f64>(), stated.parse::<f64>()) else { return false };
        let slack = if self.is_exact { 0.0 } else { 1.01 * unit(&self.value) };
        (here - there).abs() <= slack
    }
}

/// The value of one in the last digit.
fn unit(number: &str) -> f64 {
    let (digits, power) = number.split_once('e').unwrap_or((number, "0"));
    let after = digits.trim_end_matches('.').split_once('.').map_or(0, |(_, after)| after.len());
    10f64.powi(power.parse::<i32>().unwrap_or(0) - after as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_digit_may_differ_by_one_and_no_more() {
        let small = Figure::small("a", 3.9e-6);
        assert!(small.is("3.9e-6") && small.is("4.0e-6") && small.is("4e-6") && !small.is("4.1e-6"));
        let rounded = Figure::rounded("b", 0.206_688_4, 6);
        assert!(rounded.is("0.206688") && rounded.is(".206689") && !rounded.is("0.201827"));
        assert!(Figure::count("c", 4184).is("4184") && !Figure::count("c", 4184).is("4185"));
        assert!(!small.is("many") && !Figure::rounded("d", f64::NAN, 1).is("NaN"));
    }
}
