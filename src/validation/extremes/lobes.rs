//! Scattering: the same both ways, sampled as it is, with densities that integrate to 1: C-47.

use super::super::check::{Check, Trouble};
use super::super::room::gray;
use super::looks::largest;
use crate::color::Rgb;
use crate::material::{
    Density, Lobe, LobeKind, Material, Reflection, ScatterNumbers, ScatteringFrame, Side, Transport,
};
use crate::math::frame::Frame;
use crate::math::functions::{cos, sin};
use crate::math::tolerance::CLOSED_FORM;
use crate::math::{rng, warp};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Normal of the surfaces here, tilted so that no axis is special.
const NORMAL: DVec3 = DVec3::new(0.48, -0.6, 0.64);

/// Angles of what looks to the front normal, degrees: straight, slanted, grazing, on both sides.
const ANGLES: [f64; 6] = [0.0, 40.0, 85.0, 95.0, 130.0, 180.0];

/// The checks.
pub(super) fn checks() -> Vec<Check> {
    let reciprocity = Check::within(
        (
            "C-47-both-ways",
            "f(a, b) and f(b, a), by n², of eight kinds of lobes in 2000 pairs of directions: largest difference, as a part of both",
        ),
        0.0,
        CLOSED_FORM,
        |_| {
            Ok(largest(
                symmetric().iter().map(|(_, material)| both_ways(material)),
            ))
        },
    );
    let weights = Check::within(
        (
            "C-47-weights",
            "what sampling hands out less f cos / pdf, and pdf stated and asked, ten materials, six angles, 200 samples: largest difference",
        ),
        0.0,
        CLOSED_FORM,
        |_| Ok(largest(all().iter().map(|(_, material)| weights(material)))),
    );
    let densities = Check::within(
        (
            "C-47-densities",
            "integrals of densities, and what of 4000 samples goes in single directions or nowhere: largest difference of the sum from 1",
        ),
        0.0,
        0.03,
        |_| {
            let sums: Result<Vec<f64>, Trouble> = all()
                .iter()
                .map(|(_, material)| Ok(sums(material)))
                .collect();
            Ok(largest(sums?))
        },
    );
    let checks = [reciprocity, weights, densities];
    checks.map(|check| check.of_case("47")).into()
}

fn frame() -> ScatteringFrame {
    ScatteringFrame {
        normal_g: NORMAL,
        normal_s: NORMAL,
    }
}

/// A direction at this angle (degrees) to the front normal.
fn at(degrees: f64) -> DVec3 {
    let angle = degrees.to_radians();
    let local = DVec3::new(sin(angle) * 0.8, sin(angle) * 0.6, cos(angle));
    Frame::from_normal(NORMAL).to_world(local).normalize()
}

fn numbers(i: u64) -> ScatterNumbers {
    let [a, b, c, d] = [0, 1, 2, 3].map(|k| rng::unit_f64(rng::hash(&[0x000F_71C5, i, k])));
    ScatterNumbers {
        direction: DVec2::new(a, b),
        lobe: DVec2::new(c, d),
    }
}

fn of(kind: LobeKind) -> Material {
    Material::of_lobes(vec![Lobe::new(kind, gray(0.8))])
}

/// Lobes whose value is the same both ways.
fn symmetric() -> Vec<(&'static str, Material)> {
    let leaf = Material::leaf(gray(0.3), gray(0.4));
    let metal = Material::metal(Rgb::new(1.0, 0.7, 0.3), 0.5);
    let varnish = LobeKind::Rough {
        alpha: 0.3,
        reflection: Reflection::Varnish(1.5),
    };
    vec![
        ("phong", of(LobeKind::Phong { exponent: 20.0 })),
        ("haze", of(LobeKind::Haze { exponent: 8.0 })),
        ("metal", metal.clone()),
        ("varnish", of(varnish)),
        ("rough glass", Material::glass(1.5, 0.6, Rgb::BLACK)),
        ("rough bubble", Material::glass(1.0 / 1.5, 0.7, Rgb::BLACK)),
        ("leaf", leaf.clone()),
        ("leaf and metal", Material::mixed(&leaf, &metal, 0.5)),
    ]
}

/// Those and mixtures with single directions.
fn all() -> Vec<(&'static str, Material)> {
    let side = |rho, tau| Side {
        reflectance: gray(rho),
        transmittance: gray(tau),
    };
    let matt = Material::matt([side(0.5, 0.2), side(0.1, 0.6)]);
    let glass = Material::glass(1.5, 0.0, Rgb::BLACK);
    let mut all = symmetric();
    all.push(("matt and glass", Material::mixed(&matt, &glass, 0.6)));
    let mirror = Material::mirror(gray(0.9));
    all.push((
        "phong and mirror",
        Material::mixed(&of(LobeKind::Phong { exponent: 20.0 }), &mirror, 0.6),
    ));
    all
}

/// Across a boundary the value per squared index of the side it leaves on is symmetric.
fn both_ways(material: &Material) -> f64 {
    let (frame, scattering) = (frame(), material.scattering());
    let inside = material.lobes.iter().find_map(|lobe| match lobe.kind {
        LobeKind::Dielectric { ior, .. } => Some(ior),
        _ => None,
    });
    let index = |w: DVec3| {
        if frame.is_in_front(w) {
            1.0
        } else {
            inside.unwrap_or(1.0)
        }
    };
    let off = |i: u64| {
        let [a, b] = [2 * i, 2 * i + 1].map(|i| warp::sphere(numbers(i).direction));
        let f = |o: DVec3, i: DVec3| {
            let value = scattering.value_cos(&frame, o, i, Transport::Radiance).g;
            value / (i.dot(NORMAL).abs() * index(o) * index(o))
        };
        let (ab, ba) = (f(a, b), f(b, a));
        if ab == ba {
            0.0
        } else {
            (ab - ba).abs() / (ab + ba)
        }
    };
    largest((0..2000).map(off))
}

fn weights(material: &Material) -> f64 {
    let (frame, scattering) = (frame(), material.scattering());
    let mut all = Vec::new();
    for wo in ANGLES.map(at) {
        for transport in [Transport::Radiance, Transport::Importance] {
            for i in 0..200 {
                let Some(sample) = scattering.sample(&frame, wo, numbers(i), transport) else {
                    continue;
                };
                let Density::SolidAngle(pdf) = sample.density else {
                    continue;
                };
                let again = scattering.pdf_solid_angle(&frame, wo, sample.wi, transport);
                all.push((pdf / again - 1.0).abs());
                let value = scattering.value_cos(&frame, wo, sample.wi, transport);
                let off = (value / pdf - sample.weight).map(f64::abs).max_channel();
                all.push(off / (1.0 + sample.weight.max_channel()));
            }
        }
    }
    largest(all)
}

/// How far the integral of the density, with the share of samples that it does not stand for, is from 1, at the worst angle.
fn sums(material: &Material) -> f64 {
    let (frame, scattering) = (frame(), material.scattering());
    let (rows, columns) = (400, 200);
    let local = Frame::from_normal(NORMAL);
    let off = |wo: DVec3| {
        let mut smooth = 0.0;
        for k in 0..rows * columns {
            // Equal steps of height along the normal, halved near the poles by a square.
            let t = (f64::from(k / columns) + 0.5) / f64::from(rows) * 2.0 - 1.0;
            let z = t * (2.0 - t.abs());
            let weight = 2.0 * (1.0 - t.abs()) * 2.0 / f64::from(rows) * TAU / f64::from(columns);
            let turn = (f64::from(k % columns) + 0.5) / f64::from(columns);
            let w = local.to_world(warp::direction(z, turn));
            smooth += scattering.pdf_solid_angle(&frame, wo, w, Transport::Radiance) * weight;
        }
        let n = 4000;
        let is_smooth = |i: &u64| {
            let sample = scattering.sample(&frame, wo, numbers(*i), Transport::Radiance);
            sample.is_some_and(|sample| sample.density != Density::Delta)
        };
        let others = n - (0..n).filter(is_smooth).count() as u64;
        (smooth + others as f64 / n as f64 - 1.0).abs()
    };
    largest(ANGLES.map(|degrees| off(at(degrees))))
}
