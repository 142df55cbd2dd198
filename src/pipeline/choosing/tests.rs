//! What is open to choice, and what is chosen.

use super::*;
use crate::options::value::Renderer;

fn options(set: &[(&str, &str, Origin)]) -> Options {
    let mut options = Options::default();
    for (key, text, origin) in set {
        options.set(key, text, *origin).unwrap();
    }
    options
}

/// Stands for a line of the file beside the model: a weaker origin than a flag.
fn file() -> Origin {
    let mut sources = crate::diag::SourceMap::default();
    let file = sources.add("m.toml", "x");
    Origin::Sidecar(crate::diag::Span::new(file, 0, 1))
}

const ERROR: Wish = Wish::Error(0.1);

fn known(family: Family, law: Law) -> Known {
    Known {
        family,
        rung: 0,
        law,
    }
}

fn noisy(seconds: f64) -> Law {
    Law {
        sample: seconds,
        noise: 1.0,
        ..Law::default()
    }
}

fn biased(seconds: f64, bias: f64) -> Law {
    Law {
        shared: seconds,
        sample: 0.01,
        noise: 0.01,
        bias,
        ..Law::default()
    }
}

#[test]
fn two_wishes_exclude_each_other_and_files_of_light_exclude_one() {
    let both = options(&[("time", "3", Origin::Flag), ("error", "2%", Origin::Flag)]);
    assert!(
        matches!(Wish::of(&both), Err(Failure::Usage(text)) if text.contains("`time` and `error`"))
    );
    let one = options(&[("error", "2%", Origin::Flag)]);
    assert_eq!(Wish::of(&one).unwrap(), Some(Wish::Error(0.02)));
    assert!(Wish::check(&one, true).is_err() && Wish::check(&one, false).is_ok());
    assert!(Wish::check(&Options::default(), true).is_ok());
}

/// What the user names stays, unless it stands in the file and the wish is a flag.
#[test]
fn what_is_named_as_expressly_as_the_wish_stays() {
    let renderer = |named: Origin, wish: Origin| {
        let set = [("renderer", "photon", named), ("error", "0.1", wish)];
        Chooser::new(&options(&set), ERROR).families(true)
    };
    let photon = [Family::PhotonMap, Family::PhotonGather];
    assert_eq!(renderer(Origin::Flag, Origin::Flag), photon);
    assert_eq!(renderer(file(), file()), photon);
    assert_eq!(renderer(Origin::Flag, file()), photon);
    assert_eq!(renderer(file(), Origin::Flag), Family::ALL);
    let set = [
        ("error", "0.1", Origin::Flag),
        ("final-gather", "0", Origin::Flag),
        ("samples", "7", Origin::Flag),
        ("photon-area", "0.5", file()),
        ("max-depth", "3", Origin::Flag),
    ];
    let chooser = Chooser::new(&options(&set), ERROR);
    assert!(!chooser.families(true).contains(&Family::PhotonGather));
    assert_eq!(chooser.samples, Some(7));
    let chosen = chooser.with(Family::PhotonMap, 1, Some(99)).unwrap();
    assert_eq!(
        (chosen.samples.value.get(), chosen.photon_area.value),
        (7, None)
    );
    assert_eq!(chosen.final_gather.value.0, Some(0));
    let chosen = chooser.with(Family::Path, 0, None).unwrap();
    assert_eq!(chosen.max_depth.value, Some(3));
    // Without a judge, only what finds all light.
    let free = Chooser::new(&options(&[]), ERROR).families(false);
    assert_eq!(free, photon);
}

#[test]
fn chosen_settings_are_a_command_line_of_what_is_not_so_already() {
    let set = [
        ("error", "0.1", Origin::Flag),
        ("supersampling", "5", file()),
        ("renderer", "raytracer", file()),
    ];
    let chooser = Chooser::new(&options(&set), ERROR);
    let chosen = chooser.with(Family::Path, 0, Some(48)).unwrap();
    assert_eq!(chosen.renderer.value, Renderer::Path);
    assert_eq!(
        command_line(&chosen),
        "--renderer path --samples 48 --supersampling auto"
    );
    assert_eq!(command_line(&options(&[])), "");
}

#[test]
fn the_soonest_is_chosen_and_another_method_only_if_it_is_clearly_sooner() {
    let chooser = Chooser::new(&options(&[]), ERROR);
    let path = known(Family::Path, noisy(1.0));
    let best = |seconds: f64, bias: f64| {
        let other = known(Family::PhotonMap, biased(seconds, bias));
        chooser.best(&[path, other], f64::INFINITY).unwrap().family
    };
    // Path tracing takes 124 s.
    assert_eq!(best(20.0, 0.0), Family::PhotonMap);
    assert_eq!(best(100.0, 0.0), Family::Path);
    // A bias of 20 % is to be bought off by 4³ times as many photons and more.
    assert_eq!(best(20.0, 0.04), Family::Path);
    assert_eq!(best(1.0, 0.04), Family::PhotonMap);
    let offer = chooser.best(&[path], f64::INFINITY).unwrap();
    assert_eq!(chooser.path_offer(&path.law), offer);
}

/// A time without room for a single sample is no reason to take as many as there can be.
#[test]
fn where_time_is_too_short_for_path_tracing_it_has_one_sample() {
    let wish = Wish::Seconds(0.5);
    let chooser = Chooser::new(&options(&[("time", "0.5", Origin::Flag)]), wish);
    assert_eq!(chooser.path_offer(&noisy(1.0)).samples, 1);
}

#[test]
fn in_a_given_time_the_least_error_is_chosen() {
    let wish = Wish::Seconds(10.0);
    let chooser = Chooser::new(&options(&[("time", "10", Origin::Flag)]), wish);
    let path = known(Family::Path, noisy(1.0));
    let other = known(Family::PhotonMap, biased(0.1, 0.001));
    let offer = chooser.best(&[path, other], 10.0).unwrap();
    assert!(offer.family == Family::PhotonMap && offer.rung >= 2 && offer.seconds < 10.0);
    let slow = known(Family::PhotonMap, biased(11.0, 0.001));
    assert_eq!(
        chooser.best(&[path, slow], 10.0).unwrap().family,
        Family::Path
    );
    assert_eq!(chooser.best(&[slow], 10.0), None);
    let resort = chooser.last_resort(&[slow], true);
    assert_eq!((resort.family, resort.samples), (Family::Path, 1));
    assert!(!chooser.is_hasty());
    assert!(Chooser::new(&options(&[]), Wish::Seconds(0.1)).is_hasty());
}

/// Tells nobody.
struct Silent;

impl crate::pipeline::audience::Audience for Silent {
    fn printed(&self, _: &str) {}

    fn warned(&self, _: &crate::diag::SourceMap, _: &crate::diag::Diagnostics) {}

    fn begins(&self, _: &'static str) {}

    fn progress(&self, _: u64, _: u64) {}

    fn ends(&self) {}
}

/// By the clock of a world in which each look at it takes 10 ms: a wanted time is not left unused, whether methods are tried or not,
/// and there is a picture even if there is no time at all.
#[test]
fn a_wanted_time_is_used_and_a_picture_comes_in_any_case() {
    use crate::pipeline::making::{Making, Partial};
    use crate::pipeline::store::PictureTarget;
    use crate::pipeline::studio::{Keep, Studio};
    use crate::pipeline::world::World;
    use crate::pipeline::world::fake::FakeWorld;

    let model = "protected void init() [ Axiom ==> [ Translate(0, 0, 3) LightNode.(setLight(new PointLight())) ] Sphere(1); ]";
    for (text, seconds) in [("3", 3.0), ("0.4", 0.4), ("0.001", 0.001)] {
        let world = FakeWorld::default();
        world.put("m.rgg", model);
        let mut flags = Options::default();
        for (key, text) in [("size", "16x12"), ("time", text)] {
            flags.set(key, text, Origin::Flag).unwrap();
        }
        let mut studio = Studio::new(
            &world,
            std::sync::Arc::new(Silent),
            "m.rgg".into(),
            Keep::Last,
        );
        let opened = studio.read(&flags).unwrap();
        let mut run = studio.check(opened).unwrap();
        let making = Making {
            world: &world,
            audience: &Silent,
            cancel: &crate::integrator::CancelToken::default(),
            partial: Partial::Keep,
        };
        let target = PictureTarget::new(&world, std::path::Path::new("x.png")).unwrap();
        let begin = world.now();
        let made = making.picture(&mut studio, &mut run, &target).unwrap();
        let passed = (world.now() - begin).as_secs_f64();
        assert!(
            made.is_whole && passed >= 0.95 * seconds,
            "{text}: {passed}"
        );
        assert!(made.effort.samples_per_pixel >= 1);
        assert!(made.notes[0].starts_with("chosen: "), "{:?}", made.notes);
        let is_told = made.notes.iter().any(|note| note.contains("`time` wants"));
        assert!(is_told || seconds > 0.1, "{:?}", made.notes);
    }
}
