//! Pictures that shaders name: each file is read and decoded once, and equal pictures are one.

use super::failure::{self, Failure};
use super::source::Source;
use super::walk::{Painter, Place};
use crate::color::Rgb;
use crate::diag::nearest;
use crate::eval::files::{FileFault, ModelFiles};
use crate::eval::picture::candidates;
use crate::graph::NodeId;
use crate::material::image::{Coverage, Image, ImageFault};
use std::collections::HashMap;
use std::sync::Arc;

/// Pictures that were decoded for one drawing of a model, for the next one: those whose files have not changed need not be
/// decoded again.
#[derive(Debug, Default)]
pub struct DecodedPictures {
    known: Vec<Decoded>,
    n_decoded: u64,
}

/// A picture that was decoded.
#[derive(Debug)]
struct Decoded {
    of: Coverage,
    /// The content of its file.
    file: Vec<u8>,
    image: Arc<Image>,
}

impl DecodedPictures {
    /// How many pictures had to be decoded so far.
    #[must_use]
    pub fn n_decoded(&self) -> u64 {
        self.n_decoded
    }

    /// The picture in these bytes, which may take so many bytes of memory.
    fn picture(
        &mut self,
        bytes: &[u8],
        of: Coverage,
        memory: u64,
    ) -> Result<Arc<Image>, ImageFault> {
        let mut known = self.known.iter();
        let known = known.find(|known| known.of == of && known.file == bytes);
        if let Some(known) = known
            && known.image.bytes() as u64 <= memory
        {
            return Ok(Arc::clone(&known.image));
        }
        let image = Arc::new(Image::decode(bytes, memory)?.with_coverage(of));
        self.n_decoded += 1;
        self.known.push(Decoded {
            of,
            file: bytes.to_vec(),
            image: Arc::clone(&image),
        });
        Ok(image)
    }

    /// Forgets all but these: memory is for what is drawn.
    fn keep(&mut self, used: &[Arc<Image>]) {
        self.known.retain(|known| {
            let is_it = |used: &Arc<Image>| Arc::ptr_eq(used, &known.image) || *used == known.image;
            used.iter().any(is_it)
        });
    }
}

/// The pictures of a model.
#[derive(Debug, Default)]
pub(super) struct Images {
    /// By name and what cuts holes; nothing for names of projects of which there is no file. Looked up only, never iterated.
    named: HashMap<(String, Coverage), Option<Arc<Image>>>,
    /// By where the content of a mesh file keeps them. Looked up only, never iterated.
    contained: HashMap<(usize, Coverage), Arc<Image>>,
    /// Each picture once.
    known: Vec<Arc<Image>>,
    /// What was decoded for this drawing and those before it.
    decoded: DecodedPictures,
}

impl Images {
    /// Begins with what was decoded before.
    pub(super) fn with(decoded: DecodedPictures) -> Self {
        Self {
            decoded,
            ..Self::default()
        }
    }

    /// Ends with what is worth keeping.
    pub(super) fn into_decoded(mut self) -> DecodedPictures {
        self.decoded.keep(&self.known);
        self.decoded
    }
}

/// What a shader that asks for pictures gets them from.
pub struct Finder<'p> {
    images: &'p mut Images,
    files: &'p dyn ModelFiles,
    /// Bytes that pictures may still take.
    memory: u64,
    /// Bytes that new pictures took.
    taken: usize,
    fault: Option<PictureFault>,
    /// What is drawn otherwise than the shader says.
    notes: Vec<(&'static str, String)>,
}

/// A picture that cannot be used.
#[derive(Debug)]
enum PictureFault {
    Unusable {
        name: String,
        why: String,
        hint: Option<String>,
    },
    Refused {
        message: String,
        hint: String,
    },
}

impl<'p> Finder<'p> {
    fn new(images: &'p mut Images, files: &'p dyn ModelFiles, memory: u64) -> Self {
        Self {
            images,
            files,
            memory,
            taken: 0,
            fault: None,
            notes: vec![],
        }
    }

    /// Does something that needs no files.
    #[cfg(test)]
    pub(super) fn without_files<T>(work: impl FnOnce(&mut Finder<'_>) -> T) -> T {
        let mut images = Images::default();
        work(&mut Finder::new(
            &mut images,
            &crate::eval::files::NoFiles,
            1 << 20,
        ))
    }

    /// The picture in the file of this name. If there is none, the finder remembers why.
    pub(super) fn file(&mut self, name: &str, of: Coverage) -> Option<Arc<Image>> {
        let key = (name.to_owned(), of);
        if let Some(known) = self.images.named.get(&key) {
            return known.clone();
        }
        let read = self.files.read_bytes(name);
        let decoded = match read {
            Ok(bytes) => self.decode(name, &bytes, of),
            Err(fault) => {
                self.reject(name, fault);
                None
            }
        }?;
        self.images.named.insert(key, Some(Arc::clone(&decoded)));
        Some(decoded)
    }

    /// The picture that a project calls so; without it, that is noted.
    pub(super) fn of_project(&mut self, name: &str, of: Coverage) -> Option<Arc<Image>> {
        let key = (name.to_owned(), of);
        if let Some(known) = self.images.named.get(&key) {
            return known.clone();
        }
        for file in candidates(name) {
            match self.files.read_bytes(&file) {
                Ok(bytes) => {
                    let decoded = self.decode(&file, &bytes, of)?;
                    self.images.named.insert(key, Some(Arc::clone(&decoded)));
                    return Some(decoded);
                }
                Err(FileFault::Missing(_)) => {}
                Err(FileFault::Failed(why)) => {
                    self.fail(&file, why, None);
                    return None;
                }
                // A run without files draws projects without their pictures.
                Err(FileFault::Refused { .. }) => break,
            }
        }
        self.images.named.insert(key, None);
        let file = candidates(name).next().unwrap_or_default();
        self.note(
            "missing-picture",
            format!("wears the picture `{name}`, of which there is no file; it is drawn gray. Put a `{file}` beside the model"),
        );
        None
    }

    /// The picture of a mesh file, which commonly comes without its pictures; then that is noted.
    pub(super) fn beside_mesh(&mut self, name: &str, of: Coverage) -> Option<Arc<Image>> {
        let key = (name.to_owned(), of);
        if let Some(known) = self.images.named.get(&key) {
            return known.clone();
        }
        if let Err(FileFault::Missing(why)) = self.files.read_bytes(name) {
            self.images.named.insert(key, None);
            let text = format!("draws a mesh whose picture `{name}` is missing: {why}");
            self.note("missing-picture", text);
            return None;
        }
        self.file(name, of)
    }

    /// The picture in these bytes, which a mesh file keeps.
    pub(super) fn content(&mut self, bytes: &Arc<[u8]>, of: Coverage) -> Option<Arc<Image>> {
        let key = (Arc::as_ptr(bytes).cast::<u8>() as usize, of);
        if let Some(known) = self.images.contained.get(&key) {
            return Some(Arc::clone(known));
        }
        let decoded = self.decode("picture inside", bytes, of)?;
        self.images.contained.insert(key, Arc::clone(&decoded));
        Some(decoded)
    }

    /// Two by two fields: the first colour at the upper left and the lower right.
    pub(super) fn checker(
        &mut self,
        [first, second]: [Rgb; 2],
        of: Coverage,
    ) -> Option<Arc<Image>> {
        let [first, second] = [first, second].map(|color| {
            let [r, g, b] = color.to_array().map(|x| x as f32);
            [r, g, b, 1.0]
        });
        let image = Image::linear(2, 2, vec![first, second, second, first]);
        let image = image.ok()?.with_coverage(of);
        Some(self.shared(Arc::new(image)))
    }

    /// Remembers that something is drawn otherwise than it was asked for.
    pub(super) fn note(&mut self, slug: &'static str, text: String) {
        self.notes.push((slug, text));
    }

    fn decode(&mut self, name: &str, bytes: &[u8], of: Coverage) -> Option<Arc<Image>> {
        let left = self.memory.saturating_sub(self.taken as u64);
        match self.images.decoded.picture(bytes, of, left) {
            Ok(image) => Some(self.shared(image)),
            Err(fault) => {
                self.fail(name, fault.to_string(), None);
                None
            }
        }
    }

    /// The one of equal pictures.
    fn shared(&mut self, image: Arc<Image>) -> Arc<Image> {
        let is_same = |known: &&Arc<Image>| Arc::ptr_eq(known, &image) || **known == image;
        if let Some(known) = self.images.known.iter().find(is_same) {
            return Arc::clone(known);
        }
        self.taken += image.bytes();
        self.images.known.push(Arc::clone(&image));
        image
    }

    fn reject(&mut self, name: &str, fault: FileFault) {
        match fault {
            FileFault::Missing(why) => {
                let hint = self.near(name);
                self.fail(name, why, Some(hint));
            }
            FileFault::Failed(why) => self.fail(name, why, None),
            FileFault::Refused { message, hint } => {
                self.fault
                    .get_or_insert(PictureFault::Refused { message, hint });
            }
        }
    }

    /// What the name of a missing file may mean.
    fn near(&self, name: &str) -> String {
        let folder = name.rfind(['/', '\\']).map_or("", |end| &name[..=end]);
        let all = self.files.list(folder).ok().flatten().unwrap_or_default();
        match nearest(&name[folder.len()..], all.iter().map(String::as_str)) {
            Some(near) => format!("did you mean `{folder}{near}`?"),
            None => "names of pictures begin at the folder of the model".to_owned(),
        }
    }

    fn fail(&mut self, name: &str, why: String, hint: Option<String>) {
        let name = name.to_owned();
        self.fault
            .get_or_insert(PictureFault::Unusable { name, why, hint });
    }
}

impl<S: Source> Painter<'_, S> {
    /// Does something that needs pictures for a node, and tells what was wrong with them.
    pub(super) fn with_pictures<T>(
        &mut self,
        node: NodeId,
        place: Place,
        work: impl FnOnce(&S, &mut Finder<'_>) -> T,
    ) -> Result<T, Failure> {
        let memory = self.memory_left();
        let mut finder = Finder::new(&mut self.images, self.source.files(), memory);
        let done = work(self.source, &mut finder);
        let Finder {
            taken,
            fault,
            notes,
            ..
        } = finder;
        for (slug, text) in notes {
            self.warn(node, slug, &text);
        }
        if let Some(fault) = fault {
            let name = self.name(node, place);
            let made = self.made(node);
            return Err(match fault {
                PictureFault::Unusable {
                    name: file,
                    why,
                    hint,
                } => failure::picture(&name, &file, &why, hint, made),
                PictureFault::Refused { message, hint } => {
                    failure::file_refused(message, hint, made)
                }
            });
        }
        if taken > 0 {
            self.charge(taken, node, place)?;
        }
        Ok(done)
    }
}
