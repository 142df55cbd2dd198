//! Making the pictures of one setting, with several seeds, and comparing them.

use super::flip;
use super::folder::PICTURES;
use super::heat;
use super::ladder::{Family, Rung};
use super::reference::Standard;
use super::results::{Measured, ObjectBias};
use super::session::Session;
use crate::animation::flicker::FlickerMeter;
use crate::film::{LinearImage, tone};
use crate::integrator::{CancelToken, Solution};
use crate::options::value::Renderer;
use crate::options::{Options, Origin};
use crate::pipeline::audience::Silent;
use crate::pipeline::failure::Failure;
use crate::pipeline::viewing::Viewing;

/// Part of a full circle that the camera turns round what it looks at for the second view of a film: half a degree, as in a film of an
/// orbit in 29 seconds.
pub(super) const TURN: f64 = 0.5 / 360.0;

/// What one setting gives for one seed besides its picture.
pub(super) struct Taken {
    /// The view a little later, for the first two seeds.
    next: Option<LinearImage>,
    solve: f64,
    view: f64,
    /// Seconds of the view a little later.
    next_view: Option<f64>,
    rays: u64,
    patches: Option<u64>,
    photons: Option<u64>,
}

impl Session<'_> {
    pub(super) fn options_of(&self, renderer: Renderer, rung: &Rung) -> Options {
        let mut options = self.options.clone();
        let name = renderer.name();
        set(&mut options, "renderer", name);
        set(&mut options, "supersampling", "auto");
        for (key, value) in &rung.settings {
            set(&mut options, key, value);
        }
        options
    }

    /// Measures one setting.
    pub(super) fn rung(
        &self,
        family: &Family,
        rung: &Rung,
        standard: &Standard,
        (name, stop): (&str, &CancelToken),
    ) -> Result<Measured, Failure> {
        let options = self.options_of(family.renderer, rung);
        let seeds = 0..self.plan.seeds;
        let taken: Result<Vec<(LinearImage, Taken)>, Failure> = seeds
            .map(|seed| {
                let taken = self.take(&options, u64::from(seed) + 1, seed < 2, stop)?;
                self.tell();
                Ok(taken)
            })
            .collect();
        let (images, taken): (Vec<LinearImage>, Vec<Taken>) = taken?.into_iter().unzip();
        let found = standard.truth.decompose(&images);
        let look = |image: &LinearImage| {
            tone::to_srgb8(image, standard.exposure, tone::ToneCurve::default())
        };
        let seen = look(&images[0]);
        let size = self.findings.size;
        let differences = flip::difference(&standard.seen, &seen, (size[0], size[1]));
        let pictures = [
            format!("{PICTURES}/{name}.png"),
            format!("{PICTURES}/{name}-flip.png"),
        ];
        self.folder.picture(&pictures[0], seen.clone(), size)?;
        self.folder
            .picture(&pictures[1], heat::colors(&differences), size)?;
        let (mean, high) = flip::summary(&differences);
        let mut meter = FlickerMeter::default();
        if let [Taken { next: Some(a), .. }, Taken { next: Some(b), .. }, ..] = &taken[..] {
            let (a0, a1, b0, b1) = (&seen, look(a), look(&images[1]), look(b));
            meter.add([a0, &a1], [&b0, &b1]);
        }
        let mut settings = vec![("renderer".to_owned(), family.renderer.name().to_owned())];
        settings.extend(
            rung.settings
                .iter()
                .map(|(key, value)| ((*key).to_owned(), value.clone())),
        );
        let first = median(taken.iter().map(|t| t.view).collect());
        // Other methods keep nothing between views: these differ by chance alone.
        let view = match options.final_gather.value.by(family.renderer) {
            0 => first,
            _ => median(taken.iter().filter_map(|t| t.next_view).collect()).min(first),
        };
        Ok(Measured {
            key: String::new(),
            knob: rung.knob,
            settings,
            solve: median(taken.iter().map(|t| t.solve).collect()),
            first: first - view,
            view,
            error: found.error,
            error_deviation: found.error_deviation,
            error_of_all: found.error_of_all,
            variance: found.variance,
            bias_squared: found.bias_squared,
            energy: standard
                .truth
                .excess(&images, &|_| true)
                .map(|e| [e.relative, e.deviation]),
            flip: [mean, high],
            flicker: meter.result(),
            objects: self.biases(standard, &images),
            rays: taken[0].rays,
            patches: taken[0].patches,
            photons: taken[0].photons,
            pictures,
        })
    }

    fn biases(&self, standard: &Standard, images: &[LinearImage]) -> Vec<ObjectBias> {
        let one = |(nth, name): (usize, &String)| {
            let at = &standard.objects.of_pixel;
            let excess = standard.truth.excess(images, &|pixel| at[pixel] == nth)?;
            Some(ObjectBias {
                name: name.clone(),
                pixels: at.iter().filter(|&&object| object == nth).count(),
                relative: excess.relative,
                deviation: excess.deviation,
            })
        };
        standard
            .objects
            .names
            .iter()
            .enumerate()
            .filter_map(one)
            .collect()
    }

    /// Solves, prepares and looks; twice if a second view is wanted.
    pub(super) fn take(
        &self,
        options: &Options,
        seed: u64,
        is_film: bool,
        stop: &CancelToken,
    ) -> Result<(LinearImage, Taken), Failure> {
        let mut options = options.clone();
        set(&mut options, "seed", &(seed & u64::MAX >> 1).to_string());
        let viewing = self.viewing(&options, stop);
        let now = || self.means.world.now().as_secs_f64();
        let begin = now();
        let solution = viewing.solve(self.scene, &mut |_| {})?;
        let prepared = viewing.prepare(self.scene, &solution)?;
        let solved = now();
        let shot = viewing.shoot(&prepared, &self.cameras[0])?;
        let done = now();
        if !shot.is_whole {
            return Err(Failure::Stopped);
        }
        let next = is_film
            .then(|| viewing.shoot(&prepared, &self.cameras[1]))
            .transpose()?;
        let after = now();
        let patches = match &solution {
            Solution::Radiosity(solved) => Some(solved.patches),
            Solution::Nothing | Solution::Photons(_) => None,
        };
        let taken = Taken {
            next: next.map(|shot| shot.image),
            solve: solved - begin,
            view: done - solved,
            next_view: is_film.then_some(after - done),
            rays: shot.effort.n_rays,
            patches,
            photons: solution.photons().map(|(emitted, _)| emitted),
        };
        Ok((shot.image, taken))
    }

    pub(super) fn viewing<'v>(&self, options: &'v Options, cancel: &'v CancelToken) -> Viewing<'v>
    where
        Self: 'v,
    {
        Viewing {
            world: self.means.world,
            audience: &Silent,
            options,
            cancel,
        }
    }
}

/// Sets an option as if the user had.
pub(super) fn set(options: &mut Options, key: &str, text: &str) {
    options
        .set(key, text, Origin::Flag)
        .expect("invariant: ladders hold known options and values");
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    if n == 0 {
        0.0
    } else {
        0.5 * (values[(n - 1) / 2] + values[n / 2])
    }
}
