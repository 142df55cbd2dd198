//! glTF 2.0: scenes of nodes with meshes. Cameras, lights, animations, skins and morph targets are not looked at.
//!
//! The types of the document are those of the crate `gltf-json`; what they point to is checked here, because its own loader
//! trusts accessors.

use super::accessor::Document;
use super::buffers;
use super::material::{MeshHoles, MeshImage, MeshMaterial, MeshTexture, MeshWrap};
use super::{FindBeside, ImportError, MeshFile, MeshPart, Room, TriangleMesh, is_sound};
use crate::math::functions::sin_cos;
use crate::math::tolerance::SINGULAR_DETERMINANT;
use glam::{DAffine2, DAffine3, DMat2, DMat3, DMat4, DQuat, DVec2, DVec3, DVec4};
use gltf_json::accessor::Type;
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::texture::{Info, MagFilter, Sampler, WrappingMode};
use gltf_json::validation::Checked;
use gltf_json::{Index, Node, Root, material};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Extensions that a document may need: those whose absence changes nothing of the shape.
const KNOWN: &[&str] = &[
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_specular",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_texture_transform",
    "KHR_mesh_quantization",
];

pub(super) fn read_binary(
    bytes: &[u8],
    room: Room,
    beside: &mut FindBeside<'_>,
) -> Result<MeshFile, ImportError> {
    let container = buffers::open(bytes)?;
    read(container.json, container.binary, room, beside)
}

pub(super) fn read_text(
    bytes: &[u8],
    room: Room,
    beside: &mut FindBeside<'_>,
) -> Result<MeshFile, ImportError> {
    read(bytes, None, room, beside)
}

fn read(
    json: &[u8],
    binary: Option<&[u8]>,
    mut room: Room,
    beside: &mut FindBeside<'_>,
) -> Result<MeshFile, ImportError> {
    // A document of small objects takes a multiple of its text.
    room.take(json.len() as u64, 16)?;
    let root = Root::from_slice(json)
        .map_err(|error| ImportError::Broken(format!("its document cannot be read: {error}")))?;
    if let Some(unknown) = root
        .extensions_required
        .iter()
        .find(|name| !KNOWN.contains(&name.as_str()))
    {
        return Err(ImportError::Broken(format!(
            "it needs the extension `{unknown}`, which is not read"
        )));
    }
    let buffers = buffers::load(&root.buffers, binary, &mut room, beside)?;
    let mut reader = Reader {
        document: Document { root, buffers },
        room,
        meshes: BTreeMap::new(),
        file: MeshFile::default(),
    };
    reader.materials()?;
    reader.scene()?;
    Ok(reader.file)
}

/// A mesh with the number of its material.
type Drawn = (Arc<TriangleMesh>, Option<usize>);

struct Reader {
    document: Document,
    room: Room,
    /// Meshes read already, by number.
    meshes: BTreeMap<usize, Vec<Drawn>>,
    file: MeshFile,
}

impl Reader {
    fn warn(&mut self, warning: &str) {
        if !self.file.warnings.iter().any(|known| known == warning) {
            self.file.warnings.push(warning.to_owned());
        }
    }

    /// Draws the nodes of the document's scene.
    fn scene(&mut self) -> Result<(), ImportError> {
        let root = &self.document.root;
        let scene = root
            .scene
            .or((!root.scenes.is_empty()).then(|| Index::new(0)));
        let roots = match scene {
            Some(scene) => {
                let scene = root.get(scene).ok_or_else(|| {
                    ImportError::Broken("it has no such scene as it names".to_owned())
                })?;
                scene.nodes.clone()
            }
            // Without scenes all nodes that are nobody's children stand in it.
            None => {
                let mut is_child = vec![false; root.nodes.len()];
                let children = root
                    .nodes
                    .iter()
                    .filter_map(|node| node.children.as_ref())
                    .flatten();
                for child in children {
                    if let Some(slot) = is_child.get_mut(child.value()) {
                        *slot = true;
                    }
                }
                let free = (0..).zip(&is_child).filter(|(_, is_child)| !**is_child);
                free.map(|(number, _)| Index::new(number)).collect()
            }
        };
        // x stays, y (up) becomes z, z becomes -y.
        let z_up = DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y));
        let mut is_drawn = vec![false; root.nodes.len()];
        let mut pending: Vec<(Index<Node>, DAffine3)> =
            roots.into_iter().rev().map(|node| (node, z_up)).collect();
        while let Some((index, to_file)) = pending.pop() {
            let number = index.value();
            let node = self.document.root.get(index);
            let node = node.ok_or_else(|| {
                ImportError::Broken(format!("it names node {number}, which does not exist"))
            })?;
            // A tree meets each node once; this ends cycles and graphs that would multiply without end.
            if std::mem::replace(&mut is_drawn[number], true) {
                return Err(ImportError::Broken(format!(
                    "its node {number} hangs in two places, or below itself"
                )));
            }
            let to_file = to_file * placement(node);
            let columns = to_file.to_cols_array();
            if !columns.iter().all(|x| is_sound(*x)) {
                return Err(ImportError::Broken(format!(
                    "its node {number} stands nowhere: a number of its placement is not finite"
                )));
            }
            let children = node.children.iter().flatten().rev();
            pending.extend(children.map(|child| (*child, to_file)));
            let (mesh, has_skin) = (node.mesh, node.skin.is_some());
            if mesh.is_some() && is_flat(&to_file) {
                self.warn("it has a part that is scaled flat, which is not drawn");
            } else if let Some(mesh) = mesh {
                if has_skin {
                    self.warn("it has a mesh on a skeleton, which is drawn in its first pose");
                }
                self.place(mesh.value(), to_file)?;
            }
        }
        Ok(())
    }

    fn place(&mut self, number: usize, to_file: DAffine3) -> Result<(), ImportError> {
        if !self.meshes.contains_key(&number) {
            let drawn = self.mesh(number)?;
            self.meshes.insert(number, drawn);
        }
        let drawn = self.meshes.get(&number).map_or(&[][..], Vec::as_slice);
        self.room.take(drawn.len() as u64, size_of::<MeshPart>())?;
        let parts = drawn.iter().map(|(mesh, material)| MeshPart {
            mesh: Arc::clone(mesh),
            to_file,
            material: *material,
        });
        self.file.parts.extend(parts);
        Ok(())
    }

    fn mesh(&mut self, number: usize) -> Result<Vec<Drawn>, ImportError> {
        let mesh = self.document.root.meshes.get(number);
        let mesh = mesh.ok_or_else(|| {
            ImportError::Broken(format!("it names mesh {number}, which does not exist"))
        })?;
        let primitives = mesh.primitives.clone();
        let mut drawn = vec![];
        for primitive in &primitives {
            let Some(mesh) = self.primitive(primitive)? else {
                continue;
            };
            let material = primitive.material.map(|material| material.value());
            if material.is_some_and(|material| material >= self.file.materials.len()) {
                return Err(ImportError::Broken(
                    "it names a material that does not exist".to_owned(),
                ));
            }
            drawn.push((Arc::new(mesh), material));
        }
        Ok(drawn)
    }

    fn primitive(&mut self, primitive: &Primitive) -> Result<Option<TriangleMesh>, ImportError> {
        let (document, room) = (&self.document, &mut self.room);
        let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
        let Some(positions) = attribute(Semantic::Positions) else {
            return Ok(None);
        };
        let positions: Vec<DVec3> = document
            .floats(positions, Type::Vec3, room)?
            .into_iter()
            .map(DVec3::from_array)
            .collect();
        if !positions
            .iter()
            .all(|p| p.to_array().into_iter().all(is_sound))
        {
            return Err(ImportError::Broken(
                "a corner of it stands nowhere: a coordinate is not a finite number".to_owned(),
            ));
        }
        let indices = match primitive.indices {
            Some(indices) => document.indices(indices, room)?,
            None => {
                room.take(positions.len() as u64, size_of::<u32>())?;
                (0..positions.len() as u32).collect()
            }
        };
        if indices
            .iter()
            .any(|corner| *corner as usize >= positions.len())
        {
            return Err(ImportError::Broken(
                "a triangle of it has a corner that does not exist".to_owned(),
            ));
        }
        room.take(indices.len() as u64, size_of::<[u32; 3]>())?;
        let Some(triangles) = triangles(&indices, primitive.mode) else {
            self.warn("it has points or lines, which are not drawn");
            return Ok(None);
        };
        let normals = match attribute(Semantic::Normals) {
            Some(normals) => document.floats(normals, Type::Vec3, room)?,
            None => vec![],
        };
        let unit = |n| DVec3::from_array(n).try_normalize().unwrap_or(DVec3::ZERO);
        let uvs = match attribute(Semantic::TexCoords(0)) {
            Some(uvs) => document.floats(uvs, Type::Vec2, room)?,
            None => vec![],
        };
        let upright = |[u, v]: [f64; 2]| {
            if is_sound(u) && is_sound(v) {
                DVec2::new(u, 1.0 - v)
            } else {
                DVec2::ZERO
            }
        };
        if [normals.len(), uvs.len()]
            .iter()
            .any(|n| *n != 0 && *n != positions.len())
        {
            return Err(ImportError::Broken(
                "a mesh of it has normals or texture coordinates for other corners than it has"
                    .to_owned(),
            ));
        }
        if primitive.targets.is_some() {
            self.warn("it has a mesh with morph targets, which is drawn in its first shape");
        }
        Ok(Some(TriangleMesh {
            positions,
            triangles,
            normals: normals.into_iter().map(unit).collect(),
            uvs: uvs.into_iter().map(upright).collect(),
        }))
    }

    fn materials(&mut self) -> Result<(), ImportError> {
        let materials = &self.document.root.materials;
        self.room
            .take(materials.len() as u64, size_of::<MeshMaterial>())?;
        let found: Result<Vec<_>, _> = materials
            .iter()
            .map(|material| self.material(material))
            .collect();
        self.file.materials = found?;
        Ok(())
    }

    fn material(&self, of: &material::Material) -> Result<MeshMaterial, ImportError> {
        let pbr = &of.pbr_metallic_roughness;
        let [r, g, b, alpha] = pbr.base_color_factor.0.map(f64::from);
        let cutoff = of.alpha_cutoff.map_or(0.5, |cutoff| f64::from(cutoff.0));
        let (alpha, holes) = match of.alpha_mode {
            Checked::Valid(material::AlphaMode::Blend) => (alpha, MeshHoles::Alpha),
            Checked::Valid(material::AlphaMode::Mask) if alpha < cutoff => (0.0, MeshHoles::Never),
            // The image's alpha is multiplied with the factor before it is compared.
            Checked::Valid(material::AlphaMode::Mask) => (1.0, MeshHoles::Below(cutoff / alpha)),
            _ => (1.0, MeshHoles::Never),
        };
        let extensions = of.extensions.clone().unwrap_or_default();
        let strength = extensions
            .emissive_strength
            .map_or(1.0, |e| f64::from(e.emissive_strength.0));
        let look = pbr
            .base_color_texture
            .as_ref()
            .map(|info| self.texture(info))
            .transpose()?
            .flatten();
        Ok(MeshMaterial {
            name: of.name.clone().unwrap_or_default(),
            base_color: [r, g, b],
            alpha,
            emission: of.emissive_factor.0.map(|x| f64::from(x) * strength),
            metallic: f64::from(pbr.metallic_factor.0),
            roughness: f64::from(pbr.roughness_factor.0),
            transmission: extensions
                .transmission
                .map_or(0.0, |t| f64::from(t.transmission_factor.0)),
            ior: extensions.ior.map_or(1.5, |ior| f64::from(ior.ior.0)),
            look,
            holes,
        }
        .tidied())
    }

    /// A texture; none if its image is of a kind that is not read.
    fn texture(&self, info: &Info) -> Result<Option<MeshTexture>, ImportError> {
        let Some(image) = self.image(info)? else {
            return Ok(None);
        };
        let root = &self.document.root;
        let sampler = root.get(info.index).and_then(|texture| texture.sampler);
        let sampler = sampler.and_then(|sampler| root.get(sampler));
        let wrap = |of: fn(&Sampler) -> Checked<WrappingMode>| match sampler.map(of) {
            Some(Checked::Valid(WrappingMode::ClampToEdge)) => MeshWrap::Clamp,
            Some(Checked::Valid(WrappingMode::MirroredRepeat)) => MeshWrap::Mirror,
            _ => MeshWrap::Repeat,
        };
        let filter = sampler.and_then(|sampler| sampler.mag_filter);
        let map = transform(info);
        if !map.is_finite() {
            return Err(ImportError::Broken(
                "an image of it is moved or turned by what is no number".to_owned(),
            ));
        }
        Ok(Some(MeshTexture {
            image,
            map,
            wrap: [
                wrap(|sampler| sampler.wrap_s),
                wrap(|sampler| sampler.wrap_t),
            ],
            is_nearest: filter == Some(Checked::Valid(MagFilter::Nearest)),
        }))
    }

    /// The image of a texture; none if it is of a kind that is not read.
    fn image(&self, info: &Info) -> Result<Option<MeshImage>, ImportError> {
        let root = &self.document.root;
        let image = root
            .get(info.index)
            .and_then(|texture| root.get(texture.source));
        let image = image.ok_or_else(|| {
            ImportError::Broken("it names an image that does not exist".to_owned())
        })?;
        Ok(match (&image.uri, image.buffer_view) {
            (Some(uri), _) => match uri.strip_prefix("data:") {
                Some(data) => buffers::decode(data).map(|bytes| MeshImage::Content(bytes.into())),
                None => Some(MeshImage::File(buffers::unescaped(uri))),
            },
            (None, Some(view)) => Some(MeshImage::Content(self.document.view(view)?.into())),
            (None, None) => None,
        })
    }
}

/// How a texture lies (`KHR_texture_transform`): moved after it is turned after it is scaled, in coordinates whose v runs
/// down; ours runs up.
fn transform(info: &Info) -> DAffine2 {
    let extensions = info.extensions.clone().unwrap_or_default();
    let Some(of) = extensions.texture_transform else {
        return DAffine2::IDENTITY;
    };
    let vector = |v: [f32; 2]| DVec2::new(f64::from(v[0]), f64::from(v[1]));
    let (sin, cos) = sin_cos(f64::from(of.rotation.0));
    let turn = DMat2::from_cols(DVec2::new(cos, -sin), DVec2::new(sin, cos));
    let map = DAffine2 {
        matrix2: turn * DMat2::from_diagonal(vector(of.scale.0)),
        translation: vector(of.offset.0),
    };
    let over = DAffine2 {
        matrix2: DMat2::from_diagonal(DVec2::new(1.0, -1.0)),
        translation: DVec2::Y,
    };
    over * map * over
}

/// From a node to its parent.
fn placement(node: &Node) -> DAffine3 {
    if let Some(matrix) = node.matrix {
        let m = DMat4::from_cols_array(&matrix.map(f64::from));
        let axis = |column: DVec4| column.truncate();
        return DAffine3 {
            matrix3: DMat3::from_cols(axis(m.x_axis), axis(m.y_axis), axis(m.z_axis)),
            translation: axis(m.w_axis),
        };
    }
    let vector =
        |v: Option<[f32; 3]>, default| v.map_or(default, |v| DVec3::from_array(v.map(f64::from)));
    let turn = node
        .rotation
        .map_or([0.0, 0.0, 0.0, 1.0], |turn| turn.0.map(f64::from));
    let turn = DQuat::from_array(turn);
    let length = turn.length();
    // A turn of no length is none; of one that is no number, the place becomes no number and is refused.
    let turn = if length == 0.0 {
        DQuat::IDENTITY
    } else {
        turn * (1.0 / length)
    };
    DAffine3::from_scale_rotation_translation(
        vector(node.scale, DVec3::ONE),
        turn,
        vector(node.translation, DVec3::ZERO),
    )
}

/// Whether a placement squeezes space flat.
fn is_flat(to_file: &DAffine3) -> bool {
    let m = &to_file.matrix3;
    let axes = [m.x_axis, m.y_axis, m.z_axis].map(DVec3::normalize_or_zero);
    let [x, y, z] = axes;
    DMat3::from_cols(x, y, z).determinant().abs() <= SINGULAR_DETERMINANT
}

/// The triangles that indices stand for; none for points and lines.
fn triangles(indices: &[u32], mode: Checked<Mode>) -> Option<Vec<[u32; 3]>> {
    let three = |w: &[u32]| [w[0], w[1], w[2]];
    Some(match mode {
        Checked::Valid(Mode::Triangles) => indices.chunks_exact(3).map(three).collect(),
        // Every second triangle of a strip turns the other way.
        Checked::Valid(Mode::TriangleStrip) => {
            let windows = indices.windows(3).enumerate();
            windows
                .map(|(i, w)| {
                    if i % 2 == 0 {
                        three(w)
                    } else {
                        [w[1], w[0], w[2]]
                    }
                })
                .collect()
        }
        Checked::Valid(Mode::TriangleFan) => {
            let rim = indices.get(1..).unwrap_or_default();
            rim.windows(2).map(|w| [w[0], w[1], indices[0]]).collect()
        }
        _ => return None,
    })
}
