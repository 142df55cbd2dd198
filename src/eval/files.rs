//! The files of a model as the language sees them; who runs a model decides what they are.

/// Why a file cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileFault {
    /// There is none; the model can catch this.
    Missing(String),
    /// It cannot be read; the model can catch this.
    Failed(String),
    /// It may not be used. The model cannot catch this: whoever runs it has to decide.
    Refused {
        /// What was refused.
        message: String,
        /// What to do to allow it.
        hint: String,
    },
}

/// The files that a model may read and write, by the paths it uses.
pub trait ModelFiles: Send {
    /// Where a path leads to: the same for all ways to write it.
    ///
    /// # Errors
    /// If the model may not use it.
    fn place(&self, path: &str) -> Result<String, FileFault>;

    /// The text of a file.
    ///
    /// # Errors
    /// If there is none, or the model may not read it.
    fn read(&self, path: &str) -> Result<String, FileFault>;

    /// The content of a file, such as a mesh or an image.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    fn read_bytes(&self, path: &str) -> Result<Vec<u8>, FileFault>;

    /// Where a path leads to, if the model may write there.
    ///
    /// # Errors
    /// If it may not, for one because its own sources stand there.
    fn may_write(&self, path: &str) -> Result<String, FileFault>;

    /// The names of what a folder holds, sorted, hidden ones left out; `None` if there is no such folder.
    ///
    /// # Errors
    /// If the model may not use it, or it cannot be read.
    fn list(&self, path: &str) -> Result<Option<Vec<String>>, FileFault>;
}

/// No files at all.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoFiles;

impl NoFiles {
    fn refuse(path: &str) -> FileFault {
        FileFault::Refused {
            message: format!("the model uses the file `{path}`, but this run has no files"),
            hint: "run it with `understory derive` or `understory render`".to_owned(),
        }
    }
}

impl ModelFiles for NoFiles {
    fn place(&self, path: &str) -> Result<String, FileFault> {
        Err(Self::refuse(path))
    }

    fn read(&self, path: &str) -> Result<String, FileFault> {
        Err(Self::refuse(path))
    }

    fn read_bytes(&self, path: &str) -> Result<Vec<u8>, FileFault> {
        Err(Self::refuse(path))
    }

    fn may_write(&self, path: &str) -> Result<String, FileFault> {
        Err(Self::refuse(path))
    }

    fn list(&self, path: &str) -> Result<Option<Vec<String>>, FileFault> {
        Err(Self::refuse(path))
    }
}
