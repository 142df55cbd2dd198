//! What the inputs of a model contain at one moment.

use crate::pipeline::assets;
use crate::pipeline::content_hash::ContentHash;
use crate::pipeline::inputs::Inputs;
use crate::pipeline::world::World;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The content of each input, by path; `None` for one that cannot be read, or a text of the model without a byte: editors
/// that write in place empty a file first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Snapshot {
    contents: BTreeMap<PathBuf, Option<ContentHash>>,
}

impl Snapshot {
    /// Looks at the inputs of `model` now.
    pub fn take(world: &dyn World, model: &Path) -> Self {
        let inputs = Inputs::find(world, model).unwrap_or_else(|_| Inputs::only(model));
        let read = |path: PathBuf| {
            let hash = world
                .read(&path)
                .ok()
                .filter(|content| !content.is_empty())
                .map(|content| ContentHash::of([&content[..]]));
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
        }
    }

    /// Whether an input is not there, as between the two halves of an editor's save.
    pub fn is_torn(&self) -> bool {
        self.contents.values().any(|hash| hash.is_none())
    }

    /// The names of files that differ between `earlier` and this.
    pub fn changes_since(&self, earlier: &Self) -> Vec<String> {
        let paths = self.contents.keys().chain(earlier.contents.keys());
        let changed = paths.filter(|path| self.contents.get(*path) != earlier.contents.get(*path));
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
        }
    }

    #[test]
    fn meshes_that_the_model_names_are_inputs() {
        let world = crate::pipeline::world::fake::FakeWorld::default();
        world.put("m/p.rgg", "void init() [ Axiom ==> Mesh(\"rock.obj\"); ]");
        world.put("m/rock.obj", "v 0 0 0");
        let take = || Snapshot::take(&world, Path::new("m/p.rgg"));
        let old = take();
        assert!(take().changes_since(&old).is_empty());
        world.put("m/rock.obj", "v 0 0 1");
        assert_eq!(take().changes_since(&old), ["rock.obj"]);
    }

    #[test]
    fn a_file_that_was_just_emptied_is_torn() {
        let world = crate::pipeline::world::fake::FakeWorld::default();
        let take = || Snapshot::take(&world, Path::new("m/p.rgg"));
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
