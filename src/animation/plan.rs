//! A flight drawn on a map: what lies under it, seen from above, and where the camera goes and looks.

use crate::camera::View;
use crate::image::{Picture, Pixels};
use crate::math::Ray;
use crate::scene::Scene;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Longer side of the map in pixels.
const SIDE: f64 = 720.0;
/// Room round the flight, as a part of its size.
const MARGIN: f64 = 0.2;
/// Color of the way.
const WAY: [u8; 3] = [200, 30, 30];
/// Color of its beginning.
const BEGIN: [u8; 3] = [20, 140, 40];
/// Color of where the camera looks.
const LOOK: [u8; 3] = [30, 60, 200];
/// Marks of where the camera looks, at most.
const MOST_LOOKS: usize = 40;
/// Their length in pixels.
const LOOK_LENGTH: f64 = 18.0;

/// A map: what is where on it.
struct Map {
    /// The upper left corner, in metres.
    corner: DVec2,
    /// Metres in a pixel.
    scale: f64,
    width: u32,
    height: u32,
    pixels: Vec<u8>,
}

/// The map of a flight through these views. North (+y) is up; what is high is dark, as if light came from the left.
pub fn plan(scene: &Scene, views: &[View]) -> Picture {
    let points = views.iter().flat_map(|view| [view.eye, view.target]);
    let points: Vec<DVec2> = points.map(DVec3::truncate).collect();
    let start = points.first().copied().unwrap_or_default();
    let (mut min, mut max) = (start, start);
    for point in &points {
        min = min.min(*point);
        max = max.max(*point);
    }
    // A camera that stands still and looks down has no extent of its own.
    let room = ((max - min).max_element() * MARGIN).max(1.0);
    let (min, max) = (min - room, max + room);
    let size = max - min;
    let scale = size.max_element() / SIDE;
    let pixels = |metres: f64| (metres / scale).ceil().max(1.0) as u32;
    let mut map = Map {
        corner: DVec2::new(min.x, max.y),
        scale,
        width: pixels(size.x),
        height: pixels(size.y),
        pixels: Vec::new(),
    };
    map.shade(scene);
    let looks = views.len().div_ceil(MOST_LOOKS).max(1);
    for view in views.iter().step_by(looks) {
        let ahead = (view.target - view.eye).truncate().normalize_or_zero();
        let eye = view.eye.truncate();
        map.line(eye, eye + ahead * (LOOK_LENGTH * scale), LOOK);
    }
    for pair in views.windows(2) {
        map.line(pair[0].eye.truncate(), pair[1].eye.truncate(), WAY);
    }
    if let Some(first) = views.first() {
        for offset in -3..=3 {
            let shift = DVec2::new(3.0, f64::from(offset)) * scale;
            let eye = first.eye.truncate();
            map.line(eye - shift, eye + shift.with_y(-shift.y), BEGIN);
        }
    }
    Picture {
        width: map.width,
        height: map.height,
        pixels: Pixels::Srgb(map.pixels),
    }
}

impl Map {
    /// Draws what lies there.
    fn shade(&mut self, scene: &Scene) {
        let top = scene.bounds().max.z.max(0.0) + 1.0;
        let heights: Vec<Option<f64>> = (0..self.width * self.height)
            .into_par_iter()
            .map(|i| {
                let at = DVec2::new(
                    f64::from(i % self.width) + 0.5,
                    f64::from(i / self.width) + 0.5,
                );
                let place = self.corner + at * DVec2::new(self.scale, -self.scale);
                let ray = Ray::new(place.extend(top), DVec3::NEG_Z);
                scene.closest(&ray).map(|hit| top - hit.t)
            })
            .collect();
        let known = heights.iter().flatten().copied();
        let (low, high) = known.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), h| {
            (a.min(h), b.max(h))
        });
        let span = (high - low).max(self.scale);
        self.pixels = heights
            .iter()
            .enumerate()
            .flat_map(|(i, height)| {
                let Some(height) = height else {
                    return [255; 3];
                };
                let left = if i % self.width as usize == 0 {
                    None
                } else {
                    heights[i - 1]
                };
                let slope = left.map_or(0.0, |left| (height - left) / self.scale);
                let value = 225.0 - 110.0 * (height - low) / span + 30.0 * slope.clamp(-1.0, 1.0);
                let value = value.clamp(0.0, 255.0);
                [value * 0.93, value, value * 0.88].map(|channel| channel as u8)
            })
            .collect();
    }

    /// Draws a line between two places, two pixels wide.
    fn line(&mut self, from: DVec2, to: DVec2, color: [u8; 3]) {
        let pixel = |place: DVec2| (place - self.corner) / DVec2::new(self.scale, -self.scale);
        let (from, to) = (pixel(from), pixel(to));
        // Not longer than the map, wherever the places are.
        let n = from.distance(to).clamp(1.0, 4.0 * SIDE).ceil() as u32;
        for i in 0..=n {
            let at = from.lerp(to, f64::from(i) / f64::from(n));
            for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let (x, y) = (at.x.floor() as i64 + dx, at.y.floor() as i64 + dy);
                let is_inside = (0..i64::from(self.width)).contains(&x)
                    && (0..i64::from(self.height)).contains(&y);
                if is_inside {
                    let at = 3 * (y as usize * self.width as usize + x as usize);
                    self.pixels[at..at + 3].copy_from_slice(&color);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::angle::Angle;
    use crate::scene::description::SceneDescription;

    #[test]
    fn the_way_is_on_the_map_with_north_up() {
        let scene = Scene::build(SceneDescription::default()).unwrap();
        let view = |x: f64, y: f64| View {
            eye: DVec3::new(x, y, 2.0),
            target: DVec3::new(x, y + 1.0, 2.0),
            up: DVec3::Z,
            fov: Angle::deg(40.0),
        };
        let views: Vec<View> = (0..=100)
            .map(|i| view(f64::from(i), 0.2 * f64::from(i)))
            .collect();
        let map = plan(&scene, &views);
        let Pixels::Srgb(pixels) = map.pixels else {
            panic!()
        };
        let places = |color: [u8; 3]| {
            let found = pixels
                .chunks(3)
                .enumerate()
                .filter(move |(_, pixel)| **pixel == color);
            found
                .map(|(i, _)| (i as u32 % map.width, i as u32 / map.width))
                .collect::<Vec<_>>()
        };
        let (way, begin) = (places(WAY), places(BEGIN));
        assert!(way.len() > 500 && !begin.is_empty());
        let last = way.iter().max().unwrap();
        assert!(
            last.0 > map.width / 2 && last.1 < map.height / 2,
            "{last:?}"
        );
        assert!(begin[0].0 < map.width / 3 && begin[0].1 > map.height / 2);
    }
}
