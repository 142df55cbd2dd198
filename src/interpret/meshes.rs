//! Meshes from files: each file is read once and becomes a group, which stands wherever a node names it.

use super::appearance::Appearance;
use super::canvas::Canvas;
use super::failure::{self, Failure};
use super::shapes::FIELDS;
use super::source::Source;
use super::walk::{Painter, Place};
use crate::eval::files::FileFault;
use crate::geometry::Shape;
use crate::geometry::import::{self, MeshFile};
use crate::graph::NodeId;
use crate::scene::description::{GroupId, MaterialId, PlacedShape};
use crate::turtle::TurtleState;
use std::collections::HashMap;
use std::rc::Rc;

/// Files read and groups made of them.
#[derive(Debug, Default)]
pub(super) struct MeshFiles {
    /// By where they are. Looked up only, never iterated.
    read: HashMap<String, Rc<MeshFile>>,
    /// By where the file is and the shader it is drawn with instead of its own. Looked up only, never iterated.
    groups: HashMap<(String, Option<MaterialId>), GroupId>,
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
        let material = self.shader_material(node);
        let key = (file, material);
        let group = match self.mesh_files.groups.get(&key) {
            Some(group) => *group,
            None => {
                let read = self.mesh_file(node, &name, &key.0, place)?;
                let group = self.draw_parts(&read, material, node, place)?;
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
        file: &MeshFile,
        material: Option<MaterialId>,
        node: NodeId,
        place: Place,
    ) -> Result<GroupId, Failure> {
        let outer = std::mem::take(&mut self.canvas);
        let drawn = file.parts.iter().try_for_each(|part| {
            let own = part.material.and_then(|number| file.materials.get(number));
            let material = match (material, own) {
                (Some(material), _) => material,
                (None, Some(own)) => self.materials.of_mesh(own),
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
