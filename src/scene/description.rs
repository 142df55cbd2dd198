//! What growth hands to light: placed shapes, instances, materials, light sources, as plain data in `f64`.

use super::Stop;
use crate::geometry::Shape;
use crate::light::{Environment, Light};
use crate::material::Material;
use glam::{DAffine3, DVec2};

/// Shapes that are copied before it is asked again whether to go on.
const STRETCH: usize = 4096;

/// Index into [`SceneDescription::materials`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MaterialId(pub u32);

/// Index into [`SceneDescription::groups`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct GroupId(pub u32);

/// Which organ of the model a primitive belongs to; opaque to the scene, meaningful to who built it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct OrganId(pub u32);

impl OrganId {
    /// The organ of an instance that is a mere copy: what is in it belongs to the organs in it.
    pub const COPY: Self = Self(u32::MAX - 1);

    /// Whether this is an organ, not [`OrganId::COPY`].
    #[must_use]
    pub fn is_own(&self) -> bool {
        *self != Self::COPY
    }
}

/// A shape somewhere in a group.
#[derive(Clone, Debug)]
pub struct PlacedShape {
    /// The shape in its own frame.
    pub shape: Shape,
    /// From the shape's frame to the group's; any invertible affine map (mirroring and uneven scale included).
    pub to_group: DAffine3,
    /// Its material.
    pub material: MaterialId,
    /// Its organ.
    pub organ: OrganId,
}

/// A whole group, drawn again somewhere else.
#[derive(Clone, Debug)]
pub struct Instance {
    /// What is drawn.
    pub group: GroupId,
    /// From that group's frame to this one's; any invertible affine map.
    pub to_group: DAffine3,
    /// Its organ (the module that made the instance), or [`OrganId::COPY`].
    pub organ: OrganId,
}

/// Geometry with a frame of its own; a prototype if instances use it more than once.
#[derive(Clone, Debug, Default)]
pub struct Group {
    /// Shapes.
    pub shapes: Vec<PlacedShape>,
    /// Instances of other groups; never of this group itself, directly or through others.
    pub instances: Vec<Instance>,
}

/// What a world has though light does not require it: for comparing with a world that has not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras {
    /// Groups that an instance of saves nothing, as far as nesting allows.
    pub groups: bool,
    /// Texture coordinates of round shapes though there are no pictures.
    pub coordinates: bool,
}

/// All that light needs to know of a model.
#[derive(Clone, Debug, Default)]
pub struct SceneDescription {
    /// Materials, shared by all groups.
    pub materials: Vec<Material>,
    /// Groups; instances refer to them by number.
    pub groups: Vec<Group>,
    /// The group that is the world. Its frame is the world's (metres, z up).
    pub root: Option<GroupId>,
    /// Light sources that are not surfaces, in world coordinates. (Surfaces that shine have an emitting material.)
    pub lights: Vec<Light>,
    /// Light from infinitely far away: sky and sun.
    pub environment: Environment,
    /// What it has besides.
    pub extras: Extras,
}

impl SceneDescription {
    /// A copy; `None` if `stop` said so while it was made, which can take a while.
    #[must_use]
    pub fn copied_unless(&self, stop: Stop<'_>) -> Option<Self> {
        let mut groups = Vec::with_capacity(self.groups.len());
        for group in &self.groups {
            let mut copy = Group {
                shapes: Vec::with_capacity(group.shapes.len()),
                instances: group.instances.clone(),
            };
            for stretch in group.shapes.chunks(STRETCH) {
                if stop() {
                    return None;
                }
                copy.shapes.extend_from_slice(stretch);
            }
            groups.push(copy);
        }
        Some(Self {
            materials: self.materials.clone(),
            groups,
            root: self.root,
            lights: self.lights.clone(),
            environment: self.environment.clone(),
            extras: self.extras,
        })
    }

    /// The same world, put beside itself so many times to each side along x and y, at distances of `size` metres: what hangs over
    /// the sides of a plot of that size is then there on the opposite side as well. Lights stay single.
    #[must_use]
    pub fn beside_itself(mut self, size: DVec2, times: [u32; 2]) -> Self {
        let Some(root) = self.root.filter(|_| times != [0; 2]) else {
            return self;
        };
        let [n_x, n_y] = times.map(i64::from);
        let mut instances = Vec::new();
        for x in -n_x..=n_x {
            for y in -n_y..=n_y {
                let shift = DVec2::new(x as f64, y as f64) * size;
                instances.push(Instance {
                    group: root,
                    to_group: DAffine3::from_translation(shift.extend(0.0)),
                    organ: OrganId::COPY,
                });
            }
        }
        // A plane is its own neighbour.
        let planes = match self.groups.get_mut(root.0 as usize) {
            Some(group) => {
                let (planes, others) = std::mem::take(&mut group.shapes)
                    .into_iter()
                    .partition(|placed| placed.shape == Shape::Plane);
                group.shapes = others;
                planes
            }
            None => vec![],
        };
        self.root = Some(GroupId(
            u32::try_from(self.groups.len()).unwrap_or(u32::MAX),
        ));
        self.groups.push(Group {
            shapes: planes,
            instances,
        });
        self
    }
}
