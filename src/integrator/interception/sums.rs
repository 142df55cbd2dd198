//! Batches put together: means and their standard errors.

use super::Wanted;
use super::bins::Bin;
use super::sensors::SensorField;
use crate::color::Rgb;
use crate::integrator::photon::{Account, Ledger};

/// The light on an organ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OrganLight {
    /// Power that meets its front and its back, W per channel.
    pub received: [Rgb; 2],
    /// Power that it keeps, W per channel: `received` less `reflected` and `transmitted`.
    pub absorbed: Rgb,
    /// Power that it sends back to the side it came from, W per channel.
    pub reflected: Rgb,
    /// Power that it sends to the other side, W per channel.
    pub transmitted: Rgb,
    /// Photons that met it.
    pub hits: u64,
    /// Standard errors; 0 if there was but one batch.
    pub errors: Errors,
}

/// Standard errors of powers, summed over the channels, W.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Of what is kept.
    pub absorbed: f64,
    /// Of what is sent back.
    pub reflected: f64,
    /// Of what is sent through.
    pub transmitted: f64,
    /// Of what arrives.
    pub received: f64,
}

/// Where the power of all photons went, W per channel: emitted = absorbed + escaped + lost + roulette.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Books {
    /// What the sources sent towards the scene.
    pub emitted: Rgb,
    /// What surfaces and clear bodies kept.
    pub absorbed: Rgb,
    /// What met nothing more.
    pub escaped: Rgb,
    /// What was cut off by the greatest number of scatterings.
    pub lost: Rgb,
    /// What chance took less what it gave; 0 on average.
    pub roulette: Rgb,
    /// Whether the two sides are equal to the last quantum in every batch.
    pub is_balanced: bool,
}

/// The light in a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lighting {
    /// By organ number.
    pub organs: Vec<OrganLight>,
    /// By plant number.
    pub plants: Vec<OrganLight>,
    /// On what belongs to no organ: the ground, say.
    pub rest: OrganLight,
    /// On all organs together, without `rest` and what is no plant.
    pub total: OrganLight,
    /// What each sensor reads, W/m² per channel.
    pub sensed: Vec<Rgb>,
    /// Where the power went.
    pub books: Books,
    /// Photons followed.
    pub n_photons: u64,
    /// Ray queries.
    pub n_rays: u64,
    /// Whether the wanted errors were reached; also if none was wanted.
    pub is_reached: bool,
}

/// Four powers of which errors are kept: absorbed, reflected, transmitted, received.
type Four = [f64; 4];

/// An organ's light over all batches so far.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    /// Means of rounds, each times its number of photons; of the running round, sums over batches.
    done: Powers,
    running: Powers,
    hits: u64,
    /// Sums and sums of squares over the batches of the running round.
    first: Four,
    second: Four,
    /// Variances of the rounds' means, each times the square of its number of photons.
    variance: Four,
}

#[derive(Clone, Copy, Debug, Default)]
struct Powers {
    received: [Rgb; 2],
    absorbed: Rgb,
    reflected: Rgb,
    transmitted: Rgb,
}

impl Powers {
    fn of(bin: &Bin, ledger: &Ledger) -> Self {
        Self {
            received: bin.received.map(|account| ledger.watts(&account)),
            absorbed: ledger.watts(&bin.absorbed),
            reflected: ledger.watts(&bin.reflected),
            transmitted: ledger.watts(&bin.transmitted),
        }
    }

    fn add(&mut self, other: &Self, factor: f64) {
        self.received[0] += other.received[0] * factor;
        self.received[1] += other.received[1] * factor;
        self.absorbed += other.absorbed * factor;
        self.reflected += other.reflected * factor;
        self.transmitted += other.transmitted * factor;
    }

    fn four(&self) -> Four {
        [
            self.absorbed.sum(),
            self.reflected.sum(),
            self.transmitted.sum(),
            (self.received[0] + self.received[1]).sum(),
        ]
    }
}

impl Sum {
    fn add_batch(&mut self, powers: &Powers, hits: u64) {
        self.running.add(powers, 1.0);
        self.hits += hits;
        for (at, x) in powers.four().into_iter().enumerate() {
            self.first[at] += x;
            self.second[at] += x * x;
        }
    }

    /// Ends a round of so many batches of `n` photons each.
    fn end_round(&mut self, n_batches: u64, n: u64) {
        let (batches, photons) = (n_batches as f64, (n_batches * n) as f64);
        self.done.add(&self.running, photons / batches);
        self.running = Powers::default();
        for at in 0..4 {
            let (first, second) = (self.first[at], self.second[at]);
            if n_batches > 1 {
                let spread = (second - first * first / batches).max(0.0);
                let of_mean = spread / (batches * (batches - 1.0));
                self.variance[at] += of_mean * photons * photons;
            }
        }
        self.first = Four::default();
        self.second = Four::default();
    }

    fn finish(&self, photons: f64) -> OrganLight {
        let mut means = Powers::default();
        means.add(&self.done, 1.0 / photons);
        let error = |at: usize| self.variance[at].sqrt() / photons;
        OrganLight {
            received: means.received,
            absorbed: means.absorbed,
            reflected: means.reflected,
            transmitted: means.transmitted,
            hits: self.hits,
            errors: Errors {
                absorbed: error(0),
                reflected: error(1),
                transmitted: error(2),
                received: error(3),
            },
        }
    }

    /// Standard error of the absorbed power as a fraction of it; `None` of an organ in the dark.
    fn relative_error(&self) -> Option<f64> {
        let absorbed = self.done.four()[0];
        (absorbed > 0.0).then(|| self.variance[0].sqrt() / absorbed)
    }
}

/// All batches so far.
#[derive(Debug)]
pub(super) struct Sums<'p> {
    /// The last one is for what belongs to no organ.
    organs: Vec<Sum>,
    plants: Vec<Sum>,
    /// By organ number.
    plant_of: &'p [Option<u32>],
    total: Sum,
    sensed: Vec<Rgb>,
    sensed_running: Vec<Rgb>,
    books: Books,
    books_running: Books,
    n_photons: u64,
    n_rays: u64,
}

impl<'p> Sums<'p> {
    /// Bytes that so many bins and sensors need.
    pub(super) const fn bytes(n_bins: usize, n_sensors: usize) -> u64 {
        let per_bin = (size_of::<Sum>() + size_of::<Bin>()) as u64;
        let per_sensor = (2 * size_of::<Rgb>() + size_of::<Account>()) as u64;
        (n_bins as u64)
            .saturating_mul(per_bin)
            .saturating_add((n_sensors as u64).saturating_mul(per_sensor))
    }

    pub(super) fn new(
        n_bins: usize,
        n_sensors: usize,
        (plant_of, n_plants): (&'p [Option<u32>], usize),
    ) -> Self {
        let balanced = Books {
            is_balanced: true,
            ..Books::default()
        };
        Self {
            organs: vec![Sum::default(); n_bins],
            plants: vec![Sum::default(); n_plants],
            plant_of,
            total: Sum::default(),
            sensed: vec![Rgb::BLACK; n_sensors],
            sensed_running: vec![Rgb::BLACK; n_sensors],
            books: balanced,
            books_running: balanced,
            n_photons: 0,
            n_rays: 0,
        }
    }

    pub(super) fn n_bins(&self) -> usize {
        self.organs.len()
    }

    pub(super) fn n_photons(&self) -> u64 {
        self.n_photons
    }

    /// Adds what a batch has counted.
    pub(super) fn add_batch(
        &mut self,
        bins: &[Bin],
        sensors: &SensorField,
        sensed: &[Account],
        ledger: &Ledger,
    ) {
        let mut total = Bin::default();
        let mut of_plants = vec![Bin::default(); self.plants.len()];
        let last = bins.len().saturating_sub(1);
        for (at, (sum, bin)) in self.organs.iter_mut().zip(bins).enumerate() {
            sum.add_batch(&Powers::of(bin, ledger), bin.hits);
            let plant = self.plant_of.get(at).copied().flatten();
            if at < last && (self.plant_of.is_empty() || plant.is_some()) {
                total += bin;
            }
            if let Some(plant) = plant {
                of_plants[plant as usize] += bin;
            }
        }
        for (sum, bin) in self.plants.iter_mut().zip(&of_plants) {
            sum.add_batch(&Powers::of(bin, ledger), bin.hits);
        }
        self.total
            .add_batch(&Powers::of(&total, ledger), total.hits);
        for (sum, reading) in self
            .sensed_running
            .iter_mut()
            .zip(sensors.readings(sensed, ledger))
        {
            *sum += reading;
        }
        let books = &mut self.books_running;
        books.emitted += ledger.watts(&ledger.emitted);
        books.absorbed += ledger.watts(&ledger.absorbed);
        books.escaped += ledger.watts(&ledger.escaped);
        books.lost += ledger.watts(&ledger.lost);
        books.roulette += ledger.watts(&ledger.chance);
        books.is_balanced &= ledger.imbalance() == [0; 3];
        self.n_rays += ledger.n_rays;
    }

    /// Ends a round of so many batches of `n` photons each.
    pub(super) fn end_round(&mut self, n_batches: u64, n: u64) {
        let all = self.organs.iter_mut().chain(&mut self.plants);
        for sum in all.chain([&mut self.total]) {
            sum.end_round(n_batches, n);
        }
        // Means over batches, times photons.
        let weight = n as f64;
        for (sum, running) in self.sensed.iter_mut().zip(&mut self.sensed_running) {
            *sum += std::mem::take(running) * weight;
        }
        let running = std::mem::replace(
            &mut self.books_running,
            Books {
                is_balanced: true,
                ..Books::default()
            },
        );
        let books = &mut self.books;
        books.emitted += running.emitted * weight;
        books.absorbed += running.absorbed * weight;
        books.escaped += running.escaped * weight;
        books.lost += running.lost * weight;
        books.roulette += running.roulette * weight;
        books.is_balanced &= running.is_balanced;
        self.n_photons += n_batches * n;
    }

    /// How many times larger than wanted the errors are; at most 1 if all are reached, 0 if none is wanted.
    pub(super) fn excess(&self, wanted: Wanted) -> f64 {
        let of_most = |sums: &[Sum], wanted: Option<f64>| {
            let Some(wanted) = wanted else { return 0.0 };
            let mut errors: Vec<f64> = sums.iter().filter_map(Sum::relative_error).collect();
            errors.sort_unstable_by(f64::total_cmp);
            // 19 of 20 lie at or below this one.
            let place = (errors.len() * 19).div_ceil(20).saturating_sub(1);
            errors.get(place).map_or(0.0, |error| error / wanted)
        };
        let organs = &self.organs[..self.organs.len().saturating_sub(1)];
        let of_organs = of_most(organs, wanted.of_organs);
        let of_plants = of_most(&self.plants, wanted.of_plants);
        let of_total = wanted.of_total.map_or(0.0, |wanted| {
            self.total.relative_error().unwrap_or(0.0) / wanted
        });
        of_organs.max(of_plants).max(of_total)
    }

    pub(super) fn finish(self, is_reached: bool) -> Lighting {
        let photons = self.n_photons.max(1) as f64;
        let share = 1.0 / photons;
        let mut organs: Vec<OrganLight> =
            self.organs.iter().map(|sum| sum.finish(photons)).collect();
        let rest = organs.pop().unwrap_or_default();
        let plants = self.plants.iter().map(|sum| sum.finish(photons));
        Lighting {
            plants: plants.collect(),
            organs,
            rest,
            total: self.total.finish(photons),
            sensed: self.sensed.iter().map(|sum| *sum * share).collect(),
            books: Books {
                emitted: self.books.emitted * share,
                absorbed: self.books.absorbed * share,
                escaped: self.books.escaped * share,
                lost: self.books.lost * share,
                roulette: self.books.roulette * share,
                is_balanced: self.books.is_balanced,
            },
            n_photons: self.n_photons,
            n_rays: self.n_rays,
            is_reached,
        }
    }
}
