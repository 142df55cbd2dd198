//! Where the frames of a film are kept while it is made, and the film itself.
//!
//! Each frame carries a key: a hash of all that it was made from. A frame is kept only if its key is the one that is wanted,
//! so what was made from another model or with other options is never mixed in; and it is written whole or not at all, so
//! that a run can be killed at any moment and goes on with what is missing. Several runs may fill one folder.

use super::content_hash::ContentHash;
use super::exposing;
use super::failure::Failure;
use super::store::{PictureTarget, chain, may_write};
use super::world::{Entry, World};
use crate::animation::sheet;
use crate::animation::{FilmError, FilmFormat, FilmShape, film, frame_name};
use crate::color::Rgb;
use crate::film::LinearImage;
use crate::image::{Format, Picture, Pixels, png_text};
use crate::options::flying::FrameFormat;
use std::path::{Path, PathBuf};

/// The text of a frame that tells what it was made from.
const FRAME_KEY: &str = "Frame key";
/// What the file beside a frame begins with, if the frame itself can hold no text.
const KEY_LINE: &str = "understory frame ";

/// Where the frames of a film are kept, and the film itself.
#[derive(Clone, Debug)]
pub struct Reel {
    folder: PathBuf,
    frames: Format,
    film: Option<(PathBuf, FilmFormat)>,
}

impl Reel {
    /// The reel of a film at `output`: a folder of frames if the path has no suffix, otherwise one file, whose frames are kept in
    /// the folder `OUTPUT.frames`.
    ///
    /// # Errors
    /// If the suffix is unknown, files cannot be made there, or something else is there already.
    pub fn new(world: &dyn World, output: &Path) -> Result<Self, Failure> {
        match (world.entry(output), output.extension()) {
            (Entry::Folder, _) | (Entry::Missing, None) => Ok(Self {
                folder: output.to_owned(),
                frames: Format::Png,
                film: None,
            }),
            (Entry::File | Entry::Device, None) => Err(Failure::World(format!(
                "cannot write into `{}`: it is a file",
                output.display()
            ))),
            (_, Some(_)) => {
                let format =
                    FilmFormat::of_path(output).map_err(|e| Failure::Usage(e.to_string()))?;
                let mut folder = output.as_os_str().to_owned();
                folder.push(".frames");
                let reel = Self {
                    folder: folder.into(),
                    frames: Format::Png,
                    film: Some((output.to_owned(), format)),
                };
                reel.check(world)?;
                if matches!(world.entry(&reel.folder), Entry::File | Entry::Device) {
                    return Err(Failure::World(format!(
                        "cannot keep frames in `{}`: it is a file",
                        reel.folder.display()
                    )));
                }
                Ok(reel)
            }
        }
    }

    /// The same reel with frames of this format.
    ///
    /// # Errors
    /// If a film cannot be made of such frames, or cannot have this shape.
    pub fn with(self, format: FrameFormat, shape: FilmShape) -> Result<Self, Failure> {
        let frames = match format {
            FrameFormat::Png => Format::Png,
            FrameFormat::Exr => Format::Exr,
        };
        if let Some((_, film)) = &self.film {
            film.check(shape).map_err(|e| Failure::Usage(chain(&e)))?;
            if frames == Format::Exr {
                let message = "a film is made of `png` frames; `--frame-format exr` is for a folder of frames (a path without a suffix)";
                return Err(Failure::Usage(message.into()));
            }
        }
        Ok(Self { frames, ..self })
    }

    /// Makes the folder.
    ///
    /// # Errors
    /// If it cannot be made, or takes no files.
    pub fn open(&self, world: &dyn World) -> Result<(), Failure> {
        let folder = &self.folder;
        world
            .create_folder(folder)
            .map_err(|error| Failure::file("make folder", folder, &error))?;
        world
            .try_folder(folder)
            .map_err(|error| Failure::file("write files into", folder, &error))
    }

    /// The folder of the frames.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The film, if it is more than its frames.
    pub fn film(&self) -> Option<&Path> {
        self.film.as_ref().map(|(path, _)| &**path)
    }

    /// The format of single frames.
    pub fn frame_format(&self) -> Format {
        self.frames
    }

    /// The hash of a frame, if it is there, whole, and has this key.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn kept(
        &self,
        world: &dyn World,
        frame: u32,
        key: &str,
    ) -> Result<Option<ContentHash>, Failure> {
        let path = self.path(frame);
        if world.entry(&path) != Entry::File {
            return Ok(None);
        }
        let file = read(world, &path)?;
        let hash = ContentHash::of([&file[..]]);
        let is_same = if self.frames == Format::Png {
            let texts = png_text::read(&file).unwrap_or_default();
            texts
                .iter()
                .any(|(name, value)| name == FRAME_KEY && value == key)
        } else {
            let beside = key_path(&path);
            world.entry(&beside) == Entry::File
                && read(world, &beside)? == key_line(key, hash).into_bytes()
        };
        Ok(is_same.then_some(hash))
    }

    /// Writes a frame with its key; gives the hash of the file.
    ///
    /// # Errors
    /// If it cannot be written, or something that is no frame is there.
    pub fn put(
        &self,
        world: &dyn World,
        frame: u32,
        key: &str,
        picture: &Picture,
        mut texts: Vec<(&'static str, String)>,
    ) -> Result<ContentHash, Failure> {
        let path = self.path(frame);
        let target = PictureTarget::new(world, &path)?;
        texts.push((FRAME_KEY, key.to_owned()));
        let hash = target.write(world, picture, &texts)?;
        if self.frames != Format::Png {
            // After the frame: a key without its frame would be a lie.
            let beside = key_path(&path);
            may_write(world, &beside, "the key of a frame", |head| {
                KEY_LINE.as_bytes().starts_with(head) || head.starts_with(KEY_LINE.as_bytes())
            })?;
            world
                .replace(&beside, key_line(key, hash).as_bytes())
                .map_err(|error| Failure::file("write", &beside, &error))?;
        }
        Ok(hash)
    }

    /// What a frame that is there shows, in 8-bit sRGB; `exposure` as it was when it was made.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn shown(&self, world: &dyn World, frame: u32, exposure: f64) -> Result<Vec<u8>, Failure> {
        let path = self.path(frame);
        let file = read(world, &path)?;
        let image = image::load_from_memory(&file).map_err(|error| {
            Failure::World(format!("cannot read `{}`: {error}", path.display()))
        })?;
        if self.frames == Format::Png {
            return Ok(image.into_rgb8().into_raw());
        }
        let image = image.into_rgb32f();
        let (width, height) = image.dimensions();
        let pixels = image
            .pixels()
            .map(|p| Rgb::new(p[0].into(), p[1].into(), p[2].into()));
        let pixels = pixels.collect();
        let linear = LinearImage {
            width,
            height,
            pixels,
        };
        match exposing::develop(&linear, Format::Png, exposure).pixels {
            Pixels::Srgb(bytes) => Ok(bytes),
            Pixels::Linear(_) => unreachable!("invariant: PNG is sRGB"),
        }
    }

    /// Makes the film of frames that are all there; `told` hears how many are done.
    ///
    /// # Errors
    /// If a frame cannot be read, or the film not be written; then what was there before is untouched.
    pub fn assemble(
        &self,
        world: &dyn World,
        shape: FilmShape,
        told: &mut dyn FnMut(u32),
    ) -> Result<Option<ContentHash>, Failure> {
        let Some((path, format)) = &self.film else {
            return Ok(None);
        };
        let mut frame = |i| {
            told(i);
            self.shown(world, i, 1.0)
        };
        let bytes = film(*format, shape, &mut frame)?;
        self.check(world)?;
        world
            .replace(path, &bytes)
            .map_err(|error| Failure::file("write", path, &error))?;
        Ok(Some(ContentHash::of([&bytes[..]])))
    }

    /// The contact sheet of the frames that are there, among those of `frames`.
    ///
    /// # Errors
    /// If one cannot be read.
    pub fn sheet(
        &self,
        world: &dyn World,
        shape: FilmShape,
        frames: std::ops::Range<u32>,
    ) -> Result<Picture, Failure> {
        let chosen = sheet::chosen(frames.end - frames.start);
        let shown = chosen
            .iter()
            .map(|i| self.shown(world, frames.start + i, 1.0));
        let shown = shown.collect::<Result<Vec<_>, _>>()?;
        Ok(sheet::sheet(&shown, shape.width, shape.height))
    }

    fn check(&self, world: &dyn World) -> Result<(), Failure> {
        match &self.film {
            Some((path, format)) => may_write(world, path, "a film of that format", |head| {
                format.begins(head)
            }),
            None => Ok(()),
        }
    }

    fn path(&self, frame: u32) -> PathBuf {
        let suffix = if self.frames == Format::Png {
            "png"
        } else {
            "exr"
        };
        self.folder.join(frame_name(frame, suffix))
    }
}

impl From<FilmError> for Failure {
    fn from(error: FilmError) -> Self {
        Self::World(chain(&error))
    }
}

/// The file beside a frame that can hold no text.
fn key_path(frame: &Path) -> PathBuf {
    let mut path = frame.as_os_str().to_owned();
    path.push(".key");
    path.into()
}

fn key_line(key: &str, hash: ContentHash) -> String {
    format!("{KEY_LINE}{key} {hash}\n")
}

fn read(world: &dyn World, path: &Path) -> Result<Vec<u8>, Failure> {
    world
        .read(path)
        .map_err(|error| Failure::file("read", path, &error))
}
