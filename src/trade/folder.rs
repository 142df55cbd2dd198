//! The folder that holds what was measured: found again by the next run, which then measures only what is missing.

use super::results::Findings;
use crate::color::Rgb;
use crate::film::LinearImage;
use crate::image::{Format, Picture, Pixels, encode};
use crate::pipeline::failure::Failure;
use crate::pipeline::world::{Entry, World};
use image::ImageFormat;
use std::path::{Path, PathBuf};

/// The file with all numbers; by it a folder is known.
const FINDINGS: &str = "trade.json";
/// The two halves of the reference.
const REFERENCES: [&str; 2] = ["reference-a.exr", "reference-b.exr"];
/// Where pictures are.
pub const PICTURES: &str = "pictures";

/// A folder for what is measured.
pub struct Folder<'w> {
    world: &'w dyn World,
    path: PathBuf,
}

impl<'w> Folder<'w> {
    /// The folder at `path`: made if it is not there, refused if something else is in it.
    ///
    /// # Errors
    /// If it cannot be made, or holds other things than an earlier measurement.
    pub fn open(world: &'w dyn World, path: &Path) -> Result<Self, Failure> {
        let is_free = match world.entry(path) {
            Entry::Missing => true,
            Entry::Folder => {
                let inside = world
                    .list(path)
                    .map_err(|error| Failure::file("list", path, &error))?;
                inside.is_empty() || world.entry(&path.join(FINDINGS)) == Entry::File
            }
            Entry::File | Entry::Device => false,
        };
        if !is_free {
            return Err(Failure::World(format!(
                "cannot write into `{}`: what is there is not an earlier measurement of `trade`, and is not replaced",
                path.display()
            )));
        }
        let make = |folder: &Path| {
            world
                .create_folder(folder)
                .map_err(|error| Failure::file("make the folder", folder, &error))
        };
        make(path)?;
        let folder = Self {
            world,
            path: path.to_owned(),
        };
        if world.entry(&path.join(FINDINGS)) == Entry::Missing {
            // First of all, so that a run that was stopped early finds its folder again.
            folder.write(FINDINGS, b"{}\n")?;
        }
        make(&path.join(PICTURES))?;
        Ok(folder)
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What was found the last time; `None` if there is nothing, or another version wrote it.
    pub fn findings(&self) -> Option<Findings> {
        let content = self.world.read(&self.path.join(FINDINGS)).ok()?;
        let findings: Findings = serde_json::from_slice(&content).ok()?;
        (findings.understory_trade == env!("CARGO_PKG_VERSION")).then_some(findings)
    }

    /// Keeps what was found.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn keep(&self, findings: &Findings) -> Result<(), Failure> {
        let text = serde_json::to_string_pretty(findings)
            .map_err(|error| Failure::World(format!("cannot encode as JSON: {error}")))?;
        self.write(FINDINGS, text.as_bytes())
    }

    /// The two halves of the reference, if both are there whole.
    pub fn references(&self) -> Option<[LinearImage; 2]> {
        let read = |name: &str| read_exr(&self.world.read(&self.path.join(name)).ok()?);
        let [a, b] = REFERENCES.map(read);
        let (a, b) = (a?, b?);
        ((a.width, a.height) == (b.width, b.height)).then_some([a, b])
    }

    /// Keeps the two halves of the reference.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn keep_references(&self, halves: &[LinearImage; 2]) -> Result<(), Failure> {
        for (name, image) in REFERENCES.iter().zip(halves) {
            let values = image.pixels.iter().flat_map(|pixel| pixel.to_array());
            let picture = Picture {
                width: image.width,
                height: image.height,
                pixels: Pixels::Linear(values.map(|value| value as f32).collect()),
            };
            self.put(name, &picture, Format::Exr)?;
        }
        Ok(())
    }

    /// Writes a picture of 8-bit sRGB.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn picture(&self, name: &str, bytes: Vec<u8>, size: [u32; 2]) -> Result<(), Failure> {
        let picture = Picture {
            width: size[0],
            height: size[1],
            pixels: Pixels::Srgb(bytes),
        };
        self.put(name, &picture, Format::Png)
    }

    /// Writes a file.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, name: &str, content: &[u8]) -> Result<(), Failure> {
        let path = self.path.join(name);
        self.world
            .replace(&path, content)
            .map_err(|error| Failure::file("write", &path, &error))
    }

    fn put(&self, name: &str, picture: &Picture, format: Format) -> Result<(), Failure> {
        let bytes = encode(picture, format, &[])
            .map_err(|error| Failure::World(format!("cannot write `{name}`: {error}")))?;
        self.write(name, &bytes)
    }
}

/// The radiances in a file; `None` if it is damaged.
fn read_exr(content: &[u8]) -> Option<LinearImage> {
    let image = image::load_from_memory_with_format(content, ImageFormat::OpenExr).ok()?;
    let image = image.into_rgb32f();
    let pixels = image
        .pixels()
        .map(|pixel| Rgb::from_array(pixel.0.map(f64::from)));
    let pixels: Vec<Rgb> = pixels.collect();
    let is_sound = pixels.iter().all(|pixel| pixel.is_finite());
    is_sound.then_some(LinearImage {
        width: image.width(),
        height: image.height(),
        pixels,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::world::fake::FakeWorld;
    use crate::trade::front::tests::findings;

    fn image(value: f64) -> LinearImage {
        LinearImage {
            width: 3,
            height: 2,
            pixels: vec![Rgb::splat(value); 6],
        }
    }

    #[test]
    fn what_was_measured_is_found_again() {
        let world = FakeWorld::default();
        let folder = Folder::open(&world, Path::new("t")).unwrap();
        assert!(folder.findings().is_none() && folder.references().is_none());
        let findings = Findings {
            understory_trade: env!("CARGO_PKG_VERSION").into(),
            ..findings()
        };
        folder.keep(&findings).unwrap();
        folder.keep_references(&[image(0.25), image(4.0)]).unwrap();
        let again = Folder::open(&world, Path::new("t")).unwrap();
        assert_eq!(again.findings(), Some(findings));
        assert_eq!(again.references(), Some([image(0.25), image(4.0)]));
    }

    #[test]
    fn damage_is_measured_again_and_other_folders_are_left_alone() {
        let world = FakeWorld::default();
        world.put("photos/cat.png", "cat");
        world.put("file", "text");
        for path in ["photos", "file"] {
            let refused = Folder::open(&world, Path::new(path)).err().unwrap();
            assert!(matches!(refused, Failure::World(text) if text.contains("not an earlier")));
        }
        world.put("t/trade.json", "{");
        world.put("t/reference-a.exr", "?");
        let folder = Folder::open(&world, Path::new("t")).unwrap();
        assert!(folder.findings().is_none() && folder.references().is_none());
    }
}
