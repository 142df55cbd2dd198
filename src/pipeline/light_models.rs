//! Light models of a growing model: the graph as it stands becomes a scene, and photons of its own lamps are counted on it.

use super::audience::Audience;
use super::budget::readable;
use crate::diag::{Diagnostic, Span};
use crate::eval::light_model::{LightSettings, LightSolution, LightSolver, NodeLight};
use crate::eval::{Machine, Program};
use crate::growth::Sketch;
use crate::integrator::interception::{
    Interception, InterceptionError, Lighting, OrganLight, SensorField, Wanted,
};
use crate::integrator::requirements::Features;
use crate::integrator::{CancelToken, RenderContext};
use crate::interpret::{self, DecodedPictures, Interpretation, Organs, Purpose};
use crate::scene::{Scene, SceneError};
use std::sync::Arc;

/// Traces the light of light models within the budgets of a run.
pub struct SceneLight {
    /// Bytes that a scene, and what is counted on it, may take each.
    pub memory: u64,
    /// Nodes that bodies may make.
    pub body_nodes: u64,
    /// The wish to stop.
    pub cancel: CancelToken,
    /// Who is told how far it is.
    pub audience: Arc<dyn Audience>,
    /// Pictures of the last time that light was asked for; empty at first.
    pub pictures: DecodedPictures,
}

impl LightSolver for SceneLight {
    fn solve(
        &mut self,
        program: &Program,
        machine: &mut Machine,
        settings: &LightSettings,
    ) -> Result<LightSolution, Box<Diagnostic>> {
        // Bodies may draw random numbers; how often light is asked for must not change how the model grows.
        let random = machine.random.clone();
        let drawn = self.draw(program, machine, settings);
        machine.random = random;
        let Interpretation {
            scene,
            organs,
            summary,
            sensors,
            ..
        } = drawn?;
        if !summary.has_light {
            return Ok(LightSolution::default());
        }
        let explain = |error: &SceneError| Box::new(interpret::explain(error, &organs));
        let scene = Scene::build(scene).map_err(|error| explain(&error))?;
        let wanted = if settings.has_sensors {
            sensors
        } else {
            vec![]
        };
        let sensors = SensorField::new(wanted).map_err(|error| explain(&error))?;
        let lighting = self.trace(&scene, &organs, &sensors, settings)?;
        Ok(solution(&organs, &sensors, &lighting))
    }
}

impl SceneLight {
    fn draw(
        &mut self,
        program: &Program,
        machine: &mut Machine,
        settings: &LightSettings,
    ) -> Result<Interpretation, Box<Diagnostic>> {
        let limits = interpret::Limits {
            memory: self.memory,
            body_nodes: self.body_nodes,
            hidden: settings.hidden,
            purpose: Purpose::LightModel,
            ..interpret::Limits::default()
        };
        let mut sketch = Sketch::within_step(program, machine);
        interpret::interpret_again(&mut sketch, limits, &mut self.pictures)
    }

    fn trace(
        &self,
        scene: &Scene,
        organs: &Organs,
        sensors: &SensorField,
        settings: &LightSettings,
    ) -> Result<Lighting, Box<Diagnostic>> {
        let interception = Interception {
            photons: u64::from(settings.rays.unsigned_abs()),
            // Nobody asks for errors, and photons of one batch are spread best.
            batches: 1,
            max_depth: settings.depth.unsigned_abs(),
            wanted: Wanted::default(),
            most_photons: 0,
            memory: self.memory,
            plants: vec![],
            kept: Features::NONE,
        };
        let audience = &self.audience;
        audience.begins("tracing light");
        let context = RenderContext {
            seed: settings.seed.cast_unsigned(),
            cancel: &self.cancel,
            progress: &|progress| audience.progress(progress.done, progress.total),
        };
        let found = interception.solve(scene, organs.list().len(), sensors, None, &context);
        audience.begins("growing");
        found.map_err(|error| Box::new(blame(&error)))
    }
}

/// What stopped the light.
fn blame(error: &InterceptionError) -> Diagnostic {
    let (slug, message) = match error {
        InterceptionError::Cancelled => ("cancelled", error.to_string()),
        InterceptionError::Memory { organs, bytes } => (
            "memory-limit",
            format!(
                "counting the light on {organs} organs needs {} of memory",
                readable(*bytes)
            ),
        ),
    };
    let mut fault = Diagnostic::error(slug, Span::default(), message);
    fault.primary = None;
    fault.hint("`--max-memory` allows more, if the machine has it")
}

/// What was found, by node. A node in a grid of copies gets the mean over these.
fn solution(organs: &Organs, sensors: &SensorField, lighting: &Lighting) -> LightSolution {
    let lit = organs.list().iter().zip(&lighting.organs);
    let surfaces = lit.map(|(organ, light)| (organ.node, of_one(light, organ.copies)));
    // Several sensors of one node, such as its copies, are read as one: their mean.
    let mut copies = vec![0_u32; organs.list().len()];
    for sensor in sensors.sensors() {
        if let Some(n) = copies.get_mut(sensor.organ.0 as usize) {
            *n += 1;
        }
    }
    let readings = sensors.sensors().iter().zip(&lighting.sensed);
    let sensed = readings.filter_map(|(sensor, reading)| {
        let node = organs.get(sensor.organ)?.node;
        let n = f64::from(*copies.get(sensor.organ.0 as usize)?);
        let sensed = (*reading / n).to_array();
        Some((
            node,
            NodeLight {
                sensed,
                ..NodeLight::default()
            },
        ))
    });
    LightSolution::of(surfaces.chain(sensed))
}

fn of_one(light: &OrganLight, copies: u64) -> NodeLight {
    let share = 1.0 / copies.max(1) as f64;
    NodeLight {
        absorbed: (light.absorbed * share).to_array(),
        reflected: (light.reflected * share).to_array(),
        transmitted: (light.transmitted * share).to_array(),
        received: ((light.received[0] + light.received[1]) * share).to_array(),
        sensed: [0.0; 3],
        hits: light.hits / copies.max(1),
    }
}
