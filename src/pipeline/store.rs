//! Where results go: checked before the work begins, written whole or not at all, never over something else.

use super::content_hash::ContentHash;
use super::failure::Failure;
use super::solution_file::MAGIC;
use super::world::{Entry, World, folder_of};
use crate::image::format::MAGIC_LENGTH;
use crate::image::{Format, Picture, encode};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// A picture file to be.
#[derive(Clone, Debug)]
pub struct PictureTarget {
    path: PathBuf,
    format: Format,
}

impl PictureTarget {
    /// A picture at `path`, whose suffix tells the format.
    ///
    /// # Errors
    /// If the suffix is unknown, files cannot be made there, or something that is no such picture is there already.
    pub fn new(world: &dyn World, path: &Path) -> Result<Self, Failure> {
        let format = Format::of_path(path).map_err(|error| Failure::Usage(error.to_string()))?;
        let target = Self {
            path: path.to_owned(),
            format,
        };
        target.check(world)?;
        Ok(target)
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its format.
    pub fn format(&self) -> Format {
        self.format
    }

    /// Writes the picture, with these texts where the format can keep them; returns the hash of the file.
    ///
    /// # Errors
    /// If it cannot be encoded or written; what was there before is then untouched.
    pub fn write(
        &self,
        world: &dyn World,
        picture: &Picture,
        texts: &[(&str, String)],
    ) -> Result<ContentHash, Failure> {
        let bytes =
            encode(picture, self.format, texts).map_err(|error| Failure::World(chain(&error)))?;
        self.check(world)?;
        put(world, &self.path, &bytes)?;
        Ok(ContentHash::of([&bytes[..]]))
    }

    fn check(&self, world: &dyn World) -> Result<(), Failure> {
        may_write(world, &self.path, "a picture of that format", |head| {
            self.format.begins(head)
        })
    }
}

/// A JSON file to be.
#[derive(Clone, Debug)]
pub struct JsonTarget {
    path: PathBuf,
}

impl JsonTarget {
    /// A JSON object at `path`; an earlier one of its kind is known by its having `keys`.
    ///
    /// # Errors
    /// If the suffix is not `.json`, files cannot be made there, or something else is there already.
    pub fn new(
        world: &dyn World,
        path: &Path,
        keys: &'static [&'static str],
    ) -> Result<Self, Failure> {
        if path.extension().is_none_or(|suffix| suffix != "json") {
            return Err(Failure::Usage(format!(
                "`{}` does not end in `.json`",
                path.display()
            )));
        }
        may_write(world, path, "an earlier file of this kind", |_| {
            let old = world.read(path).unwrap_or_default();
            let old: serde_json::Value = serde_json::from_slice(&old).unwrap_or_default();
            keys.iter().all(|key| old.get(key).is_some())
        })?;
        Ok(Self {
            path: path.to_owned(),
        })
    }

    /// Writes the object.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, world: &dyn World, object: &impl Serialize) -> Result<(), Failure> {
        let text = serde_json::to_string_pretty(object)
            .map_err(|error| Failure::World(format!("cannot encode as JSON: {error}")))?;
        put(world, &self.path, format!("{text}\n").as_bytes())
    }
}

/// A file with a solution to be.
#[derive(Clone, Debug)]
pub struct SolutionTarget {
    path: PathBuf,
}

impl SolutionTarget {
    /// A file with a solution at `path`; an earlier one is known by its first bytes.
    ///
    /// # Errors
    /// If files cannot be made there, or something else is there already.
    pub fn new(world: &dyn World, path: &Path) -> Result<Self, Failure> {
        let target = Self {
            path: path.to_owned(),
        };
        target.check(world)?;
        Ok(target)
    }

    /// Writes the file.
    ///
    /// # Errors
    /// If it cannot be written; what was there before is then untouched.
    pub fn write(&self, world: &dyn World, bytes: &[u8]) -> Result<(), Failure> {
        self.check(world)?;
        put(world, &self.path, bytes)
    }

    fn check(&self, world: &dyn World) -> Result<(), Failure> {
        may_write(world, &self.path, "an earlier solution", |head| {
            head.starts_with(MAGIC)
        })
    }
}

/// A mesh in binary glTF to be.
#[derive(Clone, Debug)]
pub struct GlbTarget {
    path: PathBuf,
}

impl GlbTarget {
    /// A mesh at `path`.
    ///
    /// # Errors
    /// If the suffix is not `.glb`, files cannot be made there, or something else is there already.
    pub fn new(world: &dyn World, path: &Path) -> Result<Self, Failure> {
        if path.extension().is_none_or(|suffix| suffix != "glb") {
            return Err(Failure::Usage(format!(
                "`{}` does not end in `.glb`, binary glTF, the only kind of mesh that is written",
                path.display()
            )));
        }
        let target = Self {
            path: path.to_owned(),
        };
        target.check(world)?;
        Ok(target)
    }

    /// Writes the file; gives its hash.
    ///
    /// # Errors
    /// If it cannot be written; what was there before is then untouched.
    pub fn write(&self, world: &dyn World, bytes: &[u8]) -> Result<ContentHash, Failure> {
        self.check(world)?;
        put(world, &self.path, bytes)?;
        Ok(ContentHash::of([bytes]))
    }

    fn check(&self, world: &dyn World) -> Result<(), Failure> {
        may_write(world, &self.path, "a mesh in binary glTF", |head| {
            head.starts_with(b"glTF")
        })
    }
}

/// A table to be.
#[derive(Clone, Debug)]
pub struct CsvTarget {
    path: PathBuf,
    first_columns: &'static str,
}

impl CsvTarget {
    /// A table at `path`; an earlier one of its kind is known by its first columns.
    ///
    /// # Errors
    /// If the suffix is not `.csv`, files cannot be made there, or something else is there already.
    pub fn new(
        world: &dyn World,
        path: &Path,
        first_columns: &'static str,
    ) -> Result<Self, Failure> {
        if path.extension().is_none_or(|suffix| suffix != "csv") {
            return Err(Failure::Usage(format!(
                "`{}` does not end in `.csv`",
                path.display()
            )));
        }
        let target = Self {
            path: path.to_owned(),
            first_columns,
        };
        target.check(world)?;
        Ok(target)
    }

    /// Writes the table; gives the hash of the file.
    ///
    /// # Errors
    /// If it cannot be written; what was there before is then untouched.
    pub fn write(&self, world: &dyn World, text: &str) -> Result<ContentHash, Failure> {
        self.check(world)?;
        put(world, &self.path, text.as_bytes())?;
        Ok(ContentHash::of([text.as_bytes()]))
    }

    fn check(&self, world: &dyn World) -> Result<(), Failure> {
        may_write(world, &self.path, "an earlier table of this kind", |head| {
            let n = head.len().min(self.first_columns.len());
            head[..n] == self.first_columns.as_bytes()[..n]
        })
    }
}

/// A page for a browser to be.
#[derive(Clone, Debug)]
pub struct PageTarget {
    path: PathBuf,
    mark: &'static str,
}

impl PageTarget {
    /// A page at `path`; an earlier one of its kind is known by beginning with `mark`.
    ///
    /// # Errors
    /// If the suffix is not `.html`, files cannot be made there, or something else is there already.
    pub fn new(world: &dyn World, path: &Path, mark: &'static str) -> Result<Self, Failure> {
        if path.extension().is_none_or(|suffix| suffix != "html") {
            return Err(Failure::Usage(format!(
                "`{}` does not end in `.html`",
                path.display()
            )));
        }
        let target = Self {
            path: path.to_owned(),
            mark,
        };
        target.check(world)?;
        Ok(target)
    }

    /// Writes the page.
    ///
    /// # Errors
    /// If it cannot be written; what was there before is then untouched.
    pub fn write(&self, world: &dyn World, text: &str) -> Result<(), Failure> {
        self.check(world)?;
        put(world, &self.path, text.as_bytes())
    }

    fn check(&self, world: &dyn World) -> Result<(), Failure> {
        may_write(world, &self.path, "an earlier page of this kind", |_| {
            let head = world.head(&self.path, self.mark.len());
            head.is_ok_and(|head| head == self.mark.as_bytes())
        })
    }
}

/// A shell script to be.
#[derive(Clone, Debug)]
pub struct ScriptTarget {
    path: PathBuf,
}

impl ScriptTarget {
    /// A script at `path`.
    ///
    /// # Errors
    /// If files cannot be made there, or something that is no script is there already.
    pub fn new(world: &dyn World, path: &Path) -> Result<Self, Failure> {
        let target = Self {
            path: path.to_owned(),
        };
        target.check(world)?;
        Ok(target)
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the script.
    ///
    /// # Errors
    /// If it cannot be written; what was there before is then untouched.
    pub fn write(&self, world: &dyn World, text: &str) -> Result<(), Failure> {
        self.check(world)?;
        put(world, &self.path, text.as_bytes())
    }

    fn check(&self, world: &dyn World) -> Result<(), Failure> {
        may_write(world, &self.path, "a shell script", |head| {
            head.starts_with(b"#!/bin/bash")
        })
    }
}

/// Whether a file may be put at `path`: its folder takes files, and what is there is nothing, empty, or `is_own`.
pub(super) fn may_write(
    world: &dyn World,
    path: &Path,
    kind: &str,
    is_own: impl Fn(&[u8]) -> bool,
) -> Result<(), Failure> {
    let refuse = |why: String| {
        Err(Failure::World(format!(
            "cannot write `{}`: {why}",
            path.display()
        )))
    };
    match world.entry(path) {
        Entry::Folder => return refuse("it is a folder".into()),
        Entry::Device => return refuse("it is not an ordinary file".into()),
        Entry::File => {
            let head = world
                .head(path, MAGIC_LENGTH)
                .map_err(|e| Failure::file("read", path, &e))?;
            if !head.is_empty() && !is_own(&head) {
                return refuse(format!("what is there is not {kind}, and is not replaced"));
            }
        }
        Entry::Missing => {}
    }
    let destination = world.destination(path);
    let folder = folder_of(&destination);
    world
        .try_folder(folder)
        .map_err(|error| Failure::file("write files into", folder, &error))
}

fn put(world: &dyn World, path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    world
        .replace(path, bytes)
        .map_err(|error| Failure::file("write", path, &error))
}

/// An error with its causes, in one line.
pub(super) fn chain(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(inner) = cause {
        text.push_str(": ");
        text.push_str(&inner.to_string());
        cause = inner.source();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Pixels;
    use crate::pipeline::world::Machine;

    fn message(result: Result<impl std::fmt::Debug, Failure>) -> String {
        match result.unwrap_err() {
            Failure::Usage(text) => format!("usage: {text}"),
            Failure::World(text) => format!("world: {text}"),
            other => format!("{other:?}"),
        }
    }

    #[test]
    fn a_picture_is_replaced_only_by_one_of_its_kind() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let world = Machine::new();
        let picture = Picture {
            width: 1,
            height: 1,
            pixels: Pixels::Srgb(vec![1, 2, 3]),
        };
        for _ in 0..2 {
            let target = PictureTarget::new(&world, &at("a.png")).unwrap();
            target.write(&world, &picture, &[]).unwrap();
        }
        std::fs::copy(at("a.png"), at("a.jpg")).unwrap();
        std::fs::write(at("thesis.png"), "forty pages of text").unwrap();
        std::fs::write(at("empty.png"), "").unwrap();
        assert!(message(PictureTarget::new(&world, &at("a.jpg"))).contains("not replaced"));
        assert!(message(PictureTarget::new(&world, &at("thesis.png"))).starts_with("world: "));
        assert!(PictureTarget::new(&world, &at("empty.png")).is_ok());
        assert!(message(PictureTarget::new(&world, &at("a.bmp"))).starts_with("usage: "));
        assert!(message(PictureTarget::new(&world, &at("no/a.png"))).contains("no such"));
        assert!(message(PictureTarget::new(&world, &at("thesis.png/a.png"))).contains("a file"));
    }

    #[test]
    fn a_json_file_is_replaced_only_by_one_with_the_same_keys() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.json");
        let world = Machine::new();
        for _ in 0..2 {
            let target = JsonTarget::new(&world, &path, &["step"]).unwrap();
            target
                .write(&world, &serde_json::json!({"step": 3}))
                .unwrap();
        }
        assert!(message(JsonTarget::new(&world, &path, &["version"])).contains("not replaced"));
        assert!(
            message(JsonTarget::new(&world, &path.with_extension("txt"), &[])).contains(".json")
        );
    }
}
