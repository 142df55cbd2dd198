//! Events of the file system, for the files of one model.

use super::session::Event;
use crate::pipeline::world::{Entry, World, folder_of};
use notify::{EventKind, RecommendedWatcher, RecursiveMode, Watcher};
use std::path::{Path, PathBuf};
use std::sync::mpsc::Sender;

/// Sends [`Event::Touched`] whenever something happens to a file of `model`, until the result is dropped.
///
/// It is the folder that is watched: a watch on the file itself is dead after the first save that renames a new file
/// over it, as most editors do.
///
/// # Errors
/// If the system gives no events; looking once a second still works.
pub fn follow(
    world: &dyn World,
    model: &Path,
    events: Sender<Event>,
) -> notify::Result<RecommendedWatcher> {
    let is_folder = world.entry(model) == Entry::Folder;
    let folder = if is_folder { model } else { folder_of(model) };
    let files = if is_folder {
        None
    } else {
        Some([model.to_owned(), model.with_extension("toml")])
    };
    let mut watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
        // An error (a queue that ran over) may hide anything, so it counts as a touch.
        let concerns = event.map_or(true, |event| {
            !matches!(event.kind, EventKind::Access(_))
                && event.paths.iter().any(|path| belongs(path, files.as_ref()))
        });
        if concerns {
            // Nobody listens any more only when watching ends.
            let _ = events.send(Event::Touched);
        }
    })?;
    watcher.watch(folder, RecursiveMode::NonRecursive)?;
    Ok(watcher)
}

/// Whether a file in the watched folder is (or may be) a part of the model: one of `files`, or any of a folder's.
///
/// Compares names only: the system may know the folder by another path than the user.
fn belongs(path: &Path, files: Option<&[PathBuf; 2]>) -> bool {
    match files {
        Some(files) => files
            .iter()
            .any(|file| file.file_name() == path.file_name()),
        None => path
            .extension()
            .is_some_and(|suffix| suffix == "rgg" || suffix == "toml"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_beside_the_model_are_not_part_of_it() {
        let files = [PathBuf::from("d/plant.rgg"), PathBuf::from("d/plant.toml")];
        let cases = [
            ("plant.rgg", true),
            ("plant.toml", true),
            ("plant.png", false),
            ("tree.rgg", false),
        ];
        for (name, expected) in cases {
            assert_eq!(
                belongs(&Path::new("/abs/d").join(name), Some(&files)),
                expected,
                "{name}"
            );
        }
        assert!(belongs(Path::new("/abs/d/tree.rgg"), None));
        assert!(!belongs(Path::new("/abs/d/tree.rgg~"), None));
    }
}
