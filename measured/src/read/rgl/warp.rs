//! Bilinear grids over the unit square, and the warp that turns uniform points into points distributed as one, both ways.

use super::real::Real;

/// Numbers at the corners of cells, interpolated bilinearly; x along the rows.
#[derive(Clone, Debug)]
pub struct Grid<T = f64> {
    values: Vec<T>,
    columns: usize,
    rows: usize,
}

impl<T: Real> Grid<T> {
    /// The same in another precision.
    pub fn to<U: Real>(&self, convert: impl Fn(T) -> U) -> Grid<U> {
        Grid {
            values: self.values.iter().map(|v| convert(*v)).collect(),
            columns: self.columns,
            rows: self.rows,
        }
    }

    /// Index of the lower corner of the cell that a point lies in, and where in the cell.
    fn cell(&self, [x, y]: [T; 2]) -> (usize, [T; 2]) {
        let along = |v: T, n: usize| {
            let scaled = v.within_one() * T::of((n - 1) as f64);
            let low = scaled.index().min(n - 2);
            (low, scaled - T::of(low as f64))
        };
        let ((column, x), (row, y)) = (along(x, self.columns), along(y, self.rows));
        (row * self.columns + column, [x, y])
    }

    /// The interpolated number at a point of the unit square.
    pub fn value(&self, point: [T; 2]) -> T {
        let (at, [x, y]) = self.cell(point);
        let v = &self.values;
        let upper = at + self.columns;
        between(between(v[at], v[at + 1], x), between(v[upper], v[upper + 1], x), y)
    }
}

impl Grid {
    /// `None` if there is no cell, or another number of values.
    pub fn new(values: Vec<f64>, columns: usize, rows: usize) -> Option<Self> {
        let fits = columns >= 2 && rows >= 2 && columns.checked_mul(rows) == Some(values.len());
        fits.then_some(Self { values, columns, rows })
    }

    /// Whether some numbers are none.
    pub fn has_holes(&self) -> bool {
        self.values.iter().any(|v| v.is_nan())
    }

    /// The smallest number.
    pub fn least(&self) -> f64 {
        self.values.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The same with other numbers of columns and rows. Each number is the mean of its surroundings, weighed by a tent as wide as the
    /// new cells.
    pub fn resampled(&self, columns: usize, rows: usize) -> Self {
        let tents = |from: usize, to: usize| -> Vec<Vec<(usize, f64)>> {
            let width = (1.0 / (to - 1) as f64).max(1.0 / (from - 1) as f64);
            let tent = |n: usize| {
                let at = n as f64 / (to - 1) as f64;
                let share = |i: usize| (1.0 - (i as f64 / (from - 1) as f64 - at).abs() / width).max(0.0);
                let all: f64 = (0..from).map(share).sum();
                (0..from).map(|i| (i, share(i) / all)).filter(|term| term.1 > 0.0).collect()
            };
            (0..to).map(tent).collect()
        };
        let (across, down) = (tents(self.columns, columns), tents(self.rows, rows));
        let number = |n: usize| {
            let row = |r: usize| {
                across[n % columns].iter().map(move |(c, share)| share * self.values[r * self.columns + c])
            };
            down[n / columns].iter().map(|(r, share)| share * row(*r).sum::<f64>()).sum()
        };
        Self { values: (0..columns * rows).map(number).collect(), columns, rows }
    }

    /// How many columns, and how many rows.
    pub fn size(&self) -> [usize; 2] {
        [self.columns, self.rows]
    }

    /// A grid of the same size that is 0.
    pub fn zeros(&self) -> Self {
        Self { values: vec![0.0; self.values.len()], ..*self }
    }

    /// Adds `factor` times a grid of the same size.
    pub fn add_scaled(&mut self, factor: f64, other: &Self) {
        self.values.iter_mut().zip(&other.values).for_each(|(a, b)| *a += factor * b);
    }
}

/// The warp of a distribution: first a row by the marginal distribution, then a place in it by the conditional one.
#[derive(Clone, Debug)]
pub struct Warp<T = f64> {
    /// The distribution, its integral over the square 1 in units of cells.
    grid: Grid<T>,
    /// Running integral along each row.
    conditional: Vec<T>,
    /// Running integral over the rows.
    marginal: Vec<T>,
}

impl Warp {
    /// `None` if the distribution has no mass.
    pub fn new(mut grid: Grid) -> Option<Self> {
        grid.values.iter_mut().for_each(|v| *v = v.max(0.0));
        let mut conditional = Vec::with_capacity(grid.values.len());
        for row in grid.values.chunks_exact(grid.columns) {
            let mut sum = 0.0;
            conditional.push(0.0);
            conditional.extend(row.windows(2).map(|w| {
                sum += 0.5 * (w[0] + w[1]);
                sum
            }));
        }
        let whole: Vec<f64> = conditional.chunks_exact(grid.columns).map(|row| row[row.len() - 1]).collect();
        let mut marginal = vec![0.0];
        let mut sum = 0.0;
        marginal.extend(whole.windows(2).map(|w| {
            sum += 0.5 * (w[0] + w[1]);
            sum
        }));
        if sum <= 0.0 {
            return None;
        }
        [&mut grid.values, &mut conditional, &mut marginal].into_iter().flatten().for_each(|v| *v /= sum);
        Some(Self { grid, conditional, marginal })
    }
}

impl Warp {
    /// The same with as many columns and rows as that; `None` if it has no mass then.
    pub fn resampled(&self, side: usize) -> Option<Self> {
        Self::new(self.grid.resampled(side, side))
    }
}

impl<T: Real> Warp<T> {
    /// The same in another precision.
    pub fn to<U: Real>(&self, convert: impl Fn(T) -> U + Copy) -> Warp<U> {
        let all = |values: &[T]| values.iter().map(|v| convert(*v)).collect();
        Warp {
            grid: self.grid.to(convert),
            conditional: all(&self.conditional),
            marginal: all(&self.marginal),
        }
    }

    /// The uniform point that a blend of warps of one size, each with its share, takes to a point.
    pub fn invert(warps: &[(&Self, T)], point: [T; 2]) -> [T; 2] {
        let first = &warps[0].0.grid;
        let (at, [x, y]) = first.cell(point);
        let (columns, row) = (first.columns, at / first.columns);
        let mix = |f: &dyn Fn(&Self) -> T| {
            let inside = warps.iter().filter(|(_, share)| *share > T::of(0.0));
            inside.map(|(warp, share)| *share * f(warp)).sum::<T>()
        };
        let value = |i: usize| mix(&|w| w.grid.values[i]);
        let lerp = |from: T, to: T| from + y * (to - from);
        let (left, right) =
            (lerp(value(at), value(at + columns)), lerp(value(at + 1), value(at + columns + 1)));
        let running = |i: usize| mix(&|w| w.conditional[i]);
        let before = lerp(running(at), running(at + columns));
        let end = row * columns + columns - 1;
        let (low, high) = (running(end), running(end + columns));
        let along = before + x * (left + T::of(0.5) * x * (right - left));
        let whole = lerp(low, high);
        let across = mix(&|w| w.marginal[row]) + y * (low + T::of(0.5) * y * (high - low));
        [if whole > T::of(0.0) { along / whole } else { T::of(0.5) }, across]
    }

    /// The point that a blend of warps of one size takes a uniform point to; [`invert`](Self::invert) takes it back.
    pub fn sample(warps: &[(&Self, T)], u: [T; 2]) -> [T; 2] {
        let first = &warps[0].0.grid;
        let (columns, rows) = (first.columns, first.rows);
        let mix = |f: &dyn Fn(&Self) -> T| {
            let inside = warps.iter().filter(|(_, share)| *share > T::of(0.0));
            inside.map(|(warp, share)| *share * f(warp)).sum::<T>()
        };
        let marginal = |row: usize| mix(&|w| w.marginal[row]);
        let row = last_before(rows - 1, |row| marginal(row) <= u[1]);
        let whole = |row: usize| mix(&|w| w.conditional[row * columns + columns - 1]);
        let (low, high) = (whole(row), whole(row + 1));
        let y = solve(low, high, u[1] - marginal(row));
        let lerp = |from: T, to: T| from + y * (to - from);
        let at = row * columns;
        let running =
            |i: usize| lerp(mix(&|w| w.conditional[at + i]), mix(&|w| w.conditional[at + columns + i]));
        let target = u[0] * lerp(low, high);
        let column = last_before(columns - 1, |i| running(i) <= target);
        let value =
            |i: usize| lerp(mix(&|w| w.grid.values[at + i]), mix(&|w| w.grid.values[at + columns + i]));
        let x = solve(value(column), value(column + 1), target - running(column));
        let place = |cell: usize, inside: T, n: usize| (T::of(cell as f64) + inside) / T::of((n - 1) as f64);
        [place(column, x, columns), place(row, y, rows)]
    }

    /// The density of [`sample`](Self::sample) over the unit square.
    pub fn density(warps: &[(&Self, T)], point: [T; 2]) -> T {
        let cells = (warps[0].0.grid.columns - 1) * (warps[0].0.grid.rows - 1);
        T::of(cells as f64) * warps.iter().map(|(warp, share)| *share * warp.grid.value(point)).sum::<T>()
    }
}

/// The number that lies a share of the way from one to another, and never beyond them: rounding would take a small number next to a
/// large one to 0.
fn between<T: Real>(from: T, to: T, share: T) -> T {
    let (low, high) = if from <= to { (from, to) } else { (to, from) };
    let value = from + share * (to - from);
    // Not by `most` and `least`, which leave a NaN out: it is where nothing was measured.
    if value < low {
        low
    } else if value > high {
        high
    } else {
        value
    }
}

/// The last of `count` numbers from 0 on for which something holds that holds for 0 and then ends.
fn last_before(count: usize, holds: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, count);
    while high - low > 1 {
        let middle = (low + high) / 2;
        if holds(middle) { low = middle } else { high = middle }
    }
    low
}

/// The place in a cell, in [0, 1], where the integral of a linear function reaches a value; the function goes from one number to another.
fn solve<T: Real>(from: T, to: T, value: T) -> T {
    let (zero, two) = (T::of(0.0), T::of(2.0));
    let divisor = from + (from * from + two * value * (to - from)).most(zero).sqrt();
    if divisor > zero { (two * value / divisor).within_one() } else { zero }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_of_other_numbers_of_columns_and_rows_is_the_one_between_its_numbers() {
        let grid = Grid::new(vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0], 3, 2).unwrap();
        assert_eq!(grid.resampled(3, 2).values, grid.values);
        let finer = grid.resampled(5, 3);
        assert_eq!((finer.size(), finer.values.len()), ([5, 3], 15));
        for (n, value) in finer.values.iter().enumerate() {
            let wanted = 0.5 * (n % 5) as f64 + 1.5 * (n / 5) as f64;
            assert!((value - wanted).abs() < 1e-12, "{n}: {value} {wanted}");
        }
    }

    #[test]
    fn a_grid_stays_between_its_numbers_at_any_ratio_of_them() {
        for large in [1.0, 1e8, 1e17, 1e30] {
            let grid = Grid::new(vec![large, 1.0, 1.0, large], 2, 2).unwrap();
            for share in [0.0, 1e-17, 0.3, 1.0 - f64::EPSILON, 1.0] {
                for point in [[share, 0.0], [0.0, share], [share, share], [1.0, share]] {
                    let value = grid.value(point);
                    assert!((1.0..=large).contains(&value), "{large}, {point:?}: {value}");
                }
            }
        }
        let hole = Grid::new(vec![f64::NAN, 1.0, 1.0, 1.0], 2, 2).unwrap();
        assert!(hole.value([0.5, 0.5]).is_nan());
    }

    #[test]
    fn a_constant_warps_to_itself_and_corners_to_corners() {
        let flat = Warp::new(Grid::new(vec![2.0; 12], 4, 3).unwrap()).unwrap();
        for p in [[0.0, 0.0], [0.3, 0.8], [1.0, 1.0]] {
            let q = Warp::invert(&[(&flat, 0.3), (&flat, 0.7)], p);
            assert!((p[0] - q[0]).abs() < 1e-12 && (p[1] - q[1]).abs() < 1e-12, "{p:?} {q:?}");
        }
        let slope = Warp::new(Grid::new((0..12).map(f64::from).collect(), 4, 3).unwrap()).unwrap();
        assert!((Warp::invert(&[(&slope, 1.0)], [1.0, 1.0])[1] - 1.0).abs() < 1e-12);
        assert!(Warp::new(Grid::new(vec![0.0; 4], 2, 2).unwrap()).is_none());
    }

    #[test]
    fn a_sample_goes_back_to_where_it_came_from() {
        let grid = |shift: usize| {
            Grid::new((0..20).map(|i| ((i * 7 + shift) % 5) as f64 + 0.1).collect(), 5, 4).unwrap()
        };
        let warps = [Warp::new(grid(0)).unwrap(), Warp::new(grid(3)).unwrap()];
        let blend = [(&warps[0], 0.3), (&warps[1], 0.7)];
        let mut mean = 0.0;
        for i in 0..40_000 {
            let u = [(0.5 + f64::from(i % 200)) / 200.0, (0.5 + f64::from(i / 200)) / 200.0];
            let point = Warp::sample(&blend, u);
            let back = Warp::invert(&blend, point);
            assert!((back[0] - u[0]).abs() < 1e-9 && (back[1] - u[1]).abs() < 1e-9, "{u:?} {back:?}");
            mean += 1.0 / Warp::density(&blend, point) / 40_000.0;
        }
        // The mean of the inverse of the density is the area.
        assert!((mean - 1.0).abs() < 1e-3, "{mean}");
        // Corners, and cells without mass, stay in the square.
        let hollow = Warp::new(Grid::new(vec![0.0, 0.0, 0.0, 0.0, 0.0, 1.0], 3, 2).unwrap()).unwrap();
        for u in [[0.0, 0.0], [0.999_999, 0.999_999], [0.0, 0.5]] {
            let point = Warp::sample(&[(&hollow, 1.0)], u);
            assert!(point.iter().all(|v| (0.0..=1.0).contains(v)), "{point:?}");
        }
    }

    #[test]
    fn the_density_of_the_warp_is_the_grid() {
        let grid = Grid::new(vec![1.0, 2.0, 0.5, 3.0, 1.0, 2.5, 0.2, 1.4, 2.0], 3, 3).unwrap();
        let warp = Warp::new(grid).unwrap();
        let h = 1e-5;
        for p in [[0.2, 0.3], [0.7, 0.1], [0.6, 0.9]] {
            let at = |dx: f64, dy: f64| Warp::invert(&[(&warp, 1.0)], [p[0] + dx, p[1] + dy]);
            let (x1, x0, y1, y0) = (at(h, 0.0), at(-h, 0.0), at(0.0, h), at(0.0, -h));
            let determinant =
                ((x1[0] - x0[0]) * (y1[1] - y0[1]) - (x1[1] - x0[1]) * (y1[0] - y0[0])) / (4.0 * h * h);
            // Four cells: a density over the square is four times one over cells.
            assert!(
                (determinant - 4.0 * warp.grid.value(p)).abs() < 1e-4,
                "{determinant} {}",
                warp.grid.value(p)
            );
        }
    }
}
