//! The scene side of the language: what is accepted and does its work, what is accepted and idle, what is refused and how.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "support/models.rs"]
mod models;

use models::Model;
use understory::check::{SourceModel, check};
use understory::diag::{Severity, SourceMap};
use understory::syntax::parse;

/// What a model prints in `init` and one step.
fn printed(declarations: &str, statements: &str) -> String {
    let text = format!(
        "{declarations}\nprotected void init() [ Axiom ==> M(0); ]\npublic void run() {{ {statements} }}"
    );
    let mut model = Model::new(&text).unwrap_or_else(|errors| panic!("{errors:?}"));
    model.growth.init().unwrap();
    model.growth.step().unwrap();
    model.printed()
}

/// All that is found wrong with a model: slug and whole text.
fn found(text: &str) -> Vec<(Severity, String, String)> {
    let file = SourceMap::default().add("model.rgg", text);
    let (ast, mut diagnostics) = parse(file, text);
    let name = "model.rgg".into();
    diagnostics.append(check(&[SourceModel { name, ast }]).1);
    let all = diagnostics.sorted().into_iter();
    all.map(|d| (d.severity, d.slug.to_owned(), format!("{d:?}")))
        .collect()
}

#[test]
fn lights_have_the_defaults_of_groimp_and_tell_them() {
    let text = printed(
        "",
        "println(new PointLight().getPower()); println(new SpotLight().getPower());
         println(new DirectionalLight().getPowerDensity()); println(new AreaLight().getPower());
         SpotLight s = new SpotLight(); s.setInnerAngle(0.25); s.setOuterAngle(0.5);
         println(s.getInnerAngle() + s.getOuterAngle());
         s.setAttenuationExponent(2); s.setAttenuationDistance(3); s.setShadowless(true); s.setIgnoreShadows(true);
         println(new Sky().getPowerDensity());",
    );
    assert_eq!(text, "100.0\n100.0\n10.0\n100.0\n0.75\n50.0\n");
}

#[test]
fn light_models_keep_their_settings() {
    let text = printed(
        "",
        "LightModel lm = new LightModel(); println(lm.getRayCount() + \" \" + lm.getDepth());
         lm = new LightModel(1000, 5, 0.01); lm.setLayerVisible(15, false); lm.setLayerVisible(15, true); lm.setMinPower(0.1);
         lm.setThreadCount(4); lm.setRayCount(7); println(lm.getRayCount());",
    );
    assert_eq!(text, "30000 10\n7\n");
}

#[test]
fn attributes_of_nodes_can_be_set_and_read() {
    let text = printed(
        "module Sense extends SensorNode().(setRadius(0.02), setTwoSided(false), setLayer(15));
         module Text extends TextLabel(\"a\").(setHeight(0.1));",
        "Parallelogram p = new Parallelogram(1, 2); p.setAxis(0.5, 0.25, 0); println(p.getAxis()); p.setScaleV(true);
         Cone c = new Cone(1, 2); c.setOpen(true); println(c.isBaseOpen());
         GridClonerNode g = new GridClonerNode(); println(g.getXCount() + \" \" + g.getYDistance());
         Sphere s = new Sphere(2); s.setLayer(3); s.setTransforming(false); s.setTreatedAsInfinite(true);
         s.setRenderAsWireframe(true); println(s.getLayer() + \" \" + s.isTransforming());",
    );
    assert_eq!(text, "(0.5, 0.25, 0.0)\ntrue\n10 10.0\n3 false\n");
}

#[test]
fn calls_that_do_nothing_here_warn() {
    for (call, hint) in [
        ("makeSnapshot(\"a.png\");", "understory render"),
        ("makeSnapshot(\"a.png\", 100, 100);", "understory render"),
        ("export3DScene(\"a.x3d\", \"x3d\");", "export"),
        ("saveGraph(\"a.gs\");", "--json"),
    ] {
        let text =
            format!("protected void init() [ Axiom ==> M(0); ]\npublic void run() {{ {call} }}");
        let all = found(&text);
        assert_eq!(all.len(), 1, "{call}: {all:?}");
        let (severity, slug, whole) = &all[0];
        assert_eq!(
            (*severity, slug.as_str()),
            (Severity::Warning, "does-nothing")
        );
        assert!(whole.contains(hint), "{call}: {whole}");
        let mut model = Model::new(&text).unwrap();
        model.growth.init().unwrap();
        model.growth.step().expect("it does no harm");
    }
}

#[test]
fn what_is_no_part_of_a_scene_here_is_refused_with_what_to_do() {
    for (name, hint) in [
        ("Camera()", "--eye"),
        ("CameraNode()", "[camera]"),
        ("Sky().(setShader(new SunSkyLight()))", "--sun"),
        ("Line(1, 2, 3)", "F(length, diameter)"),
        ("Ellipsoid(1, 2, 3)", "Scale"),
        ("Fog()", "leave it out"),
        ("SensorNodeGrid(0.5, 1.0, 5, 10, 0.034)", "in a loop"),
        ("Supershape()", "curved shapes"),
        (
            "M(0) { ColorGradient g = new ColorGradient(\"jet\", 0, 1); }",
            "RGBAShader",
        ),
    ] {
        let text = format!("protected void init() [ Axiom ==> {name}; ]");
        let all = found(&text);
        let errors: Vec<&(Severity, String, String)> =
            all.iter().filter(|d| d.0 == Severity::Error).collect();
        assert!(!errors.is_empty(), "{name}");
        assert!(
            errors.iter().any(|e| e.2.contains(hint)),
            "{name}: {errors:?}"
        );
    }
}
