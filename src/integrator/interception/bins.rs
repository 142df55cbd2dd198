//! What arrives at each organ: exact sums over the photons of a batch.

use super::sensors::SensorField;
use crate::color::Rgb;
use crate::integrator::photon::{Account, Onward, PhotonHit, Scale, Visitor};
use crate::math::Ray;
use std::collections::BTreeMap;
use std::ops::AddAssign;

/// What has arrived at an organ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Bin {
    /// Power that met it on the front and on the back.
    pub(super) received: [Account; 2],
    /// `received` less `reflected` and `transmitted`.
    pub(super) absorbed: Account,
    pub(super) reflected: Account,
    pub(super) transmitted: Account,
    /// Photons that met it.
    pub(super) hits: u64,
}

impl AddAssign<&Self> for Bin {
    fn add_assign(&mut self, other: &Self) {
        self.received[0] += other.received[0];
        self.received[1] += other.received[1];
        self.absorbed += other.absorbed;
        self.reflected += other.reflected;
        self.transmitted += other.transmitted;
        self.hits += other.hits;
    }
}

/// What the photons of one block bring.
pub(super) struct Tally<'a> {
    scale: Scale,
    n_bins: usize,
    /// Bins that got anything. A block meets few organs of many.
    bins: BTreeMap<u32, Bin>,
    sensors: &'a SensorField,
    sensed: Vec<Account>,
}

impl<'a> Tally<'a> {
    /// Nothing yet; the last of the bins is for what belongs to none of the others.
    pub(super) fn new(scale: Scale, n_bins: usize, sensors: &'a SensorField) -> Self {
        Self {
            scale,
            n_bins,
            bins: BTreeMap::new(),
            sensors,
            sensed: sensors.accounts(),
        }
    }

    /// Adds all to the bins of the batch.
    pub(super) fn join(self, bins: &mut [Bin], sensed: &mut [Account]) {
        for (place, bin) in self.bins {
            bins[place as usize] += &bin;
        }
        for (sum, more) in sensed.iter_mut().zip(self.sensed) {
            *sum += more;
        }
    }
}

impl Visitor for Tally<'_> {
    fn arrives(&mut self, hit: &PhotonHit<'_>) -> Onward {
        let last = self.n_bins - 1;
        let place = (hit.point.owner().0 as usize).min(last) as u32;
        let bin = self.bins.entry(place).or_default();
        let met = self.scale.quanta(hit.power);
        let reflected = self.scale.quanta(hit.reflected);
        let transmitted = self.scale.quanta(hit.transmitted);
        bin.received[usize::from(!hit.point.is_front)].add(met);
        bin.absorbed.add(met);
        bin.absorbed.take(reflected);
        bin.absorbed.take(transmitted);
        bin.reflected.add(reflected);
        bin.transmitted.add(transmitted);
        bin.hits += 1;
        Onward::Go
    }

    fn flies(&mut self, ray: &Ray, power: Rgb) {
        self.sensors.count(ray, power, self.scale, &mut self.sensed);
    }
}
