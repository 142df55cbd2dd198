//! Pictures on surfaces: how an [`Image`] lies over texture coordinates, and what it changes of a material.
//!
//! Texture coordinates run to the right (u) and upwards (v) over the picture, whose lower left corner is (0, 0) and whose
//! upper right corner is (1, 1); outside of that it goes on as its [`Wrap`] says.

use super::image::Image;
use super::{Material, Optics, Scattering, Side};
use crate::color::Rgb;
use crate::math::functions::sin_cos;
use glam::{DAffine2, DMat2, DVec2};
use std::sync::Arc;

/// How many pictures may lie over one another on a surface, and how many may cut holes in it.
pub const MAX_PICTURES: usize = 8;

/// How a picture goes on beyond its edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// Again and again.
    #[default]
    Repeat,
    /// With the colour of its edge.
    Clamp,
    /// Again and again, each time turned over.
    Mirror,
}

/// What is taken between the middles of texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// What lies between the four nearest, in proportion to distance.
    #[default]
    Bilinear,
    /// The nearest.
    Nearest,
}

/// An image and how it lies on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// The image.
    pub image: Arc<Image>,
    /// From the texture coordinates of the surface to those of the picture.
    pub map: DAffine2,
    /// How it goes on beyond its edges: along u, along v.
    pub wrap: [Wrap; 2],
    /// What is taken between its texels.
    pub filter: Filter,
    /// Coverage from which on the surface is there, and below which it is not; without it, coverage counts as it is.
    pub cutoff: Option<f64>,
}

/// Light that a surface scatters in the colours of a picture: what the picture shows at a point, times these factors, is added
/// to the matt part.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// The picture.
    pub texture: Texture,
    /// Factors of its colours: front, back.
    pub sides: [Side; 2],
}

/// The pictures on a surface; at most [`MAX_PICTURES`] of either kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pictures {
    /// What they add to the matt part.
    pub layers: Vec<Layer>,
    /// Whose coverages are multiplied with the alpha of the surface.
    pub holes: Vec<Texture>,
}

/// A placement of pictures as GroIMP's `AffineUVTransformation` has it: moved by `-offset`, turned by `-angle` (radians), then
/// scaled and slanted: u' = `scale.x` u − `shear` `scale.y` v, v' = `scale.y` v.
#[must_use]
pub fn placement(offset: DVec2, angle: f64, scale: DVec2, shear: f64) -> DAffine2 {
    let (sin, cos) = sin_cos(-angle);
    let turn = DMat2::from_cols(DVec2::new(cos, sin), DVec2::new(-sin, cos));
    let stretch = DMat2::from_cols(
        DVec2::new(scale.x, 0.0),
        DVec2::new(-shear * scale.y, scale.y),
    );
    DAffine2::from_mat2(stretch * turn) * DAffine2::from_translation(-offset)
}

impl Texture {
    /// The image as it lies on the texture coordinates themselves, repeated.
    #[must_use]
    pub fn new(image: Arc<Image>) -> Self {
        Self {
            image,
            map: DAffine2::IDENTITY,
            wrap: [Wrap::Repeat; 2],
            filter: Filter::Bilinear,
            cutoff: None,
        }
    }

    /// Linear colour and coverage (0..=1) at texture coordinates of the surface; black where it does not cover at all.
    #[must_use]
    pub fn at(&self, uv: DVec2) -> (Rgb, f64) {
        let at = self.map.transform_point2(uv);
        let at = if at.is_finite() { at } else { DVec2::ZERO };
        let size = DVec2::new(
            f64::from(self.image.width()),
            f64::from(self.image.height()),
        );
        let inside = DVec2::new(wrapped(at.x, self.wrap[0]), wrapped(at.y, self.wrap[1])) * size;
        match self.filter {
            Filter::Nearest => {
                let [x, y] = inside.floor().to_array().map(|x| x as i64);
                let (color, coverage) = self.texel(x, y);
                if coverage > 0.0 {
                    (color, coverage)
                } else {
                    (Rgb::BLACK, 0.0)
                }
            }
            Filter::Bilinear => self.between(inside - 0.5),
        }
    }

    /// Coverage (0..=1) at texture coordinates of the surface, after the cutoff.
    #[must_use]
    pub fn coverage(&self, uv: DVec2) -> f64 {
        let (_, coverage) = self.at(uv);
        match self.cutoff {
            Some(cutoff) => f64::from(u8::from(coverage >= cutoff)),
            None => coverage,
        }
    }

    /// Between the middles of four texels. Colours count in proportion to their coverage, so that what colour a picture has
    /// where it is not does not show at its edges.
    fn between(&self, at: DVec2) -> (Rgb, f64) {
        let low = at.floor();
        let share = at - low;
        let [x, y] = low.to_array().map(|x| x as i64);
        let (mut color, mut coverage) = (Rgb::BLACK, 0.0);
        for (dx, of_x) in [(0, 1.0 - share.x), (1, share.x)] {
            for (dy, of_y) in [(0, 1.0 - share.y), (1, share.y)] {
                let (texel, alpha) = self.texel(x + dx, y + dy);
                let weight = of_x * of_y * alpha;
                color += texel * weight;
                coverage += weight;
            }
        }
        if coverage > 0.0 {
            // The weights of an opaque picture add up to 1, give or take a rounding.
            (color / coverage, coverage.min(1.0))
        } else {
            (Rgb::BLACK, 0.0)
        }
    }

    /// The texel in column x from the left and row y from below, at most one beyond the edges.
    fn texel(&self, x: i64, y: i64) -> (Rgb, f64) {
        let column = index(x, self.image.width(), self.wrap[0]);
        let row = index(y, self.image.height(), self.wrap[1]);
        self.image.texel(column, self.image.height() - 1 - row)
    }
}

/// A coordinate of any size, brought into 0..=1.
fn wrapped(x: f64, wrap: Wrap) -> f64 {
    match wrap {
        Wrap::Repeat => x - x.floor(),
        Wrap::Clamp => x.clamp(0.0, 1.0),
        Wrap::Mirror => {
            let twice = x - 2.0 * (0.5 * x).floor();
            twice.min(2.0 - twice)
        }
    }
}

/// A number of a row or column, brought into `0..size`; what is beyond an edge is its neighbour's there.
fn index(x: i64, size: u32, wrap: Wrap) -> u32 {
    let last = i64::from(size) - 1;
    let inside = match wrap {
        Wrap::Repeat if x < 0 => last,
        Wrap::Repeat if x > last => 0,
        _ => x.clamp(0, last),
    };
    inside as u32
}

impl Layer {
    /// The layer with its factors scaled by one number for the front and one for the back.
    fn scaled(&self, shares: [f64; 2]) -> Self {
        let side = |at: usize| Side {
            reflectance: self.sides[at].reflectance * shares[at],
            transmittance: self.sides[at].transmittance * shares[at],
        };
        Self {
            texture: self.texture.clone(),
            sides: [side(0), side(1)],
        }
    }
}

impl Pictures {
    /// The pictures of two parts of a surface together, each scaled as [`Layer::scaled`] says. Where either has a hole, so
    /// has the whole.
    pub(super) fn joined(parts: [(&Material, [f64; 2]); 2]) -> Option<Box<Self>> {
        let mut all = Self::default();
        for (material, shares) in parts {
            let Some(pictures) = &material.pictures else {
                continue;
            };
            for layer in &pictures.layers {
                let layer = layer.scaled(shares);
                let is_same = |known: &&mut Layer| known.texture.is_same(&layer.texture);
                match all.layers.iter_mut().find(is_same) {
                    Some(known) => known.add(&layer.sides),
                    None => all.layers.push(layer),
                }
            }
            for hole in &pictures.holes {
                if !all.holes.iter().any(|known| known.is_same(hole)) {
                    all.holes.push(hole.clone());
                }
            }
        }
        let is_empty = all.layers.is_empty() && all.holes.is_empty();
        (!is_empty).then(|| Box::new(all))
    }
}

impl Layer {
    fn add(&mut self, more: &[Side; 2]) {
        for (side, more) in self.sides.iter_mut().zip(more) {
            side.reflectance += more.reflectance;
            side.transmittance += more.transmittance;
        }
    }
}

impl Texture {
    /// Whether it is the same picture, lying the same way.
    fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.image, &other.image)
            && (self.map, self.wrap, self.filter) == (other.map, other.wrap, other.filter)
            && self.cutoff == other.cutoff
    }
}

impl Material {
    /// What it does to light at a point with these texture coordinates.
    #[inline]
    #[must_use]
    pub fn optics_at(&self, uv: DVec2) -> Optics<'_> {
        match &self.pictures {
            None => self.optics(),
            Some(pictures) => self.pictured(pictures, uv),
        }
    }

    /// Fraction of the light at texture coordinates that meets the surface at all.
    #[inline]
    #[must_use]
    pub fn alpha_at(&self, uv: DVec2) -> f64 {
        let holes = self.pictures.iter().flat_map(|pictures| &pictures.holes);
        holes.fold(self.alpha, |alpha, hole| alpha * hole.coverage(uv))
    }

    /// Whether pictures cut holes in it.
    #[inline]
    #[must_use]
    pub fn has_holes(&self) -> bool {
        let pictures = self.pictures.as_ref();
        pictures.is_some_and(|pictures| !pictures.holes.is_empty())
    }

    /// The matt part in the mean colours of its pictures: front, back.
    #[must_use]
    pub fn mean_sides(&self) -> [Side; 2] {
        self.with_colors(|texture| texture.image.mean())
    }

    /// The matt part at most, in the largest values of its pictures: front, back.
    #[must_use]
    pub fn most_sides(&self) -> [Side; 2] {
        self.with_colors(|texture| texture.image.most())
    }

    fn pictured<'m>(&'m self, pictures: &'m Pictures, uv: DVec2) -> Optics<'m> {
        // A colour and its coverage usually come from one picture: it is looked at once.
        let mut alpha = self.alpha;
        let mut sides = self.sides;
        let mut is_cut = [false; MAX_PICTURES];
        for layer in &pictures.layers {
            let (color, coverage) = layer.texture.at(uv);
            add_layer(&mut sides, layer, color);
            let hole = pictures.holes.iter().take(MAX_PICTURES);
            let same = hole.clone().position(|hole| hole.is_same(&layer.texture));
            if let Some(same) = same.filter(|same| !is_cut[*same] && layer.texture.cutoff.is_none())
            {
                is_cut[same] = true;
                alpha *= coverage;
            }
        }
        for (hole, is_cut) in pictures.holes.iter().zip(is_cut) {
            if !is_cut {
                alpha *= hole.coverage(uv);
            }
        }
        Optics {
            scattering: Scattering {
                sides,
                lobes: &self.lobes,
            },
            alpha,
            emission: self.emission,
        }
    }

    /// The matt part, with one colour for each picture.
    fn with_colors(&self, color: impl Fn(&Texture) -> Rgb) -> [Side; 2] {
        let mut sides = self.sides;
        let layers = self.pictures.iter().flat_map(|pictures| &pictures.layers);
        for layer in layers {
            add_layer(&mut sides, layer, color(&layer.texture));
        }
        sides
    }
}

#[inline]
fn add_layer(sides: &mut [Side; 2], layer: &Layer, color: Rgb) {
    for (side, factor) in sides.iter_mut().zip(&layer.sides) {
        side.reflectance += factor.reflectance * color;
        side.transmittance += factor.transmittance * color;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// Two columns, two rows: red, green above blue, white.
    fn four() -> Texture {
        let row = |texels: [[f32; 3]; 2]| texels.map(|[r, g, b]| [r, g, b, 1.0]);
        let texels = [
            row([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
            row([[0.0, 0.0, 1.0], [1.0, 1.0, 1.0]]),
        ];
        Texture::new(Arc::new(Image::linear(2, 2, texels.concat()).unwrap()))
    }

    fn color(texture: &Texture, u: f64, v: f64) -> [f64; 3] {
        texture.at(DVec2::new(u, v)).0.to_array()
    }

    #[test]
    fn u_runs_right_and_v_upwards() {
        let four = four();
        assert_eq!(color(&four, 0.25, 0.25), [0.0, 0.0, 1.0]);
        assert_eq!(color(&four, 0.75, 0.25), [1.0; 3]);
        assert_eq!(color(&four, 0.25, 0.75), [1.0, 0.0, 0.0]);
        assert_eq!(color(&four, 0.75, 0.75), [0.0, 1.0, 0.0]);
    }

    #[test]
    fn what_is_between_texels_is_the_mean_in_proportion() {
        let mut four = four();
        assert_eq!(color(&four, 0.5, 0.5), [0.5, 0.5, 0.5]);
        assert_eq!(color(&four, 0.375, 0.25), [0.25, 0.25, 1.0]);
        // Repeated, the column left of the first is the last.
        assert_eq!(color(&four, 0.0, 0.25), [0.5, 0.5, 1.0]);
        assert_eq!(color(&four, 7.0, -0.75), [0.5, 0.5, 1.0]);
        four.wrap = [Wrap::Clamp; 2];
        assert_eq!(color(&four, -3.0, 0.25), [0.0, 0.0, 1.0]);
        assert_eq!(color(&four, 9.0, 9.0), [0.0, 1.0, 0.0]);
        four.wrap = [Wrap::Mirror; 2];
        assert_eq!(color(&four, 1.25, 0.25), [1.0; 3]);
        assert_eq!(color(&four, -0.25, 2.25), [0.0, 0.0, 1.0]);
        four.filter = Filter::Nearest;
        assert_eq!(color(&four, 0.49, 0.51), [1.0, 0.0, 0.0]);
        assert_eq!(color(&four, f64::NAN, f64::INFINITY), [0.0, 0.0, 1.0]);
        assert_eq!(color(&four, 1.0, 1.0), [0.0, 1.0, 0.0]);
    }

    #[test]
    fn what_is_not_there_has_no_colour() {
        let texels = vec![[0.5, 0.5, 0.5, 1.0], [9.0, 9.0, 9.0, 0.0]];
        let mut edge = Texture::new(Arc::new(Image::linear(2, 1, texels).unwrap()));
        let (color, coverage) = edge.at(DVec2::new(0.5, 0.5));
        assert_eq!((color, coverage), (Rgb::splat(0.5), 0.5));
        edge.filter = Filter::Nearest;
        assert_eq!(edge.at(DVec2::new(0.75, 0.5)), (Rgb::BLACK, 0.0));
        assert_eq!(edge.at(DVec2::new(0.25, 0.5)).1, 1.0);
        edge.filter = Filter::Bilinear;
        edge.cutoff = Some(0.6);
        assert_eq!(edge.coverage(DVec2::new(0.5, 0.5)), 0.0);
        assert_eq!(edge.coverage(DVec2::new(0.3, 0.5)), 1.0);
    }

    #[test]
    fn placements_are_those_of_groimp() {
        let map = placement(DVec2::new(1.0, 2.0), 0.0, DVec2::new(3.0, 4.0), 0.0);
        assert_eq!(
            map.transform_point2(DVec2::new(2.0, 3.0)),
            DVec2::new(3.0, 4.0)
        );
        let turned = placement(DVec2::ZERO, FRAC_PI_2, DVec2::ONE, 0.0);
        let (u, v) = (
            turned.transform_point2(DVec2::X),
            turned.transform_point2(DVec2::Y),
        );
        assert!((u + DVec2::Y).length() < 1e-15 && (v - DVec2::X).length() < 1e-15);
        let slanted = placement(DVec2::ZERO, 0.0, DVec2::new(1.0, 2.0), 0.5);
        assert_eq!(slanted.transform_point2(DVec2::Y), DVec2::new(-1.0, 2.0));
    }

    fn leaf_of(texture: &Texture, factor: f64) -> Material {
        let side = Side {
            reflectance: Rgb::splat(factor),
            transmittance: Rgb::BLACK,
        };
        Material {
            pictures: Some(Box::new(Pictures {
                layers: vec![Layer {
                    texture: texture.clone(),
                    sides: [side; 2],
                }],
                holes: vec![texture.clone()],
            })),
            ..Material::matt([Side::default(); 2])
        }
    }

    #[test]
    fn parts_of_a_surface_keep_their_pictures() {
        let texture = four();
        let plain = Material::lambert(Rgb::splat(0.2));
        let half = Material::mixed(&leaf_of(&texture, 0.8), &plain, 0.5);
        let optics = half.optics_at(DVec2::new(0.25, 0.25));
        let [front, back] = optics.scattering.sides;
        assert_eq!(front, back);
        assert!(
            (front.reflectance - Rgb::new(0.1, 0.1, 0.5))
                .max_channel()
                .abs()
                < 1e-15
        );
        let coin = Material::two_sided(&leaf_of(&texture, 0.8), &plain);
        let [front, back] = coin.optics_at(DVec2::new(0.25, 0.25)).scattering.sides;
        assert_eq!(front.reflectance, Rgb::new(0.0, 0.0, 0.8));
        assert_eq!(back.reflectance, Rgb::splat(0.2));
        assert!(coin.has_holes());
        let mean = coin.mean_sides()[0].reflectance;
        assert!((mean - Rgb::splat(0.4)).max_channel().abs() < 1e-7);
        // A picture that is mixed with itself is one.
        let same = Material::mixed(&leaf_of(&texture, 0.4), &leaf_of(&texture, 0.8), 0.5);
        assert_eq!(same.pictures.as_ref().unwrap().layers.len(), 1);
        assert!((same.claim(true).max_channel() - 0.6).abs() < 1e-12);
        // One that lies otherwise, is repeated otherwise or has another filter or cutoff is another one.
        let other = |change: &dyn Fn(&mut Texture)| {
            let mut other = texture.clone();
            change(&mut other);
            let mixed = Material::mixed(&leaf_of(&texture, 0.4), &leaf_of(&other, 0.8), 0.5);
            let pictures = mixed.pictures.unwrap();
            (pictures.layers.len(), pictures.holes.len())
        };
        assert_eq!(other(&|_| {}), (1, 1));
        assert_eq!(
            other(&|t| t.map = DAffine2::from_scale(DVec2::splat(2.0))),
            (2, 2)
        );
        assert_eq!(other(&|t| t.wrap[1] = Wrap::Clamp), (2, 2));
        assert_eq!(other(&|t| t.filter = Filter::Nearest), (2, 2));
        assert_eq!(other(&|t| t.cutoff = Some(0.5)), (2, 2));
    }
}
