//! What a method finds out about a scene once, for every camera.

use super::photon_map::PhotonSolution;
use super::radiosity::RadiositySolution;
use std::sync::Arc;

/// What a method found out about a scene. Borrows nothing; clones share it.
#[derive(Clone, Debug)]
pub enum Solution {
    /// The method looks at the scene afresh for each view.
    Nothing,
    /// Photons, made ready.
    Photons(Arc<PhotonSolution>),
    /// Light of patches and elements.
    Radiosity(Arc<RadiositySolution>),
}

/// Why bytes are no solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Unreadable(pub &'static str);

impl Solution {
    /// The solution as bytes that [`Integrator::restore`](super::Integrator::restore) reads; `None` if there is nothing to keep.
    #[must_use]
    pub fn to_bytes(&self) -> Option<Vec<u8>> {
        match self {
            Self::Nothing => None,
            Self::Photons(photons) => Some(photons.to_bytes()),
            Self::Radiosity(radiosity) => Some(radiosity.to_bytes()),
        }
    }

    /// Photons emitted and photons stored, if it is made of any.
    #[must_use]
    pub fn photons(&self) -> Option<(u64, u64)> {
        match self {
            Self::Nothing | Self::Radiosity(_) => None,
            Self::Photons(photons) => Some((photons.emitted, photons.stored)),
        }
    }
}
