//! Which camera the options ask for.

use super::failure::Failure;
use super::sources::Sources;
use crate::camera::framing::{self, Subject};
use crate::camera::{Camera, CameraError, Lens, View, lens};
use crate::diag::Diagnostic;
use crate::math::Bounds3;
use crate::options::flying::Aperture;
use crate::options::{Options, Origin};
use crate::scene::Scene;
use glam::DVec3;

/// What there is to see before there is a scene.
const NOTHING: Subject<'static> = Subject {
    bounds: Bounds3::EMPTY,
    reach: &|_| 0.0,
};

/// The view of the options; what they leave open frames the scene.
pub fn of_scene(options: &Options, scene: &Scene) -> View {
    let reach = &|normal| scene.reach(normal);
    let bounds = scene.bounds();
    view(options, &Subject { bounds, reach })
}

/// The view, if no scene is needed to know it: the options say where the camera stands and what it looks at, or somebody else
/// does (`is_said`).
pub fn decided(options: &Options, is_said: bool) -> Option<View> {
    let is_decided = options.eye.value.is_some() && options.target.value.is_some();
    (is_decided || is_said).then(|| view(options, &NOTHING))
}

fn view(options: &Options, subject: &Subject<'_>) -> View {
    let aspect = options.size.value.aspect();
    let fov = options.fov.value;
    let whole = framing::frame(subject, fov, aspect);
    let up = options.up.value;
    let view = match (options.eye.value, options.target.value) {
        (Some(eye), Some(target)) => View {
            eye,
            target,
            up,
            fov,
        },
        (Some(eye), None) => View {
            eye,
            target: whole.target,
            up,
            fov,
        },
        (None, Some(target)) => View {
            eye: target + (whole.eye - whole.target),
            target,
            up,
            fov,
        },
        (None, None) => View { up, ..whole },
    };
    // A view straight down or up without a word on `up` is a map: north (+y) is at its top.
    let along = view.target - view.eye;
    let is_vertical = along.x == 0.0 && along.y == 0.0 && along.z != 0.0;
    if is_vertical && options.up.origin == Origin::Default {
        return View {
            up: DVec3::Y,
            ..view
        };
    }
    view
}

/// The camera of a view for pictures of the size that the options ask for.
///
/// # Errors
/// If the view is impossible: an error in the file beside the model if that said so, a usage error otherwise.
pub fn camera(sources: &Sources, options: &Options, view: &View) -> Result<Camera, Failure> {
    through_lens(options, view).map_err(|error| blame(sources, options, &error))
}

/// The camera of a view, with the lens that the options ask for.
///
/// # Errors
/// If the view is impossible.
pub(super) fn through_lens(options: &Options, view: &View) -> Result<Camera, CameraError> {
    let camera = Camera::perspective(view, options.size.value.aspect())?;
    let Some(aperture) = options.aperture.value else {
        return Ok(camera);
    };
    let focus = options.focus.value.map(|metres| metres.0);
    Ok(camera.with_lens(Lens {
        diameter: match aperture {
            Aperture::Diameter(diameter) => diameter,
            Aperture::FNumber(number) => lens::diameter(number, view.fov.half()),
        },
        focus: focus.unwrap_or(view.eye.distance(view.target)),
    }))
}

/// Refuses an impossible camera before the model is grown, if the options alone decide it.
///
/// # Errors
/// As [`camera`].
pub fn check(sources: &Sources, options: &Options) -> Result<(), Failure> {
    match decided(options, false) {
        Some(view) => camera(sources, options, &view).map(drop),
        None => Ok(()),
    }
}

fn blame(sources: &Sources, options: &Options, error: &CameraError) -> Failure {
    let keys: &[&str] = match error {
        CameraError::FieldOfView(_) => &["fov"],
        CameraError::UpAlongView(_) => &["up", "eye", "target"],
        CameraError::NoDirection(_) | CameraError::NotFinite(_) => &["eye", "target"],
    };
    let origins = keys
        .iter()
        .filter_map(|key| options.entry_of(key))
        .map(|entry| entry.origin);
    let origins: Vec<Origin> = origins.collect();
    let file = origins.iter().find_map(|origin| match origin {
        Origin::Sidecar(span) => Some(*span),
        Origin::Default | Origin::Preset(_) | Origin::Chosen { .. } | Origin::Flag => None,
    });
    match file {
        Some(span) if !origins.contains(&Origin::Flag) => Failure::model(
            &sources.map,
            Diagnostic::error("camera", span, error.to_string()),
        ),
        _ => Failure::Usage(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::inputs::Inputs;
    use crate::pipeline::world::fake::FakeWorld;
    use glam::DVec3;
    use std::path::Path;

    fn read(sidecar: &str, flags: &[(&str, &str)]) -> (Sources, Options) {
        let world = FakeWorld::default();
        world.put("p.rgg", "");
        world.put("p.toml", sidecar);
        let sources = Inputs::find(&world, Path::new("p.rgg"))
            .unwrap()
            .read(&world)
            .unwrap();
        let mut options = Options::default();
        for (key, text) in flags {
            options.set(key, text, Origin::Flag).unwrap();
        }
        let (options, _) = sources.options(&options);
        (sources, options)
    }

    /// An upright box.
    const BOX: Subject<'static> = Subject {
        bounds: Bounds3 {
            min: DVec3::ZERO,
            max: DVec3::new(2.0, 2.0, 8.0),
        },
        reach: &|normal| normal.max(DVec3::ZERO).dot(DVec3::new(2.0, 2.0, 8.0)),
    };

    #[test]
    fn what_is_left_open_frames_the_model() {
        let (_, options) = read("[camera]\neye = [9, 9, 9]", &[]);
        let seen = view(&options, &BOX);
        assert_eq!(seen.eye, DVec3::splat(9.0));
        assert!(seen.target.distance(DVec3::new(1.0, 1.0, 4.0)) < 0.5);
        let (_, options) = read("[camera]\ntarget = [0, 0, 0]", &[]);
        let (whole, seen) = (view(&Options::default(), &BOX), view(&options, &BOX));
        assert!((seen.eye - seen.target).distance(whole.eye - whole.target) < 1e-12);
    }

    #[test]
    fn a_view_straight_down_has_north_at_its_top() {
        let (_, options) = read("", &[("eye", "1,1,9"), ("target", "1,1,1")]);
        assert_eq!(view(&options, &BOX).up, DVec3::Y);
        let (_, options) = read("", &[("eye", "1,2,9"), ("target", "1,1,1")]);
        assert_eq!(view(&options, &BOX).up, DVec3::Z);
    }

    #[test]
    fn an_impossible_camera_is_blamed_on_who_asked_for_it() {
        let twice = "[camera]\neye = [1, 1, 1]\ntarget = [1, 1, 1]";
        let (sources, options) = read(twice, &[]);
        let failure = camera(&sources, &options, &view(&options, &BOX)).unwrap_err();
        assert!(matches!(failure, Failure::Model { .. }), "{failure:?}");
        let (sources, options) = read("", &[("eye", "1,1,1"), ("target", "1,1,1")]);
        let failure = camera(&sources, &options, &view(&options, &BOX)).unwrap_err();
        assert!(matches!(failure, Failure::Usage(text) if text.contains("same point")));
        let down = [("eye", "1,1,9"), ("target", "1,1,1"), ("up", "0,0,1")];
        let (sources, options) = read("", &down);
        let failure = camera(&sources, &options, &view(&options, &BOX)).unwrap_err();
        assert!(matches!(failure, Failure::Usage(text) if text.contains("up")));
    }
}
