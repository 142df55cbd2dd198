//! Light models in the language: what they answer, what they refuse, and what they leave alone.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "support/models.rs"]
mod models;

use models::Model;
use std::sync::Arc;
use understory::diag::{Diagnostics, SourceMap};
use understory::integrator::CancelToken;
use understory::interpret::DecodedPictures;
use understory::pipeline::audience::Audience;
use understory::pipeline::light_models::SceneLight;

struct Nobody;

impl Audience for Nobody {
    fn printed(&self, _: &str) {}
    fn warned(&self, _: &SourceMap, _: &Diagnostics) {}
    fn begins(&self, _: &'static str) {}
    fn progress(&self, _: u64, _: u64) {}
    fn ends(&self) {}
}

const HEAD: &str = "import de.grogra.ray.physics.*;
module Sun(float z) extends LightNode.(setLight(new DirectionalLight().(setPowerDensity(3))), setTransform(0, 0, z));
module Leaf(float w) extends Parallelogram(1, w).(setShader(BLACK));
static String s(Spectrum t) { return \"\" + Math.round(t.integrate() * 1000) / 1000.0; }
";

/// Runs `init` with this body and gives what it prints, or the message it ends with.
fn run(modules: &str, body: &str) -> String {
    let text = format!("{HEAD}{modules}\nprotected void init() {{\n{body}\n}}");
    let mut model = Model::new(&text).unwrap();
    model.growth.set_light_solver(Box::new(SceneLight {
        memory: 1 << 30,
        body_nodes: 1 << 20,
        cancel: CancelToken::default(),
        audience: Arc::new(Nobody),
        pictures: DecodedPictures::default(),
    }));
    match model.growth.init() {
        Ok(()) => model.printed(),
        Err(fault) => format!("{}{}", model.printed(), fault.message),
    }
}

const SCENE: &str = "[ Axiom ==> [Translate(0, 0, 9) RL(180) Sun(0)] [RL(90) Leaf(2)]; ] derive();
LightModel lm = new LightModel(4000, 4); ";

#[test]
fn the_five_powers_of_a_leaf() {
    let grey = "module Grey extends Parallelogram(1, 1).(setShader(new LeafShader(new RGBColor(0.5, 0.5, 0.5), new RGBColor(0.25, 0.25, 0.25))));";
    let body = "[ Axiom ==> [Translate(0, 0, 9) RL(180) Sun(0)] [RL(90) Grey]; ] derive();
        FluxLightModel lm = new FluxLightModel(4000, 4); lm.compute();
        Grey g = first((* Grey *));
        println(s(lm.getAbsorbedPower(g)) + \" \" + s(lm.getReflectedPower(g)) + \" \" + s(lm.getTransmittedPower(g)) + \" \" + s(lm.getReceivedPower(g)) + \" \" + (lm.getHitCount(g) > 100) + \" \" + s(lm.getRadiantPowerFor(g)));";
    assert_eq!(run(grey, body), "0.75 1.5 0.75 3.0 true 0.75\n");
}

#[test]
fn what_is_not_known_is_dark_and_told_once() {
    let body = format!(
        "{SCENE} Leaf l = first((* Leaf *)); println(s(lm.getAbsorbedPower(l)) + s(lm.getAbsorbedPower(l))); lm.compute();
        [ Leaf ==> [Leaf(1)] Leaf(1); ] derive(); for ((* x:Leaf *)) println(s(lm.getAbsorbedPower(x)));"
    );
    let expected = "LightModel data has not yet been computed.\n0.00.0\n0.0\n0.0\n";
    assert_eq!(run("", &body), expected);
}

#[test]
fn impossible_settings_are_exceptions() {
    for (call, expected) in [
        (
            "lm.setDepth(0);",
            "depth must be a positive integer but was 0",
        ),
        (
            "lm.setRayCount(-1);",
            "rayCount must be a positive integer but was -1",
        ),
        ("new LightModel(5, 0);", "depth must be a positive integer"),
        (
            "new FluxLightModel(5, 5).setMeasureMode(MeasureMode.FULL_SPECTRUM);",
            "spectra are not computed",
        ),
    ] {
        let said = run("", &format!("{SCENE} {call}"));
        assert!(said.contains(expected), "{call}: {said}");
    }
    assert_eq!(
        run(
            "",
            &format!(
                "{SCENE} lm.setSeed(3); lm.setThreadCount(2); println(lm.getSeed() + lm.getDepth());"
            )
        ),
        "7\n"
    );
}

#[test]
fn layers_and_shaders_are_those_for_light() {
    let hidden = format!(
        "{SCENE} lm.setLayerVisible(0, false); lm.compute(); println(s(lm.getAbsorbedPower(first((* Leaf *)))));"
    );
    assert_eq!(run("", &hidden), "0.0\n");
    let shader = "module Two extends Parallelogram(1, 1).(setShader(new AlgorithmSwitchShader(WHITE, BLACK)));";
    let body = "[ Axiom ==> [Translate(0, 0, 9) RL(180) Sun(0)] [RL(90) Two]; ] derive();
        LightModel lm = new LightModel(4000, 4); lm.compute(); println(s(lm.getAbsorbedPower(first((* Two *)))));";
    assert_eq!(run(shader, body), "3.0\n");
}

/// A body's light belongs to its module; a node in a grid has the light of one copy; the generator is left alone.
#[test]
fn bodies_and_copies() {
    let plant = "module Plant() ==> RH(random(0, 360)) RL(90) Leaf(1);";
    let body = "[ Axiom ==> [Translate(0, 0, 9) RL(180) Sun(0)] [GridClonerNode.(setXCount(3), setYCount(2), setXDistance(5), setYDistance(5)) Plant]; ] derive();
        setSeed(1); double a = random(0, 1); setSeed(1);
        LightModel lm = new LightModel(20000, 4); lm.compute(); lm.compute();
        Plant p = first((* Plant *)); double x = lm.getAbsorbedPower(p).integrate();
        println((Math.abs(x - 3) < 0.1) + \" \" + (a == random(0, 1)));";
    assert_eq!(run(plant, body), "true true\n");
}

#[test]
fn a_sensor_reads_the_irradiance_on_its_plane() {
    let body = "[ Axiom ==> [Translate(0, 0, 9) RL(180) Sun(0)] [Translate(3, 0, 1) SensorNode().(setRadius(0.2))] [Translate(6, 0, 1) RL(60) SensorNode().(setRadius(0.2))] [RL(90) Leaf(2)]; ] derive();
        LightModel lm = new LightModel(100000, 4); lm.compute();
        for ((* x:SensorNode *)) println(Math.round(lm.getSensedIrradiance3d(x).integrate() * 10) / 10.0);";
    assert_eq!(run("", body), "3.0\n1.5\n");
}
