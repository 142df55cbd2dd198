//! How much memory the values of a model hold, so that a runaway string or array ends with a message.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Bytes in use by long texts, arrays and collections of one machine, and how many there may be.
#[derive(Debug)]
pub struct Meter {
    used: AtomicU64,
    limit: u64,
}

/// The request would exceed the memory budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OverBudget {
    /// What was asked for, in bytes.
    pub wanted: u64,
    /// The budget, in bytes.
    pub limit: u64,
}

impl Meter {
    /// A meter that allows `limit` bytes.
    pub fn new(limit: u64) -> Arc<Self> {
        Arc::new(Self {
            used: AtomicU64::new(0),
            limit,
        })
    }

    /// Bytes in use.
    pub fn used(&self) -> u64 {
        self.used.load(Ordering::Relaxed)
    }

    /// Takes `bytes`; they are given back when the charge is dropped.
    pub fn charge(self: &Arc<Self>, bytes: u64) -> Result<Charge, OverBudget> {
        let before = self.used.fetch_add(bytes, Ordering::Relaxed);
        if before.saturating_add(bytes) > self.limit {
            self.used.fetch_sub(bytes, Ordering::Relaxed);
            return Err(OverBudget {
                wanted: bytes,
                limit: self.limit,
            });
        }
        Ok(Charge(Some((Arc::clone(self), bytes))))
    }
}

/// A share of the memory budget, held by what it was taken for.
#[derive(Debug, Default)]
pub struct Charge(Option<(Arc<Meter>, u64)>);

impl Charge {
    /// No share: constants of the program, short texts.
    pub fn none() -> Self {
        Self(None)
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        self.0.as_ref().map_or(0, |(_, bytes)| *bytes)
    }
}

impl Clone for Charge {
    /// A copy of what was charged is short-lived and takes no share.
    fn clone(&self) -> Self {
        Self::none()
    }
}

impl Drop for Charge {
    fn drop(&mut self) {
        if let Some((meter, bytes)) = &self.0 {
            meter.used.fetch_sub(*bytes, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dropped_charge_gives_its_bytes_back() {
        let meter = Meter::new(100);
        let first = meter.charge(60).unwrap();
        assert_eq!(
            meter.charge(50).unwrap_err(),
            OverBudget {
                wanted: 50,
                limit: 100
            }
        );
        drop(first);
        let second = meter.charge(100).unwrap();
        assert_eq!((meter.used(), second.bytes()), (100, 100));
    }
}
