//! All that a run needs of the machine: files, the clock, memory.

use super::content_hash::ContentHash;
use super::hashes::Hashes;
use super::packed::{self, Packed, Shelf};
use super::project_files::{ListFolder, ReadFile, RealPath};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

/// No model file is larger than this many bytes: 256 MiB.
const LARGEST_FILE: u64 = 1 << 28;

/// Symbolic links that lead from one to the next, at most: as many as Linux follows.
const MOST_LINKS: usize = 40;

/// What a path leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// Nothing.
    Missing,
    /// An ordinary file.
    File,
    /// A device, a pipe, a socket: reading it may never end, and it is not replaced.
    Device,
    /// A folder.
    Folder,
}

/// The machine as the pipeline sees it. Tests have their own.
pub trait World: Sync {
    /// What `path` leads to.
    fn entry(&self, path: &Path) -> Entry;

    /// Where a file at `path` really stands: at the end of all symbolic links.
    fn destination(&self, path: &Path) -> PathBuf;

    /// The content of a file.
    ///
    /// # Errors
    /// If it cannot be read, or is absurdly large.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;

    /// The digest of the content of a file, at little cost if the file is as it was.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    fn hash(&self, path: &Path) -> io::Result<ContentHash> {
        Ok(ContentHash::of([&self.read(path)?[..]]))
    }

    /// The content of a file of at most so many bytes, however large models may be.
    ///
    /// # Errors
    /// If it cannot be read, or is larger.
    fn read_up_to(&self, path: &Path, most: u64) -> io::Result<Vec<u8>>;

    /// Something that reads files as [`read`](Self::read) does and can be given away.
    fn reader(&self) -> ReadFile;

    /// Something that lists folders as [`list`](Self::list) does and can be given away.
    fn lister(&self) -> ListFolder;

    /// Something that finds where paths lead to after all symbolic links, whether or not anything is there.
    fn real_paths(&self) -> RealPath;

    /// The first `n` bytes of a file, fewer if it is shorter.
    ///
    /// # Errors
    /// If it cannot be read.
    fn head(&self, path: &Path, n: usize) -> io::Result<Vec<u8>>;

    /// What a folder holds, sorted by name.
    ///
    /// # Errors
    /// If it cannot be read.
    fn list(&self, folder: &Path) -> io::Result<Vec<PathBuf>>;

    /// Makes sure that there is such a folder.
    ///
    /// # Errors
    /// If there is none and none can be made.
    fn create_folder(&self, folder: &Path) -> io::Result<()>;

    /// Whether files can be made in `folder`.
    ///
    /// # Errors
    /// Why not.
    fn try_folder(&self, folder: &Path) -> io::Result<()>;

    /// Puts a file in the place of `path`, whole or not at all. A symbolic link stays; what it leads to is replaced.
    ///
    /// # Errors
    /// If it cannot be written; then `path` is as it was.
    fn replace(&self, path: &Path, content: &[u8]) -> io::Result<()>;

    /// Time since the world began.
    fn now(&self) -> Duration;

    /// The most memory this process ever held, in bytes, if the system tells.
    fn peak_memory(&self) -> Option<u64>;

    /// Memory that could still be used, in bytes, if the system tells.
    fn free_memory(&self) -> Option<u64>;
}

/// The machine itself. Packed projects (`.gsz`) are folders in it that can be read.
#[derive(Debug)]
pub struct Machine {
    start: Instant,
    shelf: Shelf,
    hashes: Arc<Hashes>,
}

impl Machine {
    /// The machine, its clock starting now.
    pub fn new() -> Self {
        Self {
            start: Instant::now(),
            shelf: Shelf::default(),
            hashes: Arc::default(),
        }
    }

    /// The packed project that `path` is or leads into, with the rest of the path inside it.
    fn packed<'p>(&self, path: &'p Path) -> Option<(io::Result<Arc<Packed>>, &'p Path)> {
        let (archive, inside) = packed::split(path)?;
        Some((self.shelf.open(archive, whole), inside))
    }

    /// What can read and list the same packed projects, given away.
    fn again(&self) -> Self {
        Self {
            start: self.start,
            shelf: self.shelf.clone(),
            hashes: self.hashes.clone(),
        }
    }
}

/// The content of a file on the disk.
fn whole(path: &Path) -> io::Result<Vec<u8>> {
    not_too_large(beginning(path, LARGEST_FILE + 1)?)
}

/// The content of a file on the disk, or as many bytes of it.
fn beginning(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut content = Vec::new();
    std::fs::File::open(path)?
        .take(most)
        .read_to_end(&mut content)?;
    Ok(content)
}

fn not_too_large(content: Vec<u8>) -> io::Result<Vec<u8>> {
    if content.len() as u64 > LARGEST_FILE {
        return Err(io::Error::other("it is larger than 256 MiB"));
    }
    Ok(content)
}

impl Default for Machine {
    fn default() -> Self {
        Self::new()
    }
}

impl World for Machine {
    fn entry(&self, path: &Path) -> Entry {
        match self.packed(path) {
            Some((Ok(packed), inside)) => return packed.entry(inside),
            // A damaged project is a folder that cannot be listed: who lists it hears why.
            Some((Err(_), inside)) if inside.as_os_str().is_empty() => return Entry::Folder,
            Some((Err(_), _)) => return Entry::Missing,
            None => {}
        }
        match std::fs::metadata(path) {
            Ok(data) if data.is_dir() => Entry::Folder,
            Ok(data) if data.is_file() => Entry::File,
            Ok(_) => Entry::Device,
            Err(_) => Entry::Missing,
        }
    }

    fn destination(&self, path: &Path) -> PathBuf {
        let mut path = path.to_owned();
        for _ in 0..MOST_LINKS {
            let Ok(next) = std::fs::read_link(&path) else {
                break;
            };
            path = folder_of(&path).join(next);
        }
        path
    }

    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        match self.packed(path) {
            Some((packed, inside)) => not_too_large(packed?.read(inside, LARGEST_FILE + 1)?),
            None => whole(path),
        }
    }

    fn hash(&self, path: &Path) -> io::Result<ContentHash> {
        match self.packed(path) {
            Some(_) => Ok(ContentHash::of([&self.read(path)?[..]])),
            None => self.hashes.of(path, SystemTime::now(), || whole(path)),
        }
    }

    fn read_up_to(&self, path: &Path, most: u64) -> io::Result<Vec<u8>> {
        let content = match self.packed(path) {
            Some((packed, inside)) => packed?.read(inside, most.saturating_add(1))?,
            None => beginning(path, most.saturating_add(1))?,
        };
        if content.len() as u64 > most {
            return Err(io::Error::other("it is larger than memory allows"));
        }
        Ok(content)
    }

    fn reader(&self) -> ReadFile {
        let world = self.again();
        Arc::new(move |path| world.read(path))
    }

    fn lister(&self) -> ListFolder {
        let world = self.again();
        Arc::new(move |path| world.list(path))
    }

    fn real_paths(&self) -> RealPath {
        Arc::new(|path| {
            let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
            // What does not exist yet stands where the nearest folder that does leads to.
            let found = path.ancestors().find_map(|ancestor| {
                let real = std::fs::canonicalize(ancestor).ok()?;
                let rest = path.strip_prefix(ancestor).ok()?;
                Some(if rest.as_os_str().is_empty() {
                    real
                } else {
                    real.join(rest)
                })
            });
            found.unwrap_or(path)
        })
    }

    fn head(&self, path: &Path, n: usize) -> io::Result<Vec<u8>> {
        if let Some((packed, inside)) = self.packed(path) {
            return packed?.read(inside, n as u64);
        }
        let mut content = Vec::new();
        std::fs::File::open(path)?
            .take(n as u64)
            .read_to_end(&mut content)?;
        Ok(content)
    }

    fn list(&self, folder: &Path) -> io::Result<Vec<PathBuf>> {
        if let Some((packed, inside)) = self.packed(folder) {
            let names = packed?.list(inside)?;
            return Ok(names.iter().map(|name| folder.join(name)).collect());
        }
        let entries = std::fs::read_dir(folder)?;
        let mut paths = entries
            .map(|e| Ok(e?.path()))
            .collect::<io::Result<Vec<PathBuf>>>()?;
        paths.sort();
        Ok(paths)
    }

    fn create_folder(&self, folder: &Path) -> io::Result<()> {
        std::fs::create_dir_all(folder)
    }

    fn try_folder(&self, folder: &Path) -> io::Result<()> {
        temporary(folder).map(drop)
    }

    fn replace(&self, path: &Path, content: &[u8]) -> io::Result<()> {
        let path = &self.destination(path);
        if packed::split(path).is_some() {
            return Err(io::Error::other(
                "it would stand inside a packed project: unpack that, or map the path to another folder with `--path-map`",
            ));
        }
        let mut file = temporary(folder_of(path))?;
        file.write_all(content)?;
        file.as_file().sync_all()?;
        file.persist(path).map_err(|error| error.error)?;
        Ok(())
    }

    fn now(&self) -> Duration {
        self.start.elapsed()
    }

    fn peak_memory(&self) -> Option<u64> {
        kibibytes("/proc/self/status", "VmHWM:")
    }

    fn free_memory(&self) -> Option<u64> {
        kibibytes("/proc/meminfo", "MemAvailable:")
    }
}

/// The folder a file stands in.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// A file that is gone when it is dropped, with the rights an ordinary new file has.
fn temporary(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".understory-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

/// A line of Linux's process file system, such as `VmHWM:  123 kB`, in bytes.
fn kibibytes(file: &str, name: &str) -> Option<u64> {
    let text = std::fs::read_to_string(file).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.trim()
        .strip_suffix("kB")?
        .trim()
        .parse::<u64>()
        .ok()?
        .checked_mul(1024)
}

#[cfg(test)]
pub(crate) mod fake {
    //! A machine that exists only in memory.

    use super::{Entry, World};
    use crate::pipeline::project_files::{ListFolder, ReadFile, RealPath};
    use std::collections::BTreeMap;
    use std::io;
    use std::path::{Path, PathBuf};
    use std::sync::atomic::{AtomicU64, Ordering};
    use std::sync::{Arc, Mutex};
    use std::time::Duration;

    /// Files in memory, and a clock that goes on by 10 ms whenever somebody looks at it.
    #[derive(Default)]
    pub(crate) struct FakeWorld {
        files: Arc<Mutex<BTreeMap<PathBuf, Vec<u8>>>>,
        ticks: AtomicU64,
    }

    impl FakeWorld {
        /// Makes or changes a file.
        pub(crate) fn put(&self, path: &str, content: &str) {
            self.files
                .lock()
                .unwrap()
                .insert(path.into(), content.into());
        }
    }

    impl World for FakeWorld {
        fn entry(&self, path: &Path) -> Entry {
            let files = self.files.lock().unwrap();
            if files.contains_key(path) {
                Entry::File
            } else if files.keys().any(|file| file.starts_with(path)) {
                Entry::Folder
            } else {
                Entry::Missing
            }
        }

        fn destination(&self, path: &Path) -> PathBuf {
            path.to_owned()
        }

        fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
            let files = self.files.lock().unwrap();
            files
                .get(path)
                .cloned()
                .ok_or_else(|| io::ErrorKind::NotFound.into())
        }

        fn read_up_to(&self, path: &Path, _: u64) -> io::Result<Vec<u8>> {
            self.read(path)
        }

        fn reader(&self) -> ReadFile {
            let files = Arc::clone(&self.files);
            Arc::new(move |path| {
                let files = files.lock().unwrap();
                files
                    .get(path)
                    .cloned()
                    .ok_or_else(|| io::ErrorKind::NotFound.into())
            })
        }

        fn lister(&self) -> ListFolder {
            let files = Arc::clone(&self.files);
            Arc::new(move |folder| {
                let files = files.lock().unwrap();
                let inside = files.keys().filter(|file| file.parent() == Some(folder));
                let found: Vec<PathBuf> = inside.cloned().collect();
                if found.is_empty() {
                    return Err(io::ErrorKind::NotFound.into());
                }
                Ok(found)
            })
        }

        fn real_paths(&self) -> RealPath {
            Arc::new(Path::to_owned)
        }

        fn head(&self, path: &Path, n: usize) -> io::Result<Vec<u8>> {
            self.read(path)
                .map(|content| content.into_iter().take(n).collect())
        }

        fn list(&self, folder: &Path) -> io::Result<Vec<PathBuf>> {
            let files = self.files.lock().unwrap();
            Ok(files
                .keys()
                .filter(|file| file.parent() == Some(folder))
                .cloned()
                .collect())
        }

        fn create_folder(&self, _: &Path) -> io::Result<()> {
            Ok(())
        }

        fn try_folder(&self, _: &Path) -> io::Result<()> {
            Ok(())
        }

        fn replace(&self, path: &Path, content: &[u8]) -> io::Result<()> {
            self.files
                .lock()
                .unwrap()
                .insert(path.into(), content.into());
            Ok(())
        }

        fn now(&self) -> Duration {
            Duration::from_millis(10 * self.ticks.fetch_add(1, Ordering::Relaxed))
        }

        fn peak_memory(&self) -> Option<u64> {
            None
        }

        fn free_memory(&self) -> Option<u64> {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_whole_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let world = Machine::new();
        assert_eq!(world.entry(&path), Entry::Missing);
        world.try_folder(folder.path()).unwrap();
        world.replace(&path, b"one").unwrap();
        let mut reader = std::fs::File::open(&path).unwrap();
        world.replace(&path, b"two").unwrap();
        // Nothing is written over what is there: who was reading it reads it to its end.
        let mut old = Vec::new();
        reader.read_to_end(&mut old).unwrap();
        assert_eq!(old, if cfg!(unix) { b"one" } else { b"two" });
        assert_eq!(world.read(&path).unwrap(), b"two");
        assert_eq!(world.head(&path, 2).unwrap(), b"tw");
        assert_eq!(world.list(folder.path()).unwrap(), [path]);
        assert!(
            world
                .replace(&folder.path().join("no/b.png"), b"x")
                .is_err()
        );
        assert!(world.try_folder(&folder.path().join("no")).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_and_what_it_leads_to_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("far")).unwrap();
        let link = |to: &str, from: &str| std::os::unix::fs::symlink(to, at(from)).unwrap();
        link("far/b.png", "a.png");
        link("c.png", "far/b.png");
        let world = Machine::new();
        for content in [b"one", b"two"] {
            // The file at the end of the links need not be there yet.
            world.replace(&at("a.png"), content).unwrap();
            assert_eq!(std::fs::read(at("far/c.png")).unwrap(), content);
            assert!(at("a.png").is_symlink() && at("far/b.png").is_symlink());
            assert!(!at("far/c.png").is_symlink());
        }
        link("round.png", "round.png");
        assert_eq!(world.entry(&at("round.png")), Entry::Missing);
        assert_eq!(world.entry(Path::new("/dev/null")), Entry::Device);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn linux_tells_its_memory() {
        let world = Machine::new();
        assert!(world.peak_memory() > Some(1 << 20));
        assert!(world.free_memory() > Some(1 << 20));
    }
}
