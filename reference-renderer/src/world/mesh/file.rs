//! Reads meshes: Wavefront `.obj` and `.ply`. Positions, faces and coordinates on maps are used; the normals are made smooth.

use super::Mesh;
use super::build::{add_fan, build, coordinates, vertex};
use crate::out::print::{ending, shown};
use anyhow::{Context, bail, ensure};
use glam::Vec2;
use std::path::Path;

/// Largest file that is read, bytes.
const MAX_FILE: u64 = 1 << 30;

/// Reads a mesh, its format told by the name's extension.
///
/// # Errors
/// Names the file, and the line or byte at which something else was expected.
pub fn read(path: &Path) -> anyhow::Result<Mesh> {
    let open = || from_bytes(&srbf_fit::read_at_most(path, MAX_FILE)?, &ending(path));
    open().with_context(|| format!("mesh {}", shown(path)))
}

/// Reads a mesh from the bytes of a file whose name has an ending, in small letters.
///
/// # Errors
/// Names the line or byte at which something else was expected.
pub fn from_bytes(bytes: &[u8], ending: &str) -> anyhow::Result<Mesh> {
    match ending {
        "obj" => from_obj(bytes),
        "ply" => super::ply::from_ply(bytes),
        _ => bail!("a name that ends in .obj or .ply is expected"),
    }
}

fn from_obj(bytes: &[u8]) -> anyhow::Result<Mesh> {
    let (mut positions, mut triangles, mut polygon) = (Vec::new(), Vec::new(), Vec::new());
    let (mut places, mut mapped, mut map_polygon) = (Vec::<Vec2>::new(), Vec::new(), Vec::new());
    for (number, line) in bytes.split(|&b| b == b'\n').enumerate() {
        // Comments and names may be in any encoding.
        let line = String::from_utf8_lossy(line);
        let mut words = line.split_whitespace();
        let read = || -> anyhow::Result<()> {
            match words.next() {
                Some("v") => {
                    let mut next = || coordinate(words.next().context("a vertex has three coordinates")?);
                    positions.push(vertex([next()?, next()?, next()?])?);
                }
                Some("vt") => {
                    // The second may be missing, and a third may follow.
                    let first = coordinate(words.next().context("coordinates on a map are expected")?)?;
                    let second = words.next().map_or(Ok(0.0), coordinate)?;
                    places.push(coordinates([first, second])?);
                }
                Some("f") => {
                    polygon.clear();
                    map_polygon.clear();
                    for word in words {
                        let mut numbers = word.split('/');
                        polygon.push(obj_index(numbers.next().unwrap_or_default(), positions.len(), word)?);
                        // A corner without coordinates lies at 0.
                        let number = numbers.next().filter(|number| !number.is_empty() && !places.is_empty());
                        let place = number.map(|number| obj_index(number, places.len(), word)).transpose()?;
                        map_polygon.push(place.map_or(Vec2::ZERO, |i| places[i as usize]));
                    }
                    ensure!(polygon.len() >= 3, "a face of at least three vertices is expected");
                    add_fan(&polygon, &mut triangles);
                    add_fan(&map_polygon, &mut mapped);
                }
                _ => {}
            }
            Ok(())
        };
        read().with_context(|| format!("line {}", number + 1))?;
    }
    if places.is_empty() {
        mapped.clear();
    }
    build(positions, triangles, mapped)
}

fn coordinate(word: &str) -> anyhow::Result<f32> {
    word.parse().with_context(|| format!("a coordinate is expected, found {word}"))
}

/// The entry that `7` or `-1` names, of those read so far, in a corner such as `7/1` or `7//3`.
fn obj_index(number: &str, count: usize, word: &str) -> anyhow::Result<u32> {
    let number: Option<i64> = number.parse().ok();
    let index = match number {
        Some(n) if n > 0 => Some(n - 1),
        Some(n) if n < 0 => n.checked_add(count as i64),
        _ => None,
    };
    match index {
        Some(i) if (0..count as i64).contains(&i) => Ok(u32::try_from(i)?),
        _ => bail!("the number of one of the {count} vertices above is expected, found {word}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    const CUBE_CORNER: &str =
        "# comment \u{e9}\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1 2/5 3//1 -1\n";

    #[test]
    fn polygons_become_fans_and_normals_are_smooth() {
        let mesh = from_obj(CUBE_CORNER.as_bytes()).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert!(mesh.normals.iter().all(|&n| n == Vec3::Z));
    }

    #[test]
    fn corners_have_coordinates_of_their_own() {
        let text =
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.5\nvt 0.25 0.75 0\nf 1/1 1/1 2/2\nf 1/1 2/-1 3/2 4\n";
        let mesh = from_obj(text.as_bytes()).unwrap();
        let [a, b] = [Vec2::new(0.5, 0.0), Vec2::new(0.25, 0.75)];
        // The first face has no area, and is left out with its coordinates.
        assert_eq!(mesh.coordinates, [[a, b, b], [a, b, Vec2::ZERO]]);
        assert!(from_obj(CUBE_CORNER.as_bytes()).unwrap().coordinates.is_empty());
        for wrong in ["vt nan 0\n", "vt\n", "vt 0 x\n", "vt 0 0\nv 0 0 0\nf 1/2 1 1\n"] {
            assert!(from_obj([text, wrong].concat().as_bytes()).is_err() || wrong.contains("1/2"), "{wrong}");
        }
        assert!(from_obj(b"v 0 0 0\nvt 0 0\nf 1/2 1 1").is_err());
    }

    #[test]
    fn of_triangles_with_the_same_corners_one_is_left() {
        // The other way round, by other vertices at the same places, and with the other zero.
        let again = "v 0 0 0\nv 1 0 -0\nv 1 1 0\nf 1 2 3\nf 3 2 1\nf 5 6 7\nf 2 3 1\n";
        let mesh = from_obj([CUBE_CORNER, again].concat().as_bytes()).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert!(mesh.normals[..4].iter().all(|&n| n == Vec3::Z));
    }

    #[test]
    fn every_truncation_is_an_error_or_a_smaller_mesh() {
        for end in 0..CUBE_CORNER.len() {
            if let Ok(mesh) = from_obj(&CUBE_CORNER.as_bytes()[..end]) {
                assert!(mesh.triangles.len() <= 2 && mesh.positions.len() <= 4);
            }
        }
        // Before the first face is complete there is no mesh.
        let face = CUBE_CORNER.find("f 1").unwrap();
        for end in 0..=face + 8 {
            assert!(from_obj(&CUBE_CORNER.as_bytes()[..end]).is_err(), "{end}");
        }
    }

    #[test]
    fn errors_name_the_line() {
        for (line, text) in [
            (1, "v 0 x 0"),
            (1, "v 0 nan 0"),
            (1, "v 0 inf 0"),
            (1, "v 1 2"),
            (2, "v 0 0 0\nf 1 2 3"),
            (2, "v 0 0 0\nf 1 1"),
            (2, "v 0 0 0\nf 0 1 1"),
            (2, "v 0 0 0\nf 1 1 -2"),
            (2, "v 0 0 0\nf 1 1 -9223372036854775808"),
            (2, "v 0 0 0\nf 1 1 99999999999999999999"),
        ] {
            let error = format!("{:#}", from_obj(text.as_bytes()).unwrap_err());
            assert!(error.contains(&format!("line {line}")), "{text}: {error}");
        }
        assert!(from_obj(b"").is_err());
        assert!(from_obj(b"v 0 0 0\nf 1 1 1").is_err());
    }

    #[test]
    #[ignore = "needs SRBF_DATA_DIR"]
    fn published_meshes_load() {
        let folder = std::env::var_os("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the folder of the data");
        // Faces of the file, and those that lie where another lies.
        for (name, faces, repeated) in [
            ("happy_buddha_100k.ply", 100_000, 24),
            ("happy_buddha_20k.ply", 20_000, 0),
            ("stanford_dragon_res3.ply", 47_794, 1254),
            ("stanford_dragon_res4_ascii.ply", 11_102, 502),
            ("stanford_bunny_small.obj", 3674, 0),
            ("teapot_6320.obj", 6320, 0),
        ] {
            let mesh = read(&Path::new(&folder).join("meshes").join(name)).unwrap();
            assert_eq!(mesh.triangles.len() + repeated, faces, "{name}");
        }
    }
}
