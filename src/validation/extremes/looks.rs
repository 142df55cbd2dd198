//! Looking at scenes: what methods see along rays, and the world that all of them are asked about.

use super::super::check::{Setting, Trouble};
use super::super::room::{gray, square};
use crate::color::Rgb;
use crate::geometry::Shape;
use crate::integrator::{
    Integrator, Path, PhotonMapping, RadianceEstimator, Radiosity, RayCounts, Raytracer,
};
use crate::light::{Environment, Light, Sky};
use crate::material::Material;
use crate::math::{Ray, rng, warp};
use crate::sampler::{Sampler, SamplerKind};
use crate::scene::description::{
    Group, GroupId, Instance, MaterialId, OrganId, PlacedShape, SceneDescription,
};
use crate::scene::{Scene, SceneError};
use glam::{DAffine3, DVec2, DVec3};

/// Pixels along a side of a [`picture`].
const SIDE: u64 = 24;
/// Samples of a pixel.
const SAMPLES: u32 = 4;

/// A method made ready.
pub(super) fn prepared<'s>(
    method: &dyn Integrator,
    scene: &'s Scene,
    setting: &Setting<'_>,
) -> Result<Box<dyn RadianceEstimator + 's>, Trouble> {
    Ok(method.prepare(scene, &setting.context())?)
}

/// Mean radiance along a ray over samples of a stream of random numbers.
pub(super) fn seen(estimator: &dyn RadianceEstimator, ray: &Ray, stream: u64, n: u32) -> Rgb {
    let samples = (0..n).map(|index| {
        let mut sampler = Sampler::new(SamplerKind::OwenSobol, stream, index);
        estimator.incident_radiance(ray, &mut sampler, &mut RayCounts::default())
    });
    samples.sum::<Rgb>() / f64::from(n)
}

/// Mean green radiance that the points `from(u, v)` of a surface send against `w`, over a grid of n × n points.
pub(super) fn mean_over(
    estimator: &dyn RadianceEstimator,
    (n, samples): (u32, u32),
    from: impl Fn(f64, f64) -> DVec3,
    w: DVec3,
) -> f64 {
    let look = |i: u32| {
        let (u, v) = (f64::from(i % n) + 0.5, f64::from(i / n) + 0.5);
        let point = from(u / f64::from(n), v / f64::from(n));
        let ray = Ray::new(point - w * 0.2, w);
        seen(estimator, &ray, rng::hash(&[u64::from(i)]), samples).g
    };
    (0..n * n).map(look).sum::<f64>() / f64::from(n * n)
}

/// Rays in all directions from a point.
pub(super) fn around(point: DVec3, n: u64) -> Vec<Ray> {
    let unit = |i, k| rng::unit_f64(rng::hash(&[17, i, k]));
    let ray = |i| Ray::new(point, warp::sphere(DVec2::new(unit(i, 0), unit(i, 1))));
    (0..n).map(ray).collect()
}

/// Every method, with settings that are quick.
pub(super) fn methods() -> [(&'static str, Box<dyn Integrator>); 4] {
    [
        ("path", Box::new(Path::default())),
        ("raytracer", Box::new(Raytracer::default())),
        ("photon", Box::new(maps(2000, 2000, None))),
        ("radiosity", Box::new(coarse())),
    ]
}

/// Radiosity with few rays and no elements smaller than patches.
pub(super) fn coarse() -> Radiosity {
    Radiosity {
        hemicube_pixels: 8,
        subdivision_depth: 0,
        ..Radiosity::default()
    }
}

/// Photon mapping with so many photons and kernels of this area.
pub(super) fn maps(global: u64, caustic: u64, area: Option<f64>) -> PhotonMapping {
    PhotonMapping {
        global_photons: global,
        caustic_photons: Some(caustic),
        photon_area: area,
        ..PhotonMapping::default()
    }
}

/// A shape of its own material and organ.
pub(super) fn placed(shape: Shape, to_group: DAffine3, number: u32) -> PlacedShape {
    PlacedShape {
        shape,
        to_group,
        material: MaterialId(number),
        organ: OrganId(number),
    }
}

/// A shining ball, a box and leaves that overlap, on soil, below a lamp: everything times `scale`, then moved.
pub(super) fn world(scale: f64, offset: DVec3) -> Result<Scene, SceneError> {
    let put = |map: DAffine3| {
        let grow = DAffine3::from_scale(DVec3::splat(scale));
        DAffine3::from_translation(offset) * grow * map
    };
    let at = |x, y, z| DAffine3::from_translation(DVec3::new(x, y, z));
    let cube = Shape::Box {
        half_x: 0.3,
        half_y: 0.4,
        length: 0.5,
    };
    let leaf = |turn: f64| DAffine3::from_rotation_x(turn) * at(0.0, 0.0, 0.9);
    let leaves = (0..20).map(|k| placed(square(0.15), leaf(0.25 * f64::from(k)), 1));
    let plant = Group {
        shapes: leaves.collect(),
        instances: vec![],
    };
    let plants = (0..4).map(|k| Instance {
        group: GroupId(0),
        to_group: put(at(f64::from(k) - 1.5, 0.7, 0.2) * DAffine3::from_rotation_z(f64::from(k))),
        organ: OrganId(10 + k),
    });
    let root = Group {
        shapes: vec![
            placed(square(3.0), put(DAffine3::IDENTITY), 0),
            placed(Shape::Sphere { radius: 0.3 }, put(at(1.0, -0.5, 0.6)), 2),
            placed(cube, put(at(-0.8, -0.6, 0.0)), 0),
        ],
        instances: plants.collect(),
    };
    Scene::build(SceneDescription {
        materials: vec![
            Material::lambert(gray(0.4)),
            Material::leaf(gray(0.3), gray(0.4)),
            Material::lambert(gray(0.2)).emitting(gray(3.0), Rgb::BLACK),
        ],
        groups: vec![plant, root],
        root: Some(GroupId(1)),
        // What arrives from a lamp falls with the square of the distance.
        lights: vec![Light::point(
            offset + DVec3::new(0.3, -1.5, 2.0) * scale,
            gray(30.0 * scale * scale),
        )],
        environment: Environment {
            sky: Sky::Uniform(gray(0.5)),
            sun: None,
        },
        ..SceneDescription::default()
    })
}

/// The picture of [`world`], green only.
pub(super) fn picture(
    method: &dyn Integrator,
    (scale, offset): (f64, DVec3),
    setting: &Setting<'_>,
) -> Result<Vec<f64>, Trouble> {
    let scene = world(scale, offset)?;
    let estimator = prepared(method, &scene, setting)?;
    let eye = DVec3::new(0.5, -4.0, 2.5);
    let pixel = |index: u64| {
        let (x, y) = ((index % SIDE) as f64, (index / SIDE) as f64);
        let target = DVec3::new(x / SIDE as f64 - 0.5, 0.0, 0.6 - y / SIDE as f64) * 3.0;
        let ray = Ray::new(offset + eye * scale, (target - eye).normalize());
        seen(&*estimator, &ray, rng::hash(&[index]), SAMPLES).g
    };
    let picture: Vec<f64> = (0..SIDE * SIDE).map(pixel).collect();
    let is_light = |value: &f64| value.is_finite() && *value >= 0.0;
    let n_lit = picture.iter().filter(|value| **value > 0.0).count();
    // Without indirect light, or with few photons, there are shadows.
    if picture.iter().all(is_light) && 4 * n_lit > 3 * picture.len() {
        Ok(picture)
    } else {
        Err(Trouble(format!(
            "{n_lit} of {} pixels are lit, or one is no number",
            picture.len()
        )))
    }
}

/// The mean of (a - b)² / (b² + 1 % of the mean of b²).
pub(super) fn relative_mse(a: &[f64], b: &[f64]) -> f64 {
    let mean = b.iter().sum::<f64>() / b.len() as f64;
    let floor = 0.01 * mean * mean;
    let pairs = a.iter().zip(b);
    let errors = pairs.map(|(a, b)| (a - b).powi(2) / (b * b + floor));
    errors.sum::<f64>() / b.len() as f64
}

/// How many numbers are not the same to the last bit.
pub(super) fn differing(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.iter().zip(b);
    let n = pairs.filter(|(a, b)| a.to_bits() != b.to_bits()).count();
    (n + a.len().abs_diff(b.len())) as f64
}

/// The largest of numbers from 0 up; what is no number is larger than all.
pub(super) fn largest(numbers: impl IntoIterator<Item = f64>) -> f64 {
    let larger = |a: f64, b: f64| if b.is_nan() { f64::INFINITY } else { a.max(b) };
    numbers.into_iter().fold(0.0, larger)
}
