//! What a model is given that it does not bring along: daylight, and a ground to stand on.

use super::failure::Failure;
use crate::color::Rgb;
use crate::geometry::Shape;
use crate::integrator::requirements::Feature;
use crate::interpret::Summary;
use crate::light::{Dome, Environment, Sky, SkyImage};
use crate::material::Material;
use crate::math::Bounds3;
use crate::math::angle::Angle;
use crate::options::Options;
use crate::options::surroundings::{SkyKind, SunIrradiance};
use crate::options::value::{Brightness, Daylight, Ground};
use crate::scene::description::{
    Extras, Group, GroupId, MaterialId, OrganId, PlacedShape, SceneDescription,
};
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;

/// The organ of what belongs to no organ of the model.
pub const NO_ORGAN: OrganId = OrganId(u32::MAX);

/// Reflectance of the ground that a model is given, and of the land round about: dry soil with short grass.
const SOIL: Rgb = Rgb::new(0.23, 0.21, 0.15);

/// Azimuth and elevation of the sun in the daylight that a model is given: over the left shoulder of who looks at it from
/// where [`frame`](crate::camera::framing::frame) stands, so that light and shadow both show.
const SUN: (Angle, Angle) = (Angle::deg(225.0), Angle::deg(40.0));

/// The light round a model: what the options say, made ready.
#[derive(Clone, Debug)]
pub struct Outdoors {
    /// The sky and its sun; `None` if the model has its own light and nothing else was asked for.
    environment: Option<Environment>,
    /// Whether it is there because the model has no light.
    is_given: bool,
}

impl Outdoors {
    /// The light that the options ask for, for a model that has light of its own or not; `panorama` is the picture that
    /// they name.
    ///
    /// # Errors
    /// If they contradict each other.
    pub fn new(
        options: &Options,
        has_light: bool,
        panorama: Option<Arc<SkyImage>>,
    ) -> Result<Self, Failure> {
        let sun = sun(options)?;
        let ground = reflectance(options);
        let elevation = sun.map_or(SUN.1, |(_, elevation)| elevation);
        let no_sun = options.sun.value == Daylight::None;
        let clear = |(azimuth, elevation): (Angle, Angle)| {
            // The compass runs from north (+y) over east (+x), mathematics from +x to +y.
            let from_x = Angle::deg(90.0 - azimuth.degrees());
            Environment::daylight(from_x, elevation, options.turbidity.value.0, ground)
        };
        let environment = match (&options.sky.value, panorama) {
            (SkyKind::Image(_), Some(image)) => Some(Environment {
                sky: Sky::Image {
                    image,
                    turn: Angle::deg(options.sky_turn.value),
                    strength: 1.0,
                },
                // Whoever names a panorama after the sun was put up means the panorama, which has its own.
                sun: sun
                    .filter(|_| !options.sky.origin.beats(options.sun.origin))
                    .and_then(|sun| clear(sun).sun),
            }),
            (SkyKind::Radiance(radiance), _) => Some(Environment {
                sky: Sky::Uniform(*radiance),
                sun: sun.and_then(|sun| clear(sun).sun),
            }),
            (SkyKind::Overcast, _) => Some(Environment::overcast(elevation, ground)),
            (SkyKind::Uniform, _) => {
                let overcast = Dome::new(&Environment::overcast(elevation, ground));
                Some(Environment {
                    sky: Sky::Uniform(overcast.horizontal_irradiance() / PI),
                    sun: None,
                })
            }
            (SkyKind::Clear, _) if no_sun => {
                return Err(contradiction("`sky` clear has a sun, and `sun` says none"));
            }
            (SkyKind::Clear, _) => Some(clear(sun.unwrap_or(SUN))),
            (SkyKind::Auto | SkyKind::Image(_), _) if no_sun => None,
            (SkyKind::Auto | SkyKind::Image(_), _) => {
                sun.or((!has_light).then_some(SUN)).map(clear)
            }
        };
        Ok(Self {
            environment: environment
                .map(|environment| with_sun_as_asked(environment, options))
                .map(|environment| as_bright_as_asked(environment, options)),
            is_given: !has_light,
        })
    }

    /// Adds the light, and the ground that the options ask for.
    pub fn complete(self, description: &mut SceneDescription, model: &Summary, options: &Options) {
        let wants_ground = match options.ground.value {
            Ground::Auto => self.is_given && self.environment.is_some() && !model.has_plane,
            Ground::None => false,
            Ground::Color(_) => true,
        };
        if let Some(environment) = self.environment {
            description.environment = environment;
        }
        let kept = options.require.value;
        description.extras = Extras {
            groups: kept.contains(Feature::Groups),
            coordinates: kept.contains(Feature::Coordinates),
        };
        if wants_ground {
            add_ground(description, reflectance(options), &model.bounds);
        }
    }
}

/// The sun's azimuth from north over east and its elevation, if the options put it somewhere.
fn sun(options: &Options) -> Result<Option<(Angle, Angle)>, Failure> {
    let (direct, date) = (&options.sun, &options.date);
    let Some(moment) = date.value.filter(|_| !direct.origin.beats(date.origin)) else {
        return Ok(match direct.value {
            Daylight::Sun { azimuth, elevation } => Some((azimuth, elevation)),
            Daylight::Auto | Daylight::None => None,
        });
    };
    if direct.value != Daylight::Auto && !date.origin.beats(direct.origin) {
        return Err(contradiction(
            "`sun` and `date` both say where the sun is; give one of them",
        ));
    }
    let Some(place) = options.place.value else {
        return Err(contradiction(
            "`date` needs `place`, the latitude and longitude, to tell where the sun stands",
        ));
    };
    let (azimuth, elevation) = place.sun(moment);
    if elevation.degrees() > 0.0 {
        return Ok(Some((azimuth, elevation)));
    }
    Err(contradiction(&format!(
        "at `date` {} the sun is {:.1}° below the horizon of `place` {}: there is no daylight",
        date.text,
        -elevation.degrees(),
        options.place.text
    )))
}

fn contradiction(message: &str) -> Failure {
    Failure::Usage(message.to_owned())
}

/// Reflectance of the ground and of the land round about.
fn reflectance(options: &Options) -> Rgb {
    match options.ground.value {
        Ground::Color(reflectance) => reflectance,
        Ground::Auto | Ground::None => SOIL,
    }
}

/// Gives the sun the irradiance that was asked for.
fn with_sun_as_asked(mut environment: Environment, options: &Options) -> Environment {
    if let (Some(sun), Some(SunIrradiance(wanted))) =
        (&mut environment.sun, options.sun_irradiance.value)
    {
        sun.irradiance = wanted;
    }
    environment
}

/// Scales sky and sun together to the power that was asked for; what is dark stays dark.
fn as_bright_as_asked(environment: Environment, options: &Options) -> Environment {
    let Some(Brightness(wanted)) = options.sky_power.value else {
        return environment;
    };
    let sun = environment.sun.as_ref();
    let direct = sun.map_or(Rgb::BLACK, |sun| sun.irradiance * sun.to_sun.z.max(0.0));
    let found = (Dome::new(&environment).horizontal_irradiance() + direct).sum();
    if found > 0.0 {
        environment.brightened(wanted / found)
    } else {
        environment
    }
}

/// The shapes placed in the world itself, not in instances.
fn world_shapes(description: &SceneDescription) -> impl Iterator<Item = &PlacedShape> {
    let root = description
        .root
        .and_then(|root| description.groups.get(root.0 as usize));
    root.into_iter().flat_map(|group| &group.shapes)
}

/// How much of a model's height may be in the ground, as roots and feet of trunks are.
const MOST_IN_GROUND: f64 = 0.05;

/// Adds the plane z = 0, a little lower where the model has a floor of its own there, and under the whole model if more than a
/// little of it is below: a drawing that grows downwards, or all round the origin, shall be seen.
fn add_ground(description: &mut SceneDescription, reflectance: Rgb, bounds: &Bounds3) {
    let below = -bounds.min.z;
    let is_below = !bounds.is_empty() && below > MOST_IN_GROUND * bounds.diagonal().z;
    let foot = if is_below { below } else { 0.0 };
    // Two surfaces in one place hide each other by chance: sink under a floor by a thousandth of its size.
    let floors = world_shapes(description).filter_map(floor_size);
    let sunk = foot.max(floors.fold(0.0, f64::max) / 1000.0);
    let material = MaterialId(description.materials.len() as u32);
    description.materials.push(Material::lambert(reflectance));
    let ground = PlacedShape {
        shape: Shape::Plane,
        to_group: DAffine3::from_translation(DVec3::new(0.0, 0.0, -sunk)),
        material,
        organ: NO_ORGAN,
    };
    let root = match description.root {
        Some(root) => root,
        None => {
            description.groups.push(Group::default());
            GroupId(description.groups.len() as u32 - 1)
        }
    };
    description.root = Some(root);
    if let Some(group) = description.groups.get_mut(root.0 as usize) {
        group.shapes.push(ground);
    }
}

/// The size of a flat shape that lies in the plane z = 0.
fn floor_size(placed: &PlacedShape) -> Option<f64> {
    let corners = match &placed.shape {
        Shape::Parallelogram {
            corner,
            edge_u,
            edge_v,
        } => {
            vec![
                *corner,
                *corner + *edge_u,
                *corner + *edge_v,
                *corner + *edge_u + *edge_v,
            ]
        }
        Shape::Disk { radius } => [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y]
            .map(|axis| axis * *radius)
            .to_vec(),
        Shape::Mesh(mesh) => mesh.positions.clone(),
        Shape::Sphere { .. } | Shape::Frustum { .. } | Shape::Box { .. } | Shape::Plane => {
            return None;
        }
    };
    let placed_corners = corners
        .into_iter()
        .map(|corner| placed.to_group.transform_point3(corner));
    let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (min, max) = placed_corners.fold(none, |(min, max), p| (min.min(p), max.max(p)));
    let size = (max - min).truncate().max_element();
    // Closer than the plane would sink: they would still meet.
    let is_floor = min.z > -size / 1000.0 && max.z < size / 1000.0;
    is_floor.then_some(size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Light;
    use crate::options::Origin;

    fn model(shapes: Vec<Shape>) -> SceneDescription {
        let place = |shape| PlacedShape {
            shape,
            to_group: DAffine3::IDENTITY,
            material: MaterialId(0),
            organ: OrganId(0),
        };
        let shapes = shapes.into_iter().map(place).collect();
        SceneDescription {
            materials: vec![Material::lambert(Rgb::splat(0.5))],
            groups: vec![Group {
                shapes,
                instances: vec![],
            }],
            root: Some(GroupId(0)),
            ..SceneDescription::default()
        }
    }

    fn completed(description: SceneDescription, flags: &[(&str, &str)]) -> SceneDescription {
        completed_within(description, flags, Bounds3::EMPTY)
    }

    fn completed_within(
        mut description: SceneDescription,
        flags: &[(&str, &str)],
        bounds: Bounds3,
    ) -> SceneDescription {
        let mut options = Options::default();
        for (key, text) in flags {
            options.set(key, text, Origin::Flag).unwrap();
        }
        let model = Summary {
            has_light: !description.lights.is_empty(),
            has_plane: plane_height(&description).is_some(),
            bounds,
        };
        let outdoors = Outdoors::new(&options, model.has_light, None).unwrap();
        outdoors.complete(&mut description, &model, &options);
        description
    }

    fn plane_height(description: &SceneDescription) -> Option<f64> {
        let plane = world_shapes(description).find(|placed| placed.shape == Shape::Plane)?;
        Some(plane.to_group.translation.z)
    }

    const BALL: Shape = Shape::Sphere { radius: 1.0 };

    #[test]
    fn a_model_without_light_stands_in_daylight_on_a_plane() {
        let given = completed(model(vec![BALL]), &[]);
        assert!(given.environment.sun.is_some() && given.environment.sky != Sky::None);
        assert_eq!(plane_height(&given), Some(0.0));
        assert_eq!(
            plane_height(&completed(SceneDescription::default(), &[])),
            Some(0.0)
        );
        assert_eq!(
            plane_height(&completed(model(vec![BALL]), &[("ground", "none")])),
            None
        );
    }

    #[test]
    fn a_model_with_light_is_left_alone_unless_told() {
        let mut lit = model(vec![BALL]);
        lit.lights.push(Light::Point {
            position: DVec3::Z,
            intensity: Rgb::WHITE,
        });
        let given = completed(lit.clone(), &[]);
        assert_eq!(
            (
                given.environment,
                plane_height(&completed(lit.clone(), &[]))
            ),
            (Environment::default(), None)
        );
        assert!(
            completed(lit.clone(), &[("sun", "90,30")])
                .environment
                .sun
                .is_some()
        );
        assert_eq!(
            plane_height(&completed(lit, &[("ground", "0.5,0.5,0.5")])),
            Some(0.0)
        );
        let dark = completed(model(vec![BALL]), &[("sun", "none")]);
        assert_eq!(
            (plane_height(&dark), dark.environment),
            (None, Environment::default())
        );
    }

    #[test]
    fn azimuths_are_those_of_the_compass() {
        let east = completed(model(vec![BALL]), &[("sun", "90,30")]);
        let to_sun = east.environment.sun.unwrap().to_sun;
        assert!(
            to_sun.x > 0.8 && to_sun.y.abs() < 1e-12 && to_sun.z > 0.4,
            "{to_sun}"
        );
    }

    #[test]
    fn the_plane_lies_under_a_floor_of_the_model() {
        let floor = Shape::Parallelogram {
            corner: DVec3::new(-50.0, -50.0, 0.0),
            edge_u: DVec3::X * 100.0,
            edge_v: DVec3::Y * 100.0,
        };
        assert_eq!(
            plane_height(&completed(model(vec![floor, BALL]), &[])),
            Some(-0.1)
        );
        let own = completed(model(vec![Shape::Plane]), &[]);
        assert_eq!(world_shapes(&own).count(), 1);
    }

    #[test]
    fn the_plane_lies_under_a_model_that_grows_downwards_and_at_0_under_roots() {
        let height = |min: f64, max: f64| {
            let (min, max) = (DVec3::new(-1.0, -1.0, min), DVec3::new(1.0, 1.0, max));
            let flags = &[];
            plane_height(&completed_within(
                model(vec![BALL]),
                flags,
                Bounds3 { min, max },
            ))
        };
        assert_eq!(height(-3.0, 0.5), Some(-3.0));
        assert_eq!(height(-1.0, 1.0), Some(-1.0));
        assert_eq!(height(-0.2, 9.8), Some(0.0));
        assert_eq!(height(4.0, 5.0), Some(0.0));
    }

    fn outdoors(flags: &[(&str, &str)]) -> Result<Environment, Failure> {
        let mut options = Options::default();
        for (key, text) in flags {
            options.set(key, text, Origin::Flag).unwrap();
        }
        let image = SkyImage::new(2, 1, vec![[1.0; 3]; 2]).unwrap();
        let found = Outdoors::new(&options, true, Some(Arc::new(image)))?;
        Ok(found.environment.unwrap_or_default())
    }

    #[test]
    fn a_time_and_a_place_tell_where_the_sun_stands() {
        let flags = [
            ("date", "2003-10-17T12:30-07:00"),
            ("place", "39.742476,-105.1786"),
        ];
        let sun = outdoors(&flags).unwrap().sun.unwrap().to_sun;
        // Azimuth 194.3° from north over east, elevation 39.9°.
        assert!(
            (sun.x + 0.190).abs() < 0.005 && (sun.y + 0.743).abs() < 0.005,
            "{sun}"
        );
        for wrong in [
            vec![flags[0]],
            vec![flags[0], flags[1], ("sun", "1,2")],
            vec![("date", "2003-10-17T00:30-07:00"), flags[1]],
            vec![("sky", "clear"), ("sun", "none")],
        ] {
            assert!(
                matches!(outdoors(&wrong), Err(Failure::Usage(_))),
                "{wrong:?}"
            );
        }
    }

    #[test]
    fn a_sky_that_is_asked_for_is_there_whatever_the_model_brings() {
        assert_eq!(outdoors(&[]).unwrap(), Environment::default());
        let sky = |flags: &[(&str, &str)]| outdoors(flags).unwrap();
        assert!(matches!(
            sky(&[("sky", "overcast")]).sky,
            Sky::Overcast { .. }
        ));
        assert!(matches!(sky(&[("sky", "clear")]).sky, Sky::ClearSky { .. }));
        assert!(sky(&[("sky", "overcast")]).sun.is_none());
        assert!(matches!(sky(&[("sky", "a.exr")]).sky, Sky::Image { .. }));
        let given = [
            ("sky", "1,2,3"),
            ("sun", "90,30"),
            ("sun-irradiance", "5,6,7"),
        ];
        let given = sky(&given);
        assert_eq!(given.sky, Sky::Uniform(Rgb::new(1.0, 2.0, 3.0)));
        assert_eq!(given.sun.unwrap().irradiance, Rgb::new(5.0, 6.0, 7.0));
        assert!(sky(&[("sky", "1,2,3")]).sun.is_none());
        assert!(sky(&[("sky", "a.exr"), ("sun", "90,30")]).sun.is_some());
        // Overcast and uniform skies of the same hour give the ground the same light.
        let light = |flags: &[(&str, &str)]| Dome::new(&sky(flags)).horizontal_irradiance();
        let high = [("sky", "uniform"), ("sun", "90,80")];
        let (uniform, overcast) = (
            light(&high),
            light(&[("sky", "overcast"), ("sun", "90,80")]),
        );
        assert!((uniform.g / overcast.g - 1.0).abs() < 1e-12);
        assert!(light(&[("sky", "uniform")]).g < uniform.g);
    }

    #[test]
    fn a_power_is_that_on_level_ground() {
        for kind in ["clear", "overcast", "uniform", "a.hdr"] {
            let found = outdoors(&[("sky", kind), ("sky-power", "500")]).unwrap();
            let direct = found
                .sun
                .as_ref()
                .map_or(Rgb::BLACK, |sun| sun.irradiance * sun.to_sun.z);
            let sum = (Dome::new(&found).horizontal_irradiance() + direct).sum();
            assert!((sum / 500.0 - 1.0).abs() < 1e-9, "{kind}: {sum}");
        }
    }
}
