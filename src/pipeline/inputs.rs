//! Where the parts of a model are: its files, those they import, and the file beside it.
//!
//! A folder's own `.rgg` files belong to the model, and what they import, from any folder below; if it has none itself, all
//! that lie below it. A single file brings the files that it imports from its own folder and those below. A packed project
//! is a folder.

use super::failure::Failure;
use super::sources::placeless;
use super::world::{Entry, World, folder_of};
use crate::diag::SourceMap;
use crate::diag::nearest;
use crate::syntax::{ImportNames, imports};
use std::collections::{BTreeMap, VecDeque};
use std::fmt;
use std::path::{Path, PathBuf};

/// Folders in folders deeper than this are not looked at.
const MAX_DEPTH: usize = 8;
/// Entries of folders looked at, at most: a model does not hide in a whole disk.
const MAX_ENTRIES: usize = 10_000;
/// Files that one model may have.
const MAX_FILES: usize = 1_000;
/// Where the names of Java and GroIMP begin: no file of a model is looked for there.
const LIBRARIES: [&str; 5] = ["java", "javax", "de", "org", "com"];

/// Where the parts of a model are, found but not kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Inputs {
    /// The files of the model: those it was asked for in the order of their names, then what they import.
    pub models: Vec<PathBuf>,
    /// The file beside it, if there is one.
    pub sidecar: Option<PathBuf>,
    /// Imports for which there is no file.
    pub missing: Vec<MissingImport>,
    /// Texts of the same project that are not read: `.rgg` files nobody imports, Java.
    pub unread: Vec<PathBuf>,
}

/// An import for which there is no file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MissingImport {
    /// Which of the model's files has it.
    pub by: PathBuf,
    /// What it says: `sub.Params`.
    pub name: String,
    /// The file that was looked for: `sub/Params.rgg`.
    pub wanted: String,
    /// A file of a similar name.
    pub near: Option<PathBuf>,
}

impl fmt::Display for MissingImport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "`{}` is imported, but there is no file `{}`",
            self.name, self.wanted
        )?;
        match &self.near {
            Some(near) => write!(f, "; there is `{}`", near.display()),
            None => Ok(()),
        }
    }
}

impl Inputs {
    /// A model of one file alone.
    pub fn only(model: &Path) -> Self {
        Self {
            models: vec![model.to_owned()],
            sidecar: None,
            missing: vec![],
            unread: vec![],
        }
    }

    /// Finds the files of `model`, a `.rgg` file or a folder of them.
    ///
    /// # Errors
    /// If there is no such model, or two of its files have the same name.
    pub fn find(world: &dyn World, model: &Path) -> Result<Self, Failure> {
        let name = model.display();
        let (mut found, base) = match world.entry(model) {
            Entry::Folder => (Self::in_folder(world, model)?, model),
            // GroIMP's list of the files of a project: what it lists stands beside it.
            Entry::File if has_suffix(model, "gs") => return Self::find(world, folder_of(model)),
            Entry::Missing if has_suffix(model, "gs") || has_suffix(model, "gsz") => {
                return Err(Failure::World(format!("there is no `{name}`")));
            }
            _ if !has_suffix(model, "rgg") => {
                return Err(Failure::Usage(format!(
                    "`{name}` is neither a `.rgg` file nor a folder, nor a packed project (`.gsz`)"
                )));
            }
            Entry::Device => {
                return Err(Failure::World(format!(
                    "cannot read `{name}`: it is not an ordinary file"
                )));
            }
            Entry::File | Entry::Missing => {
                let beside = model.with_extension("toml");
                let sidecar = (world.entry(&beside) == Entry::File).then_some(beside);
                let mut inputs = Self::only(model);
                inputs.sidecar = sidecar;
                (inputs, model.parent().unwrap_or(Path::new("")))
            }
        };
        let mut search = Search::new(world, base);
        if world.entry(model) == Entry::Folder {
            search.look_everywhere();
        }
        search.follow(&mut found);
        found.check_names()?;
        Ok(found)
    }

    fn in_folder(world: &dyn World, folder: &Path) -> Result<Self, Failure> {
        let name = folder.display();
        let all = world
            .list(folder)
            .map_err(|e| Failure::file("read", folder, &e))?;
        let with = |suffix: &str| -> Vec<PathBuf> {
            let fits =
                |path: &&PathBuf| has_suffix(path, suffix) && world.entry(path) == Entry::File;
            all.iter().filter(fits).cloned().collect()
        };
        let (mut models, mut sidecars) = (with("rgg"), with("toml"));
        // A packed project has no place for a `.toml` of this program: it may stand beside it.
        let beside = folder.with_extension("toml");
        if has_suffix(folder, "gsz") && world.entry(&beside) == Entry::File {
            sidecars = vec![beside];
        }
        if models.is_empty() {
            models = tree(world, folder);
            models.retain(|path| has_suffix(path, "rgg"));
        }
        if models.is_empty() {
            return Err(Failure::World(format!(
                "folder `{name}` holds no `.rgg` file"
            )));
        }
        if sidecars.len() > 1 {
            let message = format!("folder `{name}` holds more than one `.toml` file");
            return Err(Failure::World(message));
        }
        Ok(Self {
            models,
            sidecar: sidecars.pop(),
            missing: vec![],
            unread: vec![],
        })
    }

    /// Refuses two files that would be the same class.
    fn check_names(&self) -> Result<(), Failure> {
        let mut known: BTreeMap<String, &Path> = BTreeMap::new();
        for path in &self.models {
            let name = class_name(path);
            if let Some(first) = known.insert(name.clone(), path) {
                let message = format!(
                    "`{}` and `{}` are both the class `{name}`",
                    first.display(),
                    path.display()
                );
                let fault = placeless("duplicate-file", message).hint(
                    "rename one of them, or move it to a folder from which nothing is imported",
                );
                return Err(Failure::model(&SourceMap::default(), fault));
            }
        }
        if self.models.len() > MAX_FILES {
            let message = format!("the model has more than {MAX_FILES} files");
            return Err(Failure::World(message));
        }
        Ok(())
    }
}

/// The search for what files import.
struct Search<'w> {
    world: &'w dyn World,
    base: &'w Path,
    /// All source files below the base, once they were needed.
    tree: Option<Vec<PathBuf>>,
    /// What has been listed.
    folders: BTreeMap<PathBuf, Vec<PathBuf>>,
}

impl<'w> Search<'w> {
    fn new(world: &'w dyn World, base: &'w Path) -> Self {
        Self {
            world,
            base,
            tree: None,
            folders: BTreeMap::new(),
        }
    }

    /// All source files below the base.
    fn look_everywhere(&mut self) -> &[PathBuf] {
        self.tree.get_or_insert_with(|| tree(self.world, self.base))
    }

    /// All source files of the project, as far as it was looked for them.
    fn known(&mut self) -> Vec<PathBuf> {
        match &self.tree {
            Some(tree) => tree.clone(),
            None => self.list_of(self.base).to_vec(),
        }
    }

    /// Adds all that is imported, and what is imported there.
    fn follow(&mut self, inputs: &mut Inputs) {
        let mut waiting: VecDeque<PathBuf> = inputs.models.iter().cloned().collect();
        while let Some(by) = waiting.pop_front() {
            // What cannot be read is told when the model is.
            let content = self.world.read(&by).unwrap_or_default();
            let text = String::from_utf8(content).unwrap_or_default();
            for import in imports(&text) {
                if LIBRARIES.contains(&import.path[0].as_str()) {
                    continue;
                }
                let files = self.locate(by.parent().unwrap_or(Path::new("")), &import);
                if files.is_empty() {
                    inputs.missing.push(self.missing(&by, &import));
                }
                for file in files {
                    if !inputs.models.contains(&file) && inputs.models.len() <= MAX_FILES {
                        inputs.models.push(file.clone());
                        waiting.push_back(file);
                    }
                }
            }
        }
        inputs.unread = self.known();
        inputs.unread.retain(|path| !inputs.models.contains(path));
    }

    /// The files that an import in folder `from` means: its whole path is tried first, then its last names.
    fn locate(&mut self, from: &Path, import: &ImportNames) -> Vec<PathBuf> {
        let bases = [from.to_owned(), self.base.to_owned()];
        let path = class_path(import);
        for start in 0..path.len() {
            let tail = &path[start..];
            for base in &bases {
                if import.is_wildcard && !import.is_static {
                    let folder: PathBuf = base.join(tail.iter().collect::<PathBuf>());
                    let mut all = self.list_of(&folder).to_vec();
                    all.retain(|file| has_suffix(file, "rgg"));
                    if !all.is_empty() {
                        return all;
                    }
                    continue;
                }
                let Some((class, folders)) = tail.split_last() else {
                    continue;
                };
                let folder = base.join(folders.iter().collect::<PathBuf>());
                let means =
                    |file: &&PathBuf| has_suffix(file, "rgg") && class_name(file) == **class;
                if let Some(file) = self.list_of(&folder).iter().find(means) {
                    return vec![file.clone()];
                }
            }
        }
        // A class without a package may stand in any folder of a project.
        let class = path.last().copied().unwrap_or_default();
        let all = self.look_everywhere().iter();
        let mut named = all.filter(|file| has_suffix(file, "rgg") && class_name(file) == class);
        match (named.next(), named.next()) {
            (Some(file), None) => vec![file.clone()],
            _ => vec![],
        }
    }

    fn missing(&mut self, by: &Path, import: &ImportNames) -> MissingImport {
        let path = class_path(import);
        let wanted = path.join("/");
        let name = path.join(".");
        let class = path.last().copied().unwrap_or_default();
        let all = self.known();
        let names: Vec<String> = all.iter().map(|file| class_name(file)).collect();
        let near = nearest(class, names.iter().map(String::as_str));
        let near = near.and_then(|near| names.iter().position(|name| name == near));
        MissingImport {
            by: by.to_owned(),
            name,
            wanted: format!("{wanted}.rgg"),
            near: near.map(|at| all[at].clone()),
        }
    }

    /// The source files in a folder.
    fn list_of(&mut self, folder: &Path) -> &[PathBuf] {
        let world = self.world;
        self.folders
            .entry(folder.to_owned())
            .or_insert_with(|| files_in(world, folder))
    }
}

/// The names of the class that an import means, with its package.
fn class_path(import: &ImportNames) -> Vec<&str> {
    let mut path: Vec<&str> = import.path.iter().map(String::as_str).collect();
    if import.is_static && !import.is_wildcard {
        path.pop();
    }
    path
}

/// The source files of one folder, named as the user named the folder; none if it cannot be read.
fn files_in(world: &dyn World, folder: &Path) -> Vec<PathBuf> {
    let all = entries(world, folder).into_iter().take(MAX_ENTRIES);
    all.filter(|path| is_source(path) && world.entry(path) == Entry::File)
        .collect()
}

/// All source files below a folder. Hidden folders and links to folders are left out.
fn tree(world: &dyn World, folder: &Path) -> Vec<PathBuf> {
    let (mut found, mut n_seen) = (vec![], 0);
    let mut open = vec![(folder.to_owned(), 0)];
    while let Some((folder, depth)) = open.pop() {
        for path in entries(world, &folder) {
            n_seen += 1;
            if n_seen > MAX_ENTRIES {
                break;
            }
            // Asking the system about each of a thousand pictures takes time.
            let is_other = path.extension().is_some() && !is_source(&path);
            if is_other || is_hidden(&path) {
                continue;
            }
            match world.entry(&path) {
                Entry::File if is_source(&path) => found.push(path),
                Entry::Folder if depth < MAX_DEPTH && world.destination(&path) == path => {
                    open.push((path, depth + 1));
                }
                _ => {}
            }
        }
    }
    found.sort();
    found
}

/// What a folder holds, named as the user named the folder; nothing if it cannot be read.
fn entries(world: &dyn World, folder: &Path) -> Vec<PathBuf> {
    let here = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    let all = world.list(here).unwrap_or_default();
    all.iter()
        .filter_map(|path| Some(folder.join(path.file_name()?)))
        .collect()
}

/// The class that a file is, by its name; blanks round it do not count.
pub(super) fn class_name(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    stem.to_string_lossy().trim().to_owned()
}

fn has_suffix(path: &Path, suffix: &str) -> bool {
    path.extension().is_some_and(|e| e == suffix)
}

fn is_source(path: &Path) -> bool {
    !is_hidden(path) && ["rgg", "java", "xl"].iter().any(|s| has_suffix(path, s))
}

fn is_hidden(path: &Path) -> bool {
    path.file_name()
        .is_some_and(|name| name.to_string_lossy().starts_with('.'))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::world::Machine;
    use crate::pipeline::world::fake::FakeWorld;

    /// The names of what was found below `folder`.
    fn names(folder: &Path, paths: &[PathBuf]) -> Vec<String> {
        let names = paths.iter().map(|path| {
            let path = path.strip_prefix(folder).unwrap_or(path);
            path.to_string_lossy().into_owned()
        });
        names.collect()
    }

    #[test]
    fn a_model_is_a_file_or_a_folder_with_or_without_something_beside_it() {
        let world = FakeWorld::default();
        let find = |model: &str| Inputs::find(&world, Path::new(model));
        for file in [
            "a/one.rgg",
            "a/two.rgg",
            "a/a.toml",
            "b/one.rgg",
            "c/readme.txt",
        ] {
            world.put(file, "");
        }
        let inputs = find("a").unwrap();
        assert_eq!(
            inputs.models,
            [Path::new("a/one.rgg"), Path::new("a/two.rgg")]
        );
        assert_eq!(inputs.sidecar.as_deref(), Some(Path::new("a/a.toml")));
        assert_eq!(find("b/one.rgg").unwrap().sidecar, None);
        assert!(matches!(find("c"), Err(Failure::World(_))));
        assert!(
            matches!(find("c/readme.txt"), Err(Failure::Usage(text)) if text.contains("readme"))
        );
        for wrong in ["c/none.gs", "c/none.gsz"] {
            assert!(matches!(find(wrong), Err(Failure::World(text)) if text.contains(wrong)));
        }
        let missing = find("c/none.rgg").unwrap().read(&world);
        assert!(matches!(missing, Err(Failure::World(text)) if text.contains("c/none.rgg")));
    }

    #[test]
    fn imported_files_are_read_from_the_folders_below() {
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        put(
            "main.rgg",
            "import static sub.Params.*; import java.util.*; import lib.Lost;",
        );
        put(
            "sub/Params .rgg",
            "import static Deep.*; import static main.*;",
        );
        put("sub/far/Deep.rgg", "");
        put("old/main.rgg", "");
        put(".git/Lost.rgg", "");
        put("project.gs", "");
        put("Help.java", "");
        #[cfg(unix)]
        std::os::unix::fs::symlink("..", folder.path().join("sub/round")).unwrap();
        let world = Machine::new();
        for model in [folder.path().to_owned(), folder.path().join("main.rgg")] {
            let inputs = Inputs::find(&world, &model).unwrap();
            assert_eq!(
                names(folder.path(), &inputs.models),
                ["main.rgg", "sub/Params .rgg", "sub/far/Deep.rgg"]
            );
            assert_eq!(
                names(folder.path(), &inputs.unread),
                ["Help.java", "old/main.rgg"]
            );
            let missing: Vec<_> = inputs.missing.iter().map(|m| m.wanted.as_str()).collect();
            assert_eq!(missing, ["lib/Lost.rgg"]);
        }
    }

    #[test]
    fn a_folder_without_files_of_its_own_has_those_below() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(folder.path().join("src/a")).unwrap();
        for name in ["src/main.rgg", "src/a/Params.rgg"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let inputs = Inputs::find(&Machine::new(), folder.path()).unwrap();
        assert_eq!(
            names(folder.path(), &inputs.models),
            ["src/a/Params.rgg", "src/main.rgg"]
        );
        std::fs::write(folder.path().join("src/Params.rgg"), "").unwrap();
        let Err(Failure::Model { found, .. }) = Inputs::find(&Machine::new(), folder.path()) else {
            panic!("two files are one class")
        };
        assert_eq!(found.sorted()[0].slug, "duplicate-file");
    }
}
