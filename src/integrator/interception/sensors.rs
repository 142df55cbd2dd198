//! Discs that count the light that passes them, without being there for it.

use crate::color::Rgb;
use crate::geometry::Shape;
use crate::integrator::photon::{Account, Ledger, Scale};
use crate::interpret::Sensor;
use crate::material::Material;
use crate::math::functions::pow;
use crate::math::{Bounds3, Ray};
use crate::scene::description::{
    Group, GroupId, MaterialId, OrganId, PlacedShape, SceneDescription,
};
use crate::scene::{Scene, SceneError};
use std::f64::consts::PI;

/// Sensors, in a scene of their own: no photon meets them.
#[derive(Debug, Default)]
pub struct SensorField {
    sensors: Vec<Sensor>,
    /// The discs; their organ numbers are places in the list. `None` if there are none.
    discs: Option<Scene>,
}

impl SensorField {
    /// A field of these sensors.
    ///
    /// # Errors
    /// The first one whose disc cannot be placed, by its place in the list as an organ number.
    pub fn new(sensors: Vec<Sensor>) -> Result<Self, SceneError> {
        if sensors.is_empty() {
            return Ok(Self::default());
        }
        let disc = |(place, sensor): (u32, &Sensor)| PlacedShape {
            shape: Shape::Disk {
                radius: sensor.radius,
            },
            to_group: sensor.to_world,
            material: MaterialId(0),
            organ: OrganId(place),
        };
        let discs = Scene::build(SceneDescription {
            materials: vec![Material::default()],
            groups: vec![Group {
                shapes: (0..).zip(&sensors).map(disc).collect(),
                instances: vec![],
            }],
            root: Some(GroupId(0)),
            ..SceneDescription::default()
        })?;
        Ok(Self {
            sensors,
            discs: Some(discs),
        })
    }

    /// The sensors.
    #[must_use]
    pub fn sensors(&self) -> &[Sensor] {
        &self.sensors
    }

    /// Number of sensors.
    #[must_use]
    pub fn len(&self) -> usize {
        self.sensors.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.sensors.is_empty()
    }

    /// A box that holds them all; empty if there are none.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        self.discs.as_ref().map_or(Bounds3::EMPTY, Scene::bounds)
    }

    /// An empty account for each.
    pub(super) fn accounts(&self) -> Vec<Account> {
        vec![Account::default(); self.sensors.len()]
    }

    /// Counts a photon that flies along a ray.
    pub(super) fn count(&self, ray: &Ray, power: Rgb, scale: Scale, sensed: &mut [Account]) {
        let Some(discs) = &self.discs else { return };
        let mut next = discs.closest(ray);
        while let Some(hit) = next {
            let point = discs.surface(ray, &hit);
            let place = point.organ.0 as usize;
            let sensor = &self.sensors[place];
            if point.is_front || sensor.is_two_sided {
                let cos = point.normal_g.dot(ray.direction).abs();
                let weight = if sensor.exponent == 1.0 {
                    1.0
                } else {
                    pow(cos, sensor.exponent - 1.0)
                };
                if weight.is_finite() {
                    sensed[place].add(scale.quanta(power * sensor.color * weight));
                }
            }
            next = discs.closest_after(ray, &hit);
        }
    }

    /// What each sensor reads, W/m² per channel.
    pub(super) fn readings(&self, sensed: &[Account], ledger: &Ledger) -> Vec<Rgb> {
        let reading = |(sensor, account): (&Sensor, &Account)| {
            let m = sensor.to_world.matrix3;
            let area = PI * sensor.radius * sensor.radius * m.x_axis.cross(m.y_axis).length();
            ledger.watts(account) / area
        };
        self.sensors.iter().zip(sensed).map(reading).collect()
    }
}
