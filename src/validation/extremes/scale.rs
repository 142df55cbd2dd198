//! Units of length and places: C-21, C-22, and what coincides: C-29.

use super::super::check::{Check, Setting, Trouble};
use super::super::room::{gray, square};
use super::looks::{differing, largest, methods, picture, placed, relative_mse};
use crate::color::Rgb;
use crate::integrator::Integrator;
use crate::material::Material;
use crate::math::Ray;
use crate::math::tolerance::{SAME_PICTURE_ELSEWHERE, SAME_PICTURE_IN_OTHER_UNITS};
use crate::scene::Scene;
use crate::scene::description::{Group, GroupId, OrganId, SceneDescription};
use glam::{DAffine3, DVec3};

/// Relative mean squared error of 2000 photons that are not quite the same: 8 % in a pixel were measured.
const NOISE_OF_PHOTONS_ELSEWHERE: f64 = 0.02;

/// The checks.
pub(super) fn checks() -> Vec<Check> {
    let mut checks = Vec::new();
    for (nth, (name, _)) in methods().into_iter().enumerate() {
        let method = move || methods().into_iter().nth(nth).map(|(_, method)| method);
        checks.extend(of_method(name, method));
    }
    checks.push(
        Check::within(
            (
                "C-29-lamps",
                "of ten coincident lamps of different radiance, along 200 rays, in two orders: other than the first seen",
            ),
            0.0,
            0.0,
            |_| of_coincident_lamps_others_seen(),
        )
        .of_case("29"),
    );
    checks
}

/// A picture by a method in other units and elsewhere.
fn of_method(
    name: &'static str,
    method: impl Fn() -> Option<Box<dyn Integrator>> + Copy + Send + Sync + 'static,
) -> Vec<Check> {
    let by_units =
        move |setting: &Setting<'_>, scales: &[f64], compare: fn(&[f64], &[f64]) -> f64| {
            let worlds = scales.iter().map(|scale| (*scale, DVec3::ZERO));
            worst(&*wanted(method())?, worlds, setting, compare)
        };
    let powers_of_two: Vec<f64> = [-20, -7, -1, 3, 10, 20].map(|k| 2.0_f64.powi(k)).to_vec();
    vec![
        Check::within(
            (
                format!("C-21-powers-of-2-{name}"),
                format!("{name}: 24 × 24 pixels in units of 2^-20, 2^-7, 2^-1, 2^3, 2^10, 2^20 m: pixels that are not the same to the bit"),
            ),
            0.0,
            0.0,
            move |setting| by_units(setting, &powers_of_two, differing),
        )
        .of_case("21"),
        Check::within(
            (
                format!("C-21-powers-of-10-{name}"),
                format!("{name}: the same in units of 10^-6, 10^-3, 10^3, 10^6 m: largest relative mean squared error"),
            ),
            0.0,
            SAME_PICTURE_IN_OTHER_UNITS,
            move |setting| by_units(setting, &[1.0 / 1e6, 1.0 / 1e3, 1e3, 1e6], relative_mse),
        )
        .of_case("21"),
        Check::within(
            (
                format!("C-22-{name}"),
                format!("{name}: 24 × 24 pixels of a world 1e5, 1e6 and 1e7 m from the origin: largest relative mean squared error"),
            ),
            0.0,
            // Boxes that photons are aimed at are a little wider far away: photons are others, the light is the same.
            if name == "photon" {
                NOISE_OF_PHOTONS_ELSEWHERE
            } else {
                SAME_PICTURE_ELSEWHERE
            },
            move |setting| {
                let away = |distance: f64| DVec3::new(distance, -0.7 * distance, 0.3 * distance);
                let worlds = [1e5, 1e6, 1e7].map(|distance| (1.0, away(distance)));
                worst(&*wanted(method())?, worlds, setting, relative_mse)
            },
        )
        .of_case("22"),
    ]
}

fn wanted(method: Option<Box<dyn Integrator>>) -> Result<Box<dyn Integrator>, Trouble> {
    method.ok_or_else(|| Trouble("there is no such method".into()))
}

/// How different from the usual picture the most different one is.
fn worst(
    method: &dyn Integrator,
    worlds: impl IntoIterator<Item = (f64, DVec3)>,
    setting: &Setting<'_>,
    compare: fn(&[f64], &[f64]) -> f64,
) -> Result<f64, Trouble> {
    let usual = picture(method, (1.0, DVec3::ZERO), setting)?;
    let mut all = Vec::new();
    for world in worlds {
        if setting.cancel.is_cancelled() {
            break;
        }
        all.push(compare(&picture(method, world, setting)?, &usual));
    }
    Ok(largest(all))
}

/// C-29: of squares that coincide and shine differently, the one with the lowest number is seen, whatever it is made of.
fn of_coincident_lamps_others_seen() -> Result<f64, Trouble> {
    let mut others = 0;
    for first in [0_u32, 5] {
        let lamps = (0..10).map(|k| {
            let mut lamp = placed(square(1.0), DAffine3::IDENTITY, (k + first) % 10);
            lamp.organ = OrganId(k);
            lamp
        });
        let radiance = |k: u32| gray(f64::from(k) + 1.0);
        let material = |k| Material::lambert(Rgb::BLACK).emitting(radiance(k), Rgb::BLACK);
        let scene = Scene::build(SceneDescription {
            materials: (0..10).map(material).collect(),
            groups: vec![Group {
                shapes: lamps.collect(),
                instances: vec![],
            }],
            root: Some(GroupId(0)),
            ..SceneDescription::default()
        })?;
        for k in 0..100 {
            let x = f64::from(k) / 50.0 - 0.99;
            let ray = Ray::new(DVec3::new(x, 0.3, 2.0), DVec3::NEG_Z);
            let point = scene.closest(&ray).map(|hit| scene.surface(&ray, &hit));
            let is_first =
                point.is_some_and(|point| (point.organ.0, point.material.0) == (0, first));
            others += u32::from(!is_first);
        }
    }
    Ok(f64::from(others))
}
