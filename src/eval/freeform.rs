//! Curves, curved surfaces and meshes as a model describes them: plain numbers, which only drawing checks and understands.

/// A curve, a surface, or what they are made of.
#[derive(Clone, Debug, PartialEq)]
pub enum Freeform {
    /// A list of points.
    Points(Points),
    /// A curve.
    Curve(CurveForm),
    /// A surface.
    Surface(SurfaceForm),
    /// Triangles.
    Mesh(MeshForm),
}

/// Points, one after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// Their coordinates.
    pub data: Vec<f64>,
    /// How many coordinates each has: 2, 3, or 4 with its weight.
    pub dimension: i32,
}

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveForm {
    /// Round the origin in the plane of x and y.
    Circle(f64),
    /// A regular polygon of radius 1 round the origin in the plane of x and y.
    Polygon(i32),
    /// The smooth curve through points.
    Through(Points),
    /// A B-spline of control points.
    Spline {
        /// Its control points.
        points: Points,
        /// Its degree.
        degree: i32,
        /// Whether it closes.
        is_periodic: bool,
        /// Whether it consists of Bézier pieces.
        is_bezier: bool,
    },
}

/// A surface.
#[derive(Clone, Debug, PartialEq)]
pub enum SurfaceForm {
    /// A grid of control points.
    Grid {
        /// Its control points, u first.
        points: Points,
        /// Points per row.
        u_count: i32,
        /// Degrees in u and v; without them it is one Bézier piece.
        degrees: Option<[i32; 2]>,
    },
    /// A profile carried along a trajectory.
    Sweep(CurveForm, CurveForm),
    /// A skin over profiles.
    Skin(Vec<CurveForm>),
    /// A profile turned round z.
    Revolution(CurveForm),
}

/// Triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshForm {
    /// x, y, z of each corner.
    pub vertices: Vec<f64>,
    /// Three corners per triangle; empty: the corners in their order.
    pub indices: Vec<i32>,
    /// x, y, z of the normal at each corner, or empty.
    pub normals: Vec<f64>,
    /// u, v at each corner, or empty.
    pub textures: Vec<f64>,
}

impl Freeform {
    /// Bytes that its numbers take.
    pub fn bytes(&self) -> u64 {
        let mut key = vec![];
        self.write_key(&mut key);
        8 * key.len() as u64
    }

    /// Appends numbers that are equal for equal forms only.
    pub fn write_key(&self, key: &mut Vec<u64>) {
        match self {
            Self::Points(points) => points.write_key(key),
            Self::Curve(curve) => curve.write_key(key),
            Self::Surface(surface) => surface.write_key(key),
            Self::Mesh(mesh) => {
                for list in [&mesh.vertices, &mesh.normals, &mesh.textures] {
                    write_numbers(list, key);
                }
                key.extend(
                    mesh.indices
                        .iter()
                        .map(|index| i64::from(*index).cast_unsigned()),
                );
            }
        }
    }
}

impl Points {
    fn write_key(&self, key: &mut Vec<u64>) {
        key.push(i64::from(self.dimension).cast_unsigned());
        write_numbers(&self.data, key);
    }
}

impl CurveForm {
    fn write_key(&self, key: &mut Vec<u64>) {
        match self {
            Self::Circle(radius) => key.extend([1, radius.to_bits()]),
            Self::Polygon(sides) => key.extend([2, i64::from(*sides).cast_unsigned()]),
            Self::Through(points) => {
                key.push(3);
                points.write_key(key);
            }
            Self::Spline {
                points,
                degree,
                is_periodic,
                is_bezier,
            } => {
                key.extend([4, i64::from(*degree).cast_unsigned()]);
                key.extend([u64::from(*is_periodic), u64::from(*is_bezier)]);
                points.write_key(key);
            }
        }
    }
}

impl SurfaceForm {
    fn write_key(&self, key: &mut Vec<u64>) {
        match self {
            Self::Grid {
                points,
                u_count,
                degrees,
            } => {
                let [u, v] = degrees.unwrap_or_default();
                key.push(1);
                key.extend([*u_count, u, v].map(|n| i64::from(n).cast_unsigned()));
                points.write_key(key);
            }
            Self::Sweep(profile, trajectory) => {
                key.push(2);
                profile.write_key(key);
                trajectory.write_key(key);
            }
            Self::Skin(profiles) => {
                key.extend([3, profiles.len() as u64]);
                profiles.iter().for_each(|profile| profile.write_key(key));
            }
            Self::Revolution(profile) => {
                key.push(4);
                profile.write_key(key);
            }
        }
    }
}

fn write_numbers(numbers: &[f64], key: &mut Vec<u64>) {
    key.push(numbers.len() as u64);
    key.extend(numbers.iter().map(|x| x.to_bits()));
}
