//! Events of the file system, for the files of one model.

use super::session::Event;
use crate::pipeline::packed;
use crate::pipeline::world::folder_of;
use notify::{EventKind, RecommendedWatcher, RecursiveMode, Watcher};
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};

/// Sends [`Event::Touched`] whenever something happens to a file that counts, until it is dropped.
///
/// It is the folder that is watched: a watch on the file itself is dead after the first save that renames a new file
/// over it, as most editors do.
pub struct Follower {
    watcher: RecommendedWatcher,
    folders: BTreeSet<PathBuf>,
    names: Arc<Mutex<BTreeSet<OsString>>>,
}

impl Follower {
    /// Follows no file yet.
    ///
    /// # Errors
    /// If the system gives no events; looking once a second still works.
    pub fn new(events: Sender<Event>) -> notify::Result<Self> {
        let names = Arc::new(Mutex::new(BTreeSet::new()));
        let known = names.clone();
        let watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
            // An error (a queue that ran over) may hide anything, so it counts as a touch.
            let concerns = event.map_or(true, |event| {
                let known = known.lock().unwrap_or_else(PoisonError::into_inner);
                !matches!(event.kind, EventKind::Access(_))
                    && event.paths.iter().any(|path| belongs(path, &known))
            });
            if concerns {
                // Nobody listens any more only when watching ends.
                let _ = events.send(Event::Touched);
            }
        })?;
        Ok(Self {
            watcher,
            folders: BTreeSet::new(),
            names,
        })
    }

    /// Follows these files from now on. The folders of those before stay watched: events from there cost nothing.
    pub fn follow(&mut self, files: &[PathBuf]) {
        let files = files.iter().map(|file| {
            // A packed project is one file.
            packed::split(file).map_or(file.as_path(), |(archive, _)| archive)
        });
        let files: BTreeSet<&Path> = files.collect();
        let names = files.iter().filter_map(|file| file.file_name());
        *self.names.lock().unwrap_or_else(PoisonError::into_inner) =
            names.map(OsString::from).collect();
        for file in files {
            let folder = folder_of(file);
            // A folder that is not there, or cannot be watched, is looked into once a second.
            if !self.folders.contains(folder)
                && self
                    .watcher
                    .watch(folder, RecursiveMode::NonRecursive)
                    .is_ok()
            {
                self.folders.insert(folder.to_owned());
            }
        }
    }
}

/// Whether a file in a watched folder counts: it is known, or may be a new part of the model.
fn belongs(path: &Path, known: &BTreeSet<OsString>) -> bool {
    path.file_name().is_some_and(|name| known.contains(name))
        || path
            .extension()
            .is_some_and(|suffix| suffix == "rgg" || suffix == "toml" || suffix == "gsz")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;
    use std::time::Duration;

    #[test]
    fn pictures_beside_the_model_are_not_part_of_it_unless_it_reads_them() {
        let known = BTreeSet::from([OsString::from("bark.png")]);
        for (name, expected) in [
            ("plant.rgg", true),
            ("plant.toml", true),
            ("plant.gsz", true),
            ("bark.png", true),
            ("plant.png", false),
            ("plant.rgg~", false),
        ] {
            assert_eq!(
                belongs(&Path::new("/abs/d").join(name), &known),
                expected,
                "{name}"
            );
        }
    }

    #[test]
    fn files_in_several_folders_are_followed_through_every_kind_of_save() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("data")).unwrap();
        for name in ["m.rgg", "data/t.csv", "data/other.csv"] {
            std::fs::write(at(name), "1").unwrap();
        }
        let (sender, events) = channel();
        let Ok(mut follower) = Follower::new(sender) else {
            return;
        };
        follower.follow(&[at("m.rgg"), at("data/t.csv"), at("gone/x.csv")]);
        let is_heard = || events.recv_timeout(Duration::from_secs(10)).is_ok();
        let settle = || while events.recv_timeout(Duration::from_millis(200)).is_ok() {};
        std::fs::write(at("data/t.csv"), "2").unwrap();
        assert!(is_heard(), "written in place");
        settle();
        std::fs::write(at("data/t.new"), "3").unwrap();
        std::fs::rename(at("data/t.new"), at("data/t.csv")).unwrap();
        assert!(is_heard(), "renamed over");
        settle();
        std::fs::remove_file(at("data/t.csv")).unwrap();
        std::fs::write(at("data/t.csv"), "4").unwrap();
        assert!(is_heard(), "made again");
        settle();
        std::fs::write(at("data/other.csv"), "5").unwrap();
        let heard = events.recv_timeout(Duration::from_millis(300));
        assert!(heard.is_err(), "nobody reads it");
    }
}
