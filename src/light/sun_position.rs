//! Where the sun stands at a time, seen from a place on Earth.
//!
//! Source: the Astronomical Almanac's low-precision formulas as given by
//! [Michalsky1988](crate::references#michalsky1988): within 0.01° from 1950 to 2050, within about 0.1° from 1800 to 2200.

use crate::math::angle::Angle;
use crate::math::functions::{asin, atan2};

/// A moment, in universal time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Days since noon of 1 January 2000, universal time.
    days: f64,
    /// Hours of the day, universal time, 0..24.
    hours: f64,
}

/// A place on Earth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Degrees north of the equator, -90..=90.
    pub latitude: f64,
    /// Degrees east of Greenwich, -180..=180.
    pub longitude: f64,
}

/// The years that a [`Moment`] may lie in.
pub const YEARS: std::ops::RangeInclusive<i32> = 1800..=2200;

impl Moment {
    /// The moment of this date in the Gregorian calendar, `hours` after midnight in universal time (any finite number; a
    /// time zone's offset may have made it negative). `None` if there is no such day, or it lies outside [`YEARS`].
    #[must_use]
    pub fn new(year: i32, month: u32, day: u32, hours: f64) -> Option<Self> {
        let is_leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
        let lengths = [
            31,
            if is_leap { 29 } else { 28 },
            31,
            30,
            31,
            30,
            31,
            31,
            30,
            31,
            30,
            31,
        ];
        let length = lengths.get((month as usize).checked_sub(1)?)?;
        if !YEARS.contains(&year) || !(1..=*length).contains(&day) || !hours.is_finite() {
            return None;
        }
        // Days from 1 January 2000 to 1 January of the year, then to the first of the month.
        let years = i64::from(year) - 1;
        let leap_days = |y: i64| y.div_euclid(4) - y.div_euclid(100) + y.div_euclid(400);
        let to_year = (years - 1999) * 365 + leap_days(years) - leap_days(1999);
        let to_month: i64 = lengths[..month as usize - 1]
            .iter()
            .map(|n| i64::from(*n))
            .sum();
        let midnight = (to_year + to_month + i64::from(day) - 1) as f64 - 0.5;
        Some(Self {
            days: midnight + hours / 24.0,
            hours: hours.rem_euclid(24.0),
        })
    }
}

impl Place {
    /// Azimuth of the sun clockwise from north as seen from above, 0..360°, and its elevation above the horizon (negative:
    /// below), with the refraction of standard air.
    #[must_use]
    pub fn sun(&self, moment: Moment) -> (Angle, Angle) {
        // Ecliptic longitude of the sun from its mean longitude and mean anomaly; obliquity of the ecliptic.
        let n = moment.days;
        let mean_longitude = 280.460 + 0.985_647_4 * n;
        let anomaly = Angle::deg((357.528 + 0.985_600_3 * n).rem_euclid(360.0));
        let twice = Angle::deg(2.0 * anomaly.degrees());
        let longitude = mean_longitude + 1.915 * anomaly.sin() + 0.020 * twice.sin();
        let longitude = Angle::deg(longitude.rem_euclid(360.0));
        let obliquity = Angle::deg(23.439 - 0.000_000_4 * n);

        // Right ascension and declination, then the hour angle from the sidereal time of the place.
        let ascension = Angle::rad(atan2(obliquity.cos() * longitude.sin(), longitude.cos()));
        let declination = Angle::rad(asin(obliquity.sin() * longitude.sin()));
        // The day count ends at the moment itself, so only the surplus of sidereal over solar time is added to the clock.
        let sidereal_hours = 6.697_375 + 0.065_709_824_2 * n + moment.hours;
        let sidereal = 15.0 * sidereal_hours.rem_euclid(24.0) + self.longitude;
        let hour_angle = Angle::deg((sidereal - ascension.degrees()).rem_euclid(360.0));

        // Horizontal coordinates.
        let latitude = Angle::deg(self.latitude);
        let (sin_d, cos_d) = (declination.sin(), declination.cos());
        let east = -cos_d * hour_angle.sin();
        let north = sin_d * latitude.cos() - cos_d * latitude.sin() * hour_angle.cos();
        let up = sin_d * latitude.sin() + cos_d * latitude.cos() * hour_angle.cos();
        let elevation = Angle::rad(asin(up.clamp(-1.0, 1.0))).degrees();
        let azimuth = Angle::rad(atan2(east, north)).degrees().rem_euclid(360.0);
        (
            Angle::deg(azimuth),
            Angle::deg(elevation + refraction(elevation)),
        )
    }
}

/// By how many degrees standard air lifts what stands at this true elevation in degrees
/// ([Michalsky1988](crate::references#michalsky1988)).
fn refraction(elevation: f64) -> f64 {
    let e = elevation;
    if e < -0.56 {
        0.0
    } else {
        3.515_61 * (0.159_4 + 0.019_6 * e + 0.000_02 * e * e) / (1.0 + 0.505 * e + 0.084_5 * e * e)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sun(latitude: f64, longitude: f64, moment: Option<Moment>) -> (f64, f64) {
        let place = Place {
            latitude,
            longitude,
        };
        let (azimuth, elevation) = place.sun(moment.unwrap());
        (azimuth.degrees(), elevation.degrees())
    }

    #[test]
    fn the_example_of_reda_and_andreas() {
        // NREL/TP-560-34302, appendix A.5: Golden, Colorado, 17 October 2003, 12:30:30 at UTC-7.
        let moment = Moment::new(2003, 10, 17, 12.0 + 30.5 / 60.0 + 7.0);
        let (azimuth, elevation) = sun(39.742_476, -105.178_6, moment);
        assert!((azimuth - 194.340_24).abs() < 0.02, "{azimuth}");
        assert!((elevation - (90.0 - 50.111_62)).abs() < 0.02, "{elevation}");
    }

    #[test]
    fn solstice_and_equinox() {
        // Noon of the June solstice on the tropic: in the zenith.
        let (_, elevation) = sun(23.437, 0.0, Moment::new(2024, 6, 21, 12.03));
        assert!(elevation > 89.8, "{elevation}");
        // Sunrise of the March equinox on the equator: due east, on the horizon but for refraction.
        let (azimuth, elevation) = sun(0.0, 0.0, Moment::new(2024, 3, 20, 6.125));
        assert!((azimuth - 90.0).abs() < 0.5, "{azimuth}");
        assert!(elevation.abs() < 0.8, "{elevation}");
        // Midnight sun at the pole: as high as the obliquity, all day.
        for hour in [0.0, 6.0, 18.0] {
            let (_, elevation) = sun(90.0, 0.0, Moment::new(2024, 6, 20, hour));
            assert!((elevation - 23.47).abs() < 0.05, "{hour}: {elevation}");
        }
        // South of the tropic the sun of noon stands in the north.
        let (azimuth, _) = sun(-35.0, 149.0, Moment::new(2024, 6, 21, 2.07));
        assert!(!(3.0..=357.0).contains(&azimuth), "{azimuth}");
    }

    #[test]
    fn days_are_counted_over_leap_years_and_time_zones() {
        let at = |y, m, d, h| Moment::new(y, m, d, h).unwrap();
        assert_eq!(at(2000, 1, 1, 12.0).days, 0.0);
        assert_eq!(at(2000, 12, 31, 12.0).days, 365.0);
        assert_eq!(at(1999, 12, 31, 12.0).days, -1.0);
        assert_eq!(at(1900, 3, 1, 12.0).days - at(1900, 2, 28, 12.0).days, 1.0);
        assert_eq!(at(2024, 3, 1, 12.0).days - at(2024, 2, 28, 12.0).days, 2.0);
        assert_eq!(at(2026, 11, 22, -1.0), at(2026, 11, 21, 23.0));
        assert_eq!(at(2026, 11, 22, 25.5), at(2026, 11, 23, 1.5));
        for (y, m, d) in [
            (2023, 2, 29),
            (2024, 13, 1),
            (2024, 0, 1),
            (2024, 4, 31),
            (1799, 1, 1),
        ] {
            assert_eq!(Moment::new(y, m, d, 0.0), None, "{y}-{m}-{d}");
        }
    }
}
