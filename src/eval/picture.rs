//! Colours and pictures that shaders of a model are made of. Files are named here and read where the model is drawn.

use std::sync::Arc;

/// What a channel of a shader was given.
#[derive(Clone, Debug, PartialEq)]
pub enum Paint {
    /// One colour: linear red, green, blue.
    Plain([f64; 3]),
    /// A picture.
    Picture(Arc<Picture>),
}

/// A picture over a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// What it shows.
    pub of: PictureOf,
    /// How it lies on the surface.
    pub lies: Placement,
    /// Whether what is between its pixels is their mean in proportion to distance.
    pub is_smooth: bool,
    /// What its colours are multiplied with.
    pub tint: [f64; 3],
}

/// What a picture shows.
#[derive(Clone, Debug, PartialEq)]
pub enum PictureOf {
    /// Nothing yet: half gray.
    Nothing,
    /// The file of this name.
    File(Arc<str>),
    /// The picture that a GroIMP project calls so, if a file of that name is [there](candidates).
    Named(Arc<str>),
    /// Two by two fields of two colours; the first is at the upper left and the lower right.
    Checker([[f64; 3]; 2]),
}

/// How a picture lies on texture coordinates, as GroIMP's `AffineUVTransformation` says it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Where its lower left corner lies.
    pub offset: [f64; 2],
    /// How often it stands side by side, and one above the other, over 0..=1.
    pub scale: [f64; 2],
    /// By how much it is turned, radians.
    pub angle: f64,
    /// By how much it is slanted.
    pub shear: f64,
}

impl Default for Placement {
    fn default() -> Self {
        Self {
            offset: [0.0; 2],
            scale: [1.0; 2],
            angle: 0.0,
            shear: 0.0,
        }
    }
}

impl Picture {
    /// The picture as it is, over all of the surface.
    pub fn new(of: PictureOf) -> Self {
        Self {
            of,
            lies: Placement::default(),
            is_smooth: true,
            tint: [1.0; 3],
        }
    }

    /// What a model calls `name`: a file if the name ends like that of one, otherwise a picture of a GroIMP project.
    pub fn called(name: &str) -> Self {
        let is_file = has_suffix(name) || name.contains(['/', '\\']);
        Self::new(if is_file {
            PictureOf::File(name.into())
        } else {
            PictureOf::Named(name.into())
        })
    }

    /// The same, all colours multiplied by a number.
    pub fn times(&self, factor: f64) -> Self {
        Self {
            tint: self.tint.map(|part| part * factor),
            ..self.clone()
        }
    }
}

/// Ends of names of picture files.
pub const SUFFIXES: [&str; 3] = ["png", "jpg", "jpeg"];

/// Folders of a project in which pictures stand.
const FOLDERS: [&str; 3] = ["", "images/", "textures/"];

fn has_suffix(name: &str) -> bool {
    let suffix = name.rsplit_once('.').map_or("", |(_, suffix)| suffix);
    SUFFIXES
        .iter()
        .any(|known| suffix.eq_ignore_ascii_case(known))
}

/// The files that may be the picture that a GroIMP project calls `name`, in the order in which they are tried.
pub fn candidates(name: &str) -> impl Iterator<Item = String> {
    FOLDERS.iter().flat_map(move |folder| {
        let suffixes = SUFFIXES.iter();
        suffixes.map(move |suffix| format!("{folder}{name}.{suffix}"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_that_of_a_file_if_it_ends_like_one() {
        assert_eq!(Picture::called("a.PNG").of, PictureOf::File("a.PNG".into()));
        assert_eq!(Picture::called("img/a").of, PictureOf::File("img/a".into()));
        assert_eq!(Picture::called("a.b").of, PictureOf::Named("a.b".into()));
        assert!(candidates("leaf").any(|file| file == "images/leaf.png"));
        assert_eq!(candidates("leaf").next().as_deref(), Some("leaf.png"));
    }
}
