//! Where the thread that makes pictures and the server of the page meet.

use super::state::{Activity, Frame, State};
use super::wish::Wish;
use crate::integrator::CancelToken;
use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio::sync::watch;

/// Pictures that are kept for who is slow to fetch them.
const KEPT: usize = 3;
/// How long a sleeper sleeps at most, should a call to wake it be lost.
const NAP: Duration = Duration::from_millis(500);

/// A picture as a file.
#[derive(Clone, Debug)]
pub struct File {
    /// Its content.
    pub bytes: Arc<[u8]>,
    /// What it is, for browsers.
    pub kind: &'static str,
}

/// Where the thread that makes pictures and the server of the page meet.
#[derive(Debug)]
pub struct Room {
    inside: Mutex<Inside>,
    /// Wakes the thread that makes pictures.
    bell: Condvar,
    /// Counts the changes of the state, for who waits for them.
    version: watch::Sender<u64>,
}

#[derive(Debug)]
struct Inside {
    state: State,
    wish: Wish,
    /// Counts wishes.
    n_wishes: u64,
    /// Stops what is being done for the wish before.
    cancel: CancelToken,
    /// Stops it if it is of no use for any view.
    leave: CancelToken,
    /// Whether what is being done is of use for any view.
    suits_all_views: bool,
    frames: VecDeque<(u64, File)>,
    n_frames: u64,
    /// The last whole picture, to be saved.
    whole: Option<File>,
    /// The files of the model, by their numbers in problems.
    files: Vec<PathBuf>,
    is_closed: bool,
}

/// What to work on.
#[derive(Clone, Debug)]
pub struct Task {
    /// The wish.
    pub wish: Wish,
    /// Its number.
    pub number: u64,
    /// Set as soon as a newer wish, or a change of the files, makes the work useless.
    pub cancel: CancelToken,
    /// Set as soon as they make all views of the same scene useless.
    pub leave: CancelToken,
}

impl Room {
    /// A room for the model of this name.
    pub fn new(name: String, has_editor: bool) -> Self {
        let state = State {
            name,
            has_editor,
            ..State::default()
        };
        Self {
            inside: Mutex::new(Inside {
                state,
                wish: Wish::default(),
                n_wishes: 0,
                cancel: CancelToken::default(),
                leave: CancelToken::default(),
                suits_all_views: false,
                frames: VecDeque::new(),
                n_frames: 0,
                whole: None,
                files: Vec::new(),
                is_closed: false,
            }),
            bell: Condvar::new(),
            version: watch::Sender::new(0),
        }
    }

    fn lock(&self) -> MutexGuard<'_, Inside> {
        // What a thread that panicked left half done is a state to show, no more.
        self.inside.lock().unwrap_or_else(PoisonError::into_inner)
    }

    // ── the thread that makes pictures ──

    /// Changes what the page shows.
    pub fn tell(&self, change: impl FnOnce(&mut State)) {
        change(&mut self.lock().state);
        self.version.send_modify(|version| *version += 1);
    }

    /// Takes the newest wish. What is done for it is stopped by a newer one; by one for another view only, if
    /// `suits_all_views` is not set.
    pub fn take(&self, suits_all_views: bool) -> Task {
        let mut inside = self.lock();
        inside.cancel = CancelToken::default();
        inside.leave = CancelToken::default();
        inside.suits_all_views = suits_all_views;
        inside.state.is_queued = false;
        Task {
            wish: inside.wish.clone(),
            number: inside.n_wishes,
            cancel: inside.cancel.clone(),
            leave: inside.leave.clone(),
        }
    }

    /// Waits for a wish after this one, or for [`interrupt`](Self::interrupt) to be called after `stop` was cancelled.
    pub fn wait(&self, number: u64, stop: &CancelToken) {
        let mut inside = self.lock();
        while inside.n_wishes == number && !stop.is_cancelled() {
            let slept = self.bell.wait_timeout(inside, NAP);
            inside = slept.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Shows a picture.
    pub fn show(&self, file: File, frame: Frame) {
        let mut inside = self.lock();
        inside.n_frames += 1;
        let number = inside.n_frames;
        if frame.is_final {
            inside.whole = Some(file.clone());
        }
        inside.frames.push_back((number, file));
        while inside.frames.len() > KEPT {
            inside.frames.pop_front();
        }
        inside.state.frame = Some(Frame { number, ..frame });
        drop(inside);
        self.version.send_modify(|version| *version += 1);
    }

    /// Sets which files the numbers in problems stand for.
    pub fn set_files(&self, files: Vec<PathBuf>) {
        self.lock().files = files;
    }

    // ── the watcher ──

    /// The files changed, or watching ends: whatever is being done is to stop, whoever waits is woken.
    pub fn interrupt(&self) {
        let inside = self.lock();
        inside.cancel.cancel();
        inside.leave.cancel();
        drop(inside);
        self.bell.notify_all();
    }

    /// Watching ends: the server is to let go of its visitors.
    pub fn close(&self) {
        self.lock().is_closed = true;
        self.version.send_modify(|version| *version += 1);
    }

    // ── the server ──

    /// Asks for something else.
    pub fn ask(&self, wish: Wish) {
        let mut inside = self.lock();
        if inside.wish == wish {
            return;
        }
        let is_view = inside.wish.differs_in_view_only(&wish);
        if !(is_view && inside.suits_all_views) {
            inside.cancel.cancel();
        }
        if !is_view {
            inside.leave.cancel();
        }
        inside.wish = wish;
        inside.n_wishes += 1;
        inside.state.is_queued =
            !matches!(inside.state.activity, Activity::Done | Activity::Failed);
        self.bell.notify_all();
        drop(inside);
        self.version.send_modify(|version| *version += 1);
    }

    /// The state as a line of JSON; `None` once watching has ended.
    pub fn state(&self) -> Option<String> {
        let inside = self.lock();
        if inside.is_closed {
            return None;
        }
        let state = serde_json::to_string(&inside.state);
        Some(state.expect("invariant: the state is plain data with text keys"))
    }

    /// The model's name.
    pub fn name(&self) -> String {
        self.lock().state.name.clone()
    }

    /// Whether watching has ended.
    pub fn is_closed(&self) -> bool {
        self.lock().is_closed
    }

    /// Tells of each change of the state.
    pub fn changes(&self) -> watch::Receiver<u64> {
        self.version.subscribe()
    }

    /// A picture that was shown not long ago.
    pub fn frame(&self, number: u64) -> Option<File> {
        let inside = self.lock();
        let mut frames = inside.frames.iter();
        frames
            .find(|(n, _)| *n == number)
            .map(|(_, file)| file.clone())
    }

    /// The last whole picture.
    pub fn whole(&self) -> Option<File> {
        self.lock().whole.clone()
    }

    /// The file of this number in problems.
    pub fn file(&self, number: u16) -> Option<PathBuf> {
        self.lock().files.get(usize::from(number)).cloned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wish(json: &str) -> Wish {
        serde_json::from_str(json).unwrap()
    }

    #[test]
    fn a_wish_stops_what_it_makes_useless_and_nothing_else() {
        let room = Room::new("p".into(), false);
        let task = room.take(true);
        room.ask(wish(r#"{"options":{"eye":"1,2,3"}}"#));
        assert!(!task.cancel.is_cancelled(), "any view will do");
        room.ask(wish(r#"{"options":{"eye":"1,2,3","steps":"3"}}"#));
        assert!(task.cancel.is_cancelled());
        let task = room.take(false);
        assert_eq!(task.number, 2);
        room.ask(task.wish.clone());
        assert!(!task.cancel.is_cancelled(), "the same again is no wish");
        room.ask(wish(r#"{"options":{"eye":"4,2,3","steps":"3"}}"#));
        assert!(task.cancel.is_cancelled() && !task.leave.is_cancelled());
        room.ask(Wish::default());
        assert!(task.leave.is_cancelled());
        room.wait(task.number, &CancelToken::default());
    }

    #[test]
    fn who_waits_is_woken_by_the_watcher() {
        let (room, stop) = (Room::new("p".into(), false), CancelToken::default());
        std::thread::scope(|scope| {
            let sleeper = scope.spawn(|| room.wait(0, &stop));
            stop.cancel();
            room.interrupt();
            sleeper.join().unwrap();
        });
    }

    #[test]
    fn only_the_last_pictures_are_kept() {
        let room = Room::new("p".into(), false);
        let frame = Frame {
            number: 0,
            width: 1,
            height: 1,
            is_final: false,
            samples: 1,
            error: None,
        };
        for _ in 0..10 {
            let bytes: Arc<[u8]> = Arc::from([1_u8]);
            room.show(
                File {
                    bytes,
                    kind: "image/jpeg",
                },
                frame,
            );
        }
        assert!(room.frame(10).is_some() && room.frame(8).is_some());
        assert!(room.frame(7).is_none() && room.frame(11).is_none());
        assert!(room.whole().is_none());
    }
}
