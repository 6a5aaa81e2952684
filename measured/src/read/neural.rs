//! Neural BRDFs: fits of MERL materials by small networks (Sztrajman et al. 2021), as test input.
//!
//! One material is 675 little-endian f32: weights and biases of layers 6-21-21-3. Input is the half vector, turned to
//! azimuth 0, and the difference vector of Rusinkiewicz; activations are ReLU, ReLU, and `max(exp(x) - 1, 0)`.

use super::rusinkiewicz::{HalfAndDifference, half_and_difference};
use crate::ReadError;
use crate::table::Brdf;

/// Numbers of a material.
const NUMBERS: usize = 675;
const WIDTH: usize = 21;

/// Largest logarithm of a value: 1e30, beyond any surface. No damaged network gives infinity.
const LARGEST: f64 = 69.0;

/// One network.
#[derive(Clone, Debug, PartialEq)]
pub struct Neural {
    weights: Vec<f64>,
}

/// Refuses a file that holds no whole number of materials.
///
/// # Errors
/// [`ReadError::Content`] with the size.
pub fn check_size(bytes: u64) -> Result<(), ReadError> {
    let expected = 4 * NUMBERS as u64;
    if bytes > 0 && bytes.is_multiple_of(expected) {
        return Ok(());
    }
    Err(ReadError::Content(format!("{bytes} bytes; a multiple of {expected} was expected")))
}

/// Parses the weights of any number of materials.
///
/// # Errors
/// [`ReadError::Content`] if the length is not a multiple of a material's, or a number is not finite.
pub fn parse(bytes: &[u8]) -> Result<Vec<Neural>, ReadError> {
    check_size(bytes.len() as u64)?;
    let number = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let numbers: Vec<f64> = bytes.chunks_exact(4).map(number).collect();
    if let Some(n) = numbers.iter().position(|v| !v.is_finite()) {
        return Err(ReadError::Content(format!("weight {n} is not finite")));
    }
    Ok(numbers.chunks_exact(NUMBERS).map(|w| Neural { weights: w.to_vec() }).collect())
}

impl Brdf for Neural {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let HalfAndDifference { across, along, difference: [x, y, z] } = half_and_difference(wi, wo);
        let input = [across, 0.0, along, x, y, z];

        let (first, rest) = self.weights.split_at(7 * WIDTH);
        let (second, third) = rest.split_at((WIDTH + 1) * WIDTH);
        let mut a = [0.0; WIDTH];
        layer(first, &input, &mut a);
        a.iter_mut().for_each(|v| *v = v.max(0.0));
        let mut b = [0.0; WIDTH];
        layer(second, &a, &mut b);
        b.iter_mut().for_each(|v| *v = v.max(0.0));
        let mut out = [0.0; 3];
        layer(third, &b, &mut out);
        out.map(|v| libm::expm1(v.min(LARGEST)).max(0.0))
    }
}

/// `out = input W + b`, rows of W by input.
fn layer(weights: &[f64], input: &[f64], out: &mut [f64]) {
    let n = out.len();
    out.copy_from_slice(&weights[input.len() * n..(input.len() + 1) * n]);
    for (row, v) in weights.chunks_exact(n).zip(input) {
        out.iter_mut().zip(row).for_each(|(o, w)| *o += v * w);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_the_largest_weights_are_finite() {
        let networks = parse(&[f32::MAX.to_le_bytes(); NUMBERS].concat()).unwrap();
        let value = networks[0].evaluate([0.6, 0.0, 0.8], [0.0, 0.0, 1.0]);
        assert!(value.iter().all(|v| (1e29..=1e30).contains(v)), "{value:?}");
    }
}
