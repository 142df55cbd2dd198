//! What the inputs of a model contain at one moment.

use crate::pipeline::assets;
use crate::pipeline::content_hash::ContentHash;
use crate::pipeline::inputs::Inputs;
use crate::pipeline::reads::{Contents, Reads};
use crate::pipeline::world::World;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The content of each input, by path; `None` for one that cannot be read, or a text of the model without a byte: editors
/// that write in place empty a file first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Snapshot {
    contents: Contents,
    /// Of what the last run has read besides, what is no longer as it was then.
    stale: Contents,
}

impl Snapshot {
    /// Looks at the inputs of `model`, and at what the last run has read besides, now.
    pub fn take(world: &dyn World, model: &Path, reads: &Reads) -> Self {
        let inputs = Inputs::find(world, model).unwrap_or_else(|_| Inputs::only(model));
        let empty = ContentHash::of([&[][..]]);
        let read = |path: PathBuf| {
            let hash = world.hash(&path).ok().filter(|hash| *hash != empty);
            (path, hash)
        };
        let texts = inputs
            .models
            .iter()
            .filter_map(|path| world.read(path).ok());
        let texts: Vec<String> = texts
            .map(|text| String::from_utf8_lossy(&text).into_owned())
            .collect();
        let first = inputs.models.first().map_or(model, PathBuf::as_path);
        let named = assets::contents(world, first, texts.iter().map(String::as_str));
        let named = named.into_iter().map(|(path, hash)| (path, Some(hash)));
        let named: BTreeMap<_, _> = named.collect();
        let models = inputs.models.into_iter().chain(inputs.sidecar).map(read);
        Self {
            contents: models.chain(named).collect(),
            stale: reads.stale(world),
        }
    }

    /// All the files of the model.
    pub fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        self.contents.keys()
    }

    /// Whether an input is not there, as between the two halves of an editor's save.
    pub fn is_torn(&self) -> bool {
        self.contents.values().any(|hash| hash.is_none())
    }

    /// The names of files that differ between `earlier` and this.
    pub fn changes_since(&self, earlier: &Self) -> Vec<String> {
        let paths = self.contents.keys().chain(earlier.contents.keys());
        let changed = paths.filter(|path| self.contents.get(*path) != earlier.contents.get(*path));
        // What was stale then and is not now has been read again.
        let stale = self.stale.iter();
        let stale = stale.filter(|(path, hash)| earlier.stale.get(*path) != Some(*hash));
        let changed = changed.chain(stale.map(|(path, _)| path));
        let mut names: Vec<String> = changed
            .map(|path| {
                path.file_name()
                    .unwrap_or(path.as_os_str())
                    .to_string_lossy()
                    .into_owned()
            })
            .collect();
        names.sort();
        names.dedup();
        names
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A snapshot of one file.
    pub(in crate::watch) fn of(name: &str, content: Option<&str>) -> Snapshot {
        let hash = content.map(|text| ContentHash::of([text.as_bytes()]));
        Snapshot {
            contents: [(PathBuf::from(name), hash)].into(),
            stale: Contents::new(),
        }
    }

    #[test]
    fn meshes_that_the_model_names_are_inputs() {
        let world = crate::pipeline::world::fake::FakeWorld::default();
        world.put("m/p.rgg", "void init() [ Axiom ==> Mesh(\"rock.obj\"); ]");
        world.put("m/rock.obj", "v 0 0 0");
        let take = || Snapshot::take(&world, Path::new("m/p.rgg"), &Reads::default());
        let old = take();
        assert!(take().changes_since(&old).is_empty());
        world.put("m/rock.obj", "v 0 0 1");
        assert_eq!(take().changes_since(&old), ["rock.obj"]);
    }

    #[test]
    fn data_that_a_run_has_read_is_an_input_until_it_is_read_again() {
        let world = crate::pipeline::world::fake::FakeWorld::default();
        world.put("m/p.rgg", "x");
        world.put("m/t.csv", "1");
        let reads = Reads::default();
        let take = || Snapshot::take(&world, Path::new("m/p.rgg"), &reads);
        let read = reads.recording(world.reader());
        read(Path::new("m/t.csv")).unwrap();
        let before = take();
        assert!(take().changes_since(&before).is_empty());
        world.put("m/t.csv", "2");
        let started = take();
        assert_eq!(started.changes_since(&before), ["t.csv"]);
        // A run that does not come to read it is not started again …
        assert!(take().changes_since(&started).is_empty());
        // … nor is one that does.
        reads.begin(crate::pipeline::reads::Reader::Growth);
        read(Path::new("m/t.csv")).unwrap();
        assert!(take().changes_since(&started).is_empty());
        world.put("m/t.csv", "1");
        assert_eq!(take().changes_since(&started), ["t.csv"]);
    }

    #[test]
    fn a_file_that_was_just_emptied_is_torn() {
        let world = crate::pipeline::world::fake::FakeWorld::default();
        let take = || Snapshot::take(&world, Path::new("m/p.rgg"), &Reads::default());
        world.put("m/p.rgg", "");
        assert!(take().is_torn());
        world.put("m/p.rgg", "x");
        assert!(!take().is_torn());
    }

    #[test]
    fn changed_new_and_lost_files_are_named() {
        let old = of("d/plant.rgg", Some("a"));
        assert!(of("d/plant.rgg", Some("a")).changes_since(&old).is_empty());
        assert_eq!(
            of("d/plant.rgg", Some("b")).changes_since(&old),
            ["plant.rgg"]
        );
        assert_eq!(
            of("d/tree.rgg", Some("a")).changes_since(&old),
            ["plant.rgg", "tree.rgg"]
        );
        assert!(of("d/plant.rgg", None).is_torn() && !old.is_torn());
    }
}
