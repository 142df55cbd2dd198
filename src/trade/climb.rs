//! Which rung is tried next.

use super::ladder::Family;

/// Cost of a rung over that of the one before: until two are known, and between which it is believed to lie.
const FIRST_GROWTH: f64 = 3.0;
const GROWTH: (f64, f64) = (1.2, 6.0);

/// A ladder that is being climbed.
pub(super) struct Climb<'f> {
    pub(super) family: &'f Family,
    /// Seconds that each of its rungs took.
    pub(super) costs: Vec<f64>,
    /// Whether no rung is left, or none will be tried.
    pub(super) is_done: bool,
}

impl<'f> Climb<'f> {
    pub(super) fn new(family: &'f Family) -> Self {
        Self {
            family,
            costs: vec![],
            is_done: family.rungs.is_empty(),
        }
    }

    /// Notes what the next rung has cost.
    pub(super) fn cost(&mut self, seconds: f64) {
        self.costs.push(seconds);
        self.is_done = self.costs.len() == self.family.rungs.len();
    }

    /// What the next rung will cost; `None` before the first one.
    pub(super) fn expected(&self) -> Option<f64> {
        let last = self.costs.last()?;
        let growth = match self.costs[..] {
            [.., before, last] if before > 0.0 => (last / before).clamp(GROWTH.0, GROWTH.1),
            _ => FIRST_GROWTH,
        };
        Some(last * growth)
    }
}

/// The ladder whose next rung is cheapest, those first of which nothing is known; `None` if all are done. What only shows how a
/// method behaves has to be half as dear.
pub(super) fn cheapest(climbs: &[Climb<'_>]) -> Option<usize> {
    let cost = |climb: &Climb<'_>| {
        let weight = if climb.family.is_contender { 1.0 } else { 2.0 };
        weight * climb.expected().unwrap_or(0.0)
    };
    let open = climbs
        .iter()
        .enumerate()
        .filter(|(_, climb)| !climb.is_done);
    let least = open.min_by(|(_, a), (_, b)| cost(a).total_cmp(&cost(b)));
    least.map(|(nth, _)| nth)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trade::ladder::{Needs, families};

    #[test]
    fn the_cheapest_rung_is_next_and_every_ladder_has_its_turn() {
        let needs = Needs {
            has_specular: true,
            radius: 1.0,
        };
        let families = families(needs, None);
        let mut climbs: Vec<Climb<'_>> = families.iter().map(Climb::new).collect();
        for n in 0..climbs.len() {
            assert_eq!(
                cheapest(&climbs),
                Some(n),
                "those not begun come first, in order"
            );
            climbs[n].cost(1.0);
        }
        climbs[2].cost(1.1);
        assert_eq!(climbs[2].expected(), Some(1.1 * GROWTH.0));
        assert_eq!(cheapest(&climbs), Some(2));
        climbs[2].cost(100.0);
        assert_eq!(climbs[2].expected(), Some(100.0 * GROWTH.1));
        assert_eq!(cheapest(&climbs), Some(0));
        for climb in &mut climbs {
            climb.is_done = true;
        }
        assert_eq!(cheapest(&climbs), None);
    }
}
