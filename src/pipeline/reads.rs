//! The files that a run has read besides its texts: tables of data, panoramas. They are inputs as the texts are.

use super::content_hash::ContentHash;
use super::project_files::ReadFile;
use super::world::World;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Files with their contents; `None` for one that could not be read.
pub type Contents = BTreeMap<PathBuf, Option<ContentHash>>;

/// What was read, shared by who reads and who watches.
#[derive(Clone, Debug, Default)]
pub struct Reads {
    /// By growth, and by what comes after it.
    contents: Arc<Mutex<[Contents; 2]>>,
}

/// Which stage reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reader {
    /// The model while it grows.
    Growth,
    /// The scene.
    Scene,
}

impl Reads {
    fn lock(&self) -> MutexGuard<'_, [Contents; 2]> {
        self.contents.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A stage begins anew.
    pub fn begin(&self, reader: Reader) {
        self.lock()[reader as usize].clear();
    }

    /// Whether a stage has read anything.
    pub fn has_any(&self, reader: Reader) -> bool {
        !self.lock()[reader as usize].is_empty()
    }

    /// Remembers what was found at `path`. What was found first counts: a file that changes while a model reads it twice has
    /// changed.
    pub fn record(&self, reader: Reader, path: &Path, content: Option<&[u8]>) {
        let hash = content.map(|content| ContentHash::of([content]));
        let mut contents = self.lock();
        contents[reader as usize]
            .entry(path.to_owned())
            .or_insert(hash);
    }

    /// The model itself has written this; if it had read it before, that is no change of an input.
    pub fn wrote(&self, path: &Path, content: &[u8]) {
        if let Some(known) = self.lock()[Reader::Growth as usize].get_mut(path) {
            *known = Some(ContentHash::of([content]));
        }
    }

    /// What reads as `read` does and is remembered.
    pub fn recording(&self, read: ReadFile) -> ReadFile {
        let reads = self.clone();
        Arc::new(move |path| {
            let found = read(path);
            reads.record(Reader::Growth, path, found.as_deref().ok());
            found
        })
    }

    /// Whether everything that a stage has read still is as it was.
    pub fn are_current(&self, reader: Reader, world: &dyn World) -> bool {
        let contents = self.lock()[reader as usize].clone();
        changed(&contents, world).is_empty()
    }

    /// All files, as they are now, that are not as they were read.
    pub fn stale(&self, world: &dyn World) -> Contents {
        let all: Contents = self
            .lock()
            .iter()
            .flatten()
            .map(|(p, h)| (p.clone(), *h))
            .collect();
        changed(&all, world)
    }

    /// All files.
    pub fn paths(&self) -> Vec<PathBuf> {
        self.lock()
            .iter()
            .flat_map(BTreeMap::keys)
            .cloned()
            .collect()
    }
}

fn changed(contents: &Contents, world: &dyn World) -> Contents {
    let now = contents
        .iter()
        .map(|(path, then)| (path, world.hash(path).ok(), then));
    now.filter(|(_, now, then)| now != *then)
        .map(|(path, now, _)| (path.clone(), now))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::world::fake::FakeWorld;

    #[test]
    fn what_was_read_is_current_until_it_changes() {
        let (world, reads) = (FakeWorld::default(), Reads::default());
        world.put("d/a.csv", "1");
        let read = reads.recording(world.reader());
        let all = |paths: &[&str]| paths.iter().for_each(|path| drop(read(Path::new(path))));
        all(&["d/a.csv", "d/b.csv"]);
        assert!(reads.are_current(Reader::Growth, &world));
        world.put("d/b.csv", "2");
        assert_eq!(reads.stale(&world).len(), 1, "a file that is there now");
        reads.begin(Reader::Growth);
        all(&["d/a.csv", "d/b.csv"]);
        assert!(reads.stale(&world).is_empty());
        // A model that adds to a file does not start itself.
        world.put("d/a.csv", "1 and more");
        reads.wrote(Path::new("d/a.csv"), b"1 and more");
        assert!(reads.stale(&world).is_empty());
        assert_eq!(reads.paths().len(), 2);
    }
}
