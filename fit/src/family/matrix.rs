//! The matrix of a step, and the share that a view adds to it.

/// Linearisation in one view: half the gradient, and the Gauss-Newton matrix, by its unknowns.
pub(crate) struct Block<P> {
    pub place: P,
    /// Diagonal of the data term.
    pub scale: Vec<f64>,
    pub cost: f64,
    pub gradient: Vec<f64>,
    pub matrix: Vec<f64>,
}

impl<P> Block<P> {
    pub fn zeros(place: P, p: usize) -> Self {
        Self { place, scale: vec![0.0; p], cost: 0.0, gradient: vec![0.0; p], matrix: vec![0.0; p * p] }
    }
}

/// The Gauss-Newton matrix of all unknowns, for layouts L with places P.
pub(crate) trait Matrix<L, P>: Sized {
    fn zeros(layout: &L) -> Self;
    /// Zeros again, in the same memory where that is worth it.
    fn cleared(self, layout: &L) -> Self;
    /// Adds the gradient and the matrix of a view to those of the stored views round it.
    fn add_view(&mut self, layout: &L, block: &Block<P>, gradient: &mut [f64]);
    /// Adds the square of a sum of terms (unknown, factor).
    fn add_row(&mut self, terms: &[(usize, f64)]);
    /// The diagonal that damping is relative to.
    fn scale(&self) -> Vec<f64>;
    /// Solves `(matrix + diagonal added) step = downhill` for the unknowns that are free; 0 for the others.
    fn step(&mut self, added: &[f64], free: &[bool], downhill: Vec<f64>) -> Option<Vec<f64>>;
}
