//! Tensor trees of Radiance: values over squares that both directions are mapped to, in cells that are finer where values change.
//!
//! A direction is a point of the disk that it is projected to. The map of Shirley and Chiu (1997) makes a square of the disk, and keeps areas. So
//! equal cells are equal projected solid angles. A tree of four dimensions has the squares of both directions: of the one in which light
//! travels, and of the outgoing one. A tree of three dimensions is that of an isotropic sheet: the first dimension is the angle of
//! the light, and the outgoing direction is turned with it, so that light travels towards +x.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Halvings from which cells are as small as patches.
const SMALL: u32 = 4;

/// A cell, or a branch of 2^rank cells of half its size.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cell {
    /// The mean over the cell.
    mean: f32,
    /// The place of the first of the cells within; 0: none.
    first: u32,
}

/// A tensor tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    rank: usize,
    /// The root is the first. Cells within one follow each other; the lowest bit of their number is the half of the first dimension.
    cells: Vec<Cell>,
    depth: u32,
}

impl Tree {
    /// Most halvings: cells of a twentieth of a degree.
    pub const MOST_DEPTH: u32 = 12;

    /// Parses nested braces: a branch holds 2^rank trees, a leaf the values of a grid, of which the last dimension is the fastest. Values
    /// below 0 are 0.
    ///
    /// # Errors
    /// A text with the fault and its place; also for more than [`MOST_DEPTH`](Self::MOST_DEPTH) halvings.
    pub fn parse(text: &str, rank: usize, range: std::ops::RangeInclusive<f64>) -> Result<Self, String> {
        let tree = Self { rank, cells: vec![Cell { mean: 0.0, first: 0 }], depth: 0 };
        let mut reader = Reader { rest: text, count: 0, range, tree };
        reader.subtree(0, 0)?;
        match reader.next() {
            None => Ok(reader.tree),
            Some(_) => Err(reader.fault("more text after the tree")),
        }
    }

    /// Dimensions: 3 of an isotropic sheet, or 4.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Halvings down to the finest cell.
    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// The mean over the cell of `2^-depth` that holds a place, or over a larger one without cells within; and its own depth.
    fn cell(&self, mut at: [f64; 4], depth: u32) -> (f64, u32) {
        let (mut cell, mut own) = (self.cells[0], 0);
        while cell.first != 0 && own < depth {
            let mut number = 0;
            for (n, x) in at[..self.rank].iter_mut().enumerate() {
                *x *= 2.0;
                if *x >= 1.0 {
                    *x -= 1.0;
                    number |= 1 << n;
                }
            }
            cell = self.cells[cell.first as usize + number];
            own += 1;
        }
        (f64::from(cell.mean), own)
    }

    /// The place of two directions above the horizon: where light comes from, and where it goes.
    fn place(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 4] {
        if self.rank == 4 {
            let ([a, b], [c, d]) = (square(-wi[0], -wi[1]), square(wo[0], wo[1]));
            return [a, b, c, d];
        }
        let length = libm::hypot(wi[0], wi[1]);
        let [x, y] = if length > 0.0 { [-wi[0] / length, -wi[1] / length] } else { [1.0, 0.0] };
        let [a, b] = square(x * wo[0] + y * wo[1], x * wo[1] - y * wo[0]);
        // The upper half of the first dimension is empty.
        [(0.5 - 0.5 * length).clamp(0.0, 0.5 - 1e-9), a, b, 0.0]
    }

    /// The value of the cell that holds two directions, as it stands in the file.
    pub fn at(&self, wi: [f64; 3], wo: [f64; 3]) -> f64 {
        self.cell(self.place(wi, wo), u32::MAX).0
    }

    /// A value that is linear between the middles of cells, of those as large as the one that holds both directions.
    ///
    /// Between small incident cells the outgoing direction keeps its distance from the way straight on: so a peak there moves with the
    /// light, and does not fade from one cell to the next.
    pub fn between(&self, wi: [f64; 3], wo: [f64; 3]) -> f64 {
        let place = self.place(wi, wo);
        let depth = self.cell(place, u32::MAX).1;
        let count = f64::from(1u32 << depth);
        let glide = f64::from(u8::from(depth >= SMALL));
        // Middles of the cells before and after, and the share of the second.
        let beside = |x: f64| {
            let first = libm::floor(x * count - 0.5);
            ([first + 0.5, first + 1.5].map(|n| n / count), x * count - 0.5 - first)
        };
        let within = |x: f64| x.clamp(0.5 / count, 1.0 - 0.5 / count);
        let incident = self.rank - 2;
        let mut sum = 0.0;
        for corner in 0..1usize << incident {
            let (mut at, mut share) = (place, 1.0);
            for n in 0..incident {
                let (middles, part) = beside(place[n]);
                let second = corner >> n & 1;
                at[n] =
                    if self.rank == 4 { within(middles[second]) } else { middles[second].max(0.5 / count) };
                share *= if second == 1 { part } else { 1.0 - part };
            }
            if self.rank == 4 {
                [2, 3].iter().for_each(|&n| at[n] += glide * (at[n - 2] - place[n - 2]));
            } else {
                at[1] += glide * (place[0] - at[0]);
                // Beyond the normal light comes from the other side.
                if at[0] > 0.5 {
                    at = [1.0 - at[0], 1.0 - at[1], 1.0 - at[2], 0.0];
                }
            }
            let [across, along] = [at[incident], at[incident + 1]].map(beside);
            for corner in 0..4usize {
                let mut own = at;
                let mut part = share;
                for (n, (middles, second_part)) in [across, along].into_iter().enumerate() {
                    let second = corner >> n & 1;
                    own[incident + n] = within(middles[second]);
                    part *= if second == 1 { second_part } else { 1.0 - second_part };
                }
                if part > 0.0 {
                    sum += part * self.cell(own, depth).0;
                }
            }
        }
        sum
    }

    /// Share of the light at the normal that goes straight on, within the cells that touch that direction; cells that are larger than
    /// patches there count for nothing.
    pub fn straight(&self) -> f64 {
        const NEAR: f64 = 1e-9;
        let incident = self.rank - 2;
        let mut own = 0.0;
        for corner in 0..4 {
            let mut at = [0.5 - NEAR; 4];
            [0, 1].iter().filter(|n| corner >> *n & 1 == 1).for_each(|n| at[incident + n] = 0.5 + NEAR);
            let (value, depth) = self.cell(at, u32::MAX);
            own += if depth < SMALL { 0.0 } else { value / f64::from(1u32 << depth).powi(2) };
        }
        let all = self.slice([0.5 - NEAR; 4], 0, 1.0);
        if all > 0.0 { own / all } else { 0.0 }
    }

    /// The mean over all outgoing directions of the light of a place, of a cell of a size.
    fn slice(&self, mut at: [f64; 4], cell: usize, size: f64) -> f64 {
        let Cell { mean, first } = self.cells[cell];
        if first == 0 {
            return f64::from(mean) * size;
        }
        let incident = self.rank - 2;
        let mut number = 0;
        for (n, x) in at[..incident].iter_mut().enumerate() {
            *x *= 2.0;
            if *x >= 1.0 {
                *x -= 1.0;
                number |= 1 << n;
            }
        }
        (0..4usize).map(|o| self.slice(at, first as usize + number + (o << incident), 0.25 * size)).sum()
    }
}

/// The point of the unit square of one of the unit disk.
fn square(x: f64, y: f64) -> [f64; 2] {
    let r = libm::hypot(x, y).min(1.0);
    // Quarters of the disk about +x, +y, -x, -y are those of the square.
    let turn = libm::atan2(y, x);
    let quarter = libm::round(turn / FRAC_PI_2);
    let across = r * (turn - FRAC_PI_2 * quarter) / FRAC_PI_4;
    let [a, b] = match (quarter as i32).rem_euclid(4) {
        0 => [r, across],
        1 => [-across, r],
        2 => [-r, -across],
        _ => [across, -r],
    };
    [0.5 + 0.5 * a, 0.5 + 0.5 * b].map(|v| v.clamp(0.0, 1.0 - f64::EPSILON))
}

/// A text on its way to a tree.
struct Reader<'a> {
    rest: &'a str,
    /// Numbers so far.
    count: usize,
    range: std::ops::RangeInclusive<f64>,
    tree: Tree,
}

impl Reader<'_> {
    fn fault(&self, text: &str) -> String {
        format!("after {} numbers of the tree: {text}", self.count)
    }

    /// The next character that is neither white nor a comma.
    fn next(&mut self) -> Option<char> {
        self.rest = self.rest.trim_start_matches(|c: char| c.is_ascii_whitespace() || c == ',');
        self.rest.chars().next()
    }

    fn brace(&mut self, brace: char) -> Result<(), String> {
        if self.next() != Some(brace) {
            return Err(self.fault(&format!("`{brace}` was expected")));
        }
        self.rest = &self.rest[1..];
        Ok(())
    }

    /// A branch or a leaf, as the cell of a place.
    fn subtree(&mut self, place: usize, depth: u32) -> Result<(), String> {
        self.brace('{')?;
        if self.next() == Some('{') {
            if depth == Tree::MOST_DEPTH {
                return Err(self.fault(&format!("more than {} halvings", Tree::MOST_DEPTH)));
            }
            let first = self.branch(place)?;
            for n in 0..1 << self.tree.rank {
                self.subtree(first + n, depth + 1)?;
            }
            self.mean_of_branch(place);
        } else {
            self.leaf(place, depth)?;
        }
        self.brace('}')
    }

    /// Makes cells within one.
    fn branch(&mut self, place: usize) -> Result<usize, String> {
        let first = self.tree.cells.len();
        let number = u32::try_from(first).map_err(|_| self.fault("too many cells"))?;
        self.tree.cells[place].first = number;
        self.tree.cells.resize(first + (1 << self.tree.rank), Cell { mean: 0.0, first: 0 });
        Ok(first)
    }

    fn mean_of_branch(&mut self, place: usize) {
        let first = self.tree.cells[place].first as usize;
        let within = &self.tree.cells[first..first + (1 << self.tree.rank)];
        let sum: f64 = within.iter().map(|cell| f64::from(cell.mean)).sum();
        self.tree.cells[place].mean = (sum / within.len() as f64) as f32;
    }

    fn leaf(&mut self, place: usize, depth: u32) -> Result<(), String> {
        let mut values: Vec<f32> = Vec::new();
        while let Some(c) = self.next().filter(|c| *c != '}') {
            let end = self.rest.find(|c: char| c.is_ascii_whitespace() || ",{}".contains(c));
            let word = &self.rest[..end.unwrap_or(self.rest.len())];
            let number = word.parse::<f64>().ok().filter(|v| self.range.contains(v));
            let Some(value) = number.filter(|_| c != '{') else {
                let word: String = word.chars().take(40).collect();
                return Err(
                    self.fault(&format!("`{}` where a value was expected", srbf_core::printable(&word)))
                );
            };
            values.push(value.max(0.0) as f32);
            self.count += 1;
            self.rest = &self.rest[word.len()..];
        }
        if self.rest.is_empty() {
            return Err(self.fault("`}` was expected"));
        }
        let rank = self.tree.rank as u32;
        let halvings = (0..).take_while(|k| 1usize << (rank * k) < values.len()).count() as u32;
        if values.len() != 1 << (rank * halvings) {
            let text = format!("a leaf of {} values; 1, {} and so on are expected", values.len(), 1 << rank);
            return Err(self.fault(&text));
        }
        if depth + halvings > Tree::MOST_DEPTH {
            return Err(self.fault(&format!("more than {} halvings", Tree::MOST_DEPTH)));
        }
        self.tree.depth = self.tree.depth.max(depth + halvings);
        self.grid(place, &values, halvings, [0; 4], halvings)
    }

    /// The cells of a part of a grid of `2^side` values each way: that of `2^left` each way from a corner.
    fn grid(
        &mut self,
        place: usize,
        values: &[f32],
        side: u32,
        from: [usize; 4],
        left: u32,
    ) -> Result<(), String> {
        let rank = self.tree.rank;
        if left == 0 {
            let at = from[..rank].iter().fold(0, |at, n| (at << side) + n);
            self.tree.cells[place].mean = values[at];
            return Ok(());
        }
        let first = self.branch(place)?;
        for number in 0..1usize << rank {
            let mut from = from;
            from[..rank].iter_mut().enumerate().for_each(|(n, x)| *x += (number >> n & 1) << (left - 1));
            self.grid(first + number, values, side, from, left - 1)?;
        }
        self.mean_of_branch(place);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tree(text: &str, rank: usize) -> Result<Tree, String> {
        Tree::parse(text, rank, -1e6..=1e6)
    }

    #[test]
    fn the_square_keeps_areas_and_turns() {
        let mut counts = [[0usize; 4]; 4];
        let side = 400;
        for i in 0..side {
            for j in 0..side {
                let [x, y] = [i, j].map(|n| (2.0 * f64::from(n) + 1.0) / f64::from(side) - 1.0);
                if x * x + y * y < 1.0 {
                    let [a, b] = square(x, y);
                    counts[(4.0 * a) as usize][(4.0 * b) as usize] += 1;
                    let [c, d] = square(-x, -y);
                    assert!((a + c - 1.0).abs() < 1e-9 && (b + d - 1.0).abs() < 1e-9);
                }
            }
        }
        let mean = std::f64::consts::PI / 4.0 * f64::from(side * side) / 16.0;
        assert!(counts.iter().flatten().all(|n| (*n as f64 / mean - 1.0).abs() < 0.02), "{counts:?}");
        let (a, b) = (square(0.6, 0.0), square(0.0, -0.6));
        assert!((a[0] - 0.8).abs() < 1e-9 && (a[1] - 0.5).abs() < 1e-9, "{a:?}");
        assert!((b[0] - 0.5).abs() < 1e-9 && (b[1] - 0.2).abs() < 1e-9, "{b:?}");
    }

    #[test]
    fn leaves_and_branches_are_places() {
        // Light that comes from -x travels towards +x: the upper half of the first dimension.
        let grid = "{ 0 1 2 3 4 5 6 7, 8 9 10 11 12 13 14 15 }";
        let four = tree(grid, 4).unwrap();
        let z = |x: f64, y: f64| [x, y, libm::sqrt(1.0 - x * x - y * y)];
        assert_eq!(four.at(z(-0.5, 0.1), z(-0.5, -0.1)), 8.0);
        assert_eq!(four.at(z(0.5, -0.1), z(-0.5, 0.1)), 5.0);
        assert_eq!(four.at(z(0.5, 0.1), z(0.5, -0.1)), 2.0);
        // In branches the first dimension is the fastest.
        let numbers: String = (0..16).map(|n| format!("{{{n}}} ")).collect();
        let branches = tree(&format!("{{{numbers}}}"), 4).unwrap();
        assert_eq!(branches.at(z(-0.5, 0.1), z(-0.5, -0.1)), 1.0);
        assert_eq!(branches.at(z(0.5, 0.1), z(0.5, -0.1)), 4.0);
        // Of three dimensions, all turns are the same.
        let three = tree("{0 1 2 3 4 5 6 7}", 3).unwrap();
        assert_eq!(three.at(z(-0.5, 0.0), z(0.5, 0.1)), 3.0);
        assert_eq!(three.at(z(0.0, -0.5), z(-0.1, 0.5)), 3.0);
        assert_eq!(three.at(z(0.0, -0.5), z(-0.1, -0.5)), 1.0);
        assert_eq!((three.depth(), tree("{7}", 3).unwrap().depth()), (1, 0));
        assert_eq!(tree("{-7}", 3).unwrap().between(z(0.1, 0.2), z(0.5, 0.3)), 0.0);
    }

    #[test]
    fn what_is_no_tree_is_refused() {
        let bomb = "{".repeat(100_000);
        for (text, rank, words) in [
            ("", 3, "`{` was expected"),
            ("{}", 3, "a leaf of 0 values"),
            ("{1 2}", 3, "a leaf of 2 values; 1, 8"),
            ("{1 2 3 4 5 6 7 8", 3, "after 8 numbers of the tree: `}`"),
            ("{1} 2", 3, "more text"),
            ("{{1} {2}}", 4, "after 2 numbers of the tree: `{`"),
            ("{nan}", 3, "`nan` where a value"),
            ("{1 {2}}", 3, "after 1 numbers"),
            ("{1e9}", 3, "`1e9`"),
            (&bomb, 4, "more than 12 halvings"),
        ] {
            let error = tree(text, rank).unwrap_err();
            assert!(error.contains(words), "{error}: {words}");
        }
    }

    #[test]
    fn a_peak_moves_with_the_light() {
        // Cells that go straight on are bright.
        let bright = |n: usize| u8::from(n >> 8 == n & 255);
        let text: String = (0..16usize.pow(4)).map(|n| format!("{} ", bright(n))).collect();
        let peak = tree(&format!("{{{text}}}"), 4).unwrap();
        assert!((peak.straight() - 1.0).abs() < 1e-6, "{}", peak.straight());
        for n in 0..40 {
            let x = 0.02 * f64::from(n) - 0.4;
            let d = |x: f64| [x, 0.3, libm::sqrt(0.91 - x * x)];
            let (at, off) =
                (peak.between([-x, -0.3, d(x)[2]], d(x)), peak.between([-x, -0.3, d(x)[2]], d(x + 0.3)));
            assert!((at - 1.0).abs() < 0.01 && off < 1e-9, "{x}: {at} {off}");
        }
    }
}
