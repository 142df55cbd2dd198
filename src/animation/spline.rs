//! Smooth curves through given values that never swing beyond them.

use glam::DVec3;

/// A curve through values at increasing times: smooth (its slope has no jumps), and between two neighbouring values never
/// above the larger nor below the smaller one. Before the first time and after the last it stays as it is there.
///
/// Source: [Steffen1990](crate::references#steffen1990): cubic pieces whose slopes are limited so that each is monotone.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    times: Vec<f64>,
    values: Vec<f64>,
    slopes: Vec<f64>,
}

impl Spline {
    /// The curve through these (time, value) pairs: at least one, times increasing, all finite.
    pub fn new(points: &[(f64, f64)]) -> Self {
        let (times, values): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        let slopes = slopes(&times, &values);
        Self {
            times,
            values,
            slopes,
        }
    }

    /// The value at a time.
    pub fn at(&self, time: f64) -> f64 {
        let after = self.times.partition_point(|&t| t <= time);
        let Some(i) = after.checked_sub(1) else {
            return self.values.first().copied().unwrap_or_default();
        };
        if after == self.times.len() {
            return self.values[i];
        }
        let (start, end) = (self.values[i], self.values[after]);
        let width = self.times[after] - self.times[i];
        let u = (time - self.times[i]) / width;

        // The cubic with these values and slopes at its ends, in the form of Hermite.
        let value = start
            + u * u * (3.0 - 2.0 * u) * (end - start)
            + u * (1.0 - u) * width * (self.slopes[i] * (1.0 - u) - self.slopes[after] * u);
        // In exact arithmetic this changes nothing.
        value.clamp(start.min(end), start.max(end))
    }
}

/// The slope of the curve at each point.
fn slopes(times: &[f64], values: &[f64]) -> Vec<f64> {
    let widths: Vec<f64> = times.windows(2).map(|t| t[1] - t[0]).collect();
    let secants: Vec<f64> = values
        .windows(2)
        .zip(&widths)
        .map(|(v, width)| (v[1] - v[0]) / width)
        .collect();
    let n = times.len();
    (0..n)
        .map(|i| match (i.checked_sub(1), secants.get(i)) {
            (Some(before), Some(&after)) => {
                inner_slope((secants[before], widths[before]), (after, widths[i]))
            }
            (None, Some(&first)) => match secants.get(1) {
                Some(&second) => end_slope((first, widths[0]), (second, widths[1])),
                None => first,
            },
            (Some(before), None) => match before.checked_sub(1) {
                Some(other) => end_slope(
                    (secants[before], widths[before]),
                    (secants[other], widths[other]),
                ),
                None => secants[before],
            },
            (None, None) => 0.0,
        })
        .collect()
}

/// The slope between two intervals, each given by its secant and its width: that of the parabola through the three points,
/// but no more than twice the smaller secant, and 0 at a turning point.
fn inner_slope(before: (f64, f64), after: (f64, f64)) -> f64 {
    let ((s, h), (t, k)) = (before, after);
    if s * t <= 0.0 {
        return 0.0;
    }
    let parabola = (s * k + t * h) / (h + k);
    let most = 2.0 * s.abs().min(t.abs());
    parabola.abs().min(most).copysign(s)
}

/// The slope at the outer end of the outermost interval, given by its secant and width and those of its neighbour.
fn end_slope(own: (f64, f64), next: (f64, f64)) -> f64 {
    let ((s, h), (t, k)) = (own, next);
    let parabola = s * (1.0 + h / (h + k)) - t * h / (h + k);
    if parabola * s <= 0.0 {
        0.0
    } else {
        parabola.abs().min(2.0 * s.abs()).copysign(s)
    }
}

/// The way of a point: a [`Spline`] for each of its coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    coordinates: [Spline; 3],
    points: Vec<(f64, DVec3)>,
}

impl Track {
    /// The way through these (time, point) pairs: at least one, times increasing, all finite.
    pub fn new(points: &[(f64, DVec3)]) -> Self {
        let along = |axis: usize| {
            let values: Vec<(f64, f64)> = points.iter().map(|(t, p)| (*t, p[axis])).collect();
            Spline::new(&values)
        };
        Self {
            coordinates: [along(0), along(1), along(2)],
            points: points.to_vec(),
        }
    }

    /// The point at a time.
    pub fn at(&self, time: f64) -> DVec3 {
        DVec3::from_array(self.coordinates.each_ref().map(|spline| spline.at(time)))
    }

    /// The points it was made from.
    pub fn points(&self) -> &[(f64, DVec3)] {
        &self.points
    }
}

/// Pieces into which each span between two points is cut to measure its length.
const PIECES: u32 = 64;

/// A clock that makes a way be walked at an even speed: it begins and ends with the times of the way, and in between it is
/// fast where the way is slow.
#[derive(Clone, Debug, PartialEq)]
pub struct EvenSpeed {
    /// Times of the way, and how much of it lies before, in metres.
    table: Vec<(f64, f64)>,
}

impl EvenSpeed {
    /// The clock of a way.
    pub fn new(track: &Track) -> Self {
        let mut table = Vec::new();
        let mut length = 0.0;
        let mut last: Option<DVec3> = None;
        let mut add = |time: f64| {
            let point = track.at(time);
            length += last.map_or(0.0, |last| last.distance(point));
            last = Some(point);
            table.push((time, length));
        };
        for span in track.points.windows(2) {
            let (start, end) = (span[0].0, span[1].0);
            for piece in 0..PIECES {
                add(start + (end - start) * f64::from(piece) / f64::from(PIECES));
            }
        }
        if let Some((end, _)) = track.points.last() {
            add(*end);
        }
        Self { table }
    }

    /// The time of the way at which as much of it is behind as at an even speed at `time`.
    pub fn time(&self, time: f64) -> f64 {
        let (Some(&(start, _)), Some(&(end, length))) = (self.table.first(), self.table.last())
        else {
            return time;
        };
        if length == 0.0 || time <= start || time >= end {
            return time;
        }
        let wanted = length * (time - start) / (end - start);
        let after = self.table.partition_point(|(_, behind)| *behind <= wanted);
        let (Some(&(t0, l0)), Some(&(t1, l1))) =
            (self.table.get(after.wrapping_sub(1)), self.table.get(after))
        else {
            return time;
        };
        t0 + (t1 - t0) * (wanted - l0) / (l1 - l0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [(f64, f64); 6] = [
        (0.0, 1.0),
        (1.0, 1.5),
        (1.1, 9.0),
        (4.0, 9.0),
        (5.0, -3.0),
        (7.0, 2.0),
    ];

    #[test]
    fn it_passes_through_its_points_and_never_beyond_them() {
        let spline = Spline::new(&POINTS);
        for (time, value) in POINTS {
            assert!((spline.at(time) - value).abs() < 1e-12);
        }
        for span in POINTS.windows(2) {
            let (low, high) = (span[0].1.min(span[1].1), span[0].1.max(span[1].1));
            for i in 0..=1000 {
                let time = span[0].0 + (span[1].0 - span[0].0) * f64::from(i) / 1000.0;
                let value = spline.at(time);
                assert!(
                    (low - 1e-12..=high + 1e-12).contains(&value),
                    "{time}: {value}"
                );
            }
        }
        assert_eq!((spline.at(-5.0), spline.at(50.0)), (1.0, 2.0));
    }

    #[test]
    fn its_slope_has_no_jumps_and_a_straight_line_stays_straight() {
        let spline = Spline::new(&POINTS);
        let slope = |time: f64, h: f64| (spline.at(time + h) - spline.at(time)) / h;
        for (time, _) in &POINTS[1..5] {
            let (before, after) = (slope(*time, -1e-7), slope(*time, 1e-7));
            assert!(
                (before - after).abs() < 1e-3 * (1.0 + before.abs()),
                "{time}: {before} {after}"
            );
        }
        let line = Spline::new(&[(0.0, 1.0), (1.0, 3.0), (5.0, 11.0)]);
        for i in 0..50 {
            let time = f64::from(i) / 10.0;
            assert!((line.at(time) - (1.0 + 2.0 * time)).abs() < 1e-12);
        }
    }

    #[test]
    fn one_point_stays_and_two_make_a_line() {
        assert_eq!(Spline::new(&[(3.0, 7.0)]).at(0.0), 7.0);
        assert_eq!(Spline::new(&[(0.0, 0.0), (2.0, 4.0)]).at(0.5), 1.0);
    }

    #[test]
    fn an_even_clock_covers_equal_lengths_in_equal_times() {
        let track = Track::new(&[
            (0.0, DVec3::ZERO),
            (1.0, DVec3::X),
            (2.0, DVec3::new(9.0, 1.0, 0.0)),
            (10.0, DVec3::new(10.0, 1.0, 4.0)),
        ]);
        let clock = EvenSpeed::new(&track);
        let steps: Vec<f64> = (0..100)
            .map(|i| {
                let at = |i: i32| track.at(clock.time(f64::from(i) / 10.0));
                at(i).distance(at(i + 1))
            })
            .collect();
        let mean = steps.iter().sum::<f64>() / 100.0;
        // Chords of 1/100 of the way are shorter than their arcs by little.
        assert!(
            steps.iter().all(|step| (step / mean - 1.0).abs() < 0.1),
            "{steps:?}"
        );
        assert_eq!((clock.time(0.0), clock.time(10.0)), (0.0, 10.0));
    }

    #[test]
    fn a_way_that_stays_keeps_its_time() {
        let track = Track::new(&[(0.0, DVec3::X), (2.0, DVec3::X)]);
        assert_eq!(EvenSpeed::new(&track).time(1.25), 1.25);
    }
}
