//! Labelled pictures of one size side by side.

use anyhow::anyhow;
use glam::Vec3;
use plotters::prelude::*;
use srbf_reference_renderer::out::panel;
use srbf_reference_renderer::out::picture_file;

/// Pixels between pictures, and of the line of letters above each.
const GAP: u32 = 10;
const LETTERS: u32 = 20;
const FONT_SIZE: u32 = 14;

/// A picture and what stands above it.
pub struct Tile<'a> {
    pub label: String,
    pub picture: &'a [Vec3],
}

/// Least width of a picture on the sheet: what stands above it has room.
const LEAST_WIDTH: u32 = 200;

/// The bytes of a PNG file with all pictures in rows of `columns`, their pixels as many times larger as the letters need; all by one
/// exposure, which fits the middle of the first: the subject of the picture is there, whatever lies behind it.
///
/// # Errors
/// What plotters reports.
pub fn png(tiles: &[Tile<'_>], size: [u32; 2], columns: u32) -> anyhow::Result<Vec<u8>> {
    let scale = LEAST_WIDTH.div_ceil(size[0]);
    let [width, height] = size.map(|n| n * scale);
    let rows = (tiles.len() as u32).div_ceil(columns);
    let sheet = [columns * (width + GAP) + GAP, rows * (height + GAP + LETTERS) + GAP];
    let mut pixels = vec![255; 3 * sheet[0] as usize * sheet[1] as usize];
    let exposure =
        tiles.first().map_or(1.0, |tile| picture_file::automatic_exposure(&middle(tile.picture, size)));
    let place = |n: usize| {
        let (column, row) = (n as u32 % columns, n as u32 / columns);
        [GAP + column * (width + GAP), GAP + row * (height + GAP + LETTERS)]
    };
    for (n, tile) in tiles.iter().enumerate() {
        let shown = picture_file::tone_mapped(tile.picture, exposure);
        let [left, top] = place(n);
        for y in 0..height {
            for x in 0..width {
                let from = 3 * ((y / scale) * size[0] + x / scale) as usize;
                let to = 3 * ((top + LETTERS + y) * sheet[0] + left + x) as usize;
                pixels[to..to + 3].copy_from_slice(&shown[from..from + 3]);
            }
        }
    }
    let labels: Vec<(String, [u32; 2])> =
        tiles.iter().enumerate().map(|(n, t)| (t.label.clone(), place(n))).collect();
    write(&mut pixels, sheet, &labels).map_err(|error| anyhow!("cannot draw: {error}"))?;
    picture_file::encode_png(sheet, &pixels)
}

/// The middle half of a picture, across and down.
fn middle(picture: &[Vec3], [width, height]: [u32; 2]) -> Vec<Vec3> {
    let inside = |n: u32| n / 4..(3 * n).div_ceil(4);
    let row = |y: u32| inside(width).filter_map(move |x| picture.get((y * width + x) as usize));
    inside(height).flat_map(row).copied().collect()
}

fn write(pixels: &mut [u8], sheet: [u32; 2], labels: &[(String, [u32; 2])]) -> Result<(), panel::Failure> {
    panel::register_font()?;
    let root = BitMapBackend::with_buffer(pixels, sheet.into()).into_drawing_area();
    for (label, [left, top]) in labels {
        let place = (*left as i32, *top as i32 + 2);
        root.draw(&Text::new(label.as_str(), place, (panel::FONT, FONT_SIZE).into_font()))?;
    }
    root.present()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposure_is_that_of_the_middle() {
        // Dark in the middle of a bright picture.
        let size = [16, 8];
        let is_inside = |i: usize| (4..12).contains(&(i % 16)) && (2..6).contains(&(i / 16));
        let picture: Vec<Vec3> =
            (0..128).map(|i| Vec3::splat(if is_inside(i) { 0.01 } else { 5.0 })).collect();
        let found = middle(&picture, size);
        assert_eq!(found.len(), 32);
        assert!(found.iter().all(|&p| p == Vec3::splat(0.01)), "{found:?}");
        let sheet = png(&[Tile { label: "one".into(), picture: &picture }], size, 4).unwrap();
        assert!(sheet.starts_with(b"\x89PNG"));
    }
}
