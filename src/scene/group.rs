//! A group as rays see it: its primitives in a frame of its own, and a hierarchy over them.

use super::description::{MaterialId, OrganId};
use super::placement::Placement;
use crate::accel::{Bvh, FlatBlock};
use crate::geometry::TriangleMesh;
use crate::geometry::unit::UnitShape;
use crate::math::Bounds3;
use glam::{DAffine3, DMat3, DVec3};
use std::sync::Arc;

/// The frame in which a group is stored: its middle at the origin, its diagonal between 2¹² and 2¹³.
///
/// The scale is a power of two, so nothing is rounded by it; subtracting the middle only takes digits away that its size
/// does not need. In this frame `f32` boxes serve a bud as well as a landscape, and a bud a million metres from the origin
/// as well as one at it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GroupFrame {
    pub(super) center: DVec3,
    pub(super) scale: f64,
}

impl GroupFrame {
    /// `map`, a map into the group's own coordinates, followed by the change to this frame.
    pub(super) fn after(&self, map: &DAffine3) -> DAffine3 {
        DAffine3 {
            matrix3: map.matrix3 * self.scale,
            translation: (map.translation - self.center) * self.scale,
        }
    }

    /// From this frame to the group's own coordinates.
    pub(super) fn to_group(self) -> DAffine3 {
        DAffine3 {
            matrix3: DMat3::from_diagonal(DVec3::splat(1.0 / self.scale)),
            translation: self.center,
        }
    }
}

/// A group ready for rays. All coordinates are in its [`GroupFrame`].
#[derive(Clone, Debug)]
pub(super) struct Group {
    pub(super) frame: GroupFrame,
    /// The box of everything in it, widened like all stored boxes; empty if it holds nothing.
    pub(super) bounds: Bounds3,
    /// A few boxes that hold everything, closer than `bounds` does.
    pub(super) cover: Vec<Bounds3>,
    pub(super) triangles: Vec<Triangle>,
    pub(super) quads: Vec<Quad>,
    pub(super) solids: Vec<Solid>,
    pub(super) instances: Vec<PlacedGroup>,
    /// Of instances that are stretched unevenly.
    pub(super) matrices: Vec<DMat3>,
    /// Triangles and parallelograms once more, by leaves, for the test of eight at once.
    pub(super) blocks: Vec<FlatBlock>,
    /// Where each primitive of this group is stored, by number; `None` if it has no area.
    pub(super) places: Vec<Option<Item>>,
    /// Sorted by the number of the first primitive.
    pub(super) shapes: Vec<ShapeRecord>,
    pub(super) meshes: Vec<MeshShading>,
    /// Its leaves are called by the [`Item`] that each holds: a block, a solid or one or two instances.
    pub(super) bvh: Bvh,
    /// Primitives of this group and, once per instance, of all groups below; numbers of primitives are below it.
    pub(super) total: u64,
    /// Whether no surface in it or below lets light straight through.
    pub(super) is_opaque: bool,
}

/// A stored thing: a kind in the upper three bits, an index into the list of that kind in the others. Of flat primitives,
/// the highest bit is set for parallelograms only, as [`FlatBlock`] wants it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Item(std::num::NonZeroU32);

/// An [`Item`], taken apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ItemKind {
    Triangle(usize),
    Quad(usize),
    Solid(usize),
    Instance(usize),
    /// Up to eight flat primitives of a leaf.
    Block(usize),
    /// An instance and the next.
    TwoInstances(usize),
}

impl Item {
    /// How many things of one kind a group may hold.
    pub(super) const LIMIT: usize = (1 << 29) - 1;

    pub(super) fn new(kind: ItemKind) -> Self {
        let (tag, index) = match kind {
            ItemKind::Triangle(index) => (0, index),
            ItemKind::Solid(index) => (1, index),
            ItemKind::Instance(index) => (2, index),
            ItemKind::Block(index) => (3, index),
            ItemKind::Quad(index) => (4, index),
            ItemKind::TwoInstances(index) => (5, index),
        };
        // One is added so that no item is 0.
        let bits = tag << 29 | (index as u32 + 1);
        Self(std::num::NonZeroU32::new(bits).expect("invariant: index + 1 is below 2^29"))
    }

    /// The item as a number that is not 0.
    #[inline]
    pub(super) fn bits(self) -> u32 {
        self.0.get()
    }

    /// The item that has these bits, if any has.
    #[inline]
    pub(super) fn from_bits(bits: u32) -> Option<Self> {
        std::num::NonZeroU32::new(bits).map(Self)
    }

    #[inline]
    pub(super) fn kind(self) -> ItemKind {
        let bits = self.0.get();
        let index = (bits & 0x1fff_ffff).wrapping_sub(1) as usize;
        match bits >> 29 {
            0 => ItemKind::Triangle(index),
            1 => ItemKind::Solid(index),
            2 => ItemKind::Instance(index),
            3 => ItemKind::Block(index),
            4 => ItemKind::Quad(index),
            _ => ItemKind::TwoInstances(index),
        }
    }
}

/// A triangle of a mesh: its corners, and its number.
///
/// Corners are not shared with the neighbours: a ray wants one triangle, seldom several, and waits for memory only once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Triangle {
    pub(super) corners: [[f64; 3]; 3],
    pub(super) number: u32,
}

impl Triangle {
    /// The corners as vectors.
    pub(super) fn corners(&self) -> [DVec3; 3] {
        self.corners.map(DVec3::from_array)
    }
}

/// A parallelogram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Quad {
    pub(super) corner: DVec3,
    pub(super) edges: [DVec3; 2],
    pub(super) number: u32,
    /// Whether textures run along the second edge first.
    pub(super) is_turned: bool,
}

/// A unit shape under an affine map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Solid {
    /// From the group's frame to the unit shape's.
    pub(super) to_unit: DAffine3,
    pub(super) form: UnitShape,
    pub(super) number: u32,
}

/// Another group, placed in this one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlacedGroup {
    /// From this group's frame to that group's; read it with [`Group::to_child`].
    pub(super) placement: Placement,
    /// Number, in this group, of the placed group's first primitive.
    pub(super) first: u64,
    /// Which group, by its place in the scene.
    pub(super) group: u32,
    pub(super) organ: OrganId,
}

/// What all primitives of one shape have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ShapeRecord {
    /// Number of its first primitive.
    pub(super) first: u32,
    pub(super) material: MaterialId,
    pub(super) organ: OrganId,
    pub(super) instance_organ: Option<OrganId>,
    /// Index into the group's `meshes`, if it has shading normals or texture coordinates.
    pub(super) mesh: Option<u32>,
    /// Whether it was mirrored, so that the front of flat primitives is where corners run clockwise.
    pub(super) is_mirrored: bool,
}

/// What shading wants to know of a mesh beyond its triangles.
#[derive(Clone, Debug)]
pub(super) struct MeshShading {
    pub(super) mesh: Arc<TriangleMesh>,
    /// From normals of the mesh to normals in the group's frame, up to length.
    pub(super) normal_map: DMat3,
}

impl Group {
    /// The shape that primitive `number` belongs to.
    pub(super) fn shape_of(&self, number: u32) -> &ShapeRecord {
        let after = self.shapes.partition_point(|shape| shape.first <= number);
        &self.shapes[after.saturating_sub(1)]
    }

    /// The instance that primitive `number` lies in, which must not be the group's own.
    pub(super) fn instance_of(&self, number: u64) -> &PlacedGroup {
        let after = self
            .instances
            .partition_point(|instance| instance.first <= number);
        &self.instances[after.saturating_sub(1)]
    }

    /// From this group's frame to that of one of its instances.
    #[inline(always)]
    pub(super) fn to_child(&self, instance: &PlacedGroup) -> DAffine3 {
        instance.placement.map(&self.matrices)
    }

    /// A corner of a triangle or parallelogram and the two edges from there; zeros for anything else.
    pub(super) fn parallelogram(&self, kind: ItemKind) -> (DVec3, [DVec3; 2]) {
        match kind {
            ItemKind::Triangle(index) => {
                let [a, b, c] = self.triangles[index].corners();
                (a, [b - a, c - a])
            }
            ItemKind::Quad(index) => (self.quads[index].corner, self.quads[index].edges),
            _ => (DVec3::ZERO, [DVec3::ZERO; 2]),
        }
    }

    /// Memory it occupies, in bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of::<Self>()
            + size_of_val(&*self.cover)
            + size_of_val(&*self.triangles)
            + size_of_val(&*self.quads)
            + size_of_val(&*self.solids)
            + size_of_val(&*self.instances)
            + size_of_val(&*self.matrices)
            + size_of_val(&*self.blocks)
            + size_of_val(&*self.places)
            + size_of_val(&*self.shapes)
            + size_of_val(&*self.meshes)
            + self.bvh.bytes()
    }
}
