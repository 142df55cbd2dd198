//! The state of watching: what was run last, what is under way, and when to look again.

use super::snapshot::Snapshot;
use std::time::Duration;

/// Looks wait this long after a touch, so that a save of many writes is one change. Short, because a run that was started
/// too early is stopped at once by the next look.
const QUIET: Duration = Duration::from_millis(30);
/// … but never longer than this after the first touch.
const LONGEST: Duration = Duration::from_millis(500);
/// How long a missing file may be on its way before its absence is news.
const TORN: Duration = Duration::from_millis(400);
/// How often to look when nothing is touched.
const PATROL: Duration = Duration::from_secs(1);

/// What to do after a look.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Order {
    /// Nothing.
    Nothing,
    /// Run the model, because these files changed.
    Start(Vec<String>),
    /// Stop the run under way: it shows what is no longer true.
    Cancel,
}

/// The state of watching.
#[derive(Debug)]
pub struct Desk {
    /// What the last run, finished or not, was started on.
    seen: Snapshot,
    is_running: bool,
    first_touch: Option<Duration>,
    next_look: Duration,
    torn_since: Option<Duration>,
}

impl Desk {
    /// Begins with a run on `first` under way.
    pub fn new(first: Snapshot, now: Duration) -> Self {
        Self {
            seen: first,
            is_running: true,
            first_touch: None,
            next_look: now + PATROL,
            torn_since: None,
        }
    }

    /// A file of the model was touched at `now`.
    pub fn touched(&mut self, now: Duration) {
        let first = *self.first_touch.get_or_insert(now);
        self.next_look = (now + QUIET).min(first + LONGEST);
    }

    /// The run under way ended. Looks at once: it may have ended because something changed.
    pub fn finished(&mut self, now: Duration) {
        self.is_running = false;
        if self.first_touch.is_none() {
            self.next_look = now;
        }
    }

    /// How long to wait for events before the next look.
    pub fn patience(&self, now: Duration) -> Duration {
        self.next_look.saturating_sub(now)
    }

    /// Decides on what the inputs are at `now`.
    pub fn look(&mut self, snapshot: Snapshot, now: Duration) -> Order {
        self.first_touch = None;
        self.next_look = now + PATROL;
        let changes = snapshot.changes_since(&self.seen);
        if changes.is_empty() {
            self.torn_since = None;
            return Order::Nothing;
        }
        if snapshot.is_torn() {
            let since = *self.torn_since.get_or_insert(now);
            if now < since + TORN {
                self.next_look = since + TORN;
                return Order::Nothing;
            }
        }
        self.torn_since = None;
        if self.is_running {
            return Order::Cancel;
        }
        self.seen = snapshot;
        self.is_running = true;
        Order::Start(changes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::watch::snapshot::tests::of;

    const fn ms(ms: u64) -> Duration {
        Duration::from_millis(ms)
    }

    fn idle(content: &str) -> Desk {
        let mut desk = Desk::new(of("p.rgg", Some(content)), ms(0));
        desk.finished(ms(0));
        assert_eq!(desk.look(of("p.rgg", Some(content)), ms(0)), Order::Nothing);
        desk
    }

    fn start() -> Order {
        Order::Start(vec!["p.rgg".into()])
    }

    #[test]
    fn a_burst_of_writes_is_one_change() {
        let mut desk = idle("a");
        for at in [10, 50, 90] {
            desk.touched(ms(at));
        }
        assert_eq!(desk.patience(ms(90)), QUIET);
        assert_eq!(desk.look(of("p.rgg", Some("b")), ms(90) + QUIET), start());
    }

    #[test]
    fn writes_without_end_do_not_put_it_off_for_ever() {
        let mut desk = idle("a");
        for at in (0..2000).step_by(50) {
            desk.touched(ms(at));
        }
        assert!(desk.patience(ms(0)) <= LONGEST);
    }

    #[test]
    fn a_touch_without_change_does_nothing() {
        let mut desk = idle("a");
        desk.touched(ms(10));
        assert_eq!(desk.look(of("p.rgg", Some("a")), ms(110)), Order::Nothing);
    }

    #[test]
    fn a_file_deleted_and_made_again_is_not_missed_in_between() {
        let mut desk = idle("a");
        desk.touched(ms(0));
        assert_eq!(desk.look(of("p.rgg", None), ms(100)), Order::Nothing);
        assert_eq!(desk.patience(ms(100)), TORN);
        assert_eq!(desk.look(of("p.rgg", Some("b")), ms(200)), start());
    }

    #[test]
    fn a_file_that_stays_away_is_news() {
        let mut desk = idle("a");
        assert_eq!(desk.look(of("p.rgg", None), ms(100)), Order::Nothing);
        assert_eq!(desk.look(of("p.rgg", None), ms(500)), start());
    }

    #[test]
    fn a_change_during_a_run_cancels_it_and_runs_again() {
        let mut desk = idle("a");
        assert_eq!(desk.look(of("p.rgg", Some("b")), ms(100)), start());
        assert_eq!(desk.look(of("p.rgg", Some("c")), ms(300)), Order::Cancel);
        desk.finished(ms(350));
        assert_eq!(desk.patience(ms(350)), ms(0));
        assert_eq!(desk.look(of("p.rgg", Some("c")), ms(350)), start());
        desk.finished(ms(900));
        assert_eq!(desk.look(of("p.rgg", Some("c")), ms(900)), Order::Nothing);
    }
}
