//! The files that an editor works on: open texts over those on disk, and which of them make one model.

use super::place::{self, Lines};
use super::reading::{self, Reading};
use super::symbols::{self, Symbol};
use crate::check::model::Model;
use crate::check::{self, SourceModel, Survey};
use crate::diag::{Diagnostics, FileId, Span};
use crate::pipeline::world::{Entry, World};
use crate::syntax::ast::Item;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Folders with more models than this are taken for a heap of single files.
const MAX_FILES: usize = 500;
/// Models whose checks are kept.
const MAX_KEPT: usize = 8;

/// A text that is open in the editor.
#[derive(Clone, Debug)]
struct Open {
    uri: String,
    version: i32,
    text: Rc<str>,
}

/// A file with what is known of it alone.
#[derive(Clone, Debug)]
pub struct FileView {
    /// Where it is; for texts without a file their address.
    pub path: PathBuf,
    /// Its address.
    pub uri: String,
    /// Its number in spans.
    pub id: FileId,
    /// The editor's count of its changes, if it is open.
    pub version: Option<i32>,
    /// The text.
    pub text: Rc<str>,
    /// Its lines.
    pub lines: Lines,
    /// The text as it could be read.
    pub reading: Reading,
    /// What it declares.
    pub symbols: Vec<Symbol>,
    /// What it declared when it could last be read and does not now; the places are those of then.
    pub lost: Vec<Symbol>,
}

impl FileView {
    /// The name by which other files refer to it.
    pub fn name(&self) -> String {
        let stem = self.path.file_stem().unwrap_or_default();
        stem.to_string_lossy().trim().to_owned()
    }

    fn has_init(&self) -> bool {
        let is_init = |item: &Item| matches!(item, Item::Method(m) if m.name.name == "init" && m.params.is_empty());
        self.reading.ast.items.iter().any(is_init)
    }

    fn imports(&self, name: &str) -> bool {
        let imports = self.reading.ast.imports.iter();
        imports
            .flat_map(|import| &import.path)
            .any(|part| part.name.trim() == name)
    }
}

/// A model with all that was found out about it.
#[derive(Debug)]
pub struct Analysis {
    /// Its files.
    pub files: Vec<Rc<FileView>>,
    /// The checked model; as far as it goes if there are errors.
    pub model: Model,
    /// What is wrong with it.
    pub found: Diagnostics,
    /// What its names mean.
    pub survey: Survey,
}

impl Analysis {
    /// Reads and checks files as one model.
    pub fn of(files: Vec<Rc<FileView>>) -> Self {
        let sources: Vec<SourceModel> = files
            .iter()
            .map(|file| SourceModel {
                name: file.name(),
                ast: file.reading.ast.clone(),
            })
            .collect();
        let mut found = Diagnostics::default();
        for file in &files {
            found.append(file.reading.found.clone());
        }
        let (model, more, survey) = check::survey(&sources);
        if !found.has_errors() {
            // What a check says of half a model misleads.
            found.append(more);
        }
        Self {
            files,
            model,
            found,
            survey,
        }
    }

    /// The file of a span.
    pub fn file(&self, span: Span) -> Option<&FileView> {
        self.files
            .iter()
            .find(|file| file.id == span.file)
            .map(|file| &**file)
    }

    /// The file at a path.
    pub fn file_at(&self, path: &Path) -> Option<&FileView> {
        self.files
            .iter()
            .find(|file| file.path == path)
            .map(|file| &**file)
    }

    /// All declarations of all files, those that cannot be read at the moment last.
    pub fn symbols(&self) -> impl Iterator<Item = &Symbol> {
        let now = self.files.iter().flat_map(|file| &file.symbols);
        now.chain(self.files.iter().flat_map(|file| &file.lost))
    }
}

/// All that is open, and what was read of the rest.
pub struct Workspace<'w> {
    world: &'w dyn World,
    open: BTreeMap<PathBuf, Open>,
    views: BTreeMap<PathBuf, Rc<FileView>>,
    /// Paths by file number.
    ids: Vec<PathBuf>,
    kept: Vec<Rc<Analysis>>,
}

/// The path by which a text is known here.
pub fn path_of(uri: &str) -> PathBuf {
    place::path_of(uri).unwrap_or_else(|| PathBuf::from(uri))
}

impl<'w> Workspace<'w> {
    /// Nothing is open.
    pub fn new(world: &'w dyn World) -> Self {
        Self {
            world,
            open: BTreeMap::new(),
            views: BTreeMap::new(),
            ids: vec![],
            kept: vec![],
        }
    }

    /// Opens a text, or replaces what is open there.
    pub fn put(&mut self, uri: &str, version: i32, text: &str) {
        let open = Open {
            uri: uri.into(),
            version,
            text: text.into(),
        };
        self.open.insert(path_of(uri), open);
    }

    /// The text that is open at an address.
    pub fn text(&self, uri: &str) -> Option<Rc<str>> {
        self.open.get(&path_of(uri)).map(|open| open.text.clone())
    }

    /// Closes a text; from now on the file on disk counts.
    pub fn close(&mut self, uri: &str) {
        self.open.remove(&path_of(uri));
    }

    /// The paths of all that is open.
    pub fn open_paths(&self) -> Vec<PathBuf> {
        self.open.keys().cloned().collect()
    }

    /// The model to which a file belongs; `None` if it is neither open nor readable.
    pub fn analysis(&mut self, path: &Path) -> Option<Rc<Analysis>> {
        let files = self.members(path)?;
        let is_same = |known: &&Rc<Analysis>| {
            known.files.len() == files.len()
                && known
                    .files
                    .iter()
                    .zip(&files)
                    .all(|(a, b)| Rc::ptr_eq(a, b))
        };
        if let Some(known) = self.kept.iter().find(is_same) {
            return Some(known.clone());
        }
        let analysis = Rc::new(Analysis::of(files));
        self.kept.insert(0, analysis.clone());
        self.kept.truncate(MAX_KEPT);
        Some(analysis)
    }

    /// The files that make one model with `path`, sorted: all of the folder if at most one of them has an `init`, else
    /// those that import each other.
    fn members(&mut self, path: &Path) -> Option<Vec<Rc<FileView>>> {
        let own = self.view(path)?;
        let mut paths = self.neighbors(path);
        if paths.len() > MAX_FILES {
            paths = vec![];
        }
        let mut all: Vec<Rc<FileView>> = paths.iter().filter_map(|path| self.view(path)).collect();
        if !all.iter().any(|file| file.path == path) {
            all.push(own.clone());
        }
        all.sort_by(|a, b| a.path.cmp(&b.path));
        if all.iter().filter(|file| file.has_init()).count() <= 1 {
            return Some(all);
        }
        let mut members = vec![own];
        let mut next = 0;
        while let Some(file) = members.get(next).cloned() {
            next += 1;
            for other in &all {
                let is_linked = file.imports(&other.name()) || other.imports(&file.name());
                if is_linked && !members.iter().any(|member| Rc::ptr_eq(member, other)) {
                    members.push(other.clone());
                }
            }
        }
        members.sort_by(|a, b| a.path.cmp(&b.path));
        Some(members)
    }

    /// The models in the folder of a file, on disk or only open.
    fn neighbors(&self, path: &Path) -> Vec<PathBuf> {
        let Some(folder) = path
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty())
        else {
            return vec![];
        };
        let is_model = |path: &PathBuf| path.extension().is_some_and(|suffix| suffix == "rgg");
        let mut found: Vec<PathBuf> = self.world.list(folder).unwrap_or_default();
        found.extend(
            self.open
                .keys()
                .filter(|open| open.parent() == Some(folder))
                .cloned(),
        );
        found.retain(is_model);
        found.sort();
        found.dedup();
        found
    }

    /// A file as it is now; what was read before is kept while the text is the same.
    fn view(&mut self, path: &Path) -> Option<Rc<FileView>> {
        let (uri, version, text) = match self.open.get(path) {
            Some(open) => (open.uri.clone(), Some(open.version), open.text.clone()),
            None => {
                if self.world.entry(path) != Entry::File {
                    return None;
                }
                let text = String::from_utf8(self.world.read(path).ok()?).ok()?;
                (place::uri_of(path)?.as_str().to_owned(), None, text.into())
            }
        };
        let before = self.views.get(path);
        if let Some(known) = before.filter(|known| known.text == text && known.version == version) {
            return Some(known.clone());
        }
        let id = match before {
            Some(known) => known.id,
            None => {
                self.ids.push(path.to_owned());
                FileId(u16::try_from(self.ids.len() - 1).ok()?)
            }
        };
        let reading = reading::read(id, &text);
        let symbols = symbols::of_file(&text, &reading.ast);
        let lost = before
            .filter(|_| reading.found.has_errors())
            .map_or(vec![], |known| lost(known, &symbols));
        let lines = Lines::of(&text);
        let path = path.to_owned();
        let view = Rc::new(FileView {
            path: path.clone(),
            uri,
            id,
            version,
            text,
            lines,
            reading,
            symbols,
            lost,
        });
        self.views.insert(path, view.clone());
        Some(view)
    }
}

/// What a file declared before and does not declare now.
fn lost(before: &FileView, now: &[Symbol]) -> Vec<Symbol> {
    let is_there = |old: &&Symbol| {
        now.iter()
            .any(|new| new.name == old.name && new.kind == old.kind && new.owner == old.owner)
    };
    let old = before.symbols.iter().chain(&before.lost);
    old.filter(|old| !is_there(old)).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::world::fake::FakeWorld;

    fn members(workspace: &mut Workspace<'_>, path: &str) -> Vec<String> {
        let analysis = workspace.analysis(Path::new(path)).unwrap();
        analysis.files.iter().map(|file| file.name()).collect()
    }

    #[test]
    fn a_folder_with_one_init_is_one_model_and_others_follow_imports() {
        let world = FakeWorld::default();
        world.put(
            "/one/main.rgg",
            "import static parts.*; protected void init() [ Axiom ==> A; ]",
        );
        world.put("/one/parts.rgg", "module A;");
        world.put("/one/more.rgg", "module B;");
        world.put("/two/a.rgg", "import static c.*; protected void init() [ ]");
        world.put("/two/b.rgg", "protected void init() [ ]");
        world.put("/two/c.rgg", "module C;");
        let mut workspace = Workspace::new(&world);
        assert_eq!(
            members(&mut workspace, "/one/parts.rgg"),
            ["main", "more", "parts"]
        );
        assert_eq!(members(&mut workspace, "/two/a.rgg"), ["a", "c"]);
        assert_eq!(members(&mut workspace, "/two/c.rgg"), ["a", "c"]);
        assert_eq!(members(&mut workspace, "/two/b.rgg"), ["b"]);
        assert!(workspace.analysis(Path::new("/two/none.rgg")).is_none());
    }

    #[test]
    fn open_texts_count_and_the_same_text_is_checked_once() {
        let world = FakeWorld::default();
        world.put("/m/main.rgg", "module A;");
        let mut workspace = Workspace::new(&world);
        workspace.put("file:///m/main.rgg", 1, "module B;");
        let path = Path::new("/m/main.rgg");
        let first = workspace.analysis(path).unwrap();
        assert_eq!(first.files[0].symbols[0].name, "B");
        assert!(Rc::ptr_eq(&first, &workspace.analysis(path).unwrap()));
        workspace.put("file:///m/main.rgg", 2, "module B");
        let broken = workspace.analysis(path).unwrap();
        assert!(broken.found.has_errors());
        assert_eq!(
            broken
                .symbols()
                .map(|s| s.name.as_str())
                .collect::<Vec<_>>(),
            ["B"]
        );
        workspace.close("file:///m/main.rgg");
        assert_eq!(
            workspace.analysis(path).unwrap().files[0].symbols[0].name,
            "A"
        );
        workspace.put("untitled:1", 1, "module U;");
        assert_eq!(
            workspace
                .analysis(Path::new("untitled:1"))
                .unwrap()
                .files
                .len(),
            1
        );
    }
}
