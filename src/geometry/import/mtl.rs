//! Wavefront material libraries.
//!
//! `Kd` becomes the base colour, `d` (or 1 - `Tr`) alpha, `Ke` emission, `Ni` the index of refraction, `Pr` and `Pm` roughness
//! and metalness, `map_Kd` the image, whose alpha cuts holes unless `map_d` names another. Without `Pr`, roughness follows from the exponent `Ns` of a surface that has a gloss
//! (`Ks`); without `Pm`, a mirror (`illum` 3, 5, 8) without a matt part is a metal. The rest is not looked at.

use super::ImportError;
use super::material::{MeshHoles, MeshImage, MeshMaterial, MeshTexture, MeshWrap};
use super::obj::{Line, lines};
use glam::{DAffine2, DVec2};

/// What a library says of one material, as far as it says anything.
#[derive(Default)]
struct Entry {
    name: String,
    diffuse: Option<[f64; 3]>,
    specular: Option<[f64; 3]>,
    exponent: Option<f64>,
    roughness: Option<f64>,
    metallic: Option<f64>,
    model: Option<f64>,
    rest: MeshMaterial,
}

/// Reads a library, adding its materials to `found`.
pub(super) fn read(bytes: &[u8], found: &mut Vec<MeshMaterial>) -> Result<(), ImportError> {
    let mut entry: Option<Entry> = None;
    for line in lines(bytes) {
        let line = line.as_line();
        if line.keyword == "newmtl" {
            found.extend(entry.take().map(finished));
            entry = Some(Entry {
                name: line.rest.to_owned(),
                ..Entry::default()
            });
        } else if let Some(entry) = &mut entry {
            read_line(&line, entry)?;
        }
    }
    found.extend(entry.map(finished));
    Ok(())
}

fn read_line(line: &Line<'_>, entry: &mut Entry) -> Result<(), ImportError> {
    let rest = &mut entry.rest;
    match line.keyword {
        "Kd" => entry.diffuse = Some(color(line)?),
        "Ks" => entry.specular = Some(color(line)?),
        "Ke" => rest.emission = color(line)?,
        "Ns" => entry.exponent = Some(line.numbers::<1>()?[0]),
        "Ni" => [rest.ior] = line.numbers()?,
        "d" => [rest.alpha] = line.numbers()?,
        "Tr" => rest.alpha = 1.0 - line.numbers::<1>()?[0],
        "Pr" => entry.roughness = Some(line.numbers::<1>()?[0]),
        "Pm" => entry.metallic = Some(line.numbers::<1>()?[0]),
        "illum" => entry.model = Some(line.numbers::<1>()?[0]),
        "map_Kd" => rest.look = texture(line)?,
        "map_d" => rest.holes = texture(line)?.map_or(MeshHoles::Alpha, MeshHoles::Image),
        _ => {}
    }
    Ok(())
}

/// An image with the options in front of its name: `-s u v w` repeats it, `-o u v w` moves it, `-clamp on` ends it at its
/// edges. Other options, which end at the next word with a `-` or with the last word, are not looked at.
fn texture(line: &Line<'_>) -> Result<Option<MeshTexture>, ImportError> {
    let mut words = line.rest.split_whitespace().peekable();
    let (mut scale, mut offset, mut wrap) = (DVec2::ONE, DVec2::ZERO, MeshWrap::Repeat);
    let mut name = line.rest;
    if line.rest.starts_with('-') {
        name = line.rest.split_whitespace().last().unwrap_or_default();
    }
    while let Some(option) = words.next_if(|word| word.starts_with('-')) {
        let mut numbers = vec![];
        while let Some(Ok(number)) = words.peek().map(|word| word.parse::<f64>()) {
            numbers.push(number);
            words.next();
        }
        let of = |default: f64| {
            let at = |i: usize| numbers.get(i).copied().unwrap_or(default);
            DVec2::new(at(0), at(1))
        };
        match option {
            "-s" => scale = of(1.0),
            "-o" => offset = of(0.0),
            "-clamp" if words.next() == Some("on") => wrap = MeshWrap::Clamp,
            _ if numbers.is_empty() => {
                words.next();
            }
            _ => {}
        }
    }
    if !(scale.is_finite() && offset.is_finite()) {
        return Err(line.wrong("a picture is repeated or moved by what is no number"));
    }
    let image = MeshImage::File(name.replace('\\', "/"));
    Ok((!name.is_empty()).then(|| MeshTexture {
        map: DAffine2::from_scale_angle_translation(scale, 0.0, offset),
        wrap: [wrap; 2],
        ..MeshTexture::new(image)
    }))
}

/// Three numbers, or one for all three. Spectra and CIE colours are not read.
fn color(line: &Line<'_>) -> Result<[f64; 3], ImportError> {
    if line.rest.starts_with("spectral") || line.rest.starts_with("xyz") {
        return Err(line.wrong("colours are read as three numbers only"));
    }
    if line.rest.split_whitespace().count() == 1 {
        return Ok([line.numbers::<1>()?[0]; 3]);
    }
    line.numbers()
}

fn finished(entry: Entry) -> MeshMaterial {
    let is_mirror = entry
        .model
        .is_some_and(|model| [3.0, 5.0, 8.0].contains(&model));
    let gloss = entry.specular.unwrap_or([0.0; 3]);
    let has_gloss = gloss.iter().any(|part| *part > 0.0);
    let diffuse = entry.diffuse.unwrap_or([1.0; 3]);
    let is_metal = is_mirror && has_gloss && diffuse.iter().all(|part| *part <= 0.0);
    // The lobe of a Phong exponent n is about as wide as that of roughness (2 / (n + 2))^(1/4).
    let from_exponent = || match entry.exponent {
        _ if is_mirror => 0.0,
        Some(exponent) if has_gloss => (2.0 / (exponent.max(0.0) + 2.0)).sqrt().sqrt(),
        _ => 1.0,
    };
    MeshMaterial {
        name: entry.name,
        base_color: if is_metal { gloss } else { diffuse },
        metallic: entry.metallic.unwrap_or(f64::from(u8::from(is_metal))),
        roughness: entry.roughness.unwrap_or_else(from_exponent),
        ..entry.rest
    }
    .tidied()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn library(text: &str) -> Vec<MeshMaterial> {
        let mut found = vec![];
        read(text.as_bytes(), &mut found).unwrap();
        found
    }

    #[test]
    fn materials_are_what_the_library_says() {
        let text = "Kd 9 9 9\nnewmtl moss \nKd 0.1 0.4 0.05 # green\nd 0.5\nKe 0 2 0\nmap_Kd -s 2 2 1 img\\moss.png\n\
                    newmtl chrome\r\nKd 0\r\nKs 0.9 0.8 0.7\r\nillum 3\r\nnewmtl paint\nTr 0.25\nKs 0.5\nNs 98\nPm 0.5\n";
        let [moss, chrome, paint] = library(text).try_into().unwrap();
        assert_eq!((moss.name.as_str(), moss.alpha), ("moss", 0.5));
        assert_eq!(moss.base_color, [0.1, 0.4, 0.05]);
        assert_eq!(moss.emission, [0.0, 2.0, 0.0]);
        let look = moss.look.as_ref().unwrap();
        assert_eq!(look.image, MeshImage::File("img/moss.png".into()));
        assert_eq!(look.map.transform_point2(DVec2::ONE), DVec2::new(2.0, 2.0));
        assert_eq!((chrome.base_color, chrome.metallic), ([0.9, 0.8, 0.7], 1.0));
        assert_eq!((chrome.roughness, moss.roughness), (0.0, 1.0));
        assert_eq!((paint.alpha, paint.metallic), (0.75, 0.5));
        assert!((paint.roughness - 0.02_f64.sqrt().sqrt()).abs() < 1e-12);
    }

    #[test]
    fn wrong_numbers_are_told_or_brought_into_range() {
        let mut found = vec![];
        let fault = read(b"newmtl a\nKd 1 2\n", &mut found).unwrap_err();
        assert!(fault.to_string().starts_with("line 2: "), "{fault}");
        let [wild] = library("newmtl a\nKd 5 -1 0.5\nd 7\nNi 0\nKe -3 inf nan")
            .try_into()
            .unwrap();
        assert_eq!(wild.base_color, [1.0, 0.0, 0.5]);
        assert_eq!((wild.alpha, wild.ior), (1.0, 1.5));
        assert_eq!(wild.emission, [0.0; 3]);
    }
}
