//! Triangles with a colour at each corner, and their file: glTF 2.0, binary.
//!
//! The file needs no light to be shown: its material is unlit
//! ([`KHR_materials_unlit`](https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Khronos/KHR_materials_unlit)). In glTF y is
//! up and colours are linear; here z is up.

use crate::color::Rgb;
use glam::{DAffine3, DMat3, DVec3};
use serde_json::json;

/// Triangles with a colour at each corner.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PaintedMesh {
    /// Corners, metres.
    pub positions: Vec<DVec3>,
    /// Of each corner, display-linear, 0..=1.
    pub colors: Vec<Rgb>,
    /// Three corners each, counter-clockwise as seen from where they are seen.
    pub triangles: Vec<[u32; 3]>,
}

/// A camera in the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FileCamera {
    /// Where it stands, metres.
    pub eye: DVec3,
    /// Unit vectors to the right and to the top of the picture.
    pub right: DVec3,
    /// See `right`.
    pub up: DVec3,
    /// Vertical field of view, radians.
    pub fov: f64,
    /// Width over height.
    pub aspect: f64,
}

/// Steps of a stored colour.
const COLOR_STEPS: f64 = 65_535.0;

/// What the camera of the file sees begins at this part of the size of all.
const NEAREST: f64 = 1000.0;

/// Numbers of glTF for types and targets.
const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Bytes of a corner and of a triangle in the file.
const BYTES_PER_CORNER: u64 = 20;
const BYTES_PER_TRIANGLE: u64 = 12;

/// Bytes that a file may have: its lengths are 32 bits; with room for its description.
const MOST_BYTES: u64 = u32::MAX as u64 - (1 << 16);

impl PaintedMesh {
    /// Adds the face inside a ring of corners, counter-clockwise, or clockwise if `is_turned`. Four corners are cut along the diagonal
    /// whose colours are more like that of the middle; more are joined to the middle, which becomes a corner.
    pub fn add_face(&mut self, ring: &[u32], middle: (DVec3, Rgb), is_turned: bool) {
        match *ring {
            [a, b, c] => self.add([a, b, c], is_turned),
            [a, b, c, d] => {
                let off = |i: u32, j: u32| {
                    let mean = (self.colors[i as usize] + self.colors[j as usize]) * 0.5;
                    (mean - middle.1).map(f64::abs).sum()
                };
                let cut = if off(a, c) <= off(b, d) {
                    [[a, b, c], [a, c, d]]
                } else {
                    [[a, b, d], [b, c, d]]
                };
                cut.into_iter().for_each(|face| self.add(face, is_turned));
            }
            [first, _, _, _, ..] => {
                let center = self.positions.len() as u32;
                self.positions.push(middle.0);
                self.colors.push(middle.1);
                let next = ring.iter().skip(1).chain([&first]);
                for (a, b) in ring.iter().zip(next) {
                    self.add([center, *a, *b], is_turned);
                }
            }
            _ => {}
        }
    }

    /// Leaves out corners that no triangle has.
    #[must_use]
    pub fn compact(self) -> Self {
        let mut is_used = vec![false; self.positions.len()];
        for corner in self.triangles.as_flattened() {
            is_used[*corner as usize] = true;
        }
        let mut next = 0;
        let numbers = is_used.iter().map(|is_used| {
            let number = next;
            next += u32::from(*is_used);
            number
        });
        let numbers: Vec<u32> = numbers.collect();
        let used = |at: &usize| is_used[*at];
        let all = 0..self.positions.len();
        Self {
            positions: all
                .clone()
                .filter(used)
                .map(|at| self.positions[at])
                .collect(),
            colors: all.filter(used).map(|at| self.colors[at]).collect(),
            triangles: self
                .triangles
                .iter()
                .map(|face| face.map(|corner| numbers[corner as usize]))
                .collect(),
        }
    }

    fn add(&mut self, [a, b, c]: [u32; 3], is_turned: bool) {
        let face = if is_turned { [a, c, b] } else { [a, b, c] };
        self.triangles.push(face);
    }

    /// The file (`.glb`); `None` if there is nothing to show or the file would be too long for its format.
    #[must_use]
    pub fn to_glb(&self, camera: Option<&FileCamera>) -> Option<Vec<u8>> {
        let (n, m) = (self.positions.len() as u64, self.triangles.len() as u64);
        let data = n * BYTES_PER_CORNER + m * BYTES_PER_TRIANGLE;
        if m == 0 || data > MOST_BYTES {
            return None;
        }
        let low = self.positions.iter().copied().reduce(DVec3::min)?;
        let high = self.positions.iter().copied().reduce(DVec3::max)?;
        let center = (low + high) * 0.5;
        // Relative to the middle: 32-bit numbers keep their precision for it.
        let stored = |position: &DVec3| y_up(*position - center).as_vec3();
        let points: Vec<glam::Vec3> = self.positions.iter().map(stored).collect();
        let mut bytes = Vec::with_capacity(data as usize);
        for point in &points {
            bytes.extend(point.to_array().iter().flat_map(|x| x.to_le_bytes()));
        }
        for color in &self.colors {
            let stored = |c: f64| (c.clamp(0.0, 1.0) * COLOR_STEPS).round() as u16;
            let [r, g, b] = color.to_array().map(stored);
            bytes.extend([r, g, b, u16::MAX].iter().flat_map(|c| c.to_le_bytes()));
        }
        for corner in self.triangles.as_flattened() {
            bytes.extend(corner.to_le_bytes());
        }
        let range = (
            points.iter().copied().reduce(glam::Vec3::min)?,
            points.iter().copied().reduce(glam::Vec3::max)?,
        );
        Some(container(&self.document(center, range, camera), &bytes))
    }

    /// The description of the file.
    fn document(
        &self,
        center: DVec3,
        (low, high): (glam::Vec3, glam::Vec3),
        camera: Option<&FileCamera>,
    ) -> serde_json::Value {
        let (n, m) = (self.positions.len() as u64, self.triangles.len() as u64);
        let (colors, faces) = (12 * n, BYTES_PER_CORNER * n);
        let length = faces + BYTES_PER_TRIANGLE * m;
        let mut nodes = vec![json!({
            "name": "surfaces", "mesh": 0, "translation": y_up(center).to_array(),
        })];
        let mut document = json!({
            "asset": { "version": "2.0", "generator": concat!("understory ", env!("CARGO_PKG_VERSION")) },
            "extensionsUsed": ["KHR_materials_unlit"],
            "scene": 0,
            "meshes": [{ "primitives": [{
                "attributes": { "POSITION": 0, "COLOR_0": 1 }, "indices": 2, "material": 0,
            }] }],
            "materials": [{
                "name": "light",
                "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 1.0 },
                "extensions": { "KHR_materials_unlit": {} },
            }],
            "accessors": [
                { "bufferView": 0, "componentType": FLOAT, "count": n, "type": "VEC3",
                  "min": low.to_array(), "max": high.to_array() },
                { "bufferView": 1, "componentType": UNSIGNED_SHORT, "normalized": true, "count": n, "type": "VEC4" },
                { "bufferView": 2, "componentType": UNSIGNED_INT, "count": 3 * m, "type": "SCALAR" },
            ],
            "bufferViews": [
                { "buffer": 0, "byteOffset": 0, "byteLength": colors, "target": ARRAY_BUFFER },
                { "buffer": 0, "byteOffset": colors, "byteLength": faces - colors, "target": ARRAY_BUFFER },
                { "buffer": 0, "byteOffset": faces, "byteLength": length - faces, "target": ELEMENT_ARRAY_BUFFER },
            ],
            "buffers": [{ "byteLength": length }],
        });
        if let Some(camera) = camera {
            let size = f64::from((high - low).length());
            document["cameras"] = json!([{ "type": "perspective", "perspective": {
                "yfov": camera.fov, "aspectRatio": camera.aspect, "znear": size / NEAREST,
            } }]);
            let axes = [camera.right, camera.up, camera.right.cross(camera.up)];
            let [right, up, back] = axes.map(y_up);
            let place = DAffine3 {
                matrix3: DMat3::from_cols(right, up, back),
                translation: y_up(camera.eye),
            };
            let (_, turn, eye) = place.to_scale_rotation_translation();
            let (turn, eye) = (turn.normalize().to_array(), eye.to_array());
            nodes.push(
                json!({ "name": "camera", "camera": 0, "rotation": turn, "translation": eye }),
            );
        }
        document["scenes"] = json!([{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }]);
        document["nodes"] = json!(nodes);
        document
    }
}

/// From z up to y up.
fn y_up(v: DVec3) -> DVec3 {
    DVec3::new(v.x, v.z, -v.y)
}

/// The binary form of glTF (its §4): a description and bytes, each padded to four.
fn container(document: &serde_json::Value, bytes: &[u8]) -> Vec<u8> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + text.len() + 8 + bytes.len();
    let mut file = Vec::with_capacity(length);
    file.extend(b"glTF");
    file.extend(2_u32.to_le_bytes());
    file.extend((length as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text[..]), (b"BIN\0", bytes)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}
