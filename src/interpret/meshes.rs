//! Meshes from files: each file is read once and becomes a group, which stands wherever a node names it.

use super::appearance::Appearance;
use super::canvas::Canvas;
use super::failure::{self, Failure};
use super::images::Finder;
use super::shapes::FIELDS;
use super::source::Source;
use super::walk::{Painter, Place};
use crate::eval::files::FileFault;
use crate::geometry::Shape;
use crate::geometry::import::{
    self, MeshFile, MeshHoles, MeshImage, MeshMaterial, MeshPart, MeshTexture, MeshWrap,
};
use crate::graph::NodeId;
use crate::material::image::Coverage;
use crate::material::texture::{Filter, Texture, Wrap};
use crate::scene::description::{GroupId, MaterialId, PlacedShape};
use crate::turtle::TurtleState;
use std::collections::HashMap;
use std::rc::Rc;

/// Files read and groups made of them.
#[derive(Debug, Default)]
pub(super) struct MeshFiles {
    /// By where they are. Looked up only, never iterated.
    read: HashMap<String, Rc<MeshFile>>,
    /// By where the file is and what it wears. Looked up only, never iterated.
    groups: HashMap<(String, Worn), GroupId>,
}

/// What a mesh from a file wears.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Worn {
    /// The material it is given.
    material: Option<MaterialId>,
    /// Whether parts with a material of their own keep that.
    spares_own: bool,
}

impl<S: Source> Painter<'_, S> {
    /// Draws a mesh from the file that a node names.
    pub(super) fn draw_mesh(
        &mut self,
        node: NodeId,
        state: &TurtleState,
        place: Place,
    ) -> Result<(), Failure> {
        let graph = self.source.graph();
        let name = graph.peek_object(node, FIELDS.mesh_file).ok().flatten();
        let Some(name) = name.and_then(Appearance::words).map(str::to_owned) else {
            self.warn(node, "mesh-of-nothing", "has no file to draw");
            return Ok(());
        };
        let file = self.source.files().place(&name);
        let file = file.map_err(|fault| self.file_fault(node, &name, fault))?;
        let read = self.mesh_file(node, &name, &file, place)?;
        let mut material = self.shader_material(node, place)?;
        let is_plain = |part: &MeshPart| part.material.is_none();
        let has_plain = material.is_none() && read.parts.iter().any(is_plain);
        if has_plain {
            // What has no material in the file looks as the turtle does.
            self.canvas.note_look(state.look);
            material = Some(self.look_material(state.look, place)?);
        }
        let worn = Worn {
            material,
            spares_own: has_plain,
        };
        let key = (file, worn);
        let group = match self.mesh_files.groups.get(&key) {
            Some(group) => *group,
            None => {
                let group = self.draw_parts(&name, &read, worn, node, place)?;
                self.mesh_files.groups.insert(key, group);
                group
            }
        };
        self.push_instance(group, state.transform, node, place)
    }

    /// The file at `place_of_file`, read if it was not yet.
    fn mesh_file(
        &mut self,
        node: NodeId,
        name: &str,
        place_of_file: &str,
        place: Place,
    ) -> Result<Rc<MeshFile>, Failure> {
        if let Some(known) = self.mesh_files.read.get(place_of_file) {
            return Ok(Rc::clone(known));
        }
        let files = self.source.files();
        let bytes = files.read_bytes(name);
        let bytes = bytes.map_err(|fault| self.file_fault(node, name, fault))?;
        let folder = name.rfind(['/', '\\']).map_or("", |end| &name[..=end]);
        let files = self.source.files();
        let mut beside = |part: &str| match files.read_bytes(&format!("{folder}{part}")) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(FileFault::Missing(_)) => Ok(None),
            Err(FileFault::Failed(why)) => Err(why),
            Err(FileFault::Refused { message, hint }) => Err(format!("{message}; {hint}")),
        };
        let read = import::read(name, &bytes, self.memory_left(), &mut beside);
        let read = read.map_err(|error| {
            let made = self.made(node);
            failure::mesh_file(&self.name(node, place), name, &error.to_string(), made)
        })?;
        for warning in &read.warnings {
            let what = format!("draws `{name}`: {warning}");
            self.warn_of(node, "mesh-file", &what);
        }
        let bytes: usize = read.parts.iter().map(|part| part.mesh.bytes()).sum();
        self.charge(bytes, node, place)?;
        let read = Rc::new(read);
        self.mesh_files
            .read
            .insert(place_of_file.to_owned(), Rc::clone(&read));
        Ok(read)
    }

    /// Draws the parts of a file into a group of their own, with one material or their own ones.
    fn draw_parts(
        &mut self,
        name: &str,
        file: &MeshFile,
        worn: Worn,
        node: NodeId,
        place: Place,
    ) -> Result<GroupId, Failure> {
        let outer = std::mem::take(&mut self.canvas);
        let drawn = file.parts.iter().try_for_each(|part| {
            let own = part.material.and_then(|number| file.materials.get(number));
            let material = match (worn.material, own) {
                (Some(material), None) => material,
                (Some(material), Some(_)) if !worn.spares_own => material,
                (_, Some(own)) => self.own_material(name, own, node, place)?,
                (None, None) => self.materials.grey(),
            };
            let shape = PlacedShape {
                shape: Shape::Mesh(part.mesh.clone()),
                to_group: part.to_file,
                material,
                organ: self.organ(node, place),
            };
            self.push_shape(shape, node, place)
        });
        let canvas: Canvas = std::mem::replace(&mut self.canvas, outer);
        drawn?;
        Ok(self.add_group(canvas))
    }

    /// The material that a part of a file has there.
    fn own_material(
        &mut self,
        file: &str,
        own: &MeshMaterial,
        node: NodeId,
        place: Place,
    ) -> Result<MaterialId, Failure> {
        let folder = file.rfind(['/', '\\']).map_or("", |end| &file[..=end]);
        let (look, holes) = self.with_pictures(node, place, |_, pictures| {
            let look_holes = match own.holes {
                MeshHoles::Alpha | MeshHoles::Below(_) => Coverage::Alpha,
                MeshHoles::Never | MeshHoles::Image(_) => Coverage::Opaque,
            };
            let look = own.look.as_ref();
            let look = look.and_then(|look| texture(look, folder, look_holes, pictures));
            let holes = match &own.holes {
                MeshHoles::Never => None,
                MeshHoles::Alpha => look.clone(),
                MeshHoles::Below(cutoff) => look.clone().map(|look| Texture {
                    cutoff: Some(*cutoff),
                    ..look
                }),
                MeshHoles::Image(image) => texture(image, folder, Coverage::Alpha, pictures)
                    .filter(|texture| texture.image.has_holes())
                    .or_else(|| texture(image, folder, Coverage::Bright, pictures)),
            };
            (look, holes.filter(|holes| holes.image.has_holes()))
        })?;
        if own.metallic > 0.0 && look.is_some() {
            self.warn(
                node,
                "picture-mean",
                &format!("draws `{file}`, in which a metal has a picture; it has its mean colour"),
            );
        }
        let (material, problem) = self.materials.of_mesh(own, look, holes);
        if let Some(problem) = problem {
            self.warn(
                node,
                "impossible-shader",
                &format!("draws `{file}` with {problem}"),
            );
        }
        Ok(material)
    }

    fn file_fault(&self, node: NodeId, name: &str, fault: FileFault) -> Failure {
        let made = self.made(node);
        let text = self.name(node, Place::default());
        match fault {
            FileFault::Missing(why) | FileFault::Failed(why) => {
                failure::mesh_file(&text, name, &why, made)
            }
            FileFault::Refused { message, hint } => failure::file_refused(message, hint, made),
        }
    }
}

/// A texture of a mesh file in `folder`.
fn texture(
    of: &MeshTexture,
    folder: &str,
    coverage: Coverage,
    pictures: &mut Finder<'_>,
) -> Option<Texture> {
    let image = match &of.image {
        MeshImage::File(name) => pictures.beside_mesh(&format!("{folder}{name}"), coverage),
        MeshImage::Content(bytes) => pictures.content(bytes, coverage),
    }?;
    let filter = if of.is_nearest {
        Filter::Nearest
    } else {
        Filter::Bilinear
    };
    let wrap = of.wrap.map(|wrap| match wrap {
        MeshWrap::Repeat => Wrap::Repeat,
        MeshWrap::Clamp => Wrap::Clamp,
        MeshWrap::Mirror => Wrap::Mirror,
    });
    Some(Texture {
        map: of.map,
        wrap,
        filter,
        ..Texture::new(image)
    })
}
