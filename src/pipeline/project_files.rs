//! The files a model may read and write: those in its own folder, and what the user allows besides.

use std::io;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use super::failure::Failure;
use super::reads::Reads;
use super::world::World;
use crate::eval::files::{FileFault, ModelFiles};

/// Reads a file of the machine, from wherever the model runs.
pub type ReadFile = Arc<dyn Fn(&Path) -> io::Result<Vec<u8>> + Send + Sync>;

/// What a folder of the machine holds, from wherever the model runs; an error if it is none.
pub type ListFolder = Arc<dyn Fn(&Path) -> io::Result<Vec<PathBuf>> + Send + Sync>;

/// Where a path leads to, from wherever the model runs.
pub type RealPath = Arc<dyn Fn(&Path) -> PathBuf + Send + Sync>;

/// Suffixes of files that a model is made of: it cannot write such files.
const SOURCES: &[&str] = &["rgg", "toml", "xl", "java", "gs", "gsz", "mf"];

/// What the user allows a model besides the files in its own folder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Access {
    /// Beginnings of paths in the model, and what stands for them here.
    pub maps: Vec<(String, PathBuf)>,
    /// Folders that may be used besides the model's own.
    pub folders: Vec<PathBuf>,
    /// Where the charts of the model go; without it they are not written.
    pub charts: Option<PathBuf>,
}

impl Access {
    /// Reads the values of `--path-map`, each `FROM=TO`.
    ///
    /// # Errors
    /// If one has no `=`, or nothing on one side of it.
    pub fn parse(
        maps: &[String],
        folders: &[PathBuf],
        charts: Option<&Path>,
    ) -> Result<Self, Failure> {
        let parse = |map: &String| match map.split_once('=') {
            Some((from, to)) if !from.is_empty() && !to.is_empty() => {
                Ok((slashes(from), PathBuf::from(to)))
            }
            _ => Err(Failure::Usage(format!(
                "`--path-map {map}` is not of the form FROM=TO, such as `C:/Users/me/data=data`"
            ))),
        };
        Ok(Self {
            maps: maps.iter().map(parse).collect::<Result<_, _>>()?,
            folders: folders.to_vec(),
            charts: charts.map(Path::to_owned),
        })
    }
}

/// The files of one run.
pub struct ProjectFiles {
    root: PathBuf,
    access: Access,
    read: ReadFile,
    list: ListFolder,
    real: RealPath,
}

impl ProjectFiles {
    /// The files of the model at `model`, a file or a folder.
    pub fn new(world: &dyn World, model: &Path, access: &Access) -> Self {
        let is_folder = world.entry(model) == super::world::Entry::Folder;
        let root = if is_folder {
            model
        } else {
            super::world::folder_of(model)
        };
        Self {
            root: tidied(root),
            access: access.clone(),
            read: world.reader(),
            list: world.lister(),
            real: world.real_paths(),
        }
    }

    /// The same files; what is read of them is remembered.
    #[must_use]
    pub fn remembering(self, reads: &Reads) -> Self {
        Self {
            read: reads.recording(self.read),
            ..self
        }
    }

    /// The path on this machine, if the model may use it.
    fn resolve(&self, path: &str) -> Result<PathBuf, FileFault> {
        let plain = slashes(path);
        let has_drive = plain.as_bytes().get(1) == Some(&b':');
        let (place, is_allowed) = match self.mapped(&plain) {
            Some((place, folder)) => {
                let is_allowed = self.holds(folder, &place);
                (place, is_allowed)
            }
            None if has_drive => (PathBuf::from(&plain), false),
            None => {
                let place = tidied(&self.root.join(&plain));
                let mut folders = self.access.folders.iter();
                let is_allowed = self.holds(&self.root, &place)
                    || folders.any(|folder| self.holds(folder, &place));
                (place, is_allowed)
            }
        };
        if is_allowed {
            Ok(place)
        } else {
            Err(refusal(path, &plain, has_drive))
        }
    }

    /// What `--path-map` makes of a path, with the folder it is mapped to. Of several maps, the longest counts.
    fn mapped(&self, plain: &str) -> Option<(PathBuf, &Path)> {
        let maps = self.access.maps.iter();
        let fitting = maps.filter_map(|(from, to)| Some((rest_of(plain, from)?, to)));
        let (rest, to) = fitting.min_by_key(|(rest, _)| rest.len())?;
        Some((tidied(&to.join(rest)), to))
    }

    /// Whether `folder` holds `place`, as both are written and after all symbolic links.
    fn holds(&self, folder: &Path, place: &Path) -> bool {
        let folder = tidied(folder);
        let is_written_inside = place.strip_prefix(&folder).is_ok_and(|rest| {
            let mut parts = rest.components();
            parts.all(|part| matches!(part, Component::Normal(_)))
        });
        is_written_inside && (self.real)(place).starts_with((self.real)(&folder))
    }
}

/// What follows `from` in a path, if the path begins with it as a whole.
fn rest_of<'p>(path: &'p str, from: &str) -> Option<&'p str> {
    let rest = path.strip_prefix(from.trim_end_matches('/'))?;
    (rest.is_empty() || rest.starts_with('/')).then(|| rest.trim_start_matches('/'))
}

fn refusal(path: &str, plain: &str, has_drive: bool) -> FileFault {
    let folder = plain.rsplit_once('/').map_or(plain, |(folder, _)| folder);
    let hint = if has_drive {
        format!("say where it is here: `--path-map '{folder}=FOLDER'`")
    } else {
        format!(
            "allow it with `--allow-path '{folder}'`, or say where it is with `--path-map '{folder}=FOLDER'`"
        )
    };
    FileFault::Refused {
        message: format!("the model uses the file `{path}`, which is outside of its folder"),
        hint,
    }
}

/// The path with `/` between its parts.
fn slashes(path: &str) -> String {
    path.replace('\\', "/")
}

/// The path without `.` and, as far as they have something to undo, without `..`.
fn tidied(path: &Path) -> PathBuf {
    let mut tidy = PathBuf::new();
    for part in path.components() {
        match (part, tidy.components().next_back()) {
            (Component::CurDir, _) => {}
            (Component::ParentDir, Some(Component::Normal(_))) => {
                tidy.pop();
            }
            (Component::ParentDir, Some(Component::RootDir)) => {}
            _ => tidy.push(part),
        }
    }
    tidy
}

impl ModelFiles for ProjectFiles {
    fn place(&self, path: &str) -> Result<String, FileFault> {
        Ok(self.resolve(path)?.to_string_lossy().into_owned())
    }

    fn read(&self, path: &str) -> Result<String, FileFault> {
        let bytes = self.read_bytes(path)?;
        Ok(String::from_utf8(bytes)
            .unwrap_or_else(|e| e.into_bytes().iter().map(|&b| char::from(b)).collect()))
    }

    fn read_bytes(&self, path: &str) -> Result<Vec<u8>, FileFault> {
        let place = self.resolve(path)?;
        match (self.read)(&place) {
            Ok(bytes) => Ok(bytes),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Err(FileFault::Missing(
                format!("{} (No such file or directory)", place.display()),
            )),
            Err(error) => Err(FileFault::Failed(format!("{} ({error})", place.display()))),
        }
    }

    fn may_write(&self, path: &str) -> Result<String, FileFault> {
        let place = self.resolve(path)?;
        let suffix = place
            .extension()
            .map(|s| s.to_string_lossy().to_lowercase());
        if suffix.is_some_and(|suffix| SOURCES.contains(&suffix.as_str())) {
            return Err(FileFault::Refused {
                message: format!(
                    "the model writes the file `{path}`, which could be a part of a model"
                ),
                hint: "write to a file with another suffix, such as `.txt`".to_owned(),
            });
        }
        Ok(place.to_string_lossy().into_owned())
    }

    fn list(&self, path: &str) -> Result<Option<Vec<String>>, FileFault> {
        let place = self.resolve(path)?;
        let found = match (self.list)(&place) {
            Ok(found) => found,
            Err(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::NotFound | io::ErrorKind::NotADirectory
                ) =>
            {
                return Ok(None);
            }
            Err(error) => return Err(FileFault::Failed(format!("{} ({error})", place.display()))),
        };
        let names = found.iter().filter_map(|path| path.file_name());
        let names = names.map(|name| name.to_string_lossy().into_owned());
        // What editors and version control leave behind is no data of the model.
        Ok(Some(names.filter(|name| !name.starts_with('.')).collect()))
    }
}

/// Writes what a model has written, each file whole or not at all.
///
/// # Errors
/// If one cannot be written.
pub fn write_all(
    world: &dyn World,
    written: impl IntoIterator<Item = (String, String)>,
) -> Result<(), Failure> {
    for (place, text) in written {
        let path = Path::new(&place);
        let folder = super::world::folder_of(path);
        world
            .create_folder(folder)
            .map_err(|e| Failure::file("make folder", folder, &e))?;
        world
            .replace(path, text.as_bytes())
            .map_err(|e| Failure::file("write", path, &e))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::world::fake::FakeWorld;

    fn files(access: &Access) -> (FakeWorld, ProjectFiles) {
        let world = FakeWorld::default();
        for file in ["m/a.rgg", "m/in.csv", "data/x.csv", "secret.txt"] {
            world.put(file, file);
        }
        let files = ProjectFiles::new(&world, Path::new("m"), access);
        (world, files)
    }

    fn refused(result: Result<String, FileFault>) -> String {
        match result {
            Err(FileFault::Refused { hint, .. }) => hint,
            other => format!("{other:?}"),
        }
    }

    #[test]
    fn a_model_reads_its_own_folder_and_no_other() {
        let (_, files) = files(&Access::default());
        assert_eq!(files.read("in.csv").unwrap(), "m/in.csv");
        assert_eq!(files.read("./sub/..\\in.csv").unwrap(), "m/in.csv");
        assert!(matches!(files.read("none.csv"), Err(FileFault::Missing(_))));
        for path in ["../secret.txt", "/etc/passwd", "a/../../secret.txt"] {
            assert!(refused(files.read(path)).contains("--allow-path"), "{path}");
        }
        let hint = refused(files.read("C:\\Users\\me\\x.csv"));
        assert!(hint.contains("--path-map 'C:/Users/me=FOLDER'"), "{hint}");
    }

    #[test]
    fn folders_are_listed_by_name() {
        let world = FakeWorld::default();
        for file in ["m/a.rgg", "m/in/b.csv", "m/in/a.csv", "m/in/.hidden"] {
            world.put(file, file);
        }
        let files = ProjectFiles::new(&world, Path::new("m"), &Access::default());
        let names = files.list("in/").unwrap();
        assert_eq!(names, Some(vec!["a.csv".to_owned(), "b.csv".to_owned()]));
        assert_eq!(files.list("none").unwrap(), None);
        assert_eq!(files.list("in/a.csv").unwrap(), None);
        assert!(matches!(files.list(".."), Err(FileFault::Refused { .. })));
    }

    #[test]
    fn paths_are_mapped_and_folders_allowed() {
        let maps = ["C:\\Users\\me=data".to_owned()];
        let access = Access::parse(&maps, &[PathBuf::from("data")], None).unwrap();
        let (_, files) = files(&access);
        assert_eq!(files.read("C:\\Users\\me\\x.csv").unwrap(), "data/x.csv");
        assert_eq!(files.read("c/../../data/x.csv").unwrap(), "data/x.csv");
        assert!(Access::parse(&["C:/x".to_owned()], &[], None).is_err());
        // A map is of whole names of folders, and no way out of the folder it leads to.
        for path in ["C:\\Users\\meta\\x.csv", "C:\\Users\\me\\..\\secret.txt"] {
            assert!(refused(files.read(path)).contains("--path-map"), "{path}");
        }
    }

    #[test]
    fn links_lead_nowhere_else_and_the_working_folder_is_not_the_world() {
        let root = tempfile::tempdir().unwrap();
        let model = root.path().join("model");
        std::fs::create_dir(&model).unwrap();
        std::fs::write(root.path().join("secret.txt"), "secret").unwrap();
        std::fs::write(model.join("in.txt"), "in").unwrap();
        #[cfg(unix)]
        std::os::unix::fs::symlink(root.path(), model.join("out")).unwrap();
        let world = crate::pipeline::world::Machine::new();
        let files = ProjectFiles::new(&world, &model.join("m.rgg"), &Access::default());
        assert_eq!(files.read("in.txt").unwrap(), "in");
        assert!(files.may_write("new/t.txt").is_ok());
        for path in ["out/secret.txt", "out/new.txt"] {
            assert!(
                refused(files.may_write(path)).contains("--allow-path"),
                "{path}"
            );
        }
        let files = ProjectFiles::new(&world, Path::new("m.rgg"), &Access::default());
        for path in ["/etc/hostname", "../x", "a/../../x"] {
            assert!(refused(files.read(path)).contains("--allow-path"), "{path}");
        }
    }

    #[test]
    fn sources_are_never_written() {
        let (world, files) = files(&Access::default());
        assert!(refused(files.may_write("a.rgg")).contains("suffix"));
        let place = files.may_write("out/t.txt").unwrap();
        write_all(&world, [(place, "text".to_owned())]).unwrap();
        assert_eq!(files.read("out/t.txt").unwrap(), "text");
    }
}
