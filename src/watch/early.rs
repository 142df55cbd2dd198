//! Pictures of light that is still being solved.

use super::room::Room;
use super::showing::{frame, publish};
use crate::camera::Camera;
use crate::film::tone::auto_exposure;
use crate::integrator::Solution;
use crate::pipeline::exposing;
use crate::pipeline::viewing::Viewing;
use crate::scene::Scene;
use std::time::Duration;

/// Longer side of these pictures, pixels.
const SIDE: f64 = 320.0;

/// Shortest time from one to the next; and how many times as long as such a picture takes solving goes on before the next.
const BETWEEN: Duration = Duration::from_millis(250);
const SHARE: u32 = 4;

/// Shows what there is of the light, now and then.
pub(super) struct Early<'a> {
    pub(super) viewing: Viewing<'a>,
    pub(super) scene: &'a Scene,
    pub(super) camera: Camera,
    pub(super) room: &'a Room,
    /// When the next one may be shown.
    pub(super) next: Duration,
}

impl Early<'_> {
    /// Shows the light so far, unless it was just shown. What goes wrong is told by the picture that follows.
    pub(super) fn show(&mut self, so_far: &dyn Fn() -> Solution) {
        let start = self.viewing.world.now();
        if start < self.next || self.viewing.cancel.is_cancelled() {
            return;
        }
        let size = self.viewing.options.size.value;
        let scale = (SIDE / f64::from(size.width.max(size.height))).min(1.0);
        let side = |pixels: u32| ((f64::from(pixels) * scale).round() as u32).max(1);
        let (width, height) = (side(size.width), side(size.height));
        let Ok(prepared) = self.viewing.prepare(self.scene, &so_far()) else {
            return;
        };
        let seen = self
            .viewing
            .glimpse(&prepared, &self.camera, (width, height), 1);
        let Ok(image) = seen else { return };
        let exposure = match self.viewing.options.exposure.value {
            Some(stops) => exposing::factor(stops),
            None => {
                let subject = exposing::subject(self.scene, &self.camera, width, height);
                auto_exposure(&image, &subject)
            }
        };
        publish(self.room, &image, exposure, frame(&image, false, 0));
        let now = self.viewing.world.now();
        self.next = now + BETWEEN.max(now.saturating_sub(start) * SHARE);
    }
}
