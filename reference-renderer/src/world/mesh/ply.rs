//! Reads `.ply`, text and little-endian binary.

use super::Mesh;
use super::build::{add_fan, build, coordinates, vertex};
use anyhow::{Context, bail, ensure};
use glam::{Vec2, Vec3};

/// Most vertices of one face.
const MAX_POLYGON: usize = 1024;

/// One property of an element; a list has the type of its count in front.
struct Property {
    name: String,
    count: Option<Kind>,
    kind: Kind,
}

struct Element {
    name: String,
    rows: usize,
    properties: Vec<Property>,
}

/// Types of numbers, by their size in bytes.
#[derive(Clone, Copy)]
enum Kind {
    Signed(usize),
    Unsigned(usize),
    Float(usize),
}

impl Kind {
    fn parse(word: &str) -> anyhow::Result<Self> {
        Ok(match word {
            "char" | "int8" => Self::Signed(1),
            "short" | "int16" => Self::Signed(2),
            "int" | "int32" => Self::Signed(4),
            "uchar" | "uint8" => Self::Unsigned(1),
            "ushort" | "uint16" => Self::Unsigned(2),
            "uint" | "uint32" => Self::Unsigned(4),
            "float" | "float32" => Self::Float(4),
            "double" | "float64" => Self::Float(8),
            _ => bail!("a type of number is expected, found {word}"),
        })
    }
}

/// The numbers behind the header, one after the other. f64 holds every one of them exactly.
enum Numbers<'a> {
    Text(std::str::SplitAsciiWhitespace<'a>),
    Binary(&'a [u8]),
}

impl Numbers<'_> {
    fn next(&mut self, kind: Kind) -> anyhow::Result<f64> {
        match self {
            Self::Text(words) => {
                let word = words.next().context("the file ends early")?;
                word.parse().with_context(|| format!("a number is expected, found {word}"))
            }
            Self::Binary(bytes) => {
                let (Kind::Signed(size) | Kind::Unsigned(size) | Kind::Float(size)) = kind;
                let (head, rest) = bytes.split_at_checked(size).context("the file ends early")?;
                *bytes = rest;
                let mut padded = [0; 8];
                padded[..size].copy_from_slice(head);
                let bits = u64::from_le_bytes(padded);
                let unused = 64 - 8 * size as u32;
                Ok(match kind {
                    Kind::Unsigned(_) => bits as f64,
                    Kind::Signed(_) => (((bits << unused) as i64) >> unused) as f64,
                    Kind::Float(4) => f64::from(f32::from_bits(bits as u32)),
                    Kind::Float(_) => f64::from_bits(bits),
                })
            }
        }
    }
}

/// Reads a mesh: x, y and z of the element `vertex`, the list `vertex_indices` of the element `face`; coordinates on maps of either, u and v
/// of a vertex (s and t, texture_u and texture_v) or the list `texcoord` of a face.
pub fn from_ply(bytes: &[u8]) -> anyhow::Result<Mesh> {
    let (elements, is_text, body) = header(bytes)?;
    let mut numbers = if is_text {
        Numbers::Text(std::str::from_utf8(body).context("text is expected")?.split_ascii_whitespace())
    } else {
        Numbers::Binary(body)
    };
    let (mut positions, mut triangles, mut polygon) = (Vec::<Vec3>::new(), Vec::new(), Vec::new());
    let (mut places, mut mapped, mut is_mapped) = (Vec::<Vec2>::new(), Vec::new(), false);
    for element in &elements {
        for row in 0..element.rows {
            let mut read = || -> anyhow::Result<()> {
                let (mut position, mut place) = ([f32::NAN; 3], [0.0; 2]);
                let (mut face, mut on_map) = (Vec::<u32>::new(), Vec::<f64>::new());
                for property in &element.properties {
                    let length = match property.count {
                        None => 1,
                        Some(kind) => numbers.next(kind)? as usize,
                    };
                    ensure!(length <= MAX_POLYGON, "a list of at most {MAX_POLYGON} numbers is expected");
                    polygon.clear();
                    for _ in 0..length {
                        polygon.push(numbers.next(property.kind)?);
                    }
                    match (element.name.as_str(), property.name.as_str(), property.count.is_some()) {
                        ("vertex", "x", false) => position[0] = polygon[0] as f32,
                        ("vertex", "y", false) => position[1] = polygon[0] as f32,
                        ("vertex", "z", false) => position[2] = polygon[0] as f32,
                        ("vertex", "u" | "s" | "texture_u", false) => {
                            (place[0], is_mapped) = (polygon[0] as f32, true);
                        }
                        ("vertex", "v" | "t" | "texture_v", false) => place[1] = polygon[0] as f32,
                        ("face", "texcoord", true) => on_map.clone_from(&polygon),
                        ("face", "vertex_indices" | "vertex_index", true) => {
                            let inside = |i: &f64| (0.0..positions.len() as f64).contains(i);
                            ensure!(
                                polygon.len() >= 3 && polygon.iter().all(inside),
                                "at least three numbers of the {} vertices are expected",
                                positions.len()
                            );
                            face = polygon.iter().map(|&i| i as u32).collect();
                        }
                        _ => {}
                    }
                }
                if element.name == "vertex" {
                    positions.push(vertex(position)?);
                    places.push(coordinates(place)?);
                }
                let corners: Vec<Vec2> = if on_map.is_empty() {
                    face.iter().map(|&i| places[i as usize]).collect()
                } else {
                    is_mapped = true;
                    ensure!(
                        on_map.len() == 2 * face.len(),
                        "two coordinates on a map for each corner are expected"
                    );
                    let pairs = on_map.chunks(2).map(|uv| coordinates([uv[0] as f32, uv[1] as f32]));
                    pairs.collect::<anyhow::Result<_>>()?
                };
                add_fan(&face, &mut triangles);
                add_fan(&corners, &mut mapped);
                Ok(())
            };
            read().with_context(|| format!("{} {row}", element.name))?;
        }
    }
    if !is_mapped {
        mapped.clear();
    }
    build(positions, triangles, mapped)
}

/// The elements, whether the numbers are text, and the bytes behind the header.
fn header(bytes: &[u8]) -> anyhow::Result<(Vec<Element>, bool, &[u8])> {
    let mut elements: Vec<Element> = Vec::new();
    let mut is_text = None;
    let mut rest = bytes;
    for number in 1.. {
        let end = rest.iter().position(|&b| b == b'\n').context("the header has no end_header line")?;
        let line = String::from_utf8_lossy(&rest[..end]).into_owned();
        rest = &rest[end + 1..];
        let words: Vec<&str> = line.split_whitespace().collect();
        let mut read = || -> anyhow::Result<bool> {
            match words.as_slice() {
                ["ply"] if number == 1 => {}
                _ if number == 1 => bail!("not a .ply file: ply is expected"),
                ["format", "ascii", _] => is_text = Some(true),
                ["format", "binary_little_endian", _] => is_text = Some(false),
                ["format", other, ..] => {
                    bail!("format {other} is not read, ascii and binary_little_endian are")
                }
                ["element", name, rows] => elements.push(Element {
                    name: (*name).to_owned(),
                    rows: rows
                        .parse()
                        .with_context(|| format!("a number of rows is expected, found {rows}"))?,
                    properties: Vec::new(),
                }),
                ["property", .., name] if words.len() == 3 || (words.len() == 5 && words[1] == "list") => {
                    let property = Property {
                        name: (*name).to_owned(),
                        count: if words.len() == 5 { Some(Kind::parse(words[2])?) } else { None },
                        kind: Kind::parse(words[words.len() - 2])?,
                    };
                    elements.last_mut().context("a property without an element")?.properties.push(property);
                }
                ["comment" | "obj_info", ..] | [] => {}
                ["end_header"] => return Ok(true),
                _ => bail!("a line of a .ply header is expected, found {line}"),
            }
            Ok(false)
        };
        if read().with_context(|| format!("line {number}"))? {
            break;
        }
    }
    // Rows without properties would take no bytes, and a header alone could announce any number of them.
    let empty = elements.iter().find(|e| e.properties.is_empty() && e.rows > 0);
    ensure!(empty.is_none(), "an element without properties");
    Ok((elements, is_text.context("a format line is expected in the header")?, rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "ply\nformat ascii 1.0\ncomment c\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

    fn binary() -> Vec<u8> {
        let mut bytes =
            TEXT[..TEXT.find("0 0 0").unwrap()].replace("ascii", "binary_little_endian").into_bytes();
        for v in [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
            bytes.extend(v.to_le_bytes());
        }
        bytes.push(3);
        for i in 0i32..3 {
            bytes.extend(i.to_le_bytes());
        }
        bytes
    }

    #[test]
    fn coordinates_are_of_vertices_or_of_corners() {
        let of_vertices = TEXT
            .replace("property float z", "property float z\nproperty float s\nproperty float t")
            .replace("0 0 0\n1 0 0\n0 1 0", "0 0 0 0.5 0\n1 0 0 1 0\n0 1 0 0 1");
        let want = [[Vec2::new(0.5, 0.0), Vec2::X, Vec2::Y]];
        assert_eq!(from_ply(of_vertices.as_bytes()).unwrap().coordinates, want);
        let of_corners = TEXT
            .replace("vertex_indices", "vertex_indices\nproperty list uchar float texcoord")
            .replace("3 0 1 2", "3 0 1 2 6 0.5 0 1 0 0 1");
        assert_eq!(from_ply(of_corners.as_bytes()).unwrap().coordinates, want);
        assert!(from_ply(of_corners.replace("6 0.5 0", "4 0.5 0").as_bytes()).is_err());
        assert!(from_ply(of_corners.replace("0.5", "nan").as_bytes()).is_err());
        assert!(from_ply(TEXT.as_bytes()).unwrap().coordinates.is_empty());
    }

    #[test]
    fn text_and_binary_are_the_same_mesh() {
        let (text, binary) = (from_ply(TEXT.as_bytes()).unwrap(), from_ply(&binary()).unwrap());
        assert_eq!(text.triangles, [[0, 1, 2]]);
        assert_eq!((text.positions, text.triangles), (binary.positions, binary.triangles));
    }

    #[test]
    fn every_truncation_is_an_error() {
        for end in 0..binary().len() {
            assert!(from_ply(&binary()[..end]).is_err(), "binary {end}");
        }
        // The last number and the line end behind it may be cut without a change that shows.
        for end in 0..TEXT.len() - 2 {
            assert!(from_ply(&TEXT.as_bytes()[..end]).is_err(), "text {end}");
        }
    }

    #[test]
    fn announced_numbers_are_not_believed() {
        for (from, to) in [
            ("vertex 3", "vertex 18446744073709551615"),
            ("vertex 3", "vertex -1"),
            ("vertex 3", "vertex 2"),
            ("3 0 1 2", "3 0 1 3"),
            ("3 0 1 2", "3 0 1 nan"),
            ("3 0 1 2", "1e9 0 1 2"),
            ("1 0 0", "1 nan 0"),
            ("property float x", "property float w"),
            ("property float x\nproperty float y\nproperty float z\n", ""),
            ("element face 1\n", ""),
            ("format ascii 1.0\n", ""),
            ("format ascii", "format binary_big_endian"),
        ] {
            assert!(from_ply(TEXT.replacen(from, to, 1).as_bytes()).is_err(), "{to}");
        }
    }
}
