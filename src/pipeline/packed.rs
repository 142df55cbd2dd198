//! Packed GroIMP projects: a `.gsz` file is a zip archive, and for all who read it is a folder.

use super::world::Entry;
use std::collections::BTreeMap;
use std::io::{self, Cursor, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;
use zip::ZipArchive;

/// The suffix of packed projects.
const SUFFIX: &str = "gsz";

/// An archive lists no more files than this.
const MAX_FILES: usize = 10_000;

/// The path of the packed project that `path` is or leads into, and the rest of the path inside it.
pub fn split(path: &Path) -> Option<(&Path, &Path)> {
    let is_archive =
        |at: &&Path| at.extension().is_some_and(|suffix| suffix == SUFFIX) && at.is_file();
    let archive = path.ancestors().find(is_archive)?;
    Some((archive, path.strip_prefix(archive).ok()?))
}

/// The packed projects that were opened, so that each is unpacked once as long as it does not change.
#[derive(Clone, Debug, Default)]
pub(super) struct Shelf(Arc<Mutex<BTreeMap<PathBuf, Arc<Packed>>>>);

impl Shelf {
    /// The project in the file `archive`.
    ///
    /// # Errors
    /// If it cannot be read, or is no zip archive.
    pub(super) fn open(
        &self,
        archive: &Path,
        read: impl FnOnce(&Path) -> io::Result<Vec<u8>>,
    ) -> io::Result<Arc<Packed>> {
        let data = std::fs::metadata(archive)?;
        let stamp = (data.modified().ok(), data.len());
        let mut shelf = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = shelf.get(archive)
            && known.stamp == stamp
        {
            return Ok(known.clone());
        }
        let packed = Arc::new(Packed::new(read(archive)?, stamp)?);
        shelf.insert(archive.to_owned(), packed.clone());
        Ok(packed)
    }
}

/// When a file was written, and its length in bytes.
type Stamp = (Option<SystemTime>, u64);

/// One packed project.
pub(super) struct Packed {
    stamp: Stamp,
    archive: ZipArchive<Cursor<Arc<[u8]>>>,
    /// Where each file stands in the archive. Names that lead out of it are left out.
    files: BTreeMap<PathBuf, usize>,
}

impl std::fmt::Debug for Packed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Packed")
            .field("files", &self.files)
            .finish_non_exhaustive()
    }
}

impl Packed {
    fn new(content: Vec<u8>, stamp: Stamp) -> io::Result<Self> {
        let archive =
            ZipArchive::new(Cursor::new(Arc::from(content))).map_err(|error| broken(&error))?;
        if archive.len() > MAX_FILES {
            return Err(io::Error::other(format!(
                "it holds more than {MAX_FILES} files"
            )));
        }
        let mut archive_names = archive.clone();
        let mut files = BTreeMap::new();
        for index in 0..archive.len() {
            let entry = archive_names
                .by_index_raw(index)
                .map_err(|error| broken(&error))?;
            if entry.is_file()
                && let Some(name) = entry.enclosed_name()
            {
                files.insert(name, index);
            }
        }
        Ok(Self {
            stamp,
            archive,
            files,
        })
    }

    /// What the path `inside` leads to.
    pub(super) fn entry(&self, inside: &Path) -> Entry {
        if self.files.contains_key(inside) {
            Entry::File
        } else if inside.as_os_str().is_empty()
            || self.files.keys().any(|file| file.starts_with(inside))
        {
            Entry::Folder
        } else {
            Entry::Missing
        }
    }

    /// The content of the file at `inside`, no more than `limit` bytes of it.
    ///
    /// # Errors
    /// If there is none, or it is encrypted or damaged.
    pub(super) fn read(&self, inside: &Path, limit: u64) -> io::Result<Vec<u8>> {
        let index = *self.files.get(inside).ok_or(io::ErrorKind::NotFound)?;
        let mut archive = self.archive.clone();
        let entry = archive.by_index(index).map_err(|error| broken(&error))?;
        let mut content = Vec::new();
        entry.take(limit).read_to_end(&mut content)?;
        Ok(content)
    }

    /// The names of what the folder `inside` holds, sorted.
    ///
    /// # Errors
    /// If there is no such folder.
    pub(super) fn list(&self, inside: &Path) -> io::Result<Vec<PathBuf>> {
        if self.entry(inside) != Entry::Folder {
            return Err(io::ErrorKind::NotFound.into());
        }
        let below = self
            .files
            .keys()
            .filter_map(|file| file.strip_prefix(inside).ok());
        let mut names: Vec<PathBuf> = below
            .filter_map(|rest| rest.iter().next().map(PathBuf::from))
            .collect();
        names.sort_unstable();
        names.dedup();
        Ok(names)
    }
}

fn broken(error: &zip::result::ZipError) -> io::Error {
    io::Error::other(format!("it is not a readable zip archive: {error}"))
}

#[cfg(test)]
mod tests {
    use crate::pipeline::failure::Failure;
    use crate::pipeline::inputs::Inputs;
    use crate::pipeline::world::{Entry, Machine, World};
    use std::io::Write;
    use std::path::Path;
    use zip::write::{SimpleFileOptions, ZipWriter};

    /// Packs files as GroIMP does.
    fn pack(path: &Path, files: &[(&str, &str)]) {
        let mut archive = ZipWriter::new(std::fs::File::create(path).unwrap());
        for (name, content) in files {
            archive
                .start_file(*name, SimpleFileOptions::default())
                .unwrap();
            archive.write_all(content.as_bytes()).unwrap();
        }
        archive.finish().unwrap();
    }

    #[test]
    fn a_packed_project_is_a_folder() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("oak.gsz");
        let files = [
            ("META-INF/MANIFEST.MF", "Manifest-Version: 1.0"),
            ("project.gs", "<registry/>"),
            ("Model.rgg", "import static lib.Params.*;"),
            ("lib/Params.rgg", "static double a = 2;"),
            ("../out.rgg", "outside"),
        ];
        pack(&path, &files);
        let world = Machine::new();
        assert_eq!(world.entry(&path), Entry::Folder);
        assert_eq!(world.entry(&path.join("lib")), Entry::Folder);
        assert_eq!(world.entry(&path.join("lib/None.rgg")), Entry::Missing);
        assert_eq!(
            world.read(&path.join("project.gs")).unwrap(),
            b"<registry/>"
        );
        assert_eq!(world.head(&path.join("project.gs"), 4).unwrap(), b"<reg");
        let names = ["META-INF", "Model.rgg", "lib", "project.gs"];
        assert_eq!(
            world.list(&path).unwrap(),
            names.map(|name| path.join(name))
        );
        let inputs = Inputs::find(&world, &path).unwrap();
        assert_eq!(
            inputs.models,
            ["Model.rgg", "lib/Params.rgg"].map(|name| path.join(name))
        );
        assert!(inputs.missing.is_empty() && inputs.unread.is_empty());
    }

    #[test]
    fn what_stands_beside_a_packed_project_is_its_sidecar() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("oak.gsz");
        pack(&path, &[("Model.rgg", "")]);
        let find = || Inputs::find(&Machine::new(), &path).unwrap().sidecar;
        assert_eq!(find(), None);
        let beside = folder.path().join("oak.toml");
        std::fs::write(&beside, "steps = 1").unwrap();
        assert_eq!(find(), Some(beside));
    }

    #[test]
    fn a_changed_project_is_read_again_and_never_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("oak.gsz");
        let world = Machine::new();
        for text in ["one", "longer"] {
            pack(&path, &[("Model.rgg", text)]);
            assert_eq!(
                world.read(&path.join("Model.rgg")).unwrap(),
                text.as_bytes()
            );
        }
        let error = world.replace(&path.join("a.csv"), b"1").unwrap_err();
        assert!(error.to_string().contains("--path-map"), "{error}");
        assert_eq!(world.read(&path.join("Model.rgg")).unwrap(), b"longer");
    }

    #[test]
    fn a_damaged_project_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("oak.gsz");
        pack(&path, &[("Model.rgg", "module A;"), ("B.rgg", "")]);
        let whole = std::fs::read(&path).unwrap();
        for damaged in [&b""[..], b"no zip at all", &whole[..whole.len() / 2]] {
            std::fs::write(&path, damaged).unwrap();
            let Err(failure) = Inputs::find(&Machine::new(), &path) else {
                panic!("{} bytes were read", damaged.len())
            };
            assert!(
                matches!(&failure, Failure::World(text) if text.contains("zip archive")),
                "{failure:?}"
            );
        }
    }
}
