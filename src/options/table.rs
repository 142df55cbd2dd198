//! The table of options: one row each.

use super::flying::{Aperture, FrameCount, FrameFormat, FrameRate, Metres, Shutter};
use super::lighting::{Fraction, PlotSize};
use super::preset::Presets;
use super::radiosity::{HemicubePixels, SplitDepth, Threshold, Width};
use super::setting::{Origin, SetError, Setting};
use super::surroundings::{SkyKind, SunIrradiance};
use super::value::{
    Area, Brightness, Bytes, Daylight, GatherRays, GridSize, Ground, PhotonCount, Quality,
    Renderer, Seconds, Size, Threads, Turbidity,
};
use crate::animation::KeyFrames;
use crate::diag::nearest;
use crate::integrator::radiosity::{FormFactorMethod, Solver};
use crate::integrator::requirements::Features;
use crate::light::sun_position::{Moment, Place};
use crate::math::angle::Angle;
use crate::turtle::Layers;
use glam::DVec3;
use std::num::{NonZeroU32, NonZeroU64};
use std::ops::Range;

/// A command of the program that takes options.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Reads and checks.
    Check,
    /// Grows.
    Derive,
    /// Makes one picture.
    Render,
    /// Makes the picture again whenever an input changes.
    Watch,
    /// Makes the frames of a film.
    Fly,
    /// Writes the lit surfaces.
    Export,
    /// Counts the light on organs.
    Light,
    /// Serves an editor.
    Lsp,
    /// Measures what is known on paper.
    Validate,
    /// Measures what accuracy costs.
    Trade,
}

use Command::{Derive, Export, Fly, Light, Render, Trade, Validate, Watch};
/// Commands that run the model.
const GROWING: &[Command] = &[Derive, Render, Watch, Fly, Export, Light, Trade];
/// Commands that draw random numbers and work in parallel.
const WORKING: &[Command] = &[Derive, Render, Watch, Fly, Export, Light, Validate, Trade];
/// Commands that make pictures.
const PICTURING: &[Command] = &[Render, Watch, Fly, Trade];
/// Commands that have a camera and light that all cameras share.
const SOLVING: &[Command] = &[Render, Watch, Fly, Export, Trade];
/// Commands that trace single light paths.
const TRACING: &[Command] = &[Render, Watch, Fly, Light, Trade];
/// Commands that trace light.
const LIGHTING: &[Command] = &[Render, Watch, Fly, Export, Light, Trade];

/// Where an option stands in the file beside a model, and under which heading it is explained.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// Before the first heading.
    Model,
    /// `[camera]`
    Camera,
    /// `[render]`
    Render,
    /// `[sky]`
    Sky,
    /// `[fly]`
    Fly,
    /// `[light]`
    Light,
}

impl Section {
    /// All sections, in the order in which they are explained.
    pub const ALL: [Self; 6] = [
        Self::Model,
        Self::Camera,
        Self::Render,
        Self::Sky,
        Self::Fly,
        Self::Light,
    ];

    /// Its heading in the file; empty for what stands before the first one.
    pub fn heading(self) -> &'static str {
        match self {
            Self::Model => "",
            Self::Camera => "camera",
            Self::Render => "render",
            Self::Sky => "sky",
            Self::Fly => "fly",
            Self::Light => "light",
        }
    }
}

/// Which stage of a run an option is an input of. A stage is repeated only if an input of it or of an earlier one changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Growing the model.
    Growth,
    /// Setting up the scene.
    Scene,
    /// Solving the light for all cameras.
    Solution,
    /// Taking the picture.
    View,
    /// Moving the camera from frame to frame.
    Flight,
    /// None: what the machine may use, or which part of the result is wanted. Never changes a byte of a picture.
    Machine,
}

/// A row of the table.
#[derive(Debug)]
pub struct OptionRow {
    /// Its name: `--key` on the command line, `key` in the file.
    pub key: &'static str,
    /// What its value is, in capitals; empty for a switch.
    pub unit: &'static str,
    /// What it does, in one sentence.
    pub doc: &'static str,
    /// Its value if nobody sets it.
    pub default: &'static str,
    /// Its place in the file.
    pub section: Section,
    /// What depends on it.
    pub stage: Stage,
    /// The commands it makes a difference to.
    pub commands: &'static [Command],
}

impl OptionRow {
    /// Whether it is given by its name alone.
    pub fn is_switch(&self) -> bool {
        self.unit.is_empty()
    }
}

/// An option as it stands.
#[derive(Clone, Copy, Debug)]
pub struct Entry<'a> {
    /// Its row of the table.
    pub row: &'static OptionRow,
    /// The value as it was written.
    pub text: &'a str,
    /// Who wrote it.
    pub origin: Origin,
    /// The value in canonical form.
    debug: &'a dyn std::fmt::Debug,
}

impl Entry<'_> {
    /// The value in a form that is equal for equal values.
    pub fn canonical(&self) -> String {
        format!("{:?}", self.debug)
    }
}

macro_rules! options {
    ($($(#[doc = $doc:literal])+
       $field:ident: $type:ty = $default:literal, $key:literal, $unit:literal, $section:ident, $stage:ident, $commands:expr;)*) => {
        /// The options of a run.
        #[derive(Clone, Debug, PartialEq)]
        pub struct Options {
            $($(#[doc = $doc])+ pub $field: Setting<$type>,)*
            /// What `quality` stands for.
            pub presets: Presets,
        }

        /// All options, in the order in which they are explained.
        pub static TABLE: &[OptionRow] = &[
            $(OptionRow {
                key: $key,
                unit: $unit,
                doc: concat!($($doc),+).trim_ascii(),
                default: $default,
                section: Section::$section,
                stage: Stage::$stage,
                commands: $commands,
            },)*
        ];

        impl Default for Options {
            fn default() -> Self {
                Self { $($field: Setting::from_default($default),)* presets: Presets::default() }
            }
        }

        impl Options {
            /// Reads the value of one option; a weaker origin never replaces a stronger one.
            ///
            /// # Errors
            /// If there is no such option, or `text` is no value of it.
            pub fn set(&mut self, key: &str, text: &str, origin: Origin) -> Result<(), SetError> {
                match key {
                    $($key => self.$field.set(($key, $default), text, origin),)*
                    _ => Err(SetError::Unknown {
                        key: key.to_owned(),
                        nearest: nearest(key, TABLE.iter().map(|row| row.key)),
                    }),
                }
            }

            /// All options with their values, in the order of [`TABLE`].
            pub fn entries(&self) -> Vec<Entry<'_>> {
                let values: Vec<(&str, Origin, &dyn std::fmt::Debug)> =
                    vec![$((&self.$field.text, self.$field.origin, &self.$field.value),)*];
                let with_row = TABLE.iter().zip(values);
                with_row.map(|(row, (text, origin, debug))| Entry { row, text, origin, debug }).collect()
            }
        }
    };
}

options! {
    /// How many times the step method runs after `init`
    steps: u32 = "1", "steps", "N", Model, Growth, GROWING;
    /// Seed of all random numbers, of growth and of light
    seed: i64 = "1", "seed", "N", Model, Growth, WORKING;
    /// The step method
    entry: String = "run", "entry", "NAME", Model, Growth, GROWING;
    /// Growth stops with an error at more modules than this
    max_modules: NonZeroU64 = "50000000", "max-modules", "N", Model, Growth, GROWING;
    /// Growth and pictures that need more memory than this are refused; `auto`: three quarters of what is free
    max_memory: Option<Bytes> = "auto", "max-memory", "BYTES", Model, Machine, GROWING;
    /// Threads to use; `auto`: one for each core. The result does not depend on it
    threads: Option<Threads> = "auto", "threads", "N", Model, Machine, WORKING;

    /// Where the camera stands, in metres; `auto`: where all of the model is in view
    eye: Option<DVec3> = "auto", "eye", "X,Y,Z", Camera, View, SOLVING;
    /// The point in the middle of the picture, in metres; `auto`: the middle of the model
    target: Option<DVec3> = "auto", "target", "X,Y,Z", Camera, View, SOLVING;
    /// The direction that points up in the picture
    up: DVec3 = "0,0,1", "up", "X,Y,Z", Camera, View, SOLVING;
    /// Vertical field of view in degrees
    fov: Angle = "40", "fov", "DEG", Camera, View, SOLVING;
    /// Width of the lens, in metres or as `f/N` of a camera for 35 mm film: what is nearer or farther than `focus` is unsharp; `none`: all is sharp
    aperture: Option<Aperture> = "none", "aperture", "METRES", Camera, View, PICTURING;
    /// Distance in metres, along the view, of what a lens shows sharp; `auto`: that of `target`
    focus: Option<Metres> = "auto", "focus", "METRES", Camera, View, PICTURING;

    /// Method that computes the light: `path` (path tracing: all light), `photon` (photon mapping: solved once, every view cheap), `radiosity` (what matt surfaces send each other, solved once on the surfaces) or `raytracer` (direct light, mirrors and glass: fast)
    renderer: Renderer = "path", "renderer", "NAME", Render, Solution, SOLVING;
    /// Preset: `draft`, `preview` or `final`
    quality: Quality = "preview", "quality", "NAME", Render, View, SOLVING;
    /// Size of the picture in pixels
    size: Size = "960x640", "size", "WxH", Render, View, SOLVING;
    /// Light paths traced for each pixel
    samples: NonZeroU32 = "64", "samples", "N", Render, View, PICTURING;
    /// Longest light path, in scattering events (0: only what shines by itself); `none`: no limit, weak paths end by chance
    max_depth: Option<u32> = "none", "max-depth", "N", Render, View, TRACING;
    /// `G`×`G` samples for every pixel, GroIMP's grid; `auto`: `samples` of them, by the ray tracer only where neighbouring pixels differ, and whenever `--samples` is given and this is not
    supersampling: Option<GridSize> = "auto", "supersampling", "G", Render, View, PICTURING;
    /// How often the ray tracer, photon mapping and radiosity follow a ray through mirrors and glass
    recursion_depth: u32 = "8", "recursion-depth", "N", Render, View, SOLVING;
    /// Photons that photon mapping sends to all surfaces
    global_photons: PhotonCount = "1000000", "global-photons", "N", Render, Solution, PICTURING;
    /// Photons that it sends to mirrors and glass for caustics; `auto`: a million where there are any
    caustic_photons: Option<PhotonCount> = "auto", "caustic-photons", "N", Render, Solution, PICTURING;
    /// Area of surface over which photons are averaged, in square metres (GroIMP's *Photon area*); `auto`: for each place as large as the light there is even
    photon_area: Option<Area> = "auto", "photon-area", "M2", Render, Solution, PICTURING;
    /// Passes of photon mapping: each sends as many other photons, in the memory of one; noise and blur fall with their number
    passes: NonZeroU32 = "1", "passes", "N", Render, Solution, PICTURING;
    /// Rays by which photon mapping and radiosity gather indirect light anew where the camera looks; `0`: none, straight from the photons, faster and blotchier where light is dim, or from the elements; `auto`: 256 over photons, none over radiosity; each `--quality` says 0 over photons
    final_gather: GatherRays = "auto", "final-gather", "N", Render, View, SOLVING;
    /// How radiosity is solved: `gather` (each patch collects from all others), `shoot` (the brightest patches shoot) or `stochastic` (all patches shoot rays; for plants); `auto`: `gather` up to 20,000 patches, beyond `stochastic`
    solver: Option<Solver> = "auto", "solver", "NAME", Render, Solution, SOLVING;
    /// How finely a patch looks around in radiosity: pixels along an edge of GroIMP's hemicube, or the root of four times as many rays
    hemicube_pixels: HemicubePixels = "32", "hemicube-pixels", "N", Render, Solution, SOLVING;
    /// Edge of the hemicube in metres: what is nearer than half of it is not seen; `auto`: next to nothing
    hemicube_size: Option<Width> = "auto", "hemicube-size", "M", Render, Solution, SOLVING;
    /// What form factors of radiosity come from: `rays`, `hemicube` (GroIMP's way) or `analytic` (closed forms between near patches, rays elsewhere)
    form_factors: FormFactorMethod = "rays", "form-factors", "NAME", Render, Solution, SOLVING;
    /// Patches of radiosity are split where light differs over them by more than this part of it
    subdivision_threshold: Threshold = "0.15", "subdivision-threshold", "X", Render, Solution, SOLVING;
    /// How often they are split at most
    subdivision_depth: SplitDepth = "3", "subdivision-depth", "N", Render, Solution, SOLVING;
    /// Points of each lamp and of the sky that the ray tracer asks for light at each surface
    light_samples: NonZeroU32 = "1", "light-samples", "N", Render, View, PICTURING;
    /// Seconds that the light of the picture, or of the whole film, may take: renderer and settings that nobody names are chosen for the least error in that time; `watch` only adds samples until it is over
    time: Option<Seconds> = "none", "time", "SECONDS", Render, View, PICTURING;
    /// Error that the picture, or each frame, may have, as a part of 1 or in percent: renderer and settings that nobody names are chosen to reach it soonest
    error: Option<Fraction> = "none", "error", "FRACTION", Render, View, &[Render, Fly];
    /// What is done though the scene does not require it, to see that nothing changes but time: names that `--explain-scene` lists, or `all`
    require: Features = "none", "require", "NAME,NAME", Render, Scene, LIGHTING;
    /// Brightness: radiance is multiplied by 2 to this power before it is shown; `auto`: decided from the picture
    exposure: Option<f64> = "auto", "exposure", "STOPS", Render, View, SOLVING;

    /// Layers (`setLayer`) whose nodes are neither drawn nor shine; `none`
    hide_layers: Layers = "none", "hide-layers", "N,N", Render, Scene, LIGHTING;

    /// Daylight with the sun at this azimuth (from north over east) and elevation, in degrees; `auto`: only for a model without light; `none`
    sun: Daylight = "auto", "sun", "AZ,EL", Sky, Scene, LIGHTING;
    /// Puts the sun where it stands at this time (universal time unless an offset says otherwise); needs `place`
    date: Option<Moment> = "none", "date", "YYYY-MM-DDThh:mm", Sky, Scene, LIGHTING;
    /// Where on Earth the model stands, in degrees, north and east positive; for `date`
    place: Option<Place> = "none", "place", "LAT,LON", Sky, Scene, LIGHTING;
    /// What the sun gives a surface that faces it, W/m²; `auto`: what `turbidity` lets through
    sun_irradiance: Option<SunIrradiance> = "auto", "sun-irradiance", "R,G,B", Sky, Scene, LIGHTING;
    /// What the sky is: `clear`, `overcast`, `uniform`, the same radiance R,G,B all round, or a panorama `FILE.exr` or `FILE.hdr`; `auto`: clear, where there is daylight
    sky: SkyKind = "auto", "sky", "KIND", Sky, Scene, LIGHTING;
    /// Scales sky and sun to give so many watts per square metre on level ground, summed over red, green and blue; `auto`: as in nature, or as the panorama has it
    sky_power: Option<Brightness> = "auto", "sky-power", "W/M2", Sky, Scene, LIGHTING;
    /// Turns a panorama about the vertical by so many degrees, counter-clockwise as seen from above
    sky_turn: f64 = "0", "sky-turn", "DEG", Sky, Scene, LIGHTING;
    /// Haze of the air, from 1 (clear) to 10
    turbidity: Turbidity = "3", "turbidity", "T", Sky, Scene, LIGHTING;
    /// Reflectance of a plane to stand on; `auto`: a plane for a model without light and ground; `none`
    ground: Ground = "auto", "ground", "R,G,B", Sky, Scene, LIGHTING;

    /// Flies once round the middle of the picture
    orbit: bool = "false", "orbit", "", Fly, Flight, &[Fly];
    /// Turns the model once before the camera: flies round it, and takes the sun along
    turntable: bool = "false", "turntable", "", Fly, Flight, &[Fly];
    /// Flies through key frames: `time=0 eye=0,-9,2 target=0,0,1; time=4 eye=5,-7,3`, each with any of `eye`, `target`, `fov`, `step`, `sun`, `stops` (brighter than the film by so many); in the file one table `[[fly.key]]` for each
    key: Option<KeyFrames> = "none", "key", "KEYS", Fly, Flight, &[Fly];
    /// Flies through the key frames at an even speed; their times then only order them
    even_speed: bool = "false", "even-speed", "", Fly, Flight, &[Fly];
    /// Flies so many metres above terrain and crowns: across the model, or along the `eye`s of the key frames (their x and y)
    flyover: Option<Metres> = "none", "flyover", "METRES", Fly, Flight, &[Fly];
    /// Walks through the stand with the eyes at this height, round trunks: across the model, or from `eye` to `eye` of the key frames
    walk: Option<Metres> = "none", "walk", "METRES", Fly, Flight, &[Fly];
    /// The model grows from step `A` in the first frame to step `B` in the last
    grow: Option<Range<u32>> = "none", "grow", "A..B", Fly, Flight, &[Fly];
    /// How many frames the whole flight has, whichever of them are made; `auto`: 120, with key frames as many as their times take
    flight_frames: Option<FrameCount> = "auto", "flight-frames", "N", Fly, Flight, &[Fly];
    /// Frames per second of the film
    fps: FrameRate = "25", "fps", "N", Fly, Flight, &[Fly];
    /// Part of the time between two frames that the shutter is open, 0 to 1: the way of the camera meanwhile is blurred (growth and sun stand still)
    shutter: Shutter = "0", "shutter", "PART", Fly, Flight, &[Fly];
    /// What single frames in a folder are: `png`, or `exr` with linear radiance
    frame_format: FrameFormat = "png", "frame-format", "NAME", Fly, Flight, &[Fly];
    /// Pairs of neighbouring frames that are rendered again with other random numbers to measure how much the film flickers
    flicker: u32 = "2", "flicker", "N", Fly, Machine, &[Fly];
    /// The frames to make, the last one not included; `auto`: the whole flight
    frames: Option<Range<u32>> = "auto", "frames", "A..B", Fly, Machine, &[Fly];

    /// Photons that are followed to count the light on organs; with a wanted error, to begin with
    photons: NonZeroU64 = "1000000", "photons", "N", Light, Machine, &[Light];
    /// Follows photons until 19 of 20 lit organs know what they absorb with at most this relative standard error
    organ_error: Option<Fraction> = "none", "organ-error", "FRACTION", Light, Machine, &[Light];
    /// Follows photons until 19 of 20 lit plants, each what hangs on one branch of the root, know what all their organs absorb together with at most this relative standard error
    plant_error: Option<Fraction> = "none", "plant-error", "FRACTION", Light, Machine, &[Light];
    /// Follows photons until the light that all organs absorb together is known with at most this relative standard error
    total_error: Option<Fraction> = "none", "total-error", "FRACTION", Light, Machine, &[Light];
    /// Photons after which a wanted error is given up
    most_photons: NonZeroU64 = "1000000000", "most-photons", "N", Light, Machine, &[Light];
    /// The model stands in a plot of so many metres along x and y that repeats itself without end
    periodic: Option<PlotSize> = "none", "periodic", "X,Y", Light, Machine, &[Light];
}

impl Options {
    /// The option of this name as it stands.
    pub fn entry_of(&self, key: &str) -> Option<Entry<'_>> {
        self.entries()
            .into_iter()
            .find(|entry| entry.row.key == key)
    }

    /// The values of the options that `stage` itself depends on, as a text that is equal for equal values.
    pub fn fingerprint(&self, stage: Stage) -> String {
        let mut text = String::new();
        for entry in self
            .entries()
            .iter()
            .filter(|entry| entry.row.stage == stage)
        {
            text.push_str(entry.row.key);
            text.push('=');
            text.push_str(&entry.canonical());
            text.push('\n');
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn rows_are_whole_and_keys_unique() {
        let _ = Options::default();
        let keys: BTreeSet<&str> = TABLE.iter().map(|row| row.key).collect();
        assert_eq!(keys.len(), TABLE.len());
        for row in TABLE {
            assert!(
                !row.doc.is_empty() && !row.doc.ends_with('.'),
                "{}",
                row.key
            );
            assert!(!row.commands.is_empty(), "{}", row.key);
            assert_eq!(row.is_switch(), row.default == "false", "{}", row.key);
        }
    }

    #[test]
    fn stronger_origins_win_in_any_order() {
        let orders: [[Origin; 2]; 2] = [
            [Origin::Flag, Origin::Preset("draft")],
            [Origin::Preset("draft"), Origin::Flag],
        ];
        for order in orders {
            let mut options = Options::default();
            for origin in order {
                let text = if origin == Origin::Flag { "9" } else { "4" };
                options.set("samples", text, origin).unwrap();
            }
            assert_eq!(
                (options.samples.value.get(), options.samples.origin),
                (9, Origin::Flag)
            );
        }
    }

    #[test]
    fn fingerprints_see_values_not_spelling() {
        let mut one = Options::default();
        let mut other = Options::default();
        one.set("eye", "1,2,3", Origin::Flag).unwrap();
        other
            .set("eye", "1.0, 2.0, 3.0", Origin::Preset("x"))
            .unwrap();
        assert_eq!(one.fingerprint(Stage::View), other.fingerprint(Stage::View));
        other.set("eye", "1,2,4", Origin::Flag).unwrap();
        assert_ne!(one.fingerprint(Stage::View), other.fingerprint(Stage::View));
        for stage in [Stage::Growth, Stage::Scene, Stage::Solution] {
            assert_eq!(one.fingerprint(stage), other.fingerprint(stage));
        }
        other.set("global-photons", "5", Origin::Flag).unwrap();
        assert_ne!(
            one.fingerprint(Stage::Solution),
            other.fingerprint(Stage::Solution)
        );
    }
}
