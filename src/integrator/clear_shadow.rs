//! Shadows of clear bodies as if light went straight through them.

use super::RayCounts;
use super::medium::left_after;
use crate::color::Rgb;
use crate::material::{LobeKind, fresnel};
use crate::math::Ray;
use crate::scene::Scene;

/// Fraction of light per channel that comes straight along the ray if smooth glass does not bend it: what panes and alpha
/// pass, what the boundaries of bodies do not reflect, and what the bodies do not absorb; `absorption` in 1/m is that of the
/// body around the start of the ray.
///
/// Exact for what has no thickness. A solid body bends light, and gathers elsewhere what this takes for a weak shadow.
pub(super) fn transmittance(
    scene: &Scene,
    ray: &Ray,
    mut absorption: Rgb,
    rays: &mut RayCounts,
) -> Rgb {
    let mut left = Rgb::WHITE;
    let mut entered = 0.0;
    let mut next = scene.closest(ray);
    while let Some(hit) = next {
        let point = scene.surface(ray, &hit);
        let optics = scene.optics(&point);
        let cos = point.normal_g.dot(ray.direction);
        let mut passage = optics.passage(cos);
        for lobe in optics.scattering.lobes {
            if let LobeKind::Dielectric {
                ior,
                absorption: inside,
                ..
            } = lobe.kind
                && lobe.is_delta()
            {
                let eta = if point.is_front { ior } else { 1.0 / ior };
                let reflectance = fresnel::dielectric(cos.abs(), eta).reflectance;
                passage += lobe.weight * ((1.0 - reflectance) * optics.alpha);
                left *= left_after(absorption, hit.t - entered);
                entered = hit.t;
                absorption = if point.is_front { inside } else { Rgb::BLACK };
            }
        }
        left *= passage;
        if left.is_black() {
            return left;
        }
        rays.shadow += 1;
        next = scene.closest_after(ray, &hit);
    }
    left * left_after(absorption, ray.t_max - entered)
}
