//! Meshes from files: Wavefront `.obj` with its `.mtl`, and glTF 2.0 as `.glb` or `.gltf`.
//!
//! Nothing here touches the disk: the caller hands over the bytes of the file, and a function that finds the files it names.
//! Whatever the bytes are, the result is a mesh or an [`ImportError`]: sizes are checked before memory is taken, indices
//! before they are used, and work grows no faster than the file.
//!
//! # Conventions
//! - `.obj` has no idea of up: its coordinates are taken as they stand, z up, in metres.
//! - glTF is y-up by its standard and becomes z-up: (x, y, z) → (x, -z, y). Its front (+z) then looks along -y.
//! - Texture coordinates have (0, 0) in the lower left corner of the image; glTF's, from the upper left, are turned over.
//! - Colours are linear red, green, blue; emission is radiance in W/(m² sr).
//! - A mesh without normals is drawn flat, as its standard demands of glTF.

mod accessor;
mod buffers;
mod gltf;
mod material;
mod mtl;
mod obj;

pub use material::{MeshHoles, MeshImage, MeshMaterial, MeshTexture, MeshWrap};

use super::TriangleMesh;
use crate::math::tolerance::MAX_COORDINATE;
use glam::DAffine3;
use std::sync::Arc;

/// What a file of meshes holds.
#[derive(Clone, Debug, Default)]
pub struct MeshFile {
    /// Its meshes, each with one material and a place.
    pub parts: Vec<MeshPart>,
    /// The materials that parts name.
    pub materials: Vec<MeshMaterial>,
    /// What is drawn otherwise than the file says, one sentence each, without its name.
    pub warnings: Vec<String>,
}

/// A mesh of one material.
#[derive(Clone, Debug)]
pub struct MeshPart {
    /// The triangles; a mesh that stands in several places of the file is shared.
    pub mesh: Arc<TriangleMesh>,
    /// From the mesh to the file's frame, z up.
    pub to_file: DAffine3,
    /// Index into [`MeshFile::materials`], if it has a material.
    pub material: Option<usize>,
}

/// Why a file of meshes cannot be used. The texts do not name the file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ImportError {
    /// Its name says nothing that is known.
    #[error("its name must end in `.obj`, `.glb` or `.gltf`")]
    Kind,
    /// A line of text is wrong.
    #[error("line {line}: {what}")]
    Line {
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong with it.
        what: String,
    },
    /// Something else in it is wrong.
    #[error("{0}")]
    Broken(String),
    /// It would not fit.
    #[error("its meshes need more than {0} bytes")]
    TooLarge(u64),
    /// A file that it names cannot be used.
    #[error("its `{name}`: {why}")]
    Beside {
        /// The name, as the file gives it.
        name: String,
        /// What is wrong.
        why: String,
    },
}

/// Finds a file by the name that the mesh file gives it, relative to the mesh file's folder.
///
/// `Ok(None)` if there is none; an error says why it must or can not be read.
pub type FindBeside<'f> = dyn FnMut(&str) -> Result<Option<Vec<u8>>, String> + 'f;

/// What reading may still cost.
#[derive(Clone, Copy, Debug)]
struct Room {
    limit: u64,
    left: u64,
    /// Tests of points that cutting polygons into triangles may still make.
    tests: u64,
}

impl Room {
    /// Tests that all polygons of a file may take together: some seconds.
    const TESTS: u64 = 1 << 31;

    const fn new(limit: u64) -> Self {
        Self {
            limit,
            left: limit,
            tests: Self::TESTS,
        }
    }

    /// Takes room for so many things.
    fn take(&mut self, count: u64, bytes_each: usize) -> Result<(), ImportError> {
        let bytes = count.checked_mul(bytes_each as u64);
        match bytes.and_then(|bytes| self.left.checked_sub(bytes)) {
            Some(left) => {
                self.left = left;
                Ok(())
            }
            None => Err(ImportError::TooLarge(self.limit)),
        }
    }
}

/// Reads a file of meshes called `name`, whose meshes may take `memory` bytes.
///
/// # Errors
/// What is wrong with it.
pub fn read(
    name: &str,
    bytes: &[u8],
    memory: u64,
    beside: &mut FindBeside<'_>,
) -> Result<MeshFile, ImportError> {
    let suffix = name.rsplit_once('.').map_or("", |(_, suffix)| suffix);
    let room = Room::new(memory);
    let file = match suffix.to_ascii_lowercase().as_str() {
        "obj" => obj::read(bytes, room, beside),
        "glb" => gltf::read_binary(bytes, room, beside),
        "gltf" => gltf::read_text(bytes, room, beside),
        _ => Err(ImportError::Kind),
    }?;
    if file.parts.is_empty() {
        return Err(ImportError::Broken("it has no triangles".to_owned()));
    }
    Ok(file)
}

/// Whether a name is that of a file of meshes.
#[must_use]
pub fn is_mesh_file(name: &str) -> bool {
    let suffix = name.rsplit_once('.').map_or("", |(_, suffix)| suffix);
    ["obj", "glb", "gltf"].contains(&suffix.to_ascii_lowercase().as_str())
}

/// A coordinate that a scene can hold.
fn is_sound(coordinate: f64) -> bool {
    coordinate.abs() <= MAX_COORDINATE
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nothing(_: &str) -> Result<Option<Vec<u8>>, String> {
        Ok(None)
    }

    #[test]
    fn the_suffix_decides() {
        let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        assert!(read("A.OBJ", text, 1 << 20, &mut nothing).is_ok());
        let unknown = read("a.stl", text, 1 << 20, &mut nothing);
        assert_eq!(unknown.unwrap_err(), ImportError::Kind);
        assert!(is_mesh_file("a.GLB") && !is_mesh_file("glb"));
    }

    #[test]
    fn a_file_without_triangles_is_none() {
        let empty = read("a.obj", b"# nothing\nv 0 0 0\n", 1 << 20, &mut nothing);
        assert!(matches!(empty, Err(ImportError::Broken(_))));
    }
}
