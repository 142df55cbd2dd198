//! Right-handed orthonormal frames round a direction.

use glam::DVec3;

/// Three unit vectors, pairwise perpendicular; `normal` is the local z axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Local x in world coordinates.
    pub tangent: DVec3,
    /// Local y in world coordinates.
    pub bitangent: DVec3,
    /// Local z in world coordinates.
    pub normal: DVec3,
}

impl Frame {
    /// A frame with this unit vector as z axis; x and y are arbitrary but depend on nothing else.
    ///
    /// Free of branches and of singular directions. Source: [Duff2017, listing 3](crate::references#duff2017).
    #[must_use]
    pub fn from_normal(normal: DVec3) -> Self {
        let sign = 1.0_f64.copysign(normal.z);
        let a = -1.0 / (sign + normal.z);
        let b = normal.x * normal.y * a;
        Self {
            tangent: DVec3::new(
                1.0 + sign * normal.x * normal.x * a,
                sign * b,
                -sign * normal.x,
            ),
            bitangent: DVec3::new(b, sign + normal.y * normal.y * a, -normal.y),
            normal,
        }
    }

    /// A vector given in this frame, in world coordinates.
    #[must_use]
    pub fn to_world(&self, local: DVec3) -> DVec3 {
        self.tangent * local.x + self.bitangent * local.y + self.normal * local.z
    }

    /// A world vector in this frame.
    #[must_use]
    pub fn to_local(&self, world: DVec3) -> DVec3 {
        DVec3::new(
            self.tangent.dot(world),
            self.bitangent.dot(world),
            self.normal.dot(world),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orthonormal_and_right_handed_in_every_direction() {
        let mut normals = vec![
            DVec3::Z,
            DVec3::NEG_Z,
            DVec3::X,
            DVec3::new(0.0, -0.0, -1.0),
        ];
        for i in 0..200 {
            let k = f64::from(i);
            normals.push(
                DVec3::new((k * 1.3).sin(), (k * 0.7).cos(), (k * 2.1).sin() + 0.01).normalize(),
            );
        }
        for n in normals {
            let f = Frame::from_normal(n);
            assert!((f.tangent.length() - 1.0).abs() < 1e-14, "{n}");
            assert!(f.tangent.dot(f.bitangent).abs() < 1e-14, "{n}");
            assert!((f.tangent.cross(f.bitangent) - n).length() < 1e-14, "{n}");
            let v = DVec3::new(0.2, -3.0, 0.4);
            assert!((f.to_local(f.to_world(v)) - v).length() < 1e-14, "{n}");
        }
    }
}
