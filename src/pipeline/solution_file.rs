//! Files with the light that all cameras share: what it was found from, the light itself, and a checksum.
//!
//! ```text
//! 12 bytes  magic          4  version of the format
//!  8        size of basis  …  basis: JSON
//!  8        size of light  …  light: as its method writes it
//! 16        FNV-1a of all before
//! ```
//! Numbers are little-endian. A file is used only if everything that the light depends on is as it was, by the same version of the
//! program: pictures from it are then the same bytes as without it.

use super::content_hash::ContentHash;
use super::failure::Failure;
use super::studio::Run;
use crate::options::Stage;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};

/// How these files begin.
pub const MAGIC: &[u8; 12] = b"understory\x1a\n";

/// The version of the format, counted up with each change.
const FORMAT: u32 = 2;

/// No basis is larger than this many bytes.
const LARGEST_BASIS: u64 = 1 << 20;

/// Bytes of the checksum.
const CHECKSUM: usize = 16;

/// Everything that the light depends on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Basis {
    /// Version of the program.
    program: String,
    /// Hash of the model's files, and of the meshes and images that they name.
    model: String,
    /// Hash of the panorama.
    sky: String,
    /// Hash of what the scene has come to: of how many things, how large.
    scene: String,
    /// All options it depends on, also the seed.
    options: Vec<OptionBasis>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct OptionBasis {
    key: String,
    /// As it was written, for people.
    text: String,
    /// Equal for equal values.
    value: String,
}

/// Why a file is not used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    /// It is something else.
    #[error("it is not such a file")]
    Foreign,
    /// It was written by another version of the program.
    #[error("it was written by another version of understory; `--save-solution` writes a new one")]
    Version,
    /// It is not as it was written.
    #[error("it is damaged: {0}")]
    Damaged(&'static str),
    /// What it was found from has changed.
    #[error("it does not fit: {0}; `--save-solution` writes a new one")]
    Changed(String),
}

impl Basis {
    /// What the light of a scene depends on; `sky` is the hash of the panorama.
    pub fn new(run: &Run, scene: &Scene, sky: ContentHash) -> Self {
        let entries = run.options.entries();
        let stages = [Stage::Growth, Stage::Scene, Stage::Solution];
        let options = entries
            .iter()
            .filter(|entry| stages.contains(&entry.row.stage));
        let options = options.map(|entry| OptionBasis {
            key: entry.row.key.to_owned(),
            text: entry.text.to_owned(),
            value: entry.canonical(),
        });
        let stats = scene.stats();
        let bounds = scene.bounds();
        let counts = (
            stats.groups,
            stats.primitives,
            stats.instances,
            stats.planes,
            stats.emitters,
        );
        let scene = format!("{counts:?} {bounds:?} {:?}", scene.lights());
        Self {
            program: env!("CARGO_PKG_VERSION").into(),
            model: run.sources.model_hash.to_string(),
            sky: sky.to_string(),
            scene: ContentHash::of([scene.as_bytes()]).to_string(),
            options: options.collect(),
        }
    }

    /// What has changed since `before`; `None` if nothing has.
    fn change(&self, before: &Self) -> Option<String> {
        for now in &self.options {
            let old = before.options.iter().find(|old| old.key == now.key);
            match old {
                Some(old) if old.value == now.value => {}
                Some(old) => {
                    let (key, old, now) = (&now.key, &old.text, &now.text);
                    return Some(format!("`{key}` was `{old}` and is now `{now}`"));
                }
                None => return Some(format!("it does not tell `{}`", now.key)),
            }
        }
        if self.model != before.model {
            return Some("the model, or a file that it names, is another one".into());
        }
        if self.sky != before.sky {
            return Some("the panorama is another one".into());
        }
        if self.scene != before.scene {
            return Some(
                "the scene has become another one: a file that it reads may have changed".into(),
            );
        }
        None
    }
}

/// The file of this light.
///
/// # Errors
/// If its basis cannot be encoded.
pub fn encode(basis: &Basis, light: &[u8]) -> Result<Vec<u8>, Failure> {
    let basis = serde_json::to_vec(basis)
        .map_err(|error| Failure::World(format!("cannot encode as JSON: {error}")))?;
    let mut file = Vec::with_capacity(MAGIC.len() + 4 + 16 + basis.len() + light.len() + CHECKSUM);
    file.extend_from_slice(MAGIC);
    file.extend_from_slice(&FORMAT.to_le_bytes());
    for part in [&basis[..], light] {
        file.extend_from_slice(&(part.len() as u64).to_le_bytes());
        file.extend_from_slice(part);
    }
    file.extend_from_slice(&checksum(&file));
    Ok(file)
}

/// The light in a file, if it is that of `basis`.
///
/// # Errors
/// Why it cannot be used.
pub fn decode<'f>(file: &'f [u8], basis: &Basis) -> Result<&'f [u8], Refused> {
    let rest = file.strip_prefix(MAGIC).ok_or(Refused::Foreign)?;
    let short = Refused::Damaged("it ends too early");
    let (format, _) = rest.split_first_chunk::<4>().ok_or(short.clone())?;
    if u32::from_le_bytes(*format) != FORMAT {
        return Err(Refused::Version);
    }
    let (body, sum) = file.split_last_chunk::<CHECKSUM>().ok_or(short.clone())?;
    let mut rest = body.get(MAGIC.len() + 4..).ok_or(short.clone())?;
    let mut part = |most: u64| {
        let (size, after) = rest.split_first_chunk::<8>().ok_or(short.clone())?;
        let size = u64::from_le_bytes(*size);
        if size > most.min(after.len() as u64) {
            return Err(short.clone());
        }
        let (part, after) = after.split_at(size as usize);
        rest = after;
        Ok(part)
    };
    let (text, light) = (part(LARGEST_BASIS)?, part(u64::MAX)?);
    if !rest.is_empty() {
        return Err(Refused::Damaged("more follows after its end"));
    }
    if checksum(body) != *sum {
        return Err(Refused::Damaged("its checksum is wrong"));
    }
    let before: Basis = serde_json::from_slice(text)
        .map_err(|_| Refused::Damaged("what it depends on cannot be read"))?;
    if before.program != basis.program {
        return Err(Refused::Version);
    }
    match basis.change(&before) {
        Some(change) => Err(Refused::Changed(change)),
        None => Ok(light),
    }
}

fn checksum(bytes: &[u8]) -> [u8; CHECKSUM] {
    ContentHash::of([bytes]).to_bytes()
}
