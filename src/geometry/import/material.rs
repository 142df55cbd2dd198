//! What files of meshes say about surfaces.

use glam::DAffine2;
use std::sync::Arc;

/// A surface as a file of meshes describes it: the metallic-roughness model of glTF. Numbers are finite and within their
/// ranges.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshMaterial {
    /// Its name in the file.
    pub name: String,
    /// Reflectance of the matt part, and colour of the mirror image in metals; linear, 0..=1.
    pub base_color: [f64; 3],
    /// Fraction of the light that meets the surface at all, 0..=1.
    pub alpha: f64,
    /// Radiance that it sends out, W/(m² sr), at least 0.
    pub emission: [f64; 3],
    /// 0 for everything else, 1 for metals.
    pub metallic: f64,
    /// 0 for mirrors, 1 for matt surfaces.
    pub roughness: f64,
    /// Fraction of the light that is refracted into it rather than scattered, 0..=1.
    pub transmission: f64,
    /// Index of refraction, at least 1.
    pub ior: f64,
    /// The image that is multiplied with the base colour, if there is one.
    pub look: Option<MeshTexture>,
    /// What of the image, or of another one, cuts holes.
    pub holes: MeshHoles,
}

/// An image and how it lies on a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshTexture {
    /// The image.
    pub image: MeshImage,
    /// From the texture coordinates of the mesh to those of the image.
    pub map: DAffine2,
    /// How it goes on beyond its edges: along u, along v.
    pub wrap: [MeshWrap; 2],
    /// Whether what is between its pixels is the nearest of them.
    pub is_nearest: bool,
}

/// How an image goes on beyond its edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MeshWrap {
    /// Again and again.
    #[default]
    Repeat,
    /// With the colour of its edge.
    Clamp,
    /// Again and again, each time turned over.
    Mirror,
}

/// What cuts holes in a surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum MeshHoles {
    /// Nothing.
    Never,
    /// The alpha of the image of its colour.
    #[default]
    Alpha,
    /// That alpha: below this, it is a hole, from it on, there is none.
    Below(f64),
    /// Another image: its alpha if that varies, its brightness otherwise.
    Image(MeshTexture),
}

impl MeshTexture {
    /// An image as it is, repeated.
    #[must_use]
    pub fn new(image: MeshImage) -> Self {
        Self {
            image,
            map: DAffine2::IDENTITY,
            wrap: [MeshWrap::Repeat; 2],
            is_nearest: false,
        }
    }
}

/// An image that a material names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MeshImage {
    /// A file beside the mesh file, by the name given there.
    File(String),
    /// The content of a PNG or JPEG file.
    Content(Arc<[u8]>),
}

impl Default for MeshMaterial {
    /// White, matt, opaque.
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: [1.0; 3],
            alpha: 1.0,
            emission: [0.0; 3],
            metallic: 0.0,
            roughness: 1.0,
            transmission: 0.0,
            ior: 1.5,
            look: None,
            holes: MeshHoles::Alpha,
        }
    }
}

impl MeshMaterial {
    /// Brings every number into its range; what is no number becomes the default.
    pub(super) fn tidied(mut self) -> Self {
        let plain = Self::default();
        let share = |x: f64, default: f64| {
            if x.is_nan() {
                default
            } else {
                x.clamp(0.0, 1.0)
            }
        };
        self.base_color = self.base_color.map(|x| share(x, 1.0));
        self.alpha = share(self.alpha, plain.alpha);
        self.metallic = share(self.metallic, plain.metallic);
        self.roughness = share(self.roughness, plain.roughness);
        self.transmission = share(self.transmission, plain.transmission);
        let radiance = |x: f64| if x.is_finite() { x.max(0.0) } else { 0.0 };
        self.emission = self.emission.map(radiance);
        if !self.ior.is_finite() || self.ior < 1.0 {
            self.ior = plain.ior;
        }
        self
    }
}
