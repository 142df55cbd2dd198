//! A film of radiances becomes a picture for a file.

use crate::film::{LinearImage, tone};
use crate::image::format::Encoding;
use crate::image::{Format, Picture, Pixels};

/// The picture of `image` for a file of this format; `exposure` (a factor) applies to what is meant for eyes only.
pub fn develop(image: &LinearImage, format: Format, exposure: f64) -> Picture {
    let pixels = match format.encoding() {
        Encoding::Srgb => Pixels::Srgb(tone::to_srgb8(image, exposure, tone::ToneCurve::default())),
        Encoding::Linear => {
            let values = image.pixels.iter().flat_map(|pixel| pixel.to_array());
            Pixels::Linear(values.map(|value| value as f32).collect())
        }
    };
    Picture {
        width: image.width,
        height: image.height,
        pixels,
    }
}

/// The factor that a number of photographic stops stands for.
pub fn factor(stops: f64) -> f64 {
    libm::exp2(stops)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;

    #[test]
    fn measurements_are_not_exposed_and_pictures_are() {
        let image = LinearImage {
            width: 1,
            height: 1,
            pixels: vec![Rgb::new(0.1, 0.2, 4.0)],
        };
        let linear = develop(&image, Format::Exr, factor(3.0));
        assert_eq!(linear.pixels, Pixels::Linear(vec![0.1, 0.2, 4.0]));
        let dark = develop(&image, Format::Png, factor(-10.0));
        let bright = develop(&image, Format::Png, factor(10.0));
        let brightness = |picture: &Picture| match &picture.pixels {
            Pixels::Srgb(bytes) => bytes.iter().map(|&b| u32::from(b)).sum::<u32>(),
            Pixels::Linear(_) => 0,
        };
        assert!(brightness(&dark) < 60 && brightness(&bright) > 700);
    }
}
