//! The digests of files, made again only when a file may have changed: a look once a second at large files costs nothing.

use super::content_hash::ContentHash;
use std::collections::BTreeMap;
use std::fs::Metadata;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, SystemTime};

/// A file whose time of change is younger than this when it is looked at may change once more without that time showing it:
/// clocks of file systems are coarse.
const SETTLED: Duration = Duration::from_secs(2);
/// Files that are remembered.
const MOST: usize = 10_000;

/// What a file system tells of a file without its content.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Stamp {
    length: u64,
    modified: Option<SystemTime>,
    /// Place and last change of the entry, which nobody can set back: a copy that keeps times differs in these.
    entry: (u64, u64, i64, i64),
}

impl Stamp {
    fn of(data: &Metadata) -> Self {
        #[cfg(unix)]
        let entry = {
            use std::os::unix::fs::MetadataExt;
            (data.dev(), data.ino(), data.ctime(), data.ctime_nsec())
        };
        #[cfg(not(unix))]
        let entry = (0, 0, 0, 0);
        Self {
            length: data.len(),
            modified: data.modified().ok(),
            entry,
        }
    }

    /// Whether a later change must show in a stamp.
    fn is_settled(&self, now: SystemTime) -> bool {
        let age = self.modified.map(|modified| now.duration_since(modified));
        matches!(age, Some(Ok(age)) if age >= SETTLED)
    }
}

/// Digests by path.
#[derive(Debug, Default)]
pub(super) struct Hashes {
    known: Mutex<BTreeMap<PathBuf, (Stamp, ContentHash)>>,
}

impl Hashes {
    /// The digest of the file at `path`, which `read` reads if need be, at this time.
    ///
    /// # Errors
    /// If it cannot be read.
    pub(super) fn of(
        &self,
        path: &Path,
        now: SystemTime,
        read: impl FnOnce() -> io::Result<Vec<u8>>,
    ) -> io::Result<ContentHash> {
        let stamp = Stamp::of(&std::fs::metadata(path)?);
        let lock = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((known, hash)) = lock().get(path)
            && *known == stamp
        {
            return Ok(*hash);
        }
        let hash = ContentHash::of([&read()?[..]]);
        let mut known = lock();
        known.remove(path);
        if stamp.is_settled(now) && known.len() < MOST {
            known.insert(path.to_owned(), (stamp, hash));
        }
        Ok(hash)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn what_cannot_have_changed_is_not_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("large.obj");
        let (hashes, n_reads) = (Hashes::default(), Cell::new(0));
        let hash = |after: u64| {
            let now = SystemTime::now() + Duration::from_secs(after);
            hashes.of(&path, now, || {
                n_reads.set(n_reads.get() + 1);
                std::fs::read(&path)
            })
        };
        assert!(hash(0).is_err());
        std::fs::write(&path, "one").unwrap();
        // Too young to be sure.
        let one = hash(0).unwrap();
        assert_eq!((hash(0).unwrap(), n_reads.get()), (one, 2));
        // Old enough: read once more, then never again.
        assert_eq!((hash(5).unwrap(), n_reads.get()), (one, 3));
        assert_eq!((hash(6).unwrap(), n_reads.get()), (one, 3));
        assert_eq!((hash(0).unwrap(), n_reads.get()), (one, 3));
        // Another content of the same length and the same time.
        let modified = std::fs::metadata(&path).unwrap().modified().unwrap();
        std::fs::write(&path, "two").unwrap();
        let file = std::fs::File::options().write(true).open(&path).unwrap();
        file.set_modified(modified).unwrap();
        assert_eq!(hash(9).unwrap() != one, cfg!(unix));
        std::fs::remove_file(&path).unwrap();
        assert!(hash(9).is_err());
    }
}
