//! The sky made ready for rendering: its radiance in every direction, and directions chosen where it is bright.

use super::clear_sky::ClearSky;
use super::environment::OVERCAST_IRRADIANCE;
use super::sky_image::SkyImage;
use super::sky_table::SkyTable;
use super::{Environment, LightSample, Sky};
use crate::color::Rgb;
use crate::math::angle::Angle;
use crate::math::sum::Sum;
use crate::math::warp;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_1_PI, PI, TAU};
use std::sync::Arc;

/// Rows of the sampling table of a sky that is given by a formula, equal steps of the height z: equal solid angles.
const ROWS: usize = 64;

/// Columns of that table, equal steps of azimuth.
const COLUMNS: usize = 256;

/// Rows of the sampling table of a picture, at most; it has twice as many columns.
const IMAGE_ROWS: usize = 512;

/// How much of a pixel's light linear interpolation brings to the halves of pixels round its middle, along one axis: where the
/// middle of the half lies, in pixels, and its share.
const SPREAD: [(f64, f64); 4] = [(-0.75, 0.125), (-0.25, 0.375), (0.25, 0.375), (0.75, 0.125)];

/// The sky, ready to be looked at and sampled.
#[derive(Clone, Debug)]
pub struct Dome {
    content: Content,
}

#[derive(Clone, Debug)]
enum Content {
    Dark,
    Uniform(Rgb),
    /// A sky above the horizon, land below it.
    Landscape(Box<Landscape>),
    Image(Box<Panorama>),
}

#[derive(Clone, Debug)]
struct Landscape {
    above: Above,
    /// Radiance of the ground that is seen below the horizon.
    ground: Rgb,
    /// ∫ L cos θ dω over the sky without the sun.
    irradiance: Rgb,
    table: SkyTable,
}

/// Skies that are given by a formula.
#[derive(Clone, Debug)]
enum Above {
    /// Its brightness as a multiple of the natural one.
    Clear(Box<ClearSky>, f64),
    /// Radiance of the zenith.
    Overcast(Rgb),
}

#[derive(Clone, Debug)]
struct Panorama {
    image: Arc<SkyImage>,
    turn: Angle,
    strength: f64,
    /// ∫ L cos θ dω over the upper half.
    irradiance: Rgb,
    /// ¼ ∫ L dω over all directions.
    mean_irradiance: Rgb,
    /// In the picture's own directions.
    table: SkyTable,
}

impl Above {
    /// Radiance from a direction above the horizon.
    fn radiance(&self, w: DVec3) -> Rgb {
        match self {
            Self::Clear(sky, strength) => sky.radiance(w) * *strength,
            Self::Overcast(zenith) => *zenith * ((1.0 + 2.0 * w.z) / 3.0),
        }
    }
}

impl Landscape {
    /// The sky with the ground under it, which the sun lights too.
    fn new(above: Above, ground_albedo: Rgb, environment: &Environment) -> Self {
        // Two by two directions per cell.
        let cell_solid_angle = TAU / (ROWS * COLUMNS) as f64;
        let mut irradiance = [Sum::ZERO; 3];
        let mut cells = vec![0.0; ROWS * COLUMNS];
        for (i, cell) in cells.iter_mut().enumerate() {
            for (dz, dphi) in [(0.25, 0.25), (0.25, 0.75), (0.75, 0.25), (0.75, 0.75)] {
                let z = ((i / COLUMNS) as f64 + dz) / ROWS as f64;
                let w = warp::direction(z, ((i % COLUMNS) as f64 + dphi) / COLUMNS as f64);
                let radiance = above.radiance(w) * 0.25;
                *cell += radiance.mean();
                for (sum, value) in irradiance.iter_mut().zip(radiance.to_array()) {
                    sum.add(value * w.z * cell_solid_angle);
                }
            }
        }
        let irradiance = match &above {
            Above::Overcast(zenith) => *zenith * OVERCAST_IRRADIANCE,
            Above::Clear(..) => Rgb::from_array(irradiance.map(|sum| sum.value())),
        };
        let sun = environment.sun.as_ref();
        let direct = sun.map_or(Rgb::BLACK, |s| s.irradiance * s.to_sun.z.max(0.0));
        let edges = (0..=ROWS).map(|row| row as f64 / ROWS as f64).collect();
        Self {
            above,
            ground: ground_albedo * (irradiance + direct) * FRAC_1_PI,
            irradiance,
            table: SkyTable::new(edges, cells),
        }
    }
}

impl Panorama {
    fn new(image: Arc<SkyImage>, turn: Angle, strength: f64) -> Self {
        let (width, height) = (image.width(), image.height());
        let rows = (2 * height).min(IMAGE_ROWS);
        let columns = 2 * rows;
        let mut cells = vec![0.0; rows * columns];
        let mut irradiance = [Sum::ZERO; 3];
        let mut flux = [Sum::ZERO; 3];
        for y in 0..height {
            // The band of directions that a row of pixels covers.
            let (upper, lower) = (edge_height(y, height), edge_height(y + 1, height));
            let solid_angle = (upper - lower) * TAU / width as f64;
            let facing = (upper.max(0.0).powi(2) - lower.max(0.0).powi(2)) * PI / width as f64;
            for x in 0..width {
                let value = image.pixel(x as isize, y as isize) * strength;
                for (at, channel) in value.to_array().into_iter().enumerate() {
                    irradiance[at].add(channel * facing);
                    flux[at].add(channel * solid_angle);
                }
                // Linear interpolation spreads a pixel over the halves of pixels round its middle.
                for (dy, share_y) in SPREAD {
                    for (dx, share_x) in SPREAD {
                        let to_x = (x as f64 + 0.5 + dx) / width as f64;
                        let to_y = (y as f64 + 0.5 + dy).clamp(0.0, height as f64 - 0.5);
                        // Rows of the table run from the nadir up, columns from +x towards +y.
                        let row = rows - 1 - (to_y / height as f64 * rows as f64) as usize;
                        let turn = (0.75 - to_x).rem_euclid(1.0);
                        let column = ((turn * columns as f64) as usize).min(columns - 1);
                        cells[row * columns + column] +=
                            value.mean() * solid_angle * share_x * share_y;
                    }
                }
            }
        }
        let edges: Vec<f64> = (0..=rows).map(|row| -edge_height(row, rows)).collect();
        // The table wants radiances, the means over its cells.
        for (row, band) in cells.chunks_mut(columns).enumerate() {
            for cell in band {
                *cell /= (edges[row + 1] - edges[row]) * TAU / columns as f64;
            }
        }
        Self {
            image,
            turn,
            strength,
            irradiance: Rgb::from_array(irradiance.map(|sum| sum.value())),
            mean_irradiance: Rgb::from_array(flux.map(|sum| sum.value() * 0.25)),
            table: SkyTable::new(edges, cells),
        }
    }

    /// The picture's own direction of a direction of the world.
    fn in_picture(&self, w: DVec3) -> DVec3 {
        let (sin, cos) = (self.turn.sin(), self.turn.cos());
        DVec3::new(cos * w.x + sin * w.y, cos * w.y - sin * w.x, w.z)
    }

    fn radiance(&self, w: DVec3) -> Rgb {
        self.image.value(self.in_picture(w)) * self.strength
    }

    fn sample(&self, u: DVec2) -> DVec3 {
        let (sin, cos) = (self.turn.sin(), self.turn.cos());
        let w = self.table.sample(u);
        DVec3::new(cos * w.x - sin * w.y, cos * w.y + sin * w.x, w.z).normalize()
    }
}

/// Height of the upper edge of row `y` of `rows`, equal steps of the angle from the zenith: 1 at the top, -1 at the bottom.
fn edge_height(y: usize, rows: usize) -> f64 {
    Angle::rad(PI * y as f64 / rows as f64).cos()
}

impl Dome {
    /// Prepares the sky of `environment`; its sun lights the ground beyond the horizon.
    #[must_use]
    pub fn new(environment: &Environment) -> Self {
        let landscape = |above, ground_albedo| {
            Content::Landscape(Box::new(Landscape::new(above, ground_albedo, environment)))
        };
        let content = match &environment.sky {
            Sky::None => Content::Dark,
            Sky::Uniform(radiance) if radiance.is_black() => Content::Dark,
            Sky::Uniform(radiance) => Content::Uniform(*radiance),
            Sky::ClearSky {
                sun_azimuth,
                sun_elevation,
                turbidity,
                ground_albedo,
                strength,
            } => {
                let sky = ClearSky::new(*sun_azimuth, *sun_elevation, *turbidity, *ground_albedo);
                match sky {
                    Some(sky) if *strength > 0.0 => {
                        landscape(Above::Clear(Box::new(sky), *strength), *ground_albedo)
                    }
                    Some(_) | None => Content::Dark,
                }
            }
            Sky::Overcast { zenith, .. } if zenith.is_black() => Content::Dark,
            Sky::Overcast {
                zenith,
                ground_albedo,
            } => landscape(Above::Overcast(*zenith), *ground_albedo),
            Sky::Image {
                image,
                turn,
                strength,
            } => {
                let panorama = Panorama::new(Arc::clone(image), *turn, *strength);
                if panorama.table.is_black() {
                    Content::Dark
                } else {
                    Content::Image(Box::new(panorama))
                }
            }
        };
        Self { content }
    }

    /// Whether it gives no light at all.
    #[must_use]
    pub fn is_dark(&self) -> bool {
        matches!(self.content, Content::Dark)
    }

    /// Whether it shows land below the horizon, which [`sample`](Self::sample) leaves out.
    #[must_use]
    pub fn has_land(&self) -> bool {
        matches!(self.content, Content::Landscape(_))
    }

    /// Radiance from the direction `w` (unit), W/(m² sr) per channel.
    #[must_use]
    pub fn radiance(&self, w: DVec3) -> Rgb {
        match &self.content {
            Content::Dark => Rgb::BLACK,
            Content::Uniform(radiance) => *radiance,
            Content::Landscape(land) if w.z < 0.0 => land.ground,
            Content::Landscape(land) => land.above.radiance(w),
            Content::Image(panorama) => panorama.radiance(w),
        }
    }

    /// Irradiance of an unshaded horizontal surface by the sky without the disk of the sun, W/m² per channel.
    #[must_use]
    pub fn horizontal_irradiance(&self) -> Rgb {
        match &self.content {
            Content::Dark => Rgb::BLACK,
            Content::Uniform(radiance) => *radiance * PI,
            Content::Landscape(land) => land.irradiance,
            Content::Image(panorama) => panorama.irradiance,
        }
    }

    /// Irradiance by what [`sample`](Self::sample) can choose, as far as it matters for choosing the sky among sources: that of a
    /// horizontal surface; by a picture, which may be bright below the horizon only, the mean over surfaces of all directions.
    #[must_use]
    pub fn typical_irradiance(&self) -> Rgb {
        match &self.content {
            Content::Image(panorama) => panorama.mean_irradiance,
            Content::Dark | Content::Uniform(_) | Content::Landscape(_) => {
                self.horizontal_irradiance()
            }
        }
    }

    /// Chooses a direction, more often where the sky is bright, from a point of the unit square; `None` if it is dark.
    ///
    /// A sky with ground under it is chosen above the horizon only: the ground is left to scattered rays, because most
    /// scenes hide it.
    #[must_use]
    pub fn sample(&self, u: DVec2) -> Option<LightSample> {
        let wi = match &self.content {
            Content::Dark => return None,
            Content::Uniform(_) => warp::sphere(u),
            Content::Landscape(land) => land.table.sample(u),
            Content::Image(panorama) => panorama.sample(u),
        };
        let pdf = self.pdf_solid_angle(wi);
        (pdf > 0.0).then(|| LightSample {
            wi,
            distance: f64::INFINITY,
            facing_irradiance: self.radiance(wi) / pdf,
            pdf_solid_angle: Some(pdf),
        })
    }

    /// Density per steradian with which [`sample`](Self::sample) chooses `w`.
    #[must_use]
    pub fn pdf_solid_angle(&self, w: DVec3) -> f64 {
        match &self.content {
            Content::Dark => 0.0,
            Content::Uniform(_) => warp::sphere_pdf_solid_angle(),
            Content::Landscape(_) if w.z < 0.0 => 0.0,
            Content::Landscape(land) => land.table.pdf_solid_angle(w),
            Content::Image(panorama) => panorama.table.pdf_solid_angle(panorama.in_picture(w)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::angle::Angle;

    fn day(elevation: f64, turbidity: f64) -> Environment {
        let albedo = Rgb::splat(0.2);
        Environment::daylight(Angle::deg(130.0), Angle::deg(elevation), turbidity, albedo)
    }

    /// C-70, for every model of the sky, and with the sun on the horizon and below it.
    #[test]
    fn irradiance_is_the_integral_of_radiance() {
        let of = |sky| Environment { sky, sun: None };
        let overcast = of(Sky::Overcast {
            zenith: Rgb::new(3.0, 2.0, 1.0),
            ground_albedo: Rgb::splat(0.3),
        });
        let cases = [
            ("low sun", day(5.0, 2.0)),
            ("sun on the horizon", day(0.0, 3.0)),
            ("day", day(45.0, 3.0)),
            ("haze", day(88.0, 8.0)),
            ("overcast", overcast),
            ("uniform", of(Sky::Uniform(Rgb::new(0.5, 1.0, 2.0)))),
            ("picture", panorama(37.0, 2.5)),
            ("sun below the horizon", day(-3.0, 3.0)),
            ("night", of(Sky::None)),
        ];
        for (name, environment) in cases {
            let dome = Dome::new(&environment);
            let (n, mut sum) = (1200, Rgb::BLACK);
            for i in 0..n * n {
                let u = DVec2::new(f64::from(i % n) + 0.5, f64::from(i / n) + 0.5) / f64::from(n);
                sum += dome.radiance(warp::cosine_hemisphere(u));
            }
            let integral = sum * (PI / f64::from(n * n));
            let stated = dome.horizontal_irradiance();
            // Texels of the picture have edges, which a grid of directions cuts unevenly.
            let tolerance = if name == "picture" { 5e-3 } else { 1e-3 };
            for channel in 0..3 {
                let off = (integral[channel] - stated[channel]).abs();
                assert!(
                    off <= tolerance * stated[channel],
                    "{name}, {channel}: {integral:?} {stated:?}"
                );
            }
        }
    }

    #[test]
    fn samples_have_the_stated_density_and_bounded_weight() {
        let dome = Dome::new(&day(30.0, 3.0));
        let (n, mut sum, mut worst) = (200, 0.0, 0.0_f64);
        for i in 0..n * n {
            let u = DVec2::new(f64::from(i % n) + 0.5, f64::from(i / n) + 0.5) / f64::from(n);
            let sample = dome.sample(u).unwrap();
            assert!(sample.wi.z >= 0.0);
            sum += sample.facing_irradiance.g * sample.wi.z / f64::from(n * n);
            worst = worst.max(sample.facing_irradiance.mean());
        }
        assert!((sum / dome.horizontal_irradiance().g - 1.0).abs() < 2e-3);
        // Perfect sampling would give the same weight everywhere: π-ish × the mean radiance.
        let total = dome.horizontal_irradiance().mean();
        assert!(worst < 8.0 * total, "{worst} {total}");
    }

    #[test]
    fn sun_and_sky_share_the_light_as_an_independent_model_says() {
        // Diffuse share of luminous horizontal irradiance by Bird & Riordan 1986 for the same haze, ground albedo 0.2.
        for (elevation, share) in [
            (10.0, 0.486),
            (30.0, 0.228),
            (45.0, 0.178),
            (60.0, 0.154),
            (85.0, 0.139),
        ] {
            let environment = day(elevation, 2.0);
            let sky = Dome::new(&environment).horizontal_irradiance().luminance();
            let sun = environment.sun.unwrap();
            let direct = sun.irradiance.luminance() * sun.to_sun.z;
            let found = sky / (sky + direct);
            assert!(
                (found / share - 1.0).abs() < 0.2,
                "{elevation}: {found} {share}"
            );
        }
    }

    #[test]
    fn night_is_dark_and_the_uniform_sky_is_everywhere() {
        for elevation in [0.0, -0.1, -50.0] {
            let night = Dome::new(&day(elevation, 3.0));
            assert!(night.is_dark() && night.sample(DVec2::splat(0.5)).is_none());
            assert_eq!(night.radiance(DVec3::Z), Rgb::BLACK);
        }
        let furnace = Environment {
            sky: Sky::Uniform(Rgb::splat(2.0)),
            sun: None,
        };
        let dome = Dome::new(&furnace);
        assert_eq!(dome.radiance(DVec3::NEG_Z), Rgb::splat(2.0));
        assert_eq!(dome.horizontal_irradiance(), Rgb::splat(2.0 * PI));
    }

    #[test]
    fn below_the_horizon_lies_lit_ground() {
        let dome = Dome::new(&day(40.0, 3.0));
        let sun = day(40.0, 3.0).sun.unwrap();
        let lit = dome.horizontal_irradiance() + sun.irradiance * sun.to_sun.z;
        assert_eq!(
            dome.radiance(DVec3::NEG_Z),
            Rgb::splat(0.2) * lit * FRAC_1_PI
        );
        assert_eq!(dome.pdf_solid_angle(DVec3::NEG_Z), 0.0);
    }

    #[test]
    fn the_overcast_sky_is_the_standard_one() {
        let dome = Dome::new(&Environment::overcast(Angle::deg(30.0), Rgb::splat(0.2)));
        let zenith = dome.radiance(DVec3::Z);
        assert!(
            (dome.radiance(DVec3::X) * 3.0 - zenith)
                .map(f64::abs)
                .max_channel()
                < 1e-12
        );
        // 300 + 21,000 / 2 lux, 683 lm/W; refdata/sky_models_ratios.csv: E / L of the zenith.
        let irradiance = dome.horizontal_irradiance();
        assert!((irradiance.g - 10_800.0 / 683.0).abs() < 1e-9);
        assert!((irradiance.g / zenith.g - 2.443_460_953).abs() < 1e-9);
        assert_eq!(dome.radiance(DVec3::NEG_Z), irradiance * 0.2 * FRAC_1_PI);
        assert!(Dome::new(&Environment::overcast(Angle::deg(-1.0), Rgb::WHITE)).is_dark());
    }

    /// A dim panorama of 64 × 32 pixels with one bright pixel and one bright row.
    fn panorama(turn: f64, strength: f64) -> Environment {
        let mut pixels = vec![[0.1, 0.2, 0.3]; 64 * 32];
        pixels[5 * 64 + 40] = [900.0, 800.0, 700.0];
        for pixel in &mut pixels[20 * 64..21 * 64] {
            *pixel = [3.0, 2.0, 1.0];
        }
        let image = Arc::new(SkyImage::new(64, 32, pixels).unwrap());
        let turn = Angle::deg(turn);
        Environment {
            sky: Sky::Image {
                image,
                turn,
                strength,
            },
            sun: None,
        }
    }

    #[test]
    fn a_picture_is_sampled_as_it_is_seen_with_bounded_weight() {
        for (turn, strength) in [(0.0, 1.0), (77.0, 2.5)] {
            let dome = Dome::new(&panorama(turn, strength));
            let (n, mut by_samples, mut total, mut worst) = (400, Rgb::BLACK, 0.0, 0.0_f64);
            for i in 0..n * n {
                let u = DVec2::new(f64::from(i % n) + 0.5, f64::from(i / n) + 0.5) / f64::from(n);
                let sample = dome.sample(u).unwrap();
                let share = 1.0 / f64::from(n * n);
                by_samples += sample.facing_irradiance * (sample.wi.z.max(0.0) * share);
                total += sample.facing_irradiance.mean() * share;
                worst = worst.max(sample.facing_irradiance.mean());
            }
            assert!(worst < 6.0 * total, "{worst} {total}");
            // The same integral with directions that know nothing of the picture.
            let (n, mut by_cosine) = (2000, Rgb::BLACK);
            for i in 0..n * n {
                let u = DVec2::new(f64::from(i % n) + 0.5, f64::from(i / n) + 0.5) / f64::from(n);
                by_cosine += dome.radiance(warp::cosine_hemisphere(u));
            }
            by_cosine *= PI / f64::from(n * n);
            for channel in 0..3 {
                let ratio = by_samples[channel] / by_cosine[channel];
                assert!((ratio - 1.0).abs() < 5e-3, "{turn} {channel}: {ratio}");
                // The stated one is that of the pixels, not of what is interpolated between them.
                let ratio = dome.horizontal_irradiance()[channel] / by_cosine[channel];
                assert!((ratio - 1.0).abs() < 0.02, "{turn} {channel}: {ratio}");
            }
        }
    }

    #[test]
    fn a_picture_turns_counter_clockwise() {
        // The bright pixel is at azimuth 227.8° of the picture's own compass, elevation 59.1°.
        let compass: f64 = (40.5 / 64.0 - 0.5) * 360.0;
        let height = Angle::deg(90.0 - 5.5 / 32.0 * 180.0);
        for turn in [0.0, 30.0, 200.0] {
            let dome = Dome::new(&panorama(turn, 1.0));
            let from_x = Angle::deg(90.0 - compass + turn);
            let w = DVec3::new(
                height.cos() * from_x.cos(),
                height.cos() * from_x.sin(),
                height.sin(),
            );
            assert!((dome.radiance(w).r - 900.0).abs() < 1e-6, "{turn}");
        }
    }

    #[test]
    fn a_black_picture_is_dark() {
        let image = Arc::new(SkyImage::new(2, 1, vec![[0.0; 3]; 2]).unwrap());
        let sky = Sky::Image {
            image,
            turn: Angle::deg(0.0),
            strength: 1.0,
        };
        assert!(Dome::new(&Environment { sky, sun: None }).is_dark());
        assert!(Dome::new(&panorama(0.0, 0.0)).is_dark());
    }

    #[test]
    fn brightening_multiplies_all_of_it() {
        let up = DVec3::new(0.6, 0.0, 0.8);
        let overcast = Environment::overcast(Angle::deg(40.0), Rgb::splat(0.2));
        for environment in [day(40.0, 3.0), overcast, panorama(10.0, 1.0)] {
            let (dim, bright) = (
                Dome::new(&environment),
                Dome::new(&environment.clone().brightened(3.0)),
            );
            for w in [up, -up] {
                let ratio = bright.radiance(w).g / dim.radiance(w).g;
                assert!((ratio - 3.0).abs() < 1e-12, "{ratio}");
            }
            let sun = environment.clone().brightened(3.0).sun;
            assert_eq!(
                sun.map(|sun| sun.irradiance),
                environment.sun.map(|sun| sun.irradiance * 3.0)
            );
        }
    }
}
