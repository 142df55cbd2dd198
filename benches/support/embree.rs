//! Embree behind a pipe, if it is there: `benches/embree/server.c`, compiled by the benchmark itself.
//!
//! The scene file, little endian: the number of groups; then for each group the numbers of corners and triangles, corners (3 `f32`)
//! and triangles (3 `u32`); the number of quads and their corners (12 `f32`); the number of cones and both ends of each (x,
//! y, z, radius); the number of instances and for each the group and a 3×4 matrix by columns. The last group is the root.

use glam::{DAffine3, DVec3};
use std::error::Error;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use tempfile::TempDir;
use understory::geometry::Shape;
use understory::math::Ray;
use understory::scene::description::Group;

type Outcome<T> = Result<T, Box<dyn Error>>;

/// Half the edge of the square that stands for a plane, in metres.
const PLANE: f64 = 1e5;

/// The compiled program, in a folder that goes away with it.
pub(crate) struct Embree {
    folder: TempDir,
}

/// A scene in Embree's hands.
pub(crate) struct Server {
    child: Child,
    ask: ChildStdin,
    answers: BufReader<ChildStdout>,
    folder: std::path::PathBuf,
    /// Seconds it took to build.
    pub(crate) build: f64,
    /// Memory that Embree says it uses, in bytes.
    pub(crate) bytes: f64,
}

impl Embree {
    /// Compiles the program; an error where there is no Embree or no compiler.
    pub(crate) fn new() -> Outcome<Self> {
        let folder = tempfile::tempdir()?;
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/embree/server.c");
        let built = Command::new("cc")
            .args(["-O2", "-o"])
            .arg(folder.path().join("server"))
            .arg(source)
            .args(["-lembree3", "-lpthread", "-lm"])
            .output()?;
        if !built.status.success() {
            return Err(String::from_utf8_lossy(&built.stderr).into());
        }
        Ok(Self { folder })
    }

    /// Hands a scene over.
    pub(crate) fn start(&self, groups: &[Group]) -> Outcome<Server> {
        let folder = self.folder.path().to_owned();
        let scene = folder.join("scene");
        fs::write(&scene, scene_file(groups))?;
        let mut child = Command::new(folder.join("server"))
            .arg(&scene)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let ask = child.stdin.take().ok_or("no pipe to Embree")?;
        let answers = BufReader::new(child.stdout.take().ok_or("no pipe from Embree")?);
        let mut server = Server {
            child,
            ask,
            answers,
            folder,
            build: 0.0,
            bytes: 0.0,
        };
        (server.build, server.bytes) = server.answer()?;
        fs::remove_file(&scene)?;
        Ok(server)
    }
}

impl Server {
    /// Sets the rays of the questions that follow.
    pub(crate) fn rays(&mut self, rays: &[Ray]) -> Outcome<()> {
        let numbers = rays.iter().flat_map(|ray| {
            let (o, d) = (ray.origin.as_vec3(), ray.direction.as_vec3());
            let (near, far) = (ray.t_min as f32, ray.t_max as f32);
            [o.x, o.y, o.z, near, d.x, d.y, d.z, far]
        });
        let path = self.folder.join("rays");
        fs::write(
            &path,
            numbers.flat_map(f32::to_le_bytes).collect::<Vec<_>>(),
        )?;
        writeln!(self.ask, "rays {}", path.display())?;
        self.answers.read_line(&mut String::new())?;
        Ok(())
    }

    /// Asks `closest`, `any` or `packets` of all rays with so many threads; processor seconds and number of hits.
    pub(crate) fn ask(&mut self, question: &str, threads: usize) -> Outcome<(f64, f64)> {
        writeln!(self.ask, "{question} {threads}")?;
        self.answer()
    }

    /// The distance of each ray's nearest hit, infinite where there is none.
    pub(crate) fn distances(&mut self) -> Outcome<Vec<f32>> {
        let path = self.folder.join("distances");
        writeln!(self.ask, "dump {}", path.display())?;
        self.answer()?;
        let bytes = fs::read(&path)?;
        let (numbers, _) = bytes.as_chunks::<4>();
        Ok(numbers
            .iter()
            .map(|bytes| f32::from_le_bytes(*bytes))
            .collect())
    }

    fn answer(&mut self) -> Outcome<(f64, f64)> {
        let mut line = String::new();
        self.answers.read_line(&mut line)?;
        let mut words = line.split_whitespace().skip(1).map(str::parse::<f64>);
        let mut next = || words.next().ok_or("Embree does not answer");
        Ok((next()??, next()??))
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // It may have ended already; either way it is gone.
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

/// A scene file under construction.
#[derive(Default)]
struct Writer(Vec<u8>);

impl Writer {
    fn count(&mut self, count: usize) {
        self.0.extend((count as u32).to_le_bytes());
    }

    fn number(&mut self, number: f64) {
        self.0.extend((number as f32).to_le_bytes());
    }

    fn point(&mut self, point: DVec3) {
        point.to_array().into_iter().for_each(|x| self.number(x));
    }
}

/// Flat and round parts of a group.
#[derive(Default)]
struct Parts {
    corners: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    quads: Vec<[DVec3; 4]>,
    cones: Vec<[(DVec3, f64); 2]>,
}

impl Parts {
    fn parallelogram(&mut self, map: &DAffine3, corner: DVec3, u: DVec3, v: DVec3) {
        let corners = [corner, corner + u, corner + u + v, corner + v];
        self.quads.push(corners.map(|at| map.transform_point3(at)));
    }

    fn add(&mut self, shape: &Shape, map: &DAffine3) {
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        match *shape {
            Shape::Mesh(ref mesh) => {
                let first = self.corners.len() as u32;
                let corners = mesh.positions.iter().map(|at| map.transform_point3(*at));
                self.corners.extend(corners);
                let triangles = mesh.triangles.iter();
                self.triangles
                    .extend(triangles.map(|corners| corners.map(|corner| corner + first)));
            }
            Shape::Parallelogram {
                corner,
                edge_u,
                edge_v,
            } => self.parallelogram(map, corner, edge_u, edge_v),
            Shape::Plane => {
                let corner = (x + y) * -PLANE;
                self.parallelogram(map, corner, x * (2.0 * PLANE), y * (2.0 * PLANE));
            }
            Shape::Box {
                half_x,
                half_y,
                length,
            } => {
                let edges = [x * (2.0 * half_x), y * (2.0 * half_y), z * length];
                let corner = DVec3::new(-half_x, -half_y, 0.0);
                for k in 0..3 {
                    let (u, v) = (edges[k], edges[(k + 1) % 3]);
                    self.parallelogram(map, corner, u, v);
                    self.parallelogram(map, corner + edges[(k + 2) % 3], u, v);
                }
            }
            // Open, and not stretched: those of the benchmark.
            Shape::Frustum {
                length,
                base_radius,
                top_radius,
                ..
            } => {
                let end = map.transform_point3(z * length);
                self.cones
                    .push([(map.translation, base_radius), (end, top_radius)]);
            }
            _ => unreachable!("the worlds of the benchmark have no other shapes"),
        }
    }
}

fn scene_file(groups: &[Group]) -> Vec<u8> {
    let mut file = Writer::default();
    file.count(groups.len());
    for group in groups {
        let mut parts = Parts::default();
        for shape in &group.shapes {
            parts.add(&shape.shape, &shape.to_group);
        }
        file.count(parts.corners.len());
        file.count(parts.triangles.len());
        parts.corners.iter().for_each(|at| file.point(*at));
        for corner in parts.triangles.iter().flatten() {
            file.count(*corner as usize);
        }
        file.count(parts.quads.len());
        for corner in parts.quads.iter().flatten() {
            file.point(*corner);
        }
        file.count(parts.cones.len());
        for (at, radius) in parts.cones.iter().flatten() {
            file.point(*at);
            file.number(*radius);
        }
        file.count(group.instances.len());
        for instance in &group.instances {
            file.count(instance.group.0 as usize);
            let matrix = instance.to_group.to_cols_array();
            matrix.into_iter().for_each(|x| file.number(x));
        }
    }
    file.0
}
