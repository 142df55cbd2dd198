//! Wavefront object files: `v`, `vt`, `vn`, `f`, `usemtl`, `mtllib`. Points, lines, curves and groups are not looked at.
//!
//! The format is lines of words, and read here rather than by a crate: `tobj` 4.0 panics on `Kd 1 2`, tells no line of what
//! is wrong, mixes up corners with and without normals, and fans polygons that are not convex.

use super::material::MeshMaterial;
use super::{FindBeside, ImportError, MeshFile, MeshPart, Room, TriangleMesh, is_sound, mtl};
use crate::geometry::polygon;
use glam::{DAffine3, DVec2, DVec3};
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

/// Bytes that a corner of a finished mesh takes, at most, with its place in the table of corners.
const CORNER_BYTES: usize = 128;

/// A line of text, numbered from 1; a `\` at the end of a line takes the next one in.
pub(super) struct NumberedLine<'t> {
    number: usize,
    text: Cow<'t, str>,
}

/// A line, taken apart.
pub(super) struct Line<'l> {
    number: usize,
    pub(super) keyword: &'l str,
    /// What follows the keyword, without white space at its ends and without a comment.
    pub(super) rest: &'l str,
}

/// The lines of a text that have anything on them.
pub(super) fn lines(bytes: &[u8]) -> impl Iterator<Item = NumberedLine<'_>> {
    let mut raw = bytes.split(|byte| *byte == b'\n').zip(1..);
    std::iter::from_fn(move || {
        let (first, number) = raw.next()?;
        let mut text = String::from_utf8_lossy(first);
        while let Some(end) = text.trim_end().strip_suffix('\\').map(str::len) {
            let mut whole = text.into_owned();
            whole.truncate(end);
            if let Some((next, _)) = raw.next() {
                whole.push(' ');
                whole.push_str(&String::from_utf8_lossy(next));
            }
            text = Cow::Owned(whole);
        }
        Some(NumberedLine { number, text })
    })
}

impl NumberedLine<'_> {
    pub(super) fn as_line(&self) -> Line<'_> {
        let text = self.text.split('#').next().unwrap_or_default().trim();
        let (keyword, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        Line {
            number: self.number,
            keyword,
            rest: rest.trim(),
        }
    }
}

impl Line<'_> {
    pub(super) fn wrong(&self, what: impl Into<String>) -> ImportError {
        ImportError::Line {
            line: self.number,
            what: what.into(),
        }
    }

    /// The first `N` words as numbers, which may be anything a float can be.
    pub(super) fn numbers<const N: usize>(&self) -> Result<[f64; N], ImportError> {
        let mut numbers = [0.0; N];
        let mut words = self.rest.split_whitespace();
        for number in &mut numbers {
            let word = words
                .next()
                .ok_or_else(|| self.wrong(format!("`{}` needs {N} numbers", self.keyword)))?;
            *number = word
                .parse()
                .map_err(|_| self.wrong(format!("`{}` is not a number", shortened(word))))?;
        }
        Ok(numbers)
    }

    /// The first `N` words as finite coordinates.
    fn coordinates<const N: usize>(&self) -> Result<[f64; N], ImportError> {
        let numbers = self.numbers::<N>()?;
        if numbers.iter().all(|x| is_sound(*x)) {
            return Ok(numbers);
        }
        Err(self.wrong("a coordinate is not a finite number of at most 1e15 m"))
    }
}

/// The beginning of a word, for a message.
fn shortened(word: &str) -> String {
    word.chars().take(24).collect()
}

/// A corner of a face: position, texture coordinates, normal.
type Corner = (u32, Option<u32>, Option<u32>);

/// Faces of one material that all have, or all lack, texture coordinates and normals.
struct Part {
    material: Option<usize>,
    has: [bool; 2],
    mesh: TriangleMesh,
    /// Looked up only, never iterated.
    known: HashMap<Corner, u32>,
}

/// A file while it is read.
struct Reader {
    room: Room,
    positions: Vec<DVec3>,
    uvs: Vec<DVec2>,
    normals: Vec<DVec3>,
    materials: Vec<MeshMaterial>,
    /// The last material of each name. Looked up only, never iterated.
    by_name: HashMap<String, usize>,
    /// The material of the faces that come next.
    material: Option<usize>,
    parts: Vec<Part>,
    /// By material and what they have. Looked up only, never iterated.
    places: HashMap<(Option<usize>, [bool; 2]), usize>,
    warnings: Vec<String>,
    /// The corners of the face being read.
    face: Vec<Corner>,
}

pub(super) fn read(
    bytes: &[u8],
    room: Room,
    beside: &mut FindBeside<'_>,
) -> Result<MeshFile, ImportError> {
    let mut reader = Reader {
        room,
        positions: vec![],
        uvs: vec![],
        normals: vec![],
        materials: vec![],
        by_name: HashMap::new(),
        material: None,
        parts: vec![],
        places: HashMap::new(),
        warnings: vec![],
        face: vec![],
    };
    for line in lines(bytes) {
        reader.line(&line.as_line(), beside)?;
    }
    let parts = reader.parts.into_iter().map(|part| MeshPart {
        mesh: Arc::new(part.mesh),
        to_file: DAffine3::IDENTITY,
        material: part.material,
    });
    Ok(MeshFile {
        parts: parts
            .filter(|part| !part.mesh.triangles.is_empty())
            .collect(),
        materials: reader.materials,
        warnings: reader.warnings,
    })
}

impl Reader {
    fn line(&mut self, line: &Line<'_>, beside: &mut FindBeside<'_>) -> Result<(), ImportError> {
        match line.keyword {
            "v" => {
                self.room.take(1, size_of::<DVec3>())?;
                self.positions.push(DVec3::from_array(line.coordinates()?));
            }
            "vt" => {
                self.room.take(1, size_of::<DVec2>())?;
                // The second number may be missing: an image that is a line.
                let one = line.rest.split_whitespace().count() == 1;
                let uv = if one {
                    [line.coordinates::<1>()?[0], 0.0]
                } else {
                    line.coordinates()?
                };
                self.uvs.push(DVec2::from_array(uv));
            }
            "vn" => {
                self.room.take(1, size_of::<DVec3>())?;
                let normal = DVec3::from_array(line.coordinates()?);
                // A normal of length 0 stays one, and the face's own is drawn there.
                self.normals.push(normal.normalize_or_zero());
            }
            "f" => self.face(line)?,
            "usemtl" => self.material = self.find_material(line),
            "mtllib" => self.library(line, beside)?,
            _ => {}
        }
        Ok(())
    }

    fn find_material(&mut self, line: &Line<'_>) -> Option<usize> {
        let found = self.by_name.get(line.rest).copied();
        let warning = format!(
            "its material `{}` is in none of its libraries; it is drawn grey",
            shortened(line.rest)
        );
        if found.is_none() && !self.warnings.contains(&warning) {
            self.warn(warning);
        }
        found
    }

    /// Notes something; a file that is wrong everywhere is told of a few times only.
    fn warn(&mut self, warning: String) {
        if self.warnings.len() < 8 {
            self.warnings.push(warning);
        }
    }

    fn library(&mut self, line: &Line<'_>, beside: &mut FindBeside<'_>) -> Result<(), ImportError> {
        let name = line.rest.replace('\\', "/");
        let fail = |why: String| ImportError::Beside {
            name: name.clone(),
            why,
        };
        match beside(&name).map_err(fail)? {
            Some(bytes) => {
                // `newmtl` alone, seven bytes, makes a material and its place by name.
                self.room
                    .take(bytes.len() as u64, size_of::<MeshMaterial>() / 4)?;
                let first = self.materials.len();
                mtl::read(&bytes, &mut self.materials).map_err(|error| fail(error.to_string()))?;
                let new = self.materials.iter().zip(0..).skip(first);
                self.by_name
                    .extend(new.map(|(material, place)| (material.name.clone(), place)));
                Ok(())
            }
            None => {
                self.warn(format!(
                    "its material library `{}` is not there; it is drawn grey",
                    shortened(&name)
                ));
                Ok(())
            }
        }
    }

    fn face(&mut self, line: &Line<'_>) -> Result<(), ImportError> {
        let mut face = std::mem::take(&mut self.face);
        face.clear();
        for word in line.rest.split_whitespace() {
            face.push(self.corner(word, line)?);
        }
        if face.len() < 3 {
            return Err(line.wrong("a face needs three corners or more"));
        }
        self.room.take(face.len() as u64, CORNER_BYTES)?;
        let has = [
            face.iter().all(|corner| corner.1.is_some()),
            face.iter().all(|corner| corner.2.is_some()),
        ];
        let place = self.part(has);
        let corners: Vec<u32> = face
            .iter()
            .map(|corner| self.number(place, *corner))
            .collect();
        let at = |corner: &Corner| self.positions[corner.0 as usize];
        let outline: Vec<DVec3> = face.iter().map(at).collect();
        let triangles = &mut self.parts[place].mesh.triangles;
        polygon::cut(&outline, &mut self.room.tests, |triangle| {
            triangles.push(triangle.map(|corner| corners[corner]));
        })
        .map_err(|what| line.wrong(what))?;
        self.face = face;
        Ok(())
    }

    /// `position`, `position/uv`, `position//normal` or `position/uv/normal`; negative numbers count from the last one back.
    fn corner(&self, word: &str, line: &Line<'_>) -> Result<Corner, ImportError> {
        let lists = [
            (self.positions.len(), "v"),
            (self.uvs.len(), "vt"),
            (self.normals.len(), "vn"),
        ];
        let mut found = [None; 3];
        let mut parts = word.split('/');
        for ((slot, (count, list)), part) in found.iter_mut().zip(lists).zip(&mut parts) {
            if part.is_empty() {
                continue;
            }
            let number: i64 = part
                .parse()
                .map_err(|_| line.wrong(format!("`{}` is not a corner", shortened(word))))?;
            let place = if number < 0 {
                number.checked_add(count as i64)
            } else {
                number.checked_sub(1)
            };
            let place = place.and_then(|place| usize::try_from(place).ok());
            let place = place.filter(|place| *place < count).ok_or_else(|| {
                line.wrong(format!(
                    "a corner names `{list}` {number}, but there are {count} so far"
                ))
            })?;
            *slot = u32::try_from(place).ok();
        }
        match (found, parts.next()) {
            ([Some(position), uv, normal], None) => Ok((position, uv, normal)),
            _ => Err(line.wrong(format!("`{}` is not a corner", shortened(word)))),
        }
    }

    /// The part for faces of the present material that have these.
    fn part(&mut self, has: [bool; 2]) -> usize {
        let (material, parts) = (self.material, &mut self.parts);
        *self.places.entry((material, has)).or_insert_with(|| {
            parts.push(Part {
                material,
                has,
                mesh: TriangleMesh::default(),
                known: HashMap::new(),
            });
            parts.len() - 1
        })
    }

    /// The number of a corner within a part.
    fn number(&mut self, place: usize, (position, uv, normal): Corner) -> u32 {
        let part = &mut self.parts[place];
        let [uv, normal] = [uv.filter(|_| part.has[0]), normal.filter(|_| part.has[1])];
        let mesh = &mut part.mesh;
        *part.known.entry((position, uv, normal)).or_insert_with(|| {
            mesh.positions.push(self.positions[position as usize]);
            mesh.uvs.extend(uv.map(|at| self.uvs[at as usize]));
            mesh.normals
                .extend(normal.map(|at| self.normals[at as usize]));
            (mesh.positions.len() - 1) as u32
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn library(name: &str) -> Result<Option<Vec<u8>>, String> {
        match name {
            "a.mtl" => Ok(Some(
                b"newmtl red\nKd 1 0 0\nnewmtl green\nKd 0 1 0".to_vec(),
            )),
            "bad.mtl" => Ok(Some(b"newmtl red\nKd red".to_vec())),
            "secret.mtl" => Err("it is outside of the model's folder".to_owned()),
            _ => Ok(None),
        }
    }

    fn parse(text: &str) -> Result<MeshFile, ImportError> {
        read(text.as_bytes(), Room::new(1 << 20), &mut library)
    }

    fn fault(text: &str) -> String {
        parse(text).unwrap_err().to_string()
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 2\n";

    #[test]
    fn faces_share_corners_and_split_by_material() {
        let text = format!(
            "mtllib a.mtl\n{SQUARE}o thing\nusemtl red\nf 1 2 3 4\nusemtl green\nf -4/1/1 -3/2/1 \\\n  -2/1/1 # half\nf 1//1 3//1 4//1\nl 1 2\n"
        );
        let file = parse(&text).unwrap();
        let names: Vec<&str> = file
            .parts
            .iter()
            .map(|p| file.materials[p.material.unwrap()].name.as_str())
            .collect();
        assert_eq!(names, ["red", "green", "green"]);
        let [red, both, normals] = [0, 1, 2].map(|i| &*file.parts[i].mesh);
        assert_eq!(red.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(
            (red.positions.len(), red.uvs.len(), red.normals.len()),
            (4, 0, 0)
        );
        assert_eq!(both.uvs, [DVec2::ZERO, DVec2::ONE, DVec2::ZERO]);
        assert_eq!(both.normals, [DVec3::Z; 3]);
        assert_eq!((normals.uvs.len(), normals.normals.len()), (0, 3));
        assert!(file.warnings.is_empty());
    }

    #[test]
    fn what_is_missing_is_told_once_and_drawn_grey() {
        let file = parse(&format!(
            "mtllib no.mtl\n{SQUARE}usemtl x\nf 1 2 3\nusemtl y\nusemtl x\nf 1 3 4\n"
        ))
        .unwrap();
        assert_eq!(file.parts.len(), 1);
        assert_eq!(file.warnings.len(), 3, "{:?}", file.warnings);
    }

    #[test]
    fn hostile_files_are_refused_with_their_line() {
        for (text, line) in [
            ("v 0 0", "line 1: "),
            ("v 0 0 x", "line 1: `x`"),
            ("v 0 nan 0", "line 1: a coordinate"),
            ("v 0 1e300 0", "line 1: a coordinate"),
            ("\n\nv 0 0 inf", "line 3: "),
            (
                "f 1 2 3",
                "line 1: a corner names `v` 1, but there are 0 so far",
            ),
            (&format!("{SQUARE}f 1 2 5"), "line 8: "),
            (&format!("{SQUARE}f 0 1 2"), "line 8: "),
            (&format!("{SQUARE}f 1 2 -9"), "line 8: "),
            (&format!("{SQUARE}f 1 2 -9223372036854775808"), "line 8: "),
            (&format!("{SQUARE}f 1 2 99999999999999999999"), "line 8: "),
            (
                &format!("{SQUARE}f 1/3 2/1 3/1"),
                "line 8: a corner names `vt` 3",
            ),
            (&format!("{SQUARE}f 1/1/1/1 2 3"), "line 8: "),
            (&format!("{SQUARE}f /1 /1 /1"), "line 8: "),
            (&format!("{SQUARE}f 1 2"), "line 8: a face needs three"),
            (
                "mtllib bad.mtl",
                "its `bad.mtl`: line 2: `red` is not a number",
            ),
            ("mtllib secret.mtl", "its `secret.mtl`: it is outside"),
        ] {
            let message = fault(text);
            assert!(message.starts_with(line), "{text}: {message}");
        }
    }

    #[test]
    fn memory_is_limited_before_it_is_taken() {
        let many = "v 0 0 0\n".repeat(50_000);
        assert_eq!(parse(&many).unwrap_err(), ImportError::TooLarge(1 << 20));
        let faces = format!("{SQUARE}{}", "f 1 2 3\n".repeat(5_000));
        assert_eq!(parse(&faces).unwrap_err(), ImportError::TooLarge(1 << 20));
    }

    #[test]
    fn bytes_that_are_no_text_do_no_harm() {
        let mut bytes: Vec<u8> = (0..=255).collect();
        bytes.extend(b"\nv 0 0 0\nv 1 0 0\nv 0 1 0\n\xff\xfe\nf 1 2 3\\");
        let file = read(&bytes, Room::new(1 << 20), &mut library).unwrap();
        assert_eq!(file.parts[0].mesh.triangles.len(), 1);
    }
}
