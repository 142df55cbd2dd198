//! Light that methods which start at the camera do not find, so that a picture that lacks it says so.

use crate::light::Light;
use crate::material::{Lobe, LobeKind, Material};
use crate::scene::Scene;

/// Whether light of a lamp without extent, or of the sun, may reach surfaces through smooth glass that bends it: no path that
/// begins at the camera finds such light, or hardly ever. Panes do not bend it, and rough glass spreads it.
///
/// Conservative: it does not look at where glass and lamps are. Cost O(materials + lights).
#[must_use]
pub fn has_focused_light(scene: &Scene) -> bool {
    let bends = |lobe: &Lobe| {
        lobe.is_delta() && matches!(lobe.kind, LobeKind::Dielectric { ior, .. } if ior != 1.0)
    };
    let is_glass = |material: &Material| material.alpha > 0.0 && material.lobes.iter().any(bends);
    let shines = |light: &Light| !light.power(1.0).is_black();
    let sun = scene.environment().sun.as_ref();
    let is_sunny = sun.is_some_and(|sun| !sun.irradiance.is_black());
    (is_sunny || scene.lights().iter().any(shines)) && scene.materials().iter().any(is_glass)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::geometry::Shape;
    use crate::light::{Environment, SunDisk};
    use crate::math::angle::Angle;
    use crate::validation::room::{Room, at, even_sky};
    use glam::DVec3;

    fn with(material: Material) -> Room {
        Room::default().with(Shape::Sphere { radius: 1.0 }, at(0., 0., 0.), material)
    }

    #[test]
    fn only_bending_glass_before_small_lights_is_told() {
        let lamp = || Light::point(DVec3::Z * 3.0, Rgb::WHITE);
        let glass = || Material::glass(1.5, 0.0, Rgb::BLACK);
        let sunny = Environment {
            sun: SunDisk::clear(Angle::deg(0.0), Angle::deg(40.0), 3.0),
            ..Environment::default()
        };
        let cases = [
            (with(glass()).lit_by(lamp()), true),
            (with(glass()).under(sunny), true),
            (with(glass()).under(even_sky(1.0)), false),
            (
                with(glass()).lit_by(Light::point(DVec3::Z, Rgb::BLACK)),
                false,
            ),
            (with(Material::pane(1.5, Rgb::WHITE)).lit_by(lamp()), false),
            (
                with(Material::glass(1.5, 0.5, Rgb::BLACK)).lit_by(lamp()),
                false,
            ),
            (
                with(Material::glass(1.0, 0.0, Rgb::WHITE)).lit_by(lamp()),
                false,
            ),
            (with(Material::default()).lit_by(lamp()), false),
        ];
        for (nth, (room, expected)) in cases.into_iter().enumerate() {
            assert_eq!(has_focused_light(&room.scene().unwrap()), expected, "{nth}");
        }
    }
}
