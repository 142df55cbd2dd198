//! Ways over and through a scene, found by rays.
//!
//! *Over* it: rays fall on the scene along the way. Their heights are widened (each becomes the largest around it) and then
//! averaged over as wide a piece, which gives a smooth line that is nowhere below the heights themselves.
//!
//! *Through* it: the shortest way from cell to cell of a grid, where a cell can be entered if its ground is a small step from
//! that of the cell before and nothing stands near the head or the hip there.
//!
//! Source: [Hart1968](crate::references#hart1968) (the search).

use super::key::{KeyFrame, KeyFrames};
use super::spline::{EvenSpeed, Track};
use crate::math::Ray;
use crate::math::functions::{cos, sin};
use crate::scene::Scene;
use glam::{DVec2, DVec3};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

/// Points at which the ground under a flight is probed, at most.
const MOST_PROBES: usize = 2_000;
/// Side of a cell of the grid for walking, in metres.
const CELL: f64 = 0.5;
/// Cells that are looked at, at most, on the way from one point to the next.
const MOST_CELLS: usize = 200_000;
/// Nothing is nearer to a walker than this, in metres.
const CLEARANCE: f64 = 0.45;
/// Directions in which it is looked for.
const DIRECTIONS: u32 = 16;
/// The highest step up and down from one cell to the next, in metres; what grows lower is walked through.
const STEP: f64 = 1.0;
/// Surfaces that a ray to the ground passes through, at most.
const MOST_LAYERS: usize = 4_096;
/// Metres to each side over which a walk is smoothed.
const SMOOTHING: f64 = 0.75;
/// How far ahead a walker looks, in metres.
const LOOK_AHEAD: f64 = 6.0;

/// Why there is no such way.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RouteError {
    /// Nothing to fly over.
    #[error("there is nothing under the way to fly over or walk on")]
    Nothing,
    /// The way has no length.
    #[error("the way has no length: its points lie above one another")]
    Point,
    /// No ground at a point.
    #[error("there is no ground to stand on at x = {0:.2}, y = {1:.2}")]
    NoGround(f64, f64),
    /// Something stands there.
    #[error(
        "something stands in the way at x = {0:.2}, y = {1:.2}, where the walk would begin or pass"
    )]
    Occupied(f64, f64),
    /// No way through.
    #[error(
        "no way leads from x = {0:.2}, y = {1:.2} to x = {2:.2}, y = {3:.2} that keeps {CLEARANCE} m away from everything: choose \
         other points with key frames"
    )]
    Closed(f64, f64, f64, f64),
}

/// A way across the scene for who names none: along the longer side of what stands there, with a bend to each side.
pub fn across(scene: &Scene) -> Result<Vec<DVec2>, RouteError> {
    let bounds = scene.bounds();
    if bounds.is_empty() {
        return Err(RouteError::Nothing);
    }
    let (middle, size) = (
        bounds.center().truncate(),
        (bounds.max - bounds.min).truncate(),
    );
    let (along, side) = if size.x > size.y {
        (DVec2::X * size.x, DVec2::Y * size.y)
    } else {
        (DVec2::Y * size.y, DVec2::X * size.x)
    };
    let at = |a: f64, b: f64| middle + along * a + side * b;
    Ok(vec![
        at(-0.45, 0.0),
        at(-0.2, 0.15),
        at(0.2, -0.15),
        at(0.45, 0.0),
    ])
}

/// Key frames of a flight along `way` at `height` metres above whatever is highest around it.
///
/// # Errors
/// If nothing is under the way, or it has no length.
pub fn flyover(scene: &Scene, way: &[DVec2], height: f64) -> Result<KeyFrames, RouteError> {
    let path = even(way)?;
    let length: f64 = path.windows(2).map(|p| p[0].distance(p[1])).sum();
    let spacing = (height / 4.0).max(length / MOST_PROBES as f64);
    let n = ((length / spacing).ceil() as usize).max(8);
    let path = resampled(&path, n);

    // What is highest in the middle and to both sides, not to brush the crowns.
    let top = scene.bounds().max.z.max(0.0) + 1.0;
    let below = |point: DVec2| {
        let ray = Ray::new(point.extend(top), DVec3::NEG_Z);
        scene.closest(&ray).map(|hit| top - hit.t)
    };
    let heights: Vec<Option<f64>> = (0..=n)
        .map(|i| {
            let ahead = path[(i + 1).min(n)] - path[i.saturating_sub(1)];
            let side = ahead.normalize_or_zero().perp() * (height / 2.0);
            let around = [path[i], path[i] + side, path[i] - side];
            around.into_iter().filter_map(below).reduce(f64::max)
        })
        .collect();
    let floor = heights.iter().flatten().copied().reduce(f64::min);
    let floor = floor.ok_or(RouteError::Nothing)?;
    let heights: Vec<f64> = heights.into_iter().map(|h| h.unwrap_or(floor)).collect();

    let reach = ((2.0 * height * n as f64 / length).ceil() as usize).clamp(1, n);
    let heights = averaged(&widened(&heights, reach), reach);
    let ahead = ((4.0 * height * n as f64 / length).ceil() as usize).max(1);
    let eye = |i: usize| path[i].extend(heights[i] + height);
    let frames = (0..=n).map(|i| {
        // Beyond the end the way goes on straight.
        let over = (i + ahead).saturating_sub(n) as f64;
        let end = path[(i + ahead).min(n)] + (path[n] - path[n - 1]) * over;
        let target = end.extend(heights[(i + ahead).min(n)] + 0.3 * height);
        KeyFrame {
            time: i as f64,
            eye: Some(eye(i)),
            target: Some(target),
            ..KeyFrame::default()
        }
    });
    KeyFrames::new(frames.collect()).map_err(|_| RouteError::Point)
}

/// Key frames of a walk along `way` (from point to point, round what stands there) with the eyes at `eye_height` metres;
/// `level` is near the height of the ground at its beginning, or unknown.
///
/// # Errors
/// If there is no ground, or no way.
pub fn walk(
    scene: &Scene,
    way: &[DVec2],
    level: Option<f64>,
    eye_height: f64,
) -> Result<KeyFrames, RouteError> {
    let walker = Walker { scene, eye_height };
    let Some((&first, rest)) = way.split_first() else {
        return Err(RouteError::Nothing);
    };
    let mut ground = walker.first_ground(first, level)?;
    let mut path: Vec<DVec3> = Vec::new();
    for (&from, &to) in way.iter().zip(rest) {
        let piece = walker.find(from.extend(ground), to)?;
        ground = piece.last().map_or(ground, |point| point.z);
        path.extend(piece.iter().skip(usize::from(!path.is_empty())));
    }
    if path.len() < 2 {
        return Err(RouteError::Point);
    }
    let path = walker.smoothed(&path);
    let n = path.len() - 1;
    let ahead = (LOOK_AHEAD / CELL) as usize;
    let beyond = |i: usize| {
        let step = path[n] - path[n - 1];
        if i <= n {
            path[i]
        } else {
            path[n] + step.with_z(0.0) * (i - n) as f64
        }
    };
    let frames = (0..=n).map(|i| {
        // The head turns slower than the feet: towards the middle of a stretch of the way.
        let seen = (ahead / 2..=ahead).map(|j| beyond(i + j)).sum::<DVec3>();
        let target = seen / (ahead - ahead / 2 + 1) as f64;
        KeyFrame {
            time: i as f64,
            eye: Some(path[i] + DVec3::Z * eye_height),
            target: Some(target + DVec3::Z * eye_height),
            ..KeyFrame::default()
        }
    });
    KeyFrames::new(frames.collect()).map_err(|_| RouteError::Point)
}

/// Who walks.
struct Walker<'a> {
    scene: &'a Scene,
    eye_height: f64,
}

/// A cell of the grid.
type Cell = (i32, i32);

/// What is known of a cell that was reached.
#[derive(Clone, Copy)]
struct Reached {
    ground: f64,
    cost: f64,
    before: Option<Cell>,
}

impl Walker<'_> {
    /// Height of the ground where the walk begins: the lowest surface near `level`, or of all.
    fn first_ground(&self, at: DVec2, level: Option<f64>) -> Result<f64, RouteError> {
        let top = level.unwrap_or(self.scene.bounds().max.z.max(0.0) + 1.0);
        let depth = level.map_or(f64::INFINITY, |_| self.eye_height + 3.0 * STEP);
        self.lowest(at, top, depth)
            .ok_or(RouteError::NoGround(at.x, at.y))
    }

    /// The lowest surface at most `depth` metres below `top`.
    fn lowest(&self, at: DVec2, top: f64, depth: f64) -> Option<f64> {
        let ray = Ray::new(at.extend(top), DVec3::NEG_Z).until(depth);
        let mut hit = self.scene.closest(&ray)?;
        for _ in 0..MOST_LAYERS {
            match self.scene.closest_after(&ray, &hit) {
                Some(next) => hit = next,
                None => break,
            }
        }
        Some(top - hit.t)
    }

    /// Whether nothing is near at the height of the eyes and half as high.
    fn is_free(&self, at: DVec2, ground: f64) -> bool {
        [1.0, 0.5].iter().all(|part| {
            let origin = at.extend(ground + part * self.eye_height);
            (0..DIRECTIONS).all(|i| {
                let angle = std::f64::consts::TAU * f64::from(i) / f64::from(DIRECTIONS);
                let direction = DVec3::new(cos(angle), sin(angle), 0.0);
                let ray = Ray::new(origin, direction).until(CLEARANCE);
                self.scene.closest(&ray).is_none()
            })
        })
    }

    /// The shortest way over the ground from `from` (its height is that of the ground) to `to`.
    fn find(&self, from: DVec3, to: DVec2) -> Result<Vec<DVec3>, RouteError> {
        let origin = from.truncate();
        let place = |(x, y): Cell| origin + DVec2::new(f64::from(x), f64::from(y)) * CELL;
        let goal_offset = (to - origin) / CELL;
        let goal: Cell = (goal_offset.x.round() as i32, goal_offset.y.round() as i32);
        if !self.is_free(origin, from.z) {
            return Err(RouteError::Occupied(origin.x, origin.y));
        }
        let remaining = |cell: Cell| place(cell).distance(place(goal));
        let mut reached: BTreeMap<Cell, Reached> = BTreeMap::new();
        let start = Reached {
            ground: from.z,
            cost: 0.0,
            before: None,
        };
        reached.insert((0, 0), start);
        // Costs in millimetres, so that they can be ordered; then the cell, so that the order is always the same.
        let key = |cost: f64, cell: Cell| Reverse(((1000.0 * cost) as u64, cell));
        let mut open = BinaryHeap::from([key(remaining((0, 0)), (0, 0))]);
        let mut closed: BTreeMap<Cell, bool> = BTreeMap::new();
        while let Some(Reverse((_, cell))) = open.pop() {
            if closed.insert(cell, true).is_some() {
                continue;
            }
            if cell == goal {
                return Ok(trace(&reached, cell, place));
            }
            if closed.len() > MOST_CELLS {
                break;
            }
            let here = reached[&cell];
            for (dx, dy) in NEIGHBOURS {
                let next = (cell.0 + dx, cell.1 + dy);
                let cost = here.cost + f64::from(dx * dx + dy * dy).sqrt() * CELL;
                let is_better = reached.get(&next).is_none_or(|known| cost < known.cost);
                if closed.contains_key(&next) || !is_better {
                    continue;
                }
                let Some(ground) = self.lowest(place(next), here.ground + STEP, 2.0 * STEP) else {
                    continue;
                };
                if !self.is_free(place(next), ground) {
                    closed.insert(next, false);
                    continue;
                }
                let before = Some(cell);
                reached.insert(
                    next,
                    Reached {
                        ground,
                        cost,
                        before,
                    },
                );
                open.push(key(cost + remaining(next), next));
            }
        }
        Err(RouteError::Closed(origin.x, origin.y, to.x, to.y))
    }

    /// The way without its corners, unless that leads too near to something.
    fn smoothed(&self, path: &[DVec3]) -> Vec<DVec3> {
        let reach = (SMOOTHING / CELL).ceil() as usize;
        let axis = |pick: fn(&DVec3) -> f64, reach: usize| {
            let values: Vec<f64> = path.iter().map(pick).collect();
            averaged(&values, reach)
        };
        let (x, y, z) = (
            axis(|p| p.x, reach),
            axis(|p| p.y, reach),
            axis(|p| p.z, 2 * reach),
        );
        let smooth = (0..path.len()).map(|i| DVec3::new(x[i], y[i], z[i]));
        smooth
            .zip(path)
            .map(|(smooth, &rough)| {
                if self.is_free(smooth.truncate(), smooth.z) {
                    smooth
                } else {
                    rough
                }
            })
            .collect()
    }
}

/// The cells round a cell.
const NEIGHBOURS: [Cell; 8] = [
    (1, 0),
    (0, 1),
    (-1, 0),
    (0, -1),
    (1, 1),
    (-1, 1),
    (-1, -1),
    (1, -1),
];

/// The way that led to a cell.
fn trace(
    reached: &BTreeMap<Cell, Reached>,
    end: Cell,
    place: impl Fn(Cell) -> DVec2,
) -> Vec<DVec3> {
    let mut path = Vec::new();
    let mut at = Some(end);
    while let Some(cell) = at {
        let Some(known) = reached.get(&cell) else {
            break;
        };
        path.push(place(cell).extend(known.ground));
        at = known.before;
    }
    path.reverse();
    path
}

/// A smooth way through the points, cut into equal pieces.
fn even(way: &[DVec2]) -> Result<Vec<DVec2>, RouteError> {
    let points: Vec<(f64, DVec3)> = (0_u32..)
        .zip(way)
        .map(|(i, point)| (f64::from(i), point.extend(0.0)))
        .collect();
    let last = points.last().map_or(0.0, |(time, _)| *time);
    let track = Track::new(&points);
    let clock = EvenSpeed::new(&track);
    let path: Vec<DVec2> = (0..=MOST_PROBES)
        .map(|i| {
            track
                .at(clock.time(last * i as f64 / MOST_PROBES as f64))
                .truncate()
        })
        .collect();
    if path.windows(2).all(|p| p[0] == p[1]) {
        return Err(RouteError::Point);
    }
    Ok(path)
}

/// `n` + 1 of the points, evenly spread.
fn resampled(path: &[DVec2], n: usize) -> Vec<DVec2> {
    let last = path.len() - 1;
    (0..=n).map(|i| path[i * last / n]).collect()
}

/// Each value becomes the largest of those at most `reach` places from it.
fn widened(values: &[f64], reach: usize) -> Vec<f64> {
    around(values, reach, |near| {
        near.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    })
}

/// Each value becomes the mean of those at most `reach` places from it, of equally many to both sides.
fn averaged(values: &[f64], reach: usize) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    (0..values.len())
        .map(|i| {
            // The ends stay where they are.
            let reach = reach.min(i).min(last - i);
            let near = &values[i - reach..=i + reach];
            near.iter().sum::<f64>() / near.len() as f64
        })
        .collect()
}

fn around(values: &[f64], reach: usize, of: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    (0..values.len())
        .map(|i| of(&values[i.saturating_sub(reach)..=(i + reach).min(last)]))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Shape;
    use crate::material::Material;
    use crate::scene::description::{
        Group, GroupId, MaterialId, OrganId, PlacedShape, SceneDescription,
    };
    use glam::DAffine3;

    /// Upright trunks of this radius on a plane, 6 m high.
    fn stand(trunks: &[(f64, f64)], radius: f64) -> Scene {
        let placed = |shape: Shape, to_group: DAffine3| PlacedShape {
            shape,
            to_group,
            material: MaterialId(0),
            organ: OrganId(0),
        };
        let mut shapes = vec![placed(Shape::Plane, DAffine3::IDENTITY)];
        for (x, y) in trunks {
            let trunk = Shape::Frustum {
                length: 6.0,
                base_radius: radius,
                top_radius: radius,
                base_cap: true,
                top_cap: true,
            };
            shapes.push(placed(
                trunk,
                DAffine3::from_translation(DVec3::new(*x, *y, 0.0)),
            ));
        }
        Scene::build(SceneDescription {
            materials: vec![Material::default()],
            groups: vec![Group {
                shapes,
                instances: vec![],
            }],
            root: Some(GroupId(0)),
            ..SceneDescription::default()
        })
        .unwrap()
    }

    #[test]
    fn heights_are_smoothed_but_never_undercut() {
        let values: Vec<f64> = (0..200).map(|i| f64::from((i * 7919) % 83)).collect();
        let smooth = averaged(&widened(&values, 5), 5);
        assert!(smooth.iter().zip(&values).all(|(s, v)| s >= v));
        let rough = |v: &[f64]| {
            v.windows(2)
                .map(|p| (p[1] - p[0]).abs())
                .fold(0.0, f64::max)
        };
        assert!(rough(&smooth) < rough(&values) / 3.0);
    }

    #[test]
    fn a_flyover_keeps_its_height_above_everything() {
        let scene = stand(&[(0.0, 0.0), (3.0, 20.0), (-1.0, 40.0)], 1.5);
        let way = [DVec2::new(0.0, -20.0), DVec2::new(0.0, 60.0)];
        let keys = flyover(&scene, &way, 4.0).unwrap();
        for key in keys.frames() {
            let eye = key.eye.unwrap();
            let down = Ray::new(eye, DVec3::NEG_Z);
            assert!(scene.closest(&down).unwrap().t >= 4.0 - 1e-9, "{eye}");
        }
        let z = |y: f64| {
            let near = keys.frames().iter().min_by(|a, b| {
                let off = |k: &KeyFrame| (k.eye.unwrap().y - y).abs();
                off(a).total_cmp(&off(b))
            });
            near.unwrap().eye.unwrap().z
        };
        assert!(z(0.0) > 9.9 && z(-20.0) < 5.0, "{} {}", z(0.0), z(-20.0));
    }

    #[test]
    fn a_walk_goes_round_trunks() {
        // A row of trunks with one gap, 3 m wide.
        let trunks: Vec<(f64, f64)> = (-20..=20)
            .filter(|i| !(4..=5).contains(i))
            .map(|i| (f64::from(i), 0.0))
            .collect();
        let scene = stand(&trunks, 0.4);
        let keys = walk(
            &scene,
            &[DVec2::new(0.0, -5.0), DVec2::new(0.0, 5.0)],
            None,
            1.7,
        )
        .unwrap();
        let mut crossed = false;
        for key in keys.frames() {
            let eye = key.eye.unwrap();
            assert!((eye.z - 1.7).abs() < 1e-6, "{eye}");
            let nearest = trunks
                .iter()
                .map(|(x, y)| eye.truncate().distance(DVec2::new(*x, *y)));
            assert!(nearest.fold(f64::INFINITY, f64::min) > 0.6, "{eye}");
            crossed |= eye.y.abs() < 0.5 && (3.5..5.5).contains(&eye.x);
        }
        assert!(crossed, "{keys}");
        assert!(keys.frames().last().unwrap().eye.unwrap().y > 4.9);
    }

    #[test]
    fn where_nothing_leads_is_told() {
        let ring: Vec<(f64, f64)> = (0..24)
            .map(|i| (f64::from(i) * 15.0_f64.to_radians()).sin_cos())
            .map(|(s, c)| (3.0 * s, 3.0 * c))
            .collect();
        let scene = stand(&ring, 0.4);
        let inside = [DVec2::ZERO, DVec2::new(9.0, 0.0)];
        assert!(matches!(
            walk(&scene, &inside, None, 1.7),
            Err(RouteError::Closed(..))
        ));
        let on_trunk = [DVec2::new(3.0, 0.0), DVec2::ZERO];
        assert!(matches!(
            walk(&scene, &on_trunk, None, 1.7),
            Err(RouteError::Occupied(..))
        ));
        let point = [DVec2::ZERO, DVec2::ZERO];
        assert_eq!(flyover(&scene, &point, 4.0), Err(RouteError::Point));
        let empty = Scene::build(SceneDescription::default()).unwrap();
        assert_eq!(across(&empty), Err(RouteError::Nothing));
        assert_eq!(flyover(&empty, &inside, 4.0), Err(RouteError::Nothing));
    }
}
