//! Events of the file system, for the files of one model.

use super::session::Event;
use crate::pipeline::inputs::Inputs;
use crate::pipeline::packed;
use crate::pipeline::world::{Entry, World, folder_of};
use notify::{EventKind, RecommendedWatcher, RecursiveMode, Watcher};
use std::path::Path;
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
    let mut watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
        // An error (a queue that ran over) may hide anything, so it counts as a touch.
        let concerns = event.map_or(true, |event| {
            !matches!(event.kind, EventKind::Access(_))
                && event.paths.iter().any(|path| belongs(path))
        });
        if concerns {
            // Nobody listens any more only when watching ends.
            let _ = events.send(Event::Touched);
        }
    })?;
    // Files that are imported only later are seen by looking once a second.
    let inputs = Inputs::find(world, model).unwrap_or_else(|_| Inputs::only(model));
    let mut folders: Vec<&Path> = inputs.models.iter().map(|file| folder_of(file)).collect();
    if world.entry(model) == Entry::Folder {
        folders.push(model);
    }
    // A packed project is one file.
    for folder in &mut folders {
        *folder = packed::split(folder).map_or(*folder, |(archive, _)| folder_of(archive));
    }
    folders.sort_unstable();
    folders.dedup();
    for folder in folders {
        watcher.watch(folder, RecursiveMode::NonRecursive)?;
    }
    Ok(watcher)
}

/// Whether a file in a watched folder may be a part of the model.
fn belongs(path: &Path) -> bool {
    path.extension()
        .is_some_and(|suffix| suffix == "rgg" || suffix == "toml" || suffix == "gsz")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_beside_the_model_are_not_part_of_it() {
        for (name, expected) in [
            ("plant.rgg", true),
            ("plant.toml", true),
            ("plant.gsz", true),
            ("plant.png", false),
            ("plant.rgg~", false),
        ] {
            assert_eq!(belongs(&Path::new("/abs/d").join(name)), expected, "{name}");
        }
    }
}
