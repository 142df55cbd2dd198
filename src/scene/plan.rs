//! Deciding which groups stay groups.
//!
//! Entering an instance costs a change of frame and a walk of its own, so groups that save nothing dissolve into the groups
//! that use them: those used once, and those with so few primitives that an instance is not smaller than its contents.

use super::Stop;
use super::description::{
    Group, GroupId, Instance, MaterialId, OrganId, PlacedShape, SceneDescription,
};
use super::error::{Problem, SceneError};
use super::validate::check_placement;
use crate::geometry::Shape;
use glam::DAffine3;

/// Groups of at most this many primitives, and without instances of their own, dissolve wherever they are used. Where groups
/// are nested too deep otherwise, instances of their own count as one primitive each.
const SMALL: usize = 16;
/// Shapes that are collected before it is asked again whether to go on.
const STRETCH: usize = 4096;
/// How deep the groups that stay may be nested.
pub(super) const MAX_DEPTH: usize = 16;

/// The groups that stay, each after all the groups it refers to; the root is the last.
pub(super) struct Plan<'a> {
    pub(super) groups: Vec<PlannedGroup<'a>>,
    /// How many do not.
    pub(super) n_dissolved: usize,
}

/// A group that stays, with the contents of all that dissolved into it.
pub(super) struct PlannedGroup<'a> {
    pub(super) shapes: Vec<PlannedShape<'a>>,
    pub(super) instances: Vec<PlannedInstance>,
    /// 0 if it has no instances, otherwise one more than the highest of what it refers to.
    pub(super) height: usize,
}

/// A shape in a group that stays.
#[derive(Clone, Copy)]
pub(super) struct PlannedShape<'a> {
    pub(super) shape: &'a Shape,
    pub(super) to_group: DAffine3,
    pub(super) material: MaterialId,
    pub(super) organ: OrganId,
    /// The outermost instance that dissolved above it.
    pub(super) instance_organ: Option<OrganId>,
}

/// An instance of a group that stays.
pub(super) struct PlannedInstance {
    /// Index into [`Plan::groups`].
    pub(super) group: usize,
    pub(super) to_group: DAffine3,
    /// The outermost instance that dissolved above it, or itself.
    pub(super) organ: OrganId,
}

/// Plans the groups that the root reaches. Empty if there is no root.
pub(super) fn plan<'a>(
    description: &'a SceneDescription,
    stop: Stop<'_>,
) -> Result<Plan<'a>, SceneError> {
    let Some(root) = description.root else {
        return Ok(Plan {
            groups: Vec::new(),
            n_dissolved: 0,
        });
    };
    if root.0 as usize >= description.groups.len() {
        return Err(SceneError::NoRoot(root.0));
    }
    let order = children_first(&description.groups, root)?;
    // Shallow nesting is worth memory only where there is no other way.
    let first = if description.extras.groups {
        Dissolving::Empty
    } else {
        Dissolving::Leaves
    };
    for dissolving in [first, Dissolving::Leaves, Dissolving::Small] {
        let dissolves = which_dissolve(&description.groups, root, &order, dissolving);
        let groups = gather_all(&description.groups, &order, (&dissolves, stop))?;
        if groups.iter().all(|group| group.height <= MAX_DEPTH) {
            let n_dissolved = dissolves.iter().filter(|dissolves| **dissolves).count();
            return Ok(Plan {
                groups,
                n_dissolved,
            });
        }
    }
    Err(SceneError::TooDeep { limit: MAX_DEPTH })
}

/// Which groups dissolve because they are small.
#[derive(Clone, Copy, PartialEq)]
enum Dissolving {
    /// Those with nothing in them, and no others however often they are used.
    Empty,
    /// Those without instances of their own.
    Leaves,
    /// All.
    Small,
}

/// The groups that do not dissolve, with what dissolves into them.
fn gather_all<'a>(
    groups: &'a [Group],
    order: &[usize],
    (dissolves, stop): (&[bool], Stop<'_>),
) -> Result<Vec<PlannedGroup<'a>>, SceneError> {
    let mut places = vec![usize::MAX; groups.len()];
    let mut planned: Vec<PlannedGroup> = Vec::new();
    for &group in order.iter().filter(|group| !dissolves[**group]) {
        let gathered = gather(groups, group, (dissolves, &places, &planned), stop)?;
        places[group] = planned.len();
        planned.push(gathered);
    }
    Ok(planned)
}

/// All groups that `root` reaches, each after those it refers to.
fn children_first(groups: &[Group], root: GroupId) -> Result<Vec<usize>, SceneError> {
    #[derive(Clone, Copy, PartialEq)]
    enum Mark {
        New,
        Open,
        Done,
    }
    let mut marks = vec![Mark::New; groups.len()];
    let mut order = Vec::new();
    // Groups being visited, with the number of the next instance to follow.
    let mut open = vec![(root.0 as usize, 0)];
    marks[root.0 as usize] = Mark::Open;
    while let Some((group, next)) = open.last_mut() {
        let Some(instance) = groups[*group].instances.get(*next) else {
            marks[*group] = Mark::Done;
            order.push(*group);
            open.pop();
            continue;
        };
        *next += 1;
        let child = instance.group.0 as usize;
        match marks.get(child) {
            None => return Err(at(instance, Problem::NoGroup(instance.group.0))),
            Some(Mark::Open) => return Err(at(instance, Problem::Cycle(instance.group.0))),
            Some(Mark::Done) => {}
            Some(Mark::New) => {
                marks[child] = Mark::Open;
                open.push((child, 0));
            }
        }
    }
    Ok(order)
}

fn at(instance: &Instance, problem: Problem) -> SceneError {
    SceneError::Organ {
        organ: instance.organ,
        problem,
    }
}

/// For each group, whether it dissolves into those that refer to it.
fn which_dissolve(
    groups: &[Group],
    root: GroupId,
    order: &[usize],
    dissolving: Dissolving,
) -> Vec<bool> {
    let mut uses = vec![0_usize; groups.len()];
    for group in order {
        for instance in &groups[*group].instances {
            uses[instance.group.0 as usize] += 1;
        }
    }
    // Primitives of a group with all that dissolved into it, and the instances that remain in it.
    let mut sizes = vec![(0_usize, 0_usize); groups.len()];
    let mut dissolves = vec![false; groups.len()];
    for &group in order {
        let (mut own, mut remaining) = (0_usize, 0_usize);
        for placed in &groups[group].shapes {
            own = own.saturating_add(primitive_count(&placed.shape));
        }
        for child in groups[group]
            .instances
            .iter()
            .map(|instance| instance.group.0 as usize)
        {
            let (within, kept) = if dissolves[child] {
                sizes[child]
            } else {
                (0, 1)
            };
            own = own.saturating_add(within);
            remaining = remaining.saturating_add(kept);
        }
        sizes[group] = (own, remaining);
        let is_small = match dissolving {
            Dissolving::Empty => own.saturating_add(remaining) == 0,
            Dissolving::Leaves => remaining == 0 && own <= SMALL,
            Dissolving::Small => own.saturating_add(remaining) <= SMALL,
        };
        dissolves[group] = group != root.0 as usize
            && (is_small || uses[group] == 1 && dissolving != Dissolving::Empty);
    }
    dissolves
}

/// How many primitives a shape becomes.
pub(super) fn primitive_count(shape: &Shape) -> usize {
    match shape {
        Shape::Mesh(mesh) => mesh.triangles.len(),
        _ => 1,
    }
}

/// Collects the contents of a group and of all that dissolve into it.
fn gather<'a>(
    groups: &'a [Group],
    group: usize,
    (dissolves, places, planned): (&[bool], &[usize], &[PlannedGroup]),
    stop: Stop<'_>,
) -> Result<PlannedGroup<'a>, SceneError> {
    let mut gathered = PlannedGroup {
        shapes: Vec::new(),
        instances: Vec::new(),
        height: 0,
    };
    let mut open = vec![(group, DAffine3::IDENTITY, None)];
    while let Some((group, to_group, outer)) = open.pop() {
        for stretch in groups[group].shapes.chunks(STRETCH) {
            if stop() {
                return Err(SceneError::Stopped);
            }
            let shapes = stretch.iter().map(|placed: &PlacedShape| PlannedShape {
                shape: &placed.shape,
                to_group: to_group * placed.to_group,
                material: placed.material,
                organ: placed.organ,
                instance_organ: outer,
            });
            gathered.shapes.extend(shapes);
        }
        for instance in &groups[group].instances {
            if stop() {
                return Err(SceneError::Stopped);
            }
            check_placement(&instance.to_group, instance.organ)?;
            let child = instance.group.0 as usize;
            let organ = outer.filter(OrganId::is_own).unwrap_or(instance.organ);
            let to_group = to_group * instance.to_group;
            if dissolves[child] {
                open.push((child, to_group, Some(organ)));
            } else {
                let place = places[child];
                gathered.height = gathered.height.max(planned[place].height + 1);
                gathered.instances.push(PlannedInstance {
                    group: place,
                    to_group,
                    organ,
                });
            }
        }
    }
    Ok(gathered)
}
