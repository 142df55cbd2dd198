//! Boxes parallel to the axes.

use glam::{DAffine3, DVec3};

/// An axis-parallel box, in metres; empty if any `min` exceeds its `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds3 {
    /// The corner with the smallest coordinates.
    pub min: DVec3,
    /// The corner with the largest coordinates.
    pub max: DVec3,
}

impl Bounds3 {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };

    /// Whether it holds no point.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The smallest box that holds both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// The smallest box that holds this one and `point`.
    #[must_use]
    pub fn with(&self, point: DVec3) -> Self {
        Self {
            min: self.min.min(point),
            max: self.max.max(point),
        }
    }
    /// The smallest box that holds all of `points`.
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Self {
        points
            .into_iter()
            .fold(Self::EMPTY, |bounds, point| bounds.with(point))
    }

    /// The middle; meaningless if the box is empty.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        // Halved first, so that it cannot overflow.
        self.min * 0.5 + self.max * 0.5
    }

    /// The vector from `min` to `max`; zero if the box is empty.
    #[must_use]
    pub fn diagonal(&self) -> DVec3 {
        if self.is_empty() {
            DVec3::ZERO
        } else {
            self.max - self.min
        }
    }

    /// Twice the sum of the three face areas, in square metres; 0 if the box is empty.
    #[must_use]
    pub fn surface_area(&self) -> f64 {
        let d = self.diagonal();
        2.0 * (d.x * d.y + d.y * d.z + d.z * d.x)
    }

    /// The eight corners.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|corner| {
            DVec3::new(
                if corner & 1 == 0 {
                    self.min.x
                } else {
                    self.max.x
                },
                if corner & 2 == 0 {
                    self.min.y
                } else {
                    self.max.y
                },
                if corner & 4 == 0 {
                    self.min.z
                } else {
                    self.max.z
                },
            )
        })
    }

    /// The smallest box that holds the image of this one under `map`; empty if this one is.
    #[must_use]
    pub fn transformed(&self, map: &DAffine3) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let center = map.transform_point3(self.center());
        let half = self.max * 0.5 - self.min * 0.5;
        let reach = map.matrix3.x_axis.abs() * half.x
            + map.matrix3.y_axis.abs() * half.y
            + map.matrix3.z_axis.abs() * half.z;
        Self {
            min: center - reach,
            max: center + reach,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_hold_what_they_are_made_of() {
        let unit = Bounds3::of([DVec3::ZERO, DVec3::ONE]);
        assert_eq!(
            (unit.center(), unit.surface_area()),
            (DVec3::splat(0.5), 6.0)
        );
        let turned = unit.transformed(&DAffine3::from_scale(DVec3::new(-2.0, 1.0, 3.0)));
        assert_eq!(
            turned,
            Bounds3::of([DVec3::new(-2.0, 0.0, 0.0), DVec3::new(0.0, 1.0, 3.0)])
        );
        assert_eq!(unit.corners().len(), 8);
    }

    #[test]
    fn the_empty_box_stays_empty() {
        let empty = Bounds3::EMPTY.transformed(&DAffine3::from_translation(DVec3::ONE));
        assert!(empty.is_empty());
        assert_eq!((empty.surface_area(), empty.diagonal()), (0.0, DVec3::ZERO));
    }
}
