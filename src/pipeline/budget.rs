//! How much memory a run may use, and refusing in time what would need more.

use super::failure::Failure;
use super::world::World;
use crate::color::Rgb;
use crate::film::Pixel;
use crate::options::Options;

/// What is assumed to be free where the system does not tell: 4 GiB.
const UNKNOWN_FREE: u64 = 4 << 30;

/// Memory that a picture needs for each pixel while it is made: the film, the developed picture and the file, in bytes.
const BYTES_PER_PIXEL: u64 = (size_of::<Pixel>() + size_of::<Rgb>() + 4 * 4) as u64;

/// Bytes that a run may use: what `--max-memory` says, or three quarters of what is free.
pub fn memory(world: &dyn World, options: &Options) -> u64 {
    match options.max_memory.value {
        Some(bytes) => bytes.0,
        None => world.free_memory().unwrap_or(UNKNOWN_FREE) / 4 * 3,
    }
}

/// Refuses a picture that would not fit.
///
/// # Errors
/// A usage error with the size that was asked for and the memory it would need.
pub fn check_picture(world: &dyn World, options: &Options) -> Result<(), Failure> {
    let size = options.size.value;
    let needed = size.pixels().saturating_mul(BYTES_PER_PIXEL);
    let allowed = memory(world, options);
    if needed <= allowed {
        return Ok(());
    }
    Err(Failure::Usage(format!(
        "a picture of {}x{} pixels needs {} of memory, more than the {} of `--max-memory`",
        size.width,
        size.height,
        readable(needed),
        readable(allowed)
    )))
}

/// A number of bytes for people.
pub fn readable(bytes: u64) -> String {
    let units = ["B", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"];
    let mut value = bytes as f64;
    let mut unit = 0;
    while value >= 1024.0 && unit + 1 < units.len() {
        value /= 1024.0;
        unit += 1;
    }
    if unit == 0 {
        format!("{bytes} B")
    } else {
        format!("{value:.1} {}", units[unit])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::Origin;
    use crate::pipeline::world::fake::FakeWorld;

    /// C-65.
    #[test]
    fn absurd_pictures_are_refused_before_memory_is_asked_for() {
        let world = FakeWorld::default();
        let mut options = Options::default();
        assert!(check_picture(&world, &options).is_ok());
        options
            .set("size", "1000000x1000000", Origin::Flag)
            .unwrap();
        let Err(Failure::Usage(text)) = check_picture(&world, &options) else {
            panic!()
        };
        assert!(
            text.contains("1000000x1000000") && text.contains("TiB"),
            "{text}"
        );
        options.set("size", "100x100", Origin::Flag).unwrap();
        options.set("max-memory", "1000", Origin::Flag).unwrap();
        assert!(check_picture(&world, &options).is_err());
    }

    #[test]
    fn bytes_are_readable() {
        assert_eq!(
            (readable(999), readable(1536)),
            ("999 B".into(), "1.5 KiB".into())
        );
        assert_eq!(readable(u64::MAX), "16.0 EiB");
    }
}
