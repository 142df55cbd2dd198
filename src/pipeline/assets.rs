//! The files of meshes and images that the texts of a model name: they are part of what a run depends on.
//!
//! What counts are names in quotes, `"rock.obj"`, as they stand in the text, relative to the folder of the model's first file,
//! and the files that commonly belong to them (`rock.mtl`, `rock.bin`). A name that is put together while the model runs is
//! not found; the model then has to be saved for `watch` to see the change.

use super::content_hash::ContentHash;
use super::world::{Entry, World, folder_of};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Suffixes of such files.
const SUFFIXES: [&str; 6] = ["obj", "glb", "gltf", "png", "jpg", "jpeg"];

/// The content of each such file that is there, by path, for a model whose first file is `model`.
pub fn contents<'t>(
    world: &dyn World,
    model: &Path,
    texts: impl IntoIterator<Item = &'t str>,
) -> BTreeMap<PathBuf, ContentHash> {
    let folder = folder_of(model);
    let mut found = BTreeMap::new();
    for name in texts.into_iter().flat_map(named) {
        let path = folder.join(name.replace('\\', "/"));
        let beside = ["mtl", "bin"].map(|suffix| path.with_extension(suffix));
        for path in [path].into_iter().chain(beside) {
            if found.contains_key(&path) || world.entry(&path) != Entry::File {
                continue;
            }
            if let Ok(content) = world.read(&path) {
                found.insert(path, ContentHash::of([&content[..]]));
            }
        }
    }
    found
}

/// What stands in quotes in a text and ends like the name of such a file.
fn named(text: &str) -> impl Iterator<Item = &str> {
    let quoted = text
        .lines()
        .flat_map(|line| line.split('"').skip(1).step_by(2));
    quoted.filter(|name| {
        let suffix = name.rsplit_once('.').map_or("", |(_, suffix)| suffix);
        SUFFIXES.contains(&suffix.to_ascii_lowercase().as_str())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::world::fake::FakeWorld;

    #[test]
    fn files_that_a_model_names_are_found_with_what_belongs_to_them() {
        let world = FakeWorld::default();
        for file in [
            "m/a.rgg",
            "m/s/rock.obj",
            "m/s/rock.mtl",
            "m/pot.GLB",
            "m/other.obj",
        ] {
            world.put(file, file);
        }
        let text =
            "Mesh(\"s/rock.obj\") // \"\nMesh(\"pot.GLB\") Mesh(\"gone.obj\") x = \"other\";";
        let found = contents(&world, Path::new("m/a.rgg"), [text]);
        let names: Vec<&str> = found.keys().map(|path| path.to_str().unwrap()).collect();
        assert_eq!(names, ["m/pot.GLB", "m/s/rock.mtl", "m/s/rock.obj"]);
        world.put("m/s/rock.mtl", "new");
        let changed = contents(&world, Path::new("m/a.rgg"), [text]);
        let differs = |name: &str| changed[Path::new(name)] != found[Path::new(name)];
        assert!(differs("m/s/rock.mtl") && !differs("m/s/rock.obj"));
    }
}
