//! The texts of a run: the model's files and the file beside them.

use super::assets;
use super::constants::{self, Change};
use super::content_hash::ContentHash;
use super::failure::Failure;
use super::inputs::{Inputs, MissingImport};
use super::world::World;
use crate::diag::{Diagnostic, Diagnostics, FileId, Severity, SourceMap};
use crate::options::Options;
use std::path::PathBuf;

/// Everything that was read for a run.
#[derive(Clone, Debug)]
pub struct Sources {
    /// The texts.
    pub map: SourceMap,
    /// The files of the model, in the order of their names.
    pub models: Vec<FileId>,
    /// The file beside it, if there is one.
    pub sidecar: Option<FileId>,
    /// Imports for which there is no file.
    pub missing: Vec<MissingImport>,
    /// Texts of the same project that were not read.
    pub unread: Vec<PathBuf>,
    /// Equal for equal names and texts of the model's files, and of the meshes and images that they name.
    pub model_hash: ContentHash,
}

impl Inputs {
    /// Reads them all.
    ///
    /// # Errors
    /// If one cannot be read, or is no text.
    pub fn read(&self, world: &dyn World) -> Result<Sources, Failure> {
        self.read_changed(world, &[])
    }

    /// Reads them all, with other values for some constants of the model.
    ///
    /// # Errors
    /// If one cannot be read, or is no text, or there are no such constants.
    pub fn read_changed(&self, world: &dyn World, changes: &[Change]) -> Result<Sources, Failure> {
        let mut map = SourceMap::default();
        let mut read = |path: &PathBuf| -> Result<FileId, Failure> {
            let content = world
                .read(path)
                .map_err(|e| Failure::file("read", path, &e))?;
            let text = String::from_utf8(content).map_err(|error| {
                let at = error.utf8_error().valid_up_to();
                let message = format!("`{}` is not UTF-8 text (byte {at})", path.display());
                Failure::model(&SourceMap::default(), placeless("not-text", message))
            })?;
            Ok(map.add(path.display().to_string(), text))
        };
        let models = self
            .models
            .iter()
            .map(&mut read)
            .collect::<Result<Vec<_>, _>>()?;
        let sidecar = self.sidecar.as_ref().map(&mut read).transpose()?;
        constants::change(&mut map, &models, changes)
            .map_err(|fault| Failure::model(&map, *fault))?;
        let names = self.models.iter().filter_map(|path| path.file_name());
        let texts = models.iter().filter_map(|&id| map.file(id));
        let parts: Vec<(String, &str)> = names
            .zip(texts)
            .map(|(name, file)| (name.to_string_lossy().into_owned(), &*file.text))
            .collect();
        let mut model_hash = ContentHash::of(
            parts
                .iter()
                .flat_map(|(name, text)| [name.as_bytes(), text.as_bytes()]),
        );
        if let Some(first) = self.models.first() {
            let texts = parts.iter().map(|(_, text)| *text);
            for (path, content) in assets::contents(world, first, texts) {
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                model_hash = model_hash.with(&name).with(&content.to_string());
            }
        }
        Ok(Sources {
            map,
            models,
            sidecar,
            missing: self.missing.clone(),
            unread: self.unread.clone(),
            model_hash,
        })
    }
}

impl Sources {
    /// The name of the model's first file.
    pub fn name(&self) -> &str {
        let first = self.models.first().and_then(|&id| self.map.file(id));
        first.map_or("", |file| &*file.name)
    }

    /// The options of the run: `flags` over the file beside the model over the preset over the defaults; and what is wrong
    /// with that file.
    pub fn options(&self, flags: &Options) -> (Options, Diagnostics) {
        let mut options = flags.clone();
        let mut found = Diagnostics::default();
        if let Some(id) = self.sidecar {
            let text = self.map.file(id).map_or("", |file| &file.text);
            found = options.read_sidecar(id, text);
        }
        options.apply_preset();
        (options, found)
    }
}

/// An error without a place.
pub(super) fn placeless(slug: &'static str, message: String) -> Diagnostic {
    Diagnostic {
        severity: Severity::Error,
        slug,
        message,
        primary: None,
        secondary: vec![],
        hints: vec![],
        trace: vec![],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::Origin;
    use crate::pipeline::world::fake::FakeWorld;
    use std::path::Path;

    fn find(world: &FakeWorld, model: &str) -> Result<Inputs, Failure> {
        Inputs::find(world, Path::new(model))
    }

    #[test]
    fn the_file_beside_the_model_wins_over_presets_and_loses_to_flags() {
        let world = FakeWorld::default();
        world.put("p.rgg", "");
        world.put(
            "p.toml",
            "steps = 3\n[render]\nquality = \"draft\"\nmax-depth = 2\n",
        );
        let sources = find(&world, "p.rgg").unwrap().read(&world).unwrap();
        let mut flags = Options::default();
        flags.set("steps", "5", Origin::Flag).unwrap();
        let (options, found) = sources.options(&flags);
        assert!(found.is_empty());
        assert_eq!(options.steps.value, 5);
        assert_eq!(
            (options.samples.value.get(), options.max_depth.value),
            (8, Some(2))
        );
    }

    #[test]
    fn the_hash_is_of_names_and_texts() {
        let hash = |name: &str, text: &str| {
            let world = FakeWorld::default();
            world.put(name, text);
            find(&world, name).unwrap().read(&world).unwrap().model_hash
        };
        assert_eq!(hash("here/p.rgg", "x"), hash("there/p.rgg", "x"));
        assert_ne!(hash("p.rgg", "x"), hash("p.rgg", "y"));
        assert_ne!(hash("p.rgg", "x"), hash("q.rgg", "x"));
    }
}
