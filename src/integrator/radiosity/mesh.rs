//! Surfaces cut into patches, and patches into elements: which one a point lies in.
//!
//! Each face of the world has coordinates ([`Chart`](crate::geometry::chart::Chart)); cells are parts of their square. A patch sends
//! light; an element, which is a patch or a part of one, receives it. Cells are split into four, so that each face holds trees.
//! Instances are not shared: what stands elsewhere is lit otherwise. An infinite plane is cut around the scene, coarser with the
//! distance; what lies beyond counts as the cell at the rim that is nearest.

use super::TOO_SMALL_TO_SPLIT;
use crate::geometry::chart::Form;
use crate::light::Light;
use crate::math::warp;
use crate::scene::{Hit, PlacedChart, Scene};
use glam::{DVec2, DVec3};

/// Patches along the diagonal of the scene.
const PATCHES_ACROSS: f64 = 32.0;

/// How far the part of a plane reaches that is cut, in half diagonals of the scene.
const PLANE_REACH: f64 = 64.0;

/// Largest cells of a plane, in distances from the scene.
const PLANE_GRADE: f64 = 0.5;

/// Pieces round the axis, and along it, of what is not small.
const FEWEST_ROUND: [f64; 2] = [8.0, 4.0];

/// How much coarser the next attempt is where patches were too many, and how often it is made.
const COARSER: f64 = 1.25;
const ATTEMPTS: u32 = 64;

/// No child, or no patch.
pub(super) const NONE: u32 = u32::MAX;

/// A part of a face: coordinates from `origin` to `origin + size`; of a triangle, half of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    pub(super) chart: u32,
    pub(super) origin: DVec2,
    pub(super) size: DVec2,
}

impl Cell {
    /// The `k`-th cell of a face that is cut into so many along each coordinate.
    pub(super) fn of_grid(chart: u32, n: [u32; 2], k: u32) -> Self {
        let size = DVec2::new(1.0 / f64::from(n[0]), 1.0 / f64::from(n[1]));
        let step = DVec2::new(f64::from(k % n[0]), f64::from(k / n[0]));
        Self {
            chart,
            origin: step * size,
            size,
        }
    }
}

/// A cell and what became of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) cell: Cell,
    /// The first of four children, or [`NONE`].
    pub(super) children: u32,
    /// The patch that it is or belongs to; [`NONE`] if it holds several.
    pub(super) patch: u32,
    /// m².
    pub(super) area: f64,
}

/// The first trees of a face: a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grid {
    pub(super) first: u32,
    pub(super) n: [u32; 2],
}

/// All cells of a scene.
#[derive(Clone, Debug)]
pub(super) struct Mesh {
    pub(super) charts: Vec<PlacedChart>,
    pub(super) grids: Vec<Grid>,
    pub(super) nodes: Vec<Node>,
    /// The node that each patch is.
    pub(super) patches: Vec<u32>,
}

/// A place in an element.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) node: u32,
    /// Coordinates in the cell, 0..=1.
    pub(super) within: DVec2,
}

impl Mesh {
    /// Cuts the surfaces of a scene into at most about `most` patches.
    ///
    /// # Errors
    /// The number of patches that there would be at least.
    pub(super) fn new(scene: &Scene, most: u64) -> Result<Self, u64> {
        let Extent { radius, lamp, .. } = Extent::of(scene);
        let charts = faces(scene, most)?;
        let mut width = 2.0 * radius / PATCHES_ACROSS;
        for _ in 0..ATTEMPTS {
            let cutting = Cutting {
                scene,
                width,
                is_wide: radius > 0.0 || lamp > 0.0,
            };
            let expected: f64 = charts.iter().map(|chart| cutting.expected(chart)).sum();
            if expected <= most as f64 {
                return Ok(cutting.cut(charts));
            }
            width *= COARSER;
        }
        Err(charts.len() as u64)
    }

    /// The face that was hit, and the coordinates of the point.
    fn face_at(&self, hit: &Hit, position: DVec3) -> Option<(usize, DVec2)> {
        let first = self
            .charts
            .partition_point(|chart| chart.primitive < hit.primitive);
        let faces = self.charts[first..].iter();
        let mut same = faces.take_while(|chart| chart.primitive == hit.primitive);
        let at = first + same.position(|chart| chart.face == hit.face())?;
        Some((at, self.charts[at].chart.coordinates(position)))
    }

    /// The patch that a point lies in, if its face has any area.
    pub(super) fn patch_at(&self, hit: &Hit, position: DVec3) -> Option<u32> {
        let (chart, uv) = self.face_at(hit, position)?;
        Some(self.patch_of(chart, uv))
    }

    /// The patch of a face in which a point with these coordinates lies.
    pub(super) fn patch_of(&self, chart: usize, uv: DVec2) -> u32 {
        let place = self.descend(chart, uv, |node| node.patch != NONE);
        self.nodes[place.node as usize].patch
    }

    /// The element that a point lies in, if its face has any area.
    pub(super) fn element_at(&self, hit: &Hit, position: DVec3) -> Option<Place> {
        let (chart, uv) = self.face_at(hit, position)?;
        Some(self.descend(chart, uv, |node| node.children == NONE))
    }

    fn descend(&self, chart: usize, uv: DVec2, is_found: impl Fn(&Node) -> bool) -> Place {
        let Grid { first, n } = self.grids[chart];
        let column = |x: f64, n: u32| ((x * f64::from(n)) as u32).min(n - 1);
        let mut at = first + column(uv.x, n[0]) + n[0] * column(uv.y, n[1]);
        let is_triangle = self.charts[chart].chart.form == Form::Triangle;
        loop {
            let node = &self.nodes[at as usize];
            let within = ((uv - node.cell.origin) / node.cell.size).clamp(DVec2::ZERO, DVec2::ONE);
            if is_found(node) || node.children == NONE {
                return Place { node: at, within };
            }
            at = node.children + child_at(within, is_triangle);
        }
    }

    /// Splits an element into four.
    pub(super) fn split(&mut self, node: u32) {
        let Node { cell, patch, .. } = self.nodes[node as usize];
        let children = self.nodes.len() as u32;
        self.nodes[node as usize].children = children;
        for child in parts(&cell, self.is_triangle(&cell)) {
            self.push(child, patch);
        }
    }

    fn push(&mut self, cell: Cell, patch: u32) {
        let chart = &self.charts[cell.chart as usize].chart;
        self.nodes.push(Node {
            cell,
            children: NONE,
            patch,
            area: chart.area(cell.origin, cell.size),
        });
    }

    pub(super) fn is_triangle(&self, cell: &Cell) -> bool {
        self.charts[cell.chart as usize].chart.form == Form::Triangle
    }

    /// All elements.
    pub(super) fn elements(&self) -> impl Iterator<Item = u32> {
        let all = (0_u32..).zip(&self.nodes);
        all.filter(|(_, node)| node.children == NONE)
            .map(|(at, _)| at)
    }

    /// The coordinates of a point of a cell, chosen by two uniform numbers.
    pub(super) fn choose(&self, cell: &Cell, u: DVec2) -> DVec2 {
        let within = if self.is_triangle(cell) {
            warp::triangle(u)
        } else {
            u
        };
        cell.origin + cell.size * within
    }

    /// Coordinates of the corners of a cell: at its origin, along the first, along the second, and along both, which a triangle
    /// does not have.
    pub(super) fn corners(&self, cell: &Cell) -> Vec<DVec2> {
        let Cell { origin, size, .. } = *cell;
        let n = if self.is_triangle(cell) { 3 } else { 4 };
        let ways = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
        ways[..n].iter().map(|way| origin + size * *way).collect()
    }

    /// Whether an element is so small that its halves could not be told apart.
    pub(super) fn is_tiny(&self, node: u32) -> bool {
        self.nodes[node as usize].cell.size.abs().min_element() < TOO_SMALL_TO_SPLIT
    }
}

/// Which of the four parts of a cell a point is in.
fn child_at(within: DVec2, is_triangle: bool) -> u32 {
    if is_triangle {
        return match within {
            DVec2 { x, .. } if x > 0.5 => 1,
            DVec2 { y, .. } if y > 0.5 => 2,
            DVec2 { x, y } if x + y < 0.5 => 0,
            _ => 3,
        };
    }
    u32::from(within.x >= 0.5) + 2 * u32::from(within.y >= 0.5)
}

/// The four parts of a cell.
pub(super) fn parts(cell: &Cell, is_triangle: bool) -> [Cell; 4] {
    let half = cell.size * 0.5;
    let part = |x: f64, y: f64| Cell {
        chart: cell.chart,
        origin: cell.origin + half * DVec2::new(x, y),
        size: half,
    };
    if is_triangle {
        // The one in the middle stands on its head.
        let middle = Cell {
            origin: cell.origin + half,
            size: -half,
            ..*cell
        };
        [part(0.0, 0.0), part(1.0, 0.0), part(0.0, 1.0), middle]
    } else {
        [
            part(0.0, 0.0),
            part(1.0, 0.0),
            part(0.0, 1.0),
            part(1.0, 1.0),
        ]
    }
}

/// All faces of a scene.
///
/// # Errors
/// Their number if that is more than `most`.
pub(super) fn faces(scene: &Scene, most: u64) -> Result<Vec<PlacedChart>, u64> {
    let extent = Extent::of(scene);
    scene.charts(most, extent.center, extent.reach)
}

/// Where a scene is and how far planes are cut, metres.
struct Extent {
    center: DVec3,
    /// Half the diagonal of what is bounded.
    radius: f64,
    /// Distance of the farthest lamp from the middle.
    lamp: f64,
    /// How far planes are cut.
    reach: f64,
}

impl Extent {
    fn of(scene: &Scene) -> Self {
        let bounds = scene.bounds();
        let (center, radius) = if bounds.is_empty() {
            (DVec3::ZERO, 0.0)
        } else {
            (bounds.center(), 0.5 * bounds.diagonal().length())
        };
        let lamps = scene.lights().iter().filter_map(|light| match light {
            Light::Point { position, .. } | Light::Spot { position, .. } => Some(*position),
            Light::Directional { .. } => None,
        });
        let lamp = lamps.map(|lamp| lamp.distance(center)).fold(0.0, f64::max);
        let reach = match PLANE_REACH * radius.max(lamp) {
            reach if reach > 0.0 => reach,
            _ => 1.0,
        };
        Self {
            center,
            radius,
            lamp,
            reach,
        }
    }
}

/// How surfaces are cut.
struct Cutting<'s> {
    scene: &'s Scene,
    /// Wanted width of patches, metres.
    width: f64,
    /// Whether there is anything beside planes.
    is_wide: bool,
}

impl Cutting<'_> {
    fn cut(&self, charts: Vec<PlacedChart>) -> Mesh {
        let mut mesh = Mesh {
            charts,
            grids: Vec::new(),
            nodes: Vec::new(),
            patches: Vec::new(),
        };
        for at in 0..mesh.charts.len() {
            let placed = mesh.charts[at];
            let n = self.grid(&placed);
            let first = mesh.nodes.len() as u32;
            mesh.grids.push(Grid { first, n });
            for k in 0..n[0] * n[1] {
                mesh.push(Cell::of_grid(at as u32, n, k), NONE);
            }
            // Nodes are split until they are patches; those of the tree so far and those that come of it.
            let mut node = first as usize;
            while node < mesh.nodes.len() {
                if self.is_too_large(&mesh, &mesh.nodes[node]) {
                    mesh.split(node as u32);
                } else {
                    mesh.nodes[node].patch = mesh.patches.len() as u32;
                    mesh.patches.push(node as u32);
                }
                node += 1;
            }
        }
        mesh
    }

    /// How many cells along each coordinate a face begins with.
    fn grid(&self, placed: &PlacedChart) -> [u32; 2] {
        let m = placed.chart.to_world.matrix3;
        let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis].map(DVec3::length);
        let pieces = |length: f64| (length / self.width).ceil().clamp(1.0, 4096.0);
        let round = |radius: f64, length: f64| {
            let around = 2.0 * std::f64::consts::PI * radius;
            if around.max(length) <= self.width {
                return [1.0; 2];
            }
            let fewest = if around > 0.5 * self.width {
                FEWEST_ROUND
            } else {
                [1.0; 2]
            };
            [pieces(around).max(fewest[0]), pieces(length)]
        };
        let n = match placed.chart.form {
            _ if placed.is_plane() || self.width <= 0.0 => [1.0; 2],
            Form::Triangle => [1.0; 2],
            Form::Parallelogram => [pieces(x), pieces(y)],
            Form::Disk => round(x.max(y), x.max(y)),
            Form::Side { base, top } => round(x.max(y) * base.max(top), z),
            Form::Sphere => {
                let [u, v] = round(x.max(y), 2.0 * z);
                let fewest = if u > 1.0 { FEWEST_ROUND[1] } else { 1.0 };
                [u, v.max(fewest)]
            }
        };
        n.map(|n| n as u32)
    }

    /// About how many patches a face becomes.
    fn expected(&self, placed: &PlacedChart) -> f64 {
        let n = self.grid(placed);
        let cells = f64::from(n[0]) * f64::from(n[1]);
        if placed.is_plane() && self.is_wide {
            return 8.0 * PATCHES_ACROSS * PATCHES_ACROSS;
        }
        if placed.chart.form == Form::Triangle && self.width > 0.0 {
            let longest = longest_edge(placed, DVec2::ONE);
            let splits = (longest / self.width).max(1.0).log2().ceil().min(12.0);
            return (2.0 * splits).exp2();
        }
        cells
    }

    fn is_too_large(&self, mesh: &Mesh, node: &Node) -> bool {
        let placed = &mesh.charts[node.cell.chart as usize];
        if self.width <= 0.0 || node.cell.size.abs().min_element() < TOO_SMALL_TO_SPLIT {
            return false;
        }
        if placed.is_plane() {
            let middle = placed.chart.point(node.cell.origin + node.cell.size * 0.5);
            let bounds = self.scene.bounds();
            let size = longest_edge(placed, node.cell.size);
            let nearest = middle.position.clamp(bounds.min, bounds.max);
            let distance = (middle.position.distance(nearest) - 0.5 * size).max(0.0);
            return self.is_wide && size > self.width.max(PLANE_GRADE * distance);
        }
        let is_triangle = placed.chart.form == Form::Triangle;
        is_triangle && longest_edge(placed, node.cell.size) > self.width
    }
}

/// The longest edge of a flat cell, metres.
fn longest_edge(placed: &PlacedChart, size: DVec2) -> f64 {
    let m = placed.chart.to_world.matrix3;
    let (x, y) = (m.x_axis * size.x, m.y_axis * size.y);
    let across = if placed.chart.form == Form::Triangle {
        (x - y).length()
    } else {
        0.0
    };
    x.length().max(y.length()).max(across)
}
