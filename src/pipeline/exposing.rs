//! A film of radiances becomes a picture for a file.

use crate::camera::Camera;
use crate::film::{LinearImage, tone};
use crate::image::format::Encoding;
use crate::image::{Format, Picture, Pixels};
use crate::material::Material;
use crate::scene::Scene;
use glam::DVec2;

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

/// Of each pixel, whether the middle of it shows a surface that does not shine by itself.
pub fn subject(scene: &Scene, camera: &Camera, width: u32, height: u32) -> Vec<bool> {
    let size = DVec2::new(f64::from(width), f64::from(height));
    let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let shows_subject = |(x, y)| {
        let ray = camera.ray((DVec2::new(f64::from(x), f64::from(y)) + 0.5) / size);
        scene.closest(&ray).is_some_and(|hit| {
            let material = scene.surface(&ray, &hit).material;
            let material = scene.materials().get(material.0 as usize);
            !material.is_some_and(Material::is_emitter)
        })
    };
    rows.map(shows_subject).collect()
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
