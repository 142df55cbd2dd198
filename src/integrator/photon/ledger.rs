//! Where the power of photons went, to the last quantum.
//!
//! Powers are floating-point numbers, whose sums depend on their order. The books are kept in whole quanta instead: integers add
//! up to the same total in any order and on any number of threads, and what is on one side must be on the other.

use crate::color::Rgb;
use std::ops::AddAssign;

/// Quanta in the mean photon, as a power of two: even a photon 10¹² times weaker has some, and one half a million times stronger
/// still fits.
const QUANTA_OF_MEAN: f64 = (1_u64 << 44) as f64;

/// Whole quanta of power of one photon, per channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Quanta([i64; 3]);

/// How many quanta a watt has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale(f64);

impl Scale {
    /// The scale for photons of this mean power, W; any positive number.
    #[must_use]
    pub fn for_mean(watts: f64) -> Self {
        let scale = QUANTA_OF_MEAN / watts;
        Self(if scale.is_finite() && scale > 0.0 {
            scale
        } else {
            1.0
        })
    }

    /// A power in whole quanta; what is beyond their range is cut off.
    #[must_use]
    pub fn quanta(self, power: Rgb) -> Quanta {
        Quanta(
            power
                .to_array()
                .map(|watts| (watts * self.0).round() as i64),
        )
    }
}

/// A sum of quanta, per channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Account([i128; 3]);

impl Account {
    /// Adds the power of a photon.
    pub fn add(&mut self, quanta: Quanta) {
        for (sum, term) in self.0.iter_mut().zip(quanta.0) {
            *sum += i128::from(term);
        }
    }

    /// Takes the power of a photon away.
    pub fn take(&mut self, quanta: Quanta) {
        for (sum, term) in self.0.iter_mut().zip(quanta.0) {
            *sum -= i128::from(term);
        }
    }

    /// The quanta, per channel.
    #[must_use]
    pub fn quanta(&self) -> [i128; 3] {
        self.0
    }
}

impl AddAssign for Account {
    fn add_assign(&mut self, other: Self) {
        for (sum, term) in self.0.iter_mut().zip(other.0) {
            *sum += term;
        }
    }
}

/// Where the power of some photons went: `emitted = absorbed + escaped + lost + ended + chance`, exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ledger {
    scale: Scale,
    /// What the sources gave.
    pub emitted: Account,
    /// What surfaces and clear bodies kept: at each surface the share that they keep on average, not what chance decided.
    pub absorbed: Account,
    /// What met nothing more.
    pub escaped: Account,
    /// What was cut off by the limit of scatterings.
    pub lost: Account,
    /// What surfaces sent on where the visitor did not want the photon to go on.
    pub ended: Account,
    /// What was taken by chance less what was given by chance: Russian roulette, and the choice between ways to go. 0 on average.
    pub chance: Account,
    /// Photons emitted.
    pub n_photons: u64,
    /// Ray queries.
    pub n_rays: u64,
}

impl Ledger {
    /// Empty books.
    #[must_use]
    pub fn new(scale: Scale) -> Self {
        Self {
            scale,
            emitted: Account::default(),
            absorbed: Account::default(),
            escaped: Account::default(),
            lost: Account::default(),
            ended: Account::default(),
            chance: Account::default(),
            n_photons: 0,
            n_rays: 0,
        }
    }

    /// The scale of its quanta.
    #[must_use]
    pub fn scale(&self) -> Scale {
        self.scale
    }

    /// The power in an account, W per channel.
    #[must_use]
    pub fn watts(&self, account: &Account) -> Rgb {
        Rgb::from_array(account.0.map(|quanta| quanta as f64 / self.scale.0))
    }

    /// Emitted less everything else, in quanta: 0 unless the tracer is wrong.
    #[must_use]
    pub fn imbalance(&self) -> [i128; 3] {
        let spent = [
            self.absorbed,
            self.escaped,
            self.lost,
            self.ended,
            self.chance,
        ];
        std::array::from_fn(|channel| {
            self.emitted.0[channel] - spent.iter().map(|account| account.0[channel]).sum::<i128>()
        })
    }
}

impl AddAssign for Ledger {
    /// Both must have the same scale.
    fn add_assign(&mut self, other: Self) {
        self.emitted += other.emitted;
        self.absorbed += other.absorbed;
        self.escaped += other.escaped;
        self.lost += other.lost;
        self.ended += other.ended;
        self.chance += other.chance;
        self.n_photons += other.n_photons;
        self.n_rays += other.n_rays;
    }
}
