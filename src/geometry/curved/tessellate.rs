//! From a curved surface to triangles that are nowhere further from it than a stated error.
//!
//! A grid over the parameters: its lines begin where pieces of the surface meet and are added where they are needed, separately
//! in u and v. An interval is halved if, on any line of the other direction, the curve is further from its chord than the
//! error allows, or the inside of a cell from its two triangles. Both are measured at several places of each; distances are
//! true ones, so that a flat surface stays two triangles however its parameters run.
//!
//! Lines go through the whole surface, so that neighbouring cells share their corners bit by bit; so do the two sides of a
//! closed seam and all corners at a pole. Where pieces meet at an angle, corners come twice, each with its own normal.

use super::{CurvedError, Parametric};
use crate::geometry::TriangleMesh;
use crate::math::Bounds3;
use crate::math::tolerance::{BESIDE, CREASE, SEAM};
use glam::{DVec2, DVec3};

/// Corners of the grid of one surface, at most.
const MOST_CORNERS: usize = 1 << 20;
/// Between the places where the distance is measured it can be a little larger than at them.
const CAUTION: f64 = 0.9;

/// How far triangles may be from the surface that they stand for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// So many metres, greater than 0.
    Metres(f64),
    /// This part of the diagonal of the box round the surface, greater than 0.
    Share(f64),
}

impl Tolerance {
    /// A thousandth of its size: half a pixel of what fills a screen.
    pub const USUAL: Self = Self::Share(1.0 / 1024.0);
}

/// Triangles over a grid; the first `n_columns` corners are the first row, the last ones the last row.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    pub(super) mesh: TriangleMesh,
    pub(super) n_columns: usize,
}

/// The triangles that stand for a surface, with its normals and texture coordinates of 0..=1 over its parameters.
///
/// # Errors
/// If a point of it is not finite, or it needs too many triangles.
pub fn tessellate(surface: &dyn Parametric, error: Tolerance) -> Result<TriangleMesh, CurvedError> {
    grid(surface, error).map(|grid| grid.mesh)
}

/// A line of the grid: its parameter, and from which side its normals are taken (0: from the line itself).
#[derive(Clone, Copy)]
struct Line {
    t: f64,
    side: f64,
}

/// The lines of a grid while it is refined, per direction.
struct Lines<'s> {
    surface: &'s dyn Parametric,
    t: [Vec<f64>; 2],
}

pub(super) fn grid(surface: &dyn Parametric, error: Tolerance) -> Result<Grid, CurvedError> {
    let cuts = surface.first_cuts();
    let [u, v] = surface.breaks();
    let mut lines = Lines {
        surface,
        t: [divided(&u, cuts[0]), divided(&v, cuts[1])],
    };
    let mut points = lines.points()?;
    let size = Bounds3::of(points.iter().copied()).diagonal().length();
    let allowed = CAUTION
        * match error {
            Tolerance::Metres(metres) => metres,
            Tolerance::Share(share) => share * size,
        };
    loop {
        let halved = lines.too_coarse(&points, allowed);
        if halved.iter().flatten().all(|is_halved| !is_halved) {
            break;
        }
        for (t, halved) in lines.t.iter_mut().zip(halved) {
            *t = refined(t, &halved);
        }
        points = lines.points()?;
    }
    sew(&mut points, lines.t[0].len(), size);
    let columns = creased(surface, &lines.t, 0, &u);
    let rows = creased(surface, &lines.t, 1, &v);
    Ok(built(surface, &lines.t, &points, [&columns, &rows], size))
}

/// Each interval cut into `cuts`.
fn divided(breaks: &[f64], cuts: usize) -> Vec<f64> {
    let inner = |pair: &[f64]| -> Vec<f64> {
        let (from, to) = (pair[0], pair[1]);
        (0..cuts.max(1))
            .map(|i| from + (to - from) * (i as f64 / cuts.max(1) as f64))
            .collect()
    };
    breaks
        .windows(2)
        .flat_map(inner)
        .chain(breaks.last().copied())
        .collect()
}

/// The lines with another one in the middle of each interval that is halved.
fn refined(t: &[f64], halved: &[bool]) -> Vec<f64> {
    let mut finer = Vec::with_capacity(t.len() * 2);
    for (pair, is_halved) in t.windows(2).zip(halved) {
        finer.push(pair[0]);
        let middle = (pair[0] + pair[1]) / 2.0;
        if *is_halved && middle > pair[0] && middle < pair[1] {
            finer.push(middle);
        }
    }
    finer.extend(t.last());
    finer
}

impl Lines<'_> {
    /// The corners of the grid, u first.
    fn points(&self) -> Result<Vec<DVec3>, CurvedError> {
        let [u, v] = &self.t;
        if u.len().saturating_mul(v.len()) > MOST_CORNERS {
            return Err(CurvedError::TooFine(2 * MOST_CORNERS));
        }
        let all = v.iter().flat_map(|v| u.iter().map(|u| DVec2::new(*u, *v)));
        let points: Vec<DVec3> = all.map(|at| self.surface.point(at)).collect();
        if points.iter().all(|point| point.is_finite()) {
            Ok(points)
        } else {
            Err(CurvedError::NotFinite)
        }
    }

    /// Which intervals are too long, per direction.
    fn too_coarse(&self, points: &[DVec3], allowed: f64) -> [Vec<bool>; 2] {
        let [u, v] = &self.t;
        let width = u.len();
        let mut halved = [vec![false; u.len() - 1], vec![false; v.len() - 1]];
        let at = |i: usize, j: usize| points[j * width + i];
        let [halved_u, halved_v] = &mut halved;
        for (j, at_v) in v.iter().enumerate() {
            for (i, is_halved) in halved_u.iter_mut().enumerate() {
                let curve =
                    |share: f64| self.surface.point(DVec2::new(between(u, i, share), *at_v));
                *is_halved = *is_halved || strays(curve, [at(i, j), at(i + 1, j)], allowed);
            }
        }
        for (j, is_halved) in halved_v.iter_mut().enumerate() {
            for (i, at_u) in u.iter().enumerate() {
                let curve =
                    |share: f64| self.surface.point(DVec2::new(*at_u, between(v, j, share)));
                *is_halved = *is_halved || strays(curve, [at(i, j), at(i, j + 1)], allowed);
            }
        }
        for j in 0..v.len() - 1 {
            for i in 0..u.len() - 1 {
                // What is cut anyway is measured again afterwards.
                if halved[0][i] || halved[1][j] {
                    continue;
                }
                let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                let inside = |x: f64, y: f64| {
                    self.surface
                        .point(DVec2::new(between(u, i, x), between(v, j, y)))
                };
                if bulges(inside, corners, allowed) {
                    (halved[0][i], halved[1][j]) = (true, true);
                }
            }
        }
        halved
    }
}

fn between(t: &[f64], i: usize, share: f64) -> f64 {
    t[i] + (t[i + 1] - t[i]) * share
}

/// Whether a curve leaves its chord.
fn strays(curve: impl Fn(f64) -> DVec3, [from, to]: [DVec3; 2], allowed: f64) -> bool {
    [0.25, 0.5, 0.75]
        .iter()
        .any(|share| distance_to_segment(curve(*share), from, to) > allowed)
}

/// Whether the inside of a cell leaves its two triangles.
fn bulges(inside: impl Fn(f64, f64) -> DVec3, [a, b, c, d]: [DVec3; 4], allowed: f64) -> bool {
    [
        (0.5, 0.5),
        (0.7, 0.3),
        (0.3, 0.7),
        (0.25, 0.25),
        (0.75, 0.75),
    ]
    .iter()
    .any(|(x, y)| {
        let point = inside(*x, *y);
        distance_to_triangle(point, [a, b, c]).min(distance_to_triangle(point, [a, c, d])) > allowed
    })
}

/// The distance of a point from a segment.
fn distance_to_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let length = along.length_squared();
    let share = if length > 0.0 {
        ((p - a).dot(along) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (p - (a + along * share)).length()
}

/// The distance of a point from a triangle.
pub(super) fn distance_to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let is_left = |from: DVec3, to: DVec3| normal.dot((to - from).cross(p - from)) >= 0.0;
    if normal != DVec3::ZERO && is_left(a, b) && is_left(b, c) && is_left(c, a) {
        return (p - a).dot(normal.normalize()).abs();
    }
    let edges = [(a, b), (b, c), (c, a)];
    edges
        .iter()
        .map(|(from, to)| distance_to_segment(p, *from, *to))
        .fold(f64::INFINITY, f64::min)
}

/// Makes corners that lie together equal, bit by bit: along closed seams and at poles.
fn sew(points: &mut [DVec3], width: usize, size: f64) {
    let height = points.len() / width;
    let together = |a: DVec3, b: DVec3| (a - b).abs().max_element() <= size * SEAM;
    let (last_row, last_column) = ((height - 1) * width, width - 1);
    if (0..height).all(|j| together(points[j * width], points[j * width + last_column])) {
        (0..height).for_each(|j| points[j * width + last_column] = points[j * width]);
    }
    if (0..width).all(|i| together(points[i], points[last_row + i])) {
        (0..width).for_each(|i| points[last_row + i] = points[i]);
    }
    for row in [0, last_row] {
        if (0..width).all(|i| together(points[row], points[row + i])) {
            (1..width).for_each(|i| points[row + i] = points[row]);
        }
    }
    for column in [0, last_column] {
        if (0..height).all(|j| together(points[column], points[column + j * width])) {
            (1..height).for_each(|j| points[column + j * width] = points[column]);
        }
    }
}

/// The lines of one direction, those twice where the surface has a crease.
fn creased(
    surface: &dyn Parametric,
    t: &[Vec<f64>; 2],
    direction: usize,
    breaks: &[f64],
) -> Vec<Line> {
    let (own, other) = (&t[direction], &t[1 - direction]);
    let (first, last) = (own[0], own[own.len() - 1]);
    let step = (last - first) * BESIDE;
    let is_crease = |at: f64| {
        other.windows(2).any(|pair| {
            let across = (pair[0] + pair[1]) / 2.0;
            let normal = |own: f64| {
                let at = if direction == 0 {
                    DVec2::new(own, across)
                } else {
                    DVec2::new(across, own)
                };
                let [u, v] = surface.tangents(at);
                u.cross(v).normalize_or_zero()
            };
            let (before, after) = (normal(at - step), normal(at + step));
            before != DVec3::ZERO && after != DVec3::ZERO && before.dot(after) < 1.0 - CREASE
        })
    };
    let mut lines = vec![];
    for &at in own {
        if at > first && at < last && breaks.contains(&at) && is_crease(at) {
            lines.extend([-1.0, 1.0].map(|side| Line { t: at, side }));
        } else {
            lines.push(Line { t: at, side: 0.0 });
        }
    }
    lines
}

/// The mesh over the lines.
fn built(
    surface: &dyn Parametric,
    t: &[Vec<f64>; 2],
    points: &[DVec3],
    [columns, rows]: [&[Line]; 2],
    size: f64,
) -> Grid {
    let ends = t.each_ref().map(|t| [t[0], t[t.len() - 1]]);
    let mut mesh = TriangleMesh::default();
    // The place of each line among the parameters: creases come twice.
    let places = |lines: &[Line]| -> Vec<usize> {
        let steps = lines.windows(2).scan(0, |place, pair| {
            *place += usize::from(pair[0].t < pair[1].t);
            Some(*place)
        });
        std::iter::once(0).chain(steps).collect()
    };
    let (at_u, at_v) = (places(columns), places(rows));
    for (row, j) in rows.iter().zip(&at_v) {
        for (column, i) in columns.iter().zip(&at_u) {
            let at = DVec2::new(column.t, row.t);
            mesh.positions.push(points[j * t[0].len() + i]);
            mesh.normals.push(normal(
                surface,
                at,
                DVec2::new(column.side, row.side),
                ends,
                size,
            ));
            let share = |t: f64, [first, last]: [f64; 2]| (t - first) / (last - first);
            mesh.uvs
                .push(DVec2::new(share(at.x, ends[0]), share(at.y, ends[1])));
        }
    }
    let width = columns.len();
    let mut push = |corners: [usize; 3]| {
        let [a, b, c] = corners.map(|corner| mesh.positions[corner]);
        if a != b && b != c && c != a {
            mesh.triangles.push(corners.map(|corner| corner as u32));
        }
    };
    for j in (1..rows.len()).filter(|j| at_v[*j] > at_v[j - 1]) {
        for i in (1..width).filter(|i| at_u[*i] > at_u[i - 1]) {
            let [low, high] = [(j - 1) * width + i, j * width + i];
            push([low - 1, low, high]);
            push([low - 1, high, high - 1]);
        }
    }
    Grid {
        mesh,
        n_columns: width,
    }
}

/// The normal at a place, taken a little to one side if that is asked for, or if there is none at the place itself.
fn normal(
    surface: &dyn Parametric,
    at: DVec2,
    side: DVec2,
    ends: [[f64; 2]; 2],
    size: f64,
) -> DVec3 {
    let range = DVec2::from_array(ends.map(|[first, last]| last - first));
    let middle = DVec2::from_array(ends.map(|[first, last]| (first + last) / 2.0));
    let at = at + side * range * BESIDE;
    let inwards = (middle - at) * 2.0;
    for share in [0.0, BESIDE, BESIDE.sqrt()] {
        let [u, v] = surface.tangents(at + inwards * share);
        let is_there = |tangent: DVec3, range: f64| tangent.length() * range > size * SEAM;
        if is_there(u, range.x)
            && is_there(v, range.y)
            && let Some(normal) = u.normalize().cross(v.normalize()).try_normalize()
        {
            return normal;
        }
    }
    DVec3::ZERO
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::basis::Basis;
    use super::super::curve::{Curve, plain};
    use super::super::surface::Surface;
    use super::super::surface::tests::sphere;
    use super::*;
    use std::collections::HashMap;
    use std::f64::consts::PI;

    fn corners(mesh: &TriangleMesh) -> impl Iterator<Item = [DVec3; 3]> {
        mesh.triangles
            .iter()
            .map(|t| t.map(|corner| mesh.positions[corner as usize]))
    }

    pub(in super::super) fn area(mesh: &TriangleMesh) -> f64 {
        corners(mesh)
            .map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0)
            .sum()
    }

    pub(in super::super) fn volume(mesh: &TriangleMesh) -> f64 {
        corners(mesh).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    /// Every edge is shared by exactly two triangles that run along it in opposite directions, corners equal bit by bit.
    pub(in super::super) fn assert_watertight(mesh: &TriangleMesh) {
        let mut edges: HashMap<[[u64; 3]; 2], i32> = HashMap::new();
        let key = |p: DVec3| (p + DVec3::ZERO).to_array().map(f64::to_bits);
        for [a, b, c] in corners(mesh) {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry([key(from), key(to)]).or_default() += 1;
                *edges.entry([key(to), key(from)]).or_default() -= 1;
            }
        }
        let open = edges.values().filter(|n| **n != 0).count();
        assert_eq!(open, 0, "of {} edges", edges.len());
    }

    /// The greatest distance of points of the surface from the triangles.
    fn deviation(surface: &dyn Parametric, mesh: &TriangleMesh) -> f64 {
        let [u, v] = surface.breaks();
        let between = |t: &[f64], share: f64| t[0] + (t[t.len() - 1] - t[0]) * share;
        let share = |k: i32, by: f64| (f64::from(k) * by).fract();
        let places = (0..300).map(|k| {
            DVec2::new(
                between(&u, share(k, 0.618_033_988)),
                between(&v, share(k, 0.754_877_666)),
            )
        });
        // Of the triangles over the same parameters, which is never nearer than the nearest of all.
        let over = |uv: DVec2, triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|corner| mesh.uvs[corner as usize]);
            a.min(b).min(c).cmple(uv).all() && a.max(b).max(c).cmpge(uv).all()
        };
        let distance = |at: DVec2| {
            let p = surface.point(at);
            let share = |t: &[f64], x: f64| (x - t[0]) / (t[t.len() - 1] - t[0]);
            let uv = DVec2::new(share(&u, at.x), share(&v, at.y));
            let near = mesh.triangles.iter().filter(|triangle| over(uv, triangle));
            let corners = |t: &[u32; 3]| t.map(|corner| mesh.positions[corner as usize]);
            near.map(|t| distance_to_triangle(p, corners(t)))
                .fold(f64::INFINITY, f64::min)
        };
        places.map(distance).fold(0.0, f64::max)
    }

    /// A leaf: bent along, folded across, with a wave at its rim.
    fn leaf() -> Surface {
        let point = |i: i32, j: i32| {
            let (x, y) = (f64::from(i) / 4.0 - 0.5, f64::from(j) / 5.0);
            let wide = y * (1.0 - y) * 2.0 + 0.02;
            plain(DVec3::new(
                x * wide,
                x.abs() * 0.3 + y * y * 0.5,
                y + 0.05 * f64::from((i * j) % 3),
            ))
        };
        let points = (0..6)
            .flat_map(|j| (0..5).map(move |i| point(i, j)))
            .collect();
        Surface::new(
            [Basis::clamped(4, 5).unwrap(), Basis::clamped(3, 6).unwrap()],
            points,
        )
        .unwrap()
    }

    fn rough() -> Surface {
        let point = |i: i32, j: i32| {
            plain(DVec3::new(
                f64::from(i),
                f64::from(j),
                f64::from((i * 7 + j * 5) % 4),
            ))
        };
        let points = (0..8)
            .flat_map(|j| (0..8).map(move |i| point(i, j)))
            .collect();
        Surface::new(
            [Basis::clamped(7, 8).unwrap(), Basis::clamped(2, 8).unwrap()],
            points,
        )
        .unwrap()
    }

    #[test]
    fn triangles_are_as_near_as_stated_and_not_much_nearer() {
        for surface in [leaf(), rough(), sphere(2.0)] {
            let mut last = usize::MAX;
            for metres in [1e-3, 1e-2] {
                let mesh = tessellate(&surface, Tolerance::Metres(metres)).unwrap();
                let found = deviation(&surface, &mesh);
                assert!(found <= metres, "{found} > {metres}");
                // Halving the lines once more would quarter the distance: it is not halved needlessly.
                assert!(
                    found > metres / 16.0 || mesh.triangles.len() < 100,
                    "{found} {metres}"
                );
                assert!(mesh.triangles.len() < last);
                last = mesh.triangles.len();
            }
            let share = tessellate(&surface, Tolerance::USUAL).unwrap();
            let size = Bounds3::of(share.positions.iter().copied())
                .diagonal()
                .length();
            assert!(deviation(&surface, &share) <= size / 1024.0);
        }
    }

    #[test]
    fn a_sphere_is_closed_and_nearly_its_size() {
        let mesh = tessellate(&sphere(2.0), Tolerance::Metres(1e-3)).unwrap();
        assert_watertight(&mesh);
        assert!((area(&mesh) / (16.0 * PI) - 1.0).abs() < 1.5e-3);
        assert!((volume(&mesh) / (32.0 / 3.0 * PI) - 1.0).abs() < 1.5e-3);
        for (at, normal) in mesh.positions.iter().zip(&mesh.normals) {
            assert!((*normal - *at / 2.0).length() < 1e-4, "{at} {normal}");
        }
        assert!(
            mesh.uvs
                .iter()
                .all(|uv| uv.cmpge(DVec2::ZERO).all() && uv.cmple(DVec2::ONE).all())
        );
        assert!(mesh.uvs.contains(&DVec2::ZERO) && mesh.uvs.contains(&DVec2::ONE));
    }

    #[test]
    fn flat_surfaces_stay_coarse_and_creases_sharp() {
        let flat = (0..4)
            .flat_map(|j: i32| {
                (0..4).map(move |i: i32| plain(DVec3::new(f64::from(i), f64::from(j), 0.0)))
            })
            .collect();
        let bases = [Basis::clamped(3, 4).unwrap(), Basis::clamped(3, 4).unwrap()];
        let flat = tessellate(&Surface::new(bases, flat).unwrap(), Tolerance::USUAL).unwrap();
        assert_eq!(flat.triangles.len(), 18);
        assert!(
            flat.normals
                .iter()
                .all(|n| (*n - DVec3::Z).length() < 1e-12)
        );
        // A hexagonal prism: every corner twice, with the normals of the two sides it belongs to.
        let hexagon = |z: f64| {
            let curve = Curve::polygon(1.0, 6).unwrap();
            let lifted = curve
                .control()
                .iter()
                .map(|p| *p + glam::DVec4::Z * z)
                .collect();
            Curve::new(curve.basis().clone(), lifted).unwrap()
        };
        let prism = Surface::skin(&[hexagon(0.0), hexagon(1.0)]).unwrap();
        let mesh = tessellate(&prism, Tolerance::USUAL).unwrap();
        for [a, b, c] in &mesh.triangles {
            let [p, q, r] = [a, b, c].map(|corner| mesh.positions[*corner as usize]);
            let normal = (q - p).cross(r - p).normalize();
            for corner in [a, b, c] {
                assert!(mesh.normals[*corner as usize].dot(normal) > 1.0 - 1e-9);
            }
        }
    }

    #[test]
    fn too_fine_a_surface_is_refused() {
        let error = tessellate(&sphere(1.0), Tolerance::Metres(1e-12)).unwrap_err();
        assert_eq!(error, CurvedError::TooFine(2 * MOST_CORNERS));
    }
}
