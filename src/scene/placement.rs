//! Maps of instances, stored small.
//!
//! A forest has millions of instances and nearly all of them are moved, turned, scaled evenly and perhaps mirrored. Such a
//! map fits into a quaternion, a scale and a translation, 64 bytes instead of 96, without loss: the numbers that come back
//! differ from those given by a few units in the last place, and not at all if the map does not turn. Any other map is kept whole in a list beside.

use crate::math::tolerance::SIMILARITY;
use glam::{DAffine3, DMat3, DQuat, DVec3};

/// An affine map, in 64 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placement {
    /// A rotation. If `scale` is NaN, the first number holds the bits of an index into the list of matrices instead.
    quaternion: [f64; 4],
    /// Even scale after the rotation, negative if the map mirrors.
    scale: f64,
    translation: DVec3,
}

impl Placement {
    /// Stores `map`, its matrix in `matrices` if it is not a similarity.
    pub(super) fn new(map: &DAffine3, matrices: &mut Vec<DMat3>) -> Self {
        let translation = map.translation;
        if let Some((quaternion, scale)) = similarity(&map.matrix3) {
            return Self {
                quaternion,
                scale,
                translation,
            };
        }
        let quaternion = [f64::from_bits(matrices.len() as u64), 0.0, 0.0, 0.0];
        matrices.push(map.matrix3);
        Self {
            quaternion,
            scale: f64::NAN,
            translation,
        }
    }

    /// The map; `matrices` is the list it was stored with.
    #[inline(always)]
    pub(super) fn map(&self, matrices: &[DMat3]) -> DAffine3 {
        let matrix3 = if self.scale.is_nan() {
            matrices[self.quaternion[0].to_bits() as usize]
        } else {
            rotation(self.quaternion) * self.scale
        };
        DAffine3 {
            matrix3,
            translation: self.translation,
        }
    }
}

/// The rotation and the signed scale that make up a matrix, or `None` if there are none.
fn similarity(matrix: &DMat3) -> Option<([f64; 4], f64)> {
    let scale = matrix.x_axis.length().copysign(matrix.determinant());
    let turn = DQuat::from_mat3(&(*matrix * (1.0 / scale)))
        .normalize()
        .to_array();
    let back = rotation(turn) * scale;
    let close = |a: DVec3, b: DVec3| (a - b).abs().max_element() <= SIMILARITY * scale.abs();
    let is_similar = close(back.x_axis, matrix.x_axis)
        && close(back.y_axis, matrix.y_axis)
        && close(back.z_axis, matrix.z_axis);
    is_similar.then_some((turn, scale))
}

/// The matrix of a unit quaternion.
#[inline(always)]
fn rotation([x, y, z, w]: [f64; 4]) -> DMat3 {
    let (xx, yy, zz) = (2.0 * x * x, 2.0 * y * y, 2.0 * z * z);
    let (xy, xz, yz) = (2.0 * x * y, 2.0 * x * z, 2.0 * y * z);
    let (wx, wy, wz) = (2.0 * w * x, 2.0 * w * y, 2.0 * w * z);
    DMat3::from_cols(
        DVec3::new(1.0 - yy - zz, xy + wz, xz - wy),
        DVec3::new(xy - wz, 1.0 - xx - zz, yz + wx),
        DVec3::new(xz + wy, yz - wx, 1.0 - xx - yy),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: &DAffine3, b: &DAffine3, scale: f64) -> bool {
        let a = a.to_cols_array();
        a.iter()
            .zip(b.to_cols_array())
            .all(|(a, b)| (a - b).abs() <= 1e-14 * scale)
    }

    #[test]
    fn similarities_come_back_and_need_no_list() {
        let mut matrices = Vec::new();
        for k in 0..200 {
            let k = f64::from(k);
            let axis = DVec3::new(k.sin(), k.cos(), 0.3 - (k * 0.7).sin()).normalize();
            // Half turns among them: the quaternion's w is 0 there.
            let angle = if k % 3.0 == 0.0 {
                std::f64::consts::PI
            } else {
                k * 0.37
            };
            for scale in [1e-6, -1.0, 3.0, -1e7] {
                let map = DAffine3 {
                    matrix3: DMat3::from_axis_angle(axis, angle) * scale,
                    translation: DVec3::new(k, -1e6, 0.1),
                };
                let back = Placement::new(&map, &mut matrices).map(&matrices);
                assert!(close(&map, &back, scale.abs()), "{map:?} {back:?}");
            }
        }
        for diagonal in [
            DVec3::new(1.0, -1.0, 1.0),
            DVec3::new(-1.0, -1.0, 1.0),
            DVec3::NEG_ONE,
        ] {
            let map = DAffine3::from_scale(diagonal * 2.0);
            assert_eq!(Placement::new(&map, &mut matrices).map(&matrices), map);
        }
        assert!(matrices.is_empty());
        assert_eq!(size_of::<Placement>(), 64);
    }

    #[test]
    fn other_maps_are_kept_whole() {
        let mut matrices = Vec::new();
        let stretch = DMat3::from_diagonal(DVec3::new(1.0, 1.0, 1.0 + 1e-9));
        for matrix in [
            stretch,
            DMat3::from_cols(DVec3::X, DVec3::new(0.2, 1.0, 0.0), DVec3::Z),
        ] {
            let map = DAffine3 {
                matrix3: matrix,
                translation: DVec3::ONE,
            };
            let stored = Placement::new(&map, &mut matrices);
            assert_eq!(stored.map(&matrices), map);
        }
        assert_eq!(matrices.len(), 2);
    }
}
