//! Real models, from their text to the shapes that light sees.

use std::f64::consts::PI;
use understory::check::{SourceModel, check};
use understory::color::{Rgb, palette};
use understory::diag::SourceMap;
use understory::geometry::Shape;
use understory::growth::{Growth, GrowthOptions};
use understory::interpret::{Interpretation, Limits, interpret};
use understory::light::Light;
use understory::scene::Scene;
use understory::scene::description::PlacedShape;
use understory::syntax::parse;

fn grow(text: &str) -> Growth {
    let file = SourceMap::default().add("model.rgg", text);
    let (ast, mut diagnostics) = parse(file, text);
    let name = "model.rgg".into();
    let (model, checked) = check(&[SourceModel { name, ast }]);
    diagnostics.append(checked);
    assert!(!diagnostics.has_errors(), "{diagnostics:#?}");
    let ignore = Box::new(|_: &str| {});
    let mut growth = Growth::new(&model, GrowthOptions::default(), ignore, Box::new(|| false))
        .expect("it begins");
    growth.init().expect("init runs");
    growth
}

/// Draws what hangs on `M(0)`: brackets at the very beginning of a rule would come in reverse order, as in GroIMP.
fn draw(rules: &str, modules: &str) -> Interpretation {
    let text = format!("{modules}\nprotected void init() [ Axiom ==> M(0) {rules}; ]");
    interpret(&mut grow(&text), Limits::default()).expect("it can be drawn")
}

fn shapes(drawn: &Interpretation) -> &[PlacedShape] {
    &drawn.scene.groups[drawn.scene.root.expect("a world").0 as usize].shapes
}

fn reflectance(drawn: &Interpretation, at: usize) -> Rgb {
    let material = &drawn.scene.materials[shapes(drawn)[at].material.0 as usize];
    material.sides[0].reflectance
}

/// Golden 40: every module with a body draws it, and what follows stays where it was.
#[test]
fn bodies_of_the_golden_model() {
    let text = std::fs::read_to_string("tests/golden/40-instantiation/model.rgg").unwrap();
    let drawn = interpret(&mut grow(&text), Limits::default()).unwrap();
    let mut owners: Vec<&str> = shapes(&drawn)
        .iter()
        .map(|shape| drawn.organs.type_name(shape.organ).unwrap())
        .collect();
    owners.sort_unstable();
    let expected = [
        "Ball", "Ball", "Ball", "Ball", "Inter", "Inter", "Leaf", "Stalk", "Stalk",
    ];
    assert_eq!(owners, expected);
    let of = |name| {
        let is_its = |s: &PlacedShape| drawn.organs.type_name(s.organ) == Some(name);
        shapes(&drawn).iter().rposition(is_its).unwrap()
    };
    assert_eq!(reflectance(&drawn, of("Leaf")), Rgb::new(0.0, 1.0, 0.0));
    // The branch of `Inter` begins where its own cylinder ends.
    assert_eq!(shapes(&drawn)[of("Inter")].to_group.translation.z, 1.5);
    assert!(Scene::build(drawn.scene).is_ok());
}

#[test]
fn colours_shaders_and_setters() {
    let drawn = draw(
        "[F(1,1,4)] [P(2) F(1) Sphere(1)] [Sphere(1).(setShader(new RGBAShader(0.25, 0.5, 0.75)))] \
         [Box(1,1,1).(setColor(1, 0, 0))] [F(1).(setShader(BLUE))] [Sphere(1).(setTransform(1, 2, 3))]",
        "",
    );
    let found: Vec<Rgb> = (0..7).map(|i| reflectance(&drawn, i)).collect();
    let expected = [
        palette::ega(4),
        palette::ega(2),
        Rgb::splat(0.5),
        Rgb::new(0.25, 0.5, 0.75),
        Rgb::new(1.0, 0.0, 0.0),
        Rgb::new(0.0, 0.0, 1.0),
        Rgb::splat(0.5),
    ];
    assert_eq!(found, expected);
    assert_eq!(
        shapes(&drawn)[6].to_group.translation.to_array(),
        [1.0, 2.0, 3.0]
    );
}

#[test]
fn leaves_transmit() {
    let drawn = draw(
        "Parallelogram(1, 1).(setShader(leaf()))",
        "static Phong leaf() { Phong p = new Phong(); p.setDiffuse(new RGBColor(0.1, 0.4, 0.1));
            p.setDiffuseTransparency(new RGBColor(0.2, 0.3, 0.1)); return p; }",
    );
    let sides = &drawn.scene.materials[0].sides;
    assert!((sides[1].transmittance.g - 0.3).abs() < 1e-7);
    assert!((sides[1].reflectance.g - 0.4).abs() < 1e-7);
}

#[test]
fn lamps_of_a_model() {
    let drawn = draw(
        "[Translate(0, 0, 10) RL(180) LightNode().(setLight(new DirectionalLight().(setPowerDensity(3))))] \
         [M(2) LightNode().(setLight(new PointLight().(setPower(12))))] \
         [Parallelogram(2, 3).(setLight(new AreaLight().(setPower(90))))]",
        "",
    );
    let [
        Light::Directional {
            direction,
            irradiance,
            ..
        },
        Light::Point { intensity, .. },
    ] = &drawn.scene.lights[..]
    else {
        panic!("{:?}", drawn.scene.lights)
    };
    assert_eq!(direction.to_array(), [0.0, 0.0, -1.0]);
    assert_eq!(*irradiance, Rgb::WHITE);
    assert!((intensity.sum() - 12.0 / (4.0 * PI)).abs() < 1e-12);
    let panel = &drawn.scene.materials[shapes(&drawn)[0].material.0 as usize];
    assert!((panel.emitted_radiance(true).sum() * PI * 6.0 - 90.0).abs() < 1e-10);
    assert!(drawn.summary.has_light);
}

#[test]
fn a_forest_of_instances_costs_one_tree() {
    let drawn = draw(
        "[Translate(0, 0, 0) tree:Tree [F(3, 0.2) for (int i : 1:50) (RH(137) [RU(60) Leaf(0.3)] F(0.05, 0.1))]]
         for (int i : 1:200) ([Translate(2 * (i % 20), 2 * (i / 20), 0) RH(i * 37) Instance(tree)])",
        "module Tree; module Leaf(float s) ==> Parallelogram(s, s / 2).(setShader(GREEN));",
    );
    let root = &drawn.scene.groups[drawn.scene.root.unwrap().0 as usize];
    assert_eq!((root.shapes.len(), root.instances.len()), (101, 200));
    let tree = &drawn.scene.groups[root.instances[0].group.0 as usize];
    assert_eq!(tree.shapes.len(), 101);
    assert!(matches!(tree.shapes[0].shape, Shape::Frustum { .. }));
    assert!(Scene::build(drawn.scene).is_ok());
}

#[test]
fn failures_name_the_organ_and_its_module() {
    let text = "module Bad(float x) ==> F(x / 0);\nprotected void init() [ Axiom ==> Bad(0); ]";
    let failure = interpret(&mut grow(text), Limits::default()).unwrap_err();
    assert!(
        failure.message.contains("in the body of `Bad`"),
        "{}",
        failure.message
    );
    assert!(failure.primary.is_some());

    let text = "module Endless(int n) ==> Endless(n + 1);\nprotected void init() [ Axiom ==> Endless(0); ]";
    let mut growth = grow(text);
    let failure = interpret(&mut growth, Limits::default()).unwrap_err();
    assert_eq!(failure.slug, "body-depth");
    let nodes = growth.graph().n_nodes();
    assert!(nodes < 10, "{nodes} nodes: bodies left theirs behind");
}
