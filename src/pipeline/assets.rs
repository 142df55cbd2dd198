//! The files of meshes and images that the texts of a model name: they are part of what a run depends on.
//!
//! What counts are names in quotes, `"rock.obj"`, as they stand in the text, relative to the folder of the model's first file,
//! the files that commonly belong to them (`rock.mtl`, `rock.bin`), and the pictures that those name. Behind `shader(` and
//! `image(` a name may lack its suffix. A name that is put together while the model runs is not found; the model then has to be
//! saved for `watch` to see the change.

use super::content_hash::ContentHash;
use super::world::{Entry, World, folder_of};
use crate::eval::picture::candidates;
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
    let mut found = Found {
        world,
        files: BTreeMap::new(),
    };
    for text in texts {
        for name in named(text) {
            found.mesh_or_picture(&folder.join(slashes(name)));
        }
        for name in called(text).flat_map(candidates) {
            found.add(&folder.join(slashes(&name)));
        }
    }
    found.files
}

/// What was found so far.
struct Found<'w> {
    world: &'w dyn World,
    files: BTreeMap<PathBuf, ContentHash>,
}

impl Found<'_> {
    /// Adds a file; tells whether it is there and was not known.
    fn add(&mut self, path: &Path) -> bool {
        if self.files.contains_key(path) || self.world.entry(path) != Entry::File {
            return false;
        }
        let hash = self.world.hash(path);
        if let Ok(hash) = hash {
            self.files.insert(path.to_owned(), hash);
        }
        hash.is_ok()
    }

    /// Adds a file with what belongs to it.
    fn mesh_or_picture(&mut self, path: &Path) {
        let library = path.with_extension("mtl");
        let is_document = self.add(path) && has_suffix(path, "gltf");
        let has_library = self.add(&library);
        self.add(&path.with_extension("bin"));
        let folder = folder_of(path).to_owned();
        let speaking = [(is_document, path), (has_library, &*library)];
        for (_, path) in speaking.into_iter().filter(|(is_there, _)| *is_there) {
            let Ok(content) = self.world.read(path) else {
                continue;
            };
            let text = String::from_utf8_lossy(&content);
            let words = text.lines().filter_map(|line| {
                let is_map = line.trim_start().starts_with("map_");
                is_map.then(|| line.split_whitespace().last()).flatten()
            });
            for name in words.chain(named(&text)) {
                self.add(&folder.join(slashes(name)));
            }
        }
    }
}

fn slashes(name: &str) -> String {
    name.replace('\\', "/")
}

fn has_suffix(path: &Path, suffix: &str) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case(suffix))
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

/// What stands in quotes as the name of a shader or image.
fn called(text: &str) -> impl Iterator<Item = &str> {
    ["shader(", "image(", "ShaderRef(", "ImageMap("]
        .into_iter()
        .flat_map(move |call| text.split(call).skip(1))
        .filter_map(|rest| rest.trim_start().strip_prefix('"')?.split_once('"'))
        .map(|(name, _)| name)
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

    #[test]
    fn pictures_are_found_by_their_short_names_and_in_materials() {
        let world = FakeWorld::default();
        for file in ["m/a.rgg", "m/leaf.jpg", "m/images/bark.png", "m/s/moss.png"] {
            world.put(file, file);
        }
        world.put("m/s/rock.obj", "");
        world.put("m/s/rock.mtl", "newmtl a\n map_Kd -s 2 2 1 moss.png\n");
        let text = "setShader(shader(\"leaf\")) image( \"bark\") Mesh(\"s/rock.obj\")";
        let found = contents(&world, Path::new("m/a.rgg"), [text]);
        let names: Vec<&str> = found.keys().map(|path| path.to_str().unwrap()).collect();
        let expected = ["m/images/bark.png", "m/leaf.jpg", "m/s/moss.png"];
        assert!(
            expected.iter().all(|name| names.contains(name)),
            "{names:?}"
        );
    }
}
