//! The sky made ready for rendering: its radiance in every direction, and directions chosen where it is bright.

use super::clear_sky::ClearSky;
use super::{Environment, LightSample, Sky};
use crate::color::Rgb;
use crate::math::functions::atan2;
use crate::math::sum::Sum;
use crate::math::warp;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_1_PI, PI, TAU};

/// Rows of the sampling table, equal steps of the height z of the direction: equal solid angles.
const ROWS: usize = 64;

/// Columns of the sampling table, equal steps of azimuth.
const COLUMNS: usize = 256;

/// Share of the average cell that every cell has at least, so that no direction with light is impossible to choose.
const LEAST_SHARE: f64 = 0.01;

/// The sky, ready to be looked at and sampled.
#[derive(Clone, Debug)]
pub struct Dome {
    content: Content,
}

#[derive(Clone, Debug)]
enum Content {
    Dark,
    Uniform(Rgb),
    Clear(Box<Clear>),
}

#[derive(Clone, Debug)]
struct Clear {
    sky: ClearSky,
    /// Radiance of the ground that is seen below the horizon.
    ground: Rgb,
    /// ∫ L cos θ dω over the sky without the sun.
    irradiance: Rgb,
    table: Table,
}

/// Piecewise constant density over the upper hemisphere.
#[derive(Clone, Debug)]
struct Table {
    /// Running sums of the rows' shares, from 0 to 1.
    rows: Vec<f64>,
    /// Per row, running sums of the shares of its columns, from 0 to 1.
    columns: Vec<f64>,
}

impl Dome {
    /// Prepares the sky of `environment`; its sun lights the ground beyond the horizon.
    #[must_use]
    pub fn new(environment: &Environment) -> Self {
        let content = match environment.sky {
            Sky::None => Content::Dark,
            Sky::Uniform(radiance) if radiance.is_black() => Content::Dark,
            Sky::Uniform(radiance) => Content::Uniform(radiance),
            Sky::ClearSky {
                sun_azimuth,
                sun_elevation,
                turbidity,
                ground_albedo,
            } => match ClearSky::new(sun_azimuth, sun_elevation, turbidity, ground_albedo) {
                None => Content::Dark,
                Some(sky) => {
                    let (table, irradiance) = Table::new(&sky);
                    let sun = environment.sun.as_ref();
                    let direct = sun.map_or(Rgb::BLACK, |s| s.irradiance * s.to_sun.z.max(0.0));
                    let ground = ground_albedo * (irradiance + direct) * FRAC_1_PI;
                    Content::Clear(Box::new(Clear {
                        sky,
                        ground,
                        irradiance,
                        table,
                    }))
                }
            },
        };
        Self { content }
    }

    /// Whether it gives no light at all.
    #[must_use]
    pub fn is_dark(&self) -> bool {
        matches!(self.content, Content::Dark)
    }

    /// Radiance from the direction `w` (unit), W/(m² sr) per channel.
    #[must_use]
    pub fn radiance(&self, w: DVec3) -> Rgb {
        match &self.content {
            Content::Dark => Rgb::BLACK,
            Content::Uniform(radiance) => *radiance,
            Content::Clear(clear) if w.z < 0.0 => clear.ground,
            Content::Clear(clear) => clear.sky.radiance(w),
        }
    }

    /// Irradiance of an unshaded horizontal surface by the sky without the disk of the sun, W/m² per channel.
    #[must_use]
    pub fn horizontal_irradiance(&self) -> Rgb {
        match &self.content {
            Content::Dark => Rgb::BLACK,
            Content::Uniform(radiance) => *radiance * PI,
            Content::Clear(clear) => clear.irradiance,
        }
    }

    /// Chooses a direction, more often where the sky is bright, from a point of the unit square; `None` if it is dark.
    ///
    /// A clear sky is chosen above the horizon only: the ground beyond it is left to scattered rays, because most scenes
    /// hide it.
    #[must_use]
    pub fn sample(&self, u: DVec2) -> Option<LightSample> {
        let wi = match &self.content {
            Content::Dark => return None,
            Content::Uniform(_) => warp::sphere(u),
            Content::Clear(clear) => clear.table.sample(u),
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
            Content::Clear(_) if w.z < 0.0 => 0.0,
            Content::Clear(clear) => clear.table.pdf_solid_angle(w),
        }
    }
}

impl Table {
    /// The table of a sky, and the sky's horizontal irradiance from the same directions.
    fn new(sky: &ClearSky) -> (Self, Rgb) {
        // Two by two directions per cell.
        let cell_solid_angle = TAU / (ROWS * COLUMNS) as f64;
        let mut irradiance = [Sum::ZERO; 3];
        let mut cells = vec![0.0; ROWS * COLUMNS];
        for (i, cell) in cells.iter_mut().enumerate() {
            for (dz, dphi) in [(0.25, 0.25), (0.25, 0.75), (0.75, 0.25), (0.75, 0.75)] {
                let z = ((i / COLUMNS) as f64 + dz) / ROWS as f64;
                let w = warp::direction(z, ((i % COLUMNS) as f64 + dphi) / COLUMNS as f64);
                let radiance = sky.radiance(w) * 0.25;
                *cell += radiance.mean();
                for (sum, value) in irradiance.iter_mut().zip(radiance.to_array()) {
                    sum.add(value * w.z * cell_solid_angle);
                }
            }
        }

        // A least share everywhere keeps the weights of samples bounded.
        let least = LEAST_SHARE * cells.iter().sum::<f64>() / cells.len() as f64;
        for cell in &mut cells {
            *cell = cell.max(least);
        }
        let row_sums: Vec<f64> = cells.chunks(COLUMNS).map(|row| row.iter().sum()).collect();
        let columns = cells.chunks(COLUMNS).flat_map(running_shares).collect();
        let irradiance = Rgb::from_array(irradiance.map(|sum| sum.value()));
        (
            Self {
                rows: running_shares(&row_sums),
                columns,
            },
            irradiance,
        )
    }

    fn row_of_columns(&self, row: usize) -> &[f64] {
        &self.columns[row * (COLUMNS + 1)..(row + 1) * (COLUMNS + 1)]
    }

    fn sample(&self, u: DVec2) -> DVec3 {
        let (row, along_row) = invert(&self.rows, u.x);
        let (column, along_column) = invert(self.row_of_columns(row), u.y);
        let z = (row as f64 + along_row) / ROWS as f64;
        warp::direction(z, (column as f64 + along_column) / COLUMNS as f64)
    }

    fn pdf_solid_angle(&self, w: DVec3) -> f64 {
        let turn = atan2(w.y, w.x) / TAU;
        let turn = if turn < 0.0 { turn + 1.0 } else { turn };
        let row = ((w.z * ROWS as f64) as usize).min(ROWS - 1);
        let column = ((turn * COLUMNS as f64) as usize).min(COLUMNS - 1);
        let columns = self.row_of_columns(row);
        let share = (self.rows[row + 1] - self.rows[row]) * (columns[column + 1] - columns[column]);
        share * (ROWS * COLUMNS) as f64 / TAU
    }
}

/// Running sums of weights, scaled to end at exactly 1; even shares if all weights are 0.
fn running_shares(weights: &[f64]) -> Vec<f64> {
    let total: f64 = weights.iter().sum();
    let n = weights.len() as f64;
    let share = |w: f64| if total > 0.0 { w / total } else { 1.0 / n };
    let mut sums = Vec::with_capacity(weights.len() + 1);
    let mut sum = 0.0;
    sums.push(0.0);
    for weight in weights {
        sum += share(*weight);
        sums.push(sum.min(1.0));
    }
    if let Some(last) = sums.last_mut() {
        *last = 1.0;
    }
    sums
}

/// The cell of running sums that `u` in [0, 1) falls into, and how far along the cell it lies, 0..1.
fn invert(sums: &[f64], u: f64) -> (usize, f64) {
    let cell = sums
        .partition_point(|sum| *sum <= u)
        .clamp(1, sums.len() - 1)
        - 1;
    let width = sums[cell + 1] - sums[cell];
    let along = if width > 0.0 {
        ((u - sums[cell]) / width).clamp(0.0, 1.0)
    } else {
        0.5
    };
    (cell, along)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::angle::Angle;

    fn day(elevation: f64, turbidity: f64) -> Environment {
        let albedo = Rgb::splat(0.2);
        Environment::daylight(Angle::deg(130.0), Angle::deg(elevation), turbidity, albedo)
    }

    #[test]
    fn irradiance_is_the_integral_of_radiance() {
        for (elevation, turbidity) in [(5.0, 2.0), (45.0, 3.0), (88.0, 8.0)] {
            let dome = Dome::new(&day(elevation, turbidity));
            let (n, mut sum) = (1200, Rgb::BLACK);
            for i in 0..n * n {
                let u = DVec2::new(f64::from(i % n) + 0.5, f64::from(i / n) + 0.5) / f64::from(n);
                sum += dome.radiance(warp::cosine_hemisphere(u));
            }
            let integral = sum * (PI / f64::from(n * n));
            let stated = dome.horizontal_irradiance();
            for channel in 0..3 {
                let ratio = integral[channel] / stated[channel];
                assert!(
                    (ratio - 1.0).abs() < 1e-3,
                    "{elevation} {turbidity} {channel}: {ratio}"
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
    fn inverting_running_shares_meets_every_cell() {
        let sums = running_shares(&[1.0, 0.0, 3.0]);
        assert_eq!(sums, [0.0, 0.25, 0.25, 1.0]);
        assert_eq!(invert(&sums, 0.0), (0, 0.0));
        assert_eq!(invert(&sums, 0.25).0, 2);
        assert_eq!(invert(&sums, 1.0).0, 2);
        assert_eq!(running_shares(&[0.0, 0.0]), [0.0, 0.5, 1.0]);
    }
}
