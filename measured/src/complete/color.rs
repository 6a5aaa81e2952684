//! Colours as a completion sees them: CIE XYZ over that of white.
//!
//! Channels of linear sRGB are negative for saturated colours, and have no logarithm there. A channel that falls beside a
//! highlight would go on falling under it. X, Y and Z are never negative, and grey has three equal ones.

/// Linear sRGB to XYZ over that of its white, so that the rows add up to 1.
const TO_XYZ: [[f64; 3]; 3] = {
    let xyz = [
        [0.412_456_4, 0.357_576_1, 0.180_437_5],
        [0.212_672_9, 0.715_152_2, 0.072_175_0],
        [0.019_333_9, 0.119_192_0, 0.950_304_1],
    ];
    let mut rows = xyz;
    let mut i = 0;
    while i < 3 {
        let white = xyz[i][0] + xyz[i][1] + xyz[i][2];
        rows[i] = [xyz[i][0] / white, xyz[i][1] / white, xyz[i][2] / white];
        i += 1;
    }
    rows
};

/// The inverse.
const TO_RGB: [[f64; 3]; 3] = inverse(TO_XYZ);

const fn inverse(m: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut cofactors = [[0.0; 3]; 3];
    let (mut i, mut determinant) = (0, 0.0);
    while i < 3 {
        let mut j = 0;
        while j < 3 {
            let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
            cofactors[i][j] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
            j += 1;
        }
        determinant += if i == 0 {
            m[0][0] * cofactors[0][0] + m[0][1] * cofactors[0][1] + m[0][2] * cofactors[0][2]
        } else {
            0.0
        };
        i += 1;
    }
    let mut out = [[0.0; 3]; 3];
    let mut row = 0;
    while row < 3 {
        let mut column = 0;
        while column < 3 {
            out[row][column] = cofactors[column][row] / determinant;
            column += 1;
        }
        row += 1;
    }
    out
}

fn times(m: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2])
}

/// XYZ over that of white, of linear sRGB.
pub(super) fn xyz(rgb: [f64; 3]) -> [f64; 3] {
    times(&TO_XYZ, rgb)
}

/// Linear sRGB of XYZ over that of white.
pub(crate) fn rgb(xyz: [f64; 3]) -> [f64; 3] {
    times(&TO_RGB, xyz)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_come_back_and_grey_stays_grey() {
        for color in [[1.0, 0.0, 0.0], [-0.1, 0.7, 0.2], [0.3; 3]] {
            let back = rgb(xyz(color));
            assert!((0..3).all(|c| (back[c] - color[c]).abs() < 1e-12), "{color:?} {back:?}");
        }
        assert!(xyz([0.4; 3]).iter().all(|v| (v - 0.4).abs() < 1e-12));
        // A blue whose red is below 0 in sRGB, as of the wavelength 480 nm.
        assert!(xyz([-0.1, 0.25, 0.6]).iter().all(|v| *v > 0.0));
    }
}
