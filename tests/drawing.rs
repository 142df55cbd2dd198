//! Real models, from their text to the shapes that light sees.

use std::f64::consts::PI;
use understory::check::{SourceModel, check};
use understory::color::{Rgb, palette};
use understory::diag::SourceMap;
use understory::geometry::Shape;
use understory::growth::{Growth, GrowthOptions};
use understory::interpret::{Interpretation, Limits, interpret};
use understory::light::{Light, Sky as Background};
use understory::scene::Scene;
use understory::scene::description::PlacedShape;
use understory::syntax::parse;
use understory::turtle::Layers;

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
    interpret(&mut grow(&text).sketch(), Limits::default()).expect("it can be drawn")
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
    let drawn = interpret(&mut grow(&text).sketch(), Limits::default()).unwrap();
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
        palette::ega(2),
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
    let failure = interpret(&mut grow(text).sketch(), Limits::default()).unwrap_err();
    assert!(
        failure.message.contains("in the body of `Bad`"),
        "{}",
        failure.message
    );
    assert!(failure.primary.is_some());

    let text = "module Endless(int n) ==> Endless(n + 1);\nprotected void init() [ Axiom ==> Endless(0); ]";
    let mut growth = grow(text);
    let failure = interpret(&mut growth.sketch(), Limits::default()).unwrap_err();
    assert_eq!(failure.slug, "body-depth");
    let nodes = growth.graph().n_nodes();
    assert!(nodes < 10, "{nodes} nodes: bodies left theirs behind");
}

/// Where shapes begin, along z.
fn heights(drawn: &Interpretation) -> Vec<f64> {
    let height = |shape: &PlacedShape| shape.to_group.translation.z;
    shapes(drawn).iter().map(height).collect()
}

/// As GroIMP's visitor of scenes does it: the shader of a node holds for all that follows and has none.
#[test]
fn what_has_no_shader_looks_as_what_it_hangs_on() {
    let drawn = draw(
        "[Sphere(1) M(1) F(1, 1, 4) M(1) Sphere(1) [Box.(setShader(BLUE)) Sphere(1)] Null Sphere(1)]
         [ShadedNull.(setShader(RED)) RU(30) Leaf [Leaf] F(1, 1, 2) Leaf]
         [Parallelogram(1, 1).(setLight(new AreaLight())) Sphere(1)]",
        "module Leaf ==> Sphere(2);",
    );
    let found: Vec<Rgb> = (0..12).map(|i| reflectance(&drawn, i)).collect();
    let (blue, red, grey) = (
        Rgb::new(0.0, 0.0, 1.0),
        Rgb::new(1.0, 0.0, 0.0),
        Rgb::splat(0.5),
    );
    let (four, two) = (palette::ega(4), palette::ega(2));
    let expected = [
        grey, four, four, blue, blue, four, red, red, two, two, grey, grey,
    ];
    assert_eq!(found, expected);
}

/// Axis.preTransform and postTransform of GroIMP: drawn from `startPosition * length` on, what follows stands at
/// `endPosition * length`.
#[test]
fn axes_begin_and_end_where_the_model_says() {
    let after = |axis: &str| heights(&draw(&format!("{axis} Sphere(0.1)"), ""));
    assert_eq!(after("Cylinder(2, 1)"), [0.0, 2.0]);
    assert_eq!(
        after("Cylinder(2, 1).(setStartPosition(-0.5))"),
        [-1.0, 2.0]
    );
    assert_eq!(after("Cone(2, 1).(setEndPosition(0.25))"), [0.0, 0.5]);
    let both = "Parallelogram(4, 1).(setStartPosition(0.5), setEndPosition(0.75))";
    assert_eq!(after(both), [2.0, 3.0]);
    assert_eq!(
        after("Box(2, 3, 5).(setShiftPivot(true))"),
        [-1.5, 2.0],
        "half the width, as in GroIMP"
    );
    assert_eq!(after("Box(2, true)"), [-0.5, 2.0]);
    assert_eq!(
        after("Frustum(2, 1, 1).(setTransforming(false))"),
        [0.0, 0.0]
    );
    assert_eq!(
        after("M(1) Null(0, 0, 5).(setTransforming(false)) Null(0, 0, 1)"),
        [2.0]
    );
}

#[test]
fn locations_know_where_axes_begin_and_end() {
    let text = "protected void init() [ Axiom ==> c:Cylinder(2, 1).(setStartPosition(-0.5), setEndPosition(3)) Sphere(1); ]
        public void run() [ (* c:Cylinder *) Sphere ==> Sphere(10 * endlocation(c).z - location(c).z); ]";
    let mut growth = grow(text);
    growth.step().expect("it runs");
    let drawn = interpret(&mut growth.sketch(), Limits::default()).unwrap();
    assert_eq!(heights(&drawn), [-1.0, 6.0]);
    let Shape::Sphere { radius } = shapes(&drawn)[1].shape else {
        panic!("a ball")
    };
    assert_eq!(radius, 61.0);
}

#[test]
fn a_grid_of_copies() {
    let drawn = draw(
        "M(5) RU(90) GridClonerNode(2, 10, 3, 4) RV(1) [Ball] Ball",
        "module Ball ==> Sphere(0.5);",
    );
    let root = &drawn.scene.groups[drawn.scene.root.unwrap().0 as usize];
    assert_eq!((root.shapes.len(), root.instances.len()), (0, 6));
    let moved: Vec<[f64; 3]> = root
        .instances
        .iter()
        .map(|copy| copy.to_group.translation.to_array().map(f64::round))
        .collect();
    // Local x points down after RU(90), local y still north.
    let expected = [
        [0.0, 0.0, 0.0],
        [0.0, 4.0, 0.0],
        [0.0, 8.0, 0.0],
        [0.0, 0.0, -10.0],
        [0.0, 4.0, -10.0],
        [0.0, 8.0, -10.0],
    ];
    assert_eq!(moved, expected);
    let group = &drawn.scene.groups[root.instances[0].group.0 as usize];
    assert_eq!(group.shapes.len(), 2);
    assert_eq!(drawn.summary.bounds.max.y, 8.5);
    assert!(Scene::build(drawn.scene).is_ok());

    for empty in ["0, 1, 2000000000, 1", "2000000000, 1, 0, 1", "-1, 1, 5, 1"] {
        let none = draw(&format!("GridClonerNode({empty}) Sphere(1)"), "");
        let root = &none.scene.groups[none.scene.root.unwrap().0 as usize];
        assert!(root.instances.is_empty(), "{empty}");
    }
    let limits = Limits {
        memory: 1 << 20,
        ..Limits::default()
    };
    let huge = "protected void init() [ Axiom ==> GridClonerNode(2000000000, 1, 2000000000, 1) Sphere(1); ]";
    assert!(
        interpret(&mut grow(huge).sketch(), limits).is_err(),
        "memory ends it"
    );
    let nested = "GridClonerNode(1, 1, 1, 1) ".repeat(100);
    let text = format!("protected void init() [ Axiom ==> {nested} Sphere(1); ]");
    let failure = interpret(&mut grow(&text).sketch(), Limits::default()).unwrap_err();
    assert_eq!(failure.slug, "instance-depth");
}

#[test]
fn hidden_layers_are_not_drawn_and_do_not_shine() {
    let rules =
        "[Sphere(1)] [Sphere(2).(setLayer(5)) M(1) Sphere(3)] [Helper] [Sphere(4).(setLayer(99))]
         [LightNode.(setLayer(15), setLight(new PointLight()))]";
    let modules =
        "module Helper extends Box(1, 1, 1) { { layer = 5; } } ==> Sphere(5).(setLayer(15));";
    let text = format!("{modules}\nprotected void init() [ Axiom ==> M(0) {rules}; ]");
    let counts = |hidden: &[i32]| {
        let layers = hidden.iter().fold(Layers::default(), |all, n| all.with(*n));
        let limits = Limits {
            hidden: layers,
            ..Limits::default()
        };
        let drawn = interpret(&mut grow(&text).sketch(), limits).unwrap();
        (shapes(&drawn).len(), drawn.scene.lights.len())
    };
    assert_eq!(counts(&[]), (6, 1), "as in GroIMP all are shown at first");
    assert_eq!(counts(&[5]), (4, 1));
    assert_eq!(counts(&[15]), (5, 0));
    assert_eq!(counts(&[0]), (4, 1));
    let drawn = draw("[Sphere(2).(setLayer(5)) M(1) Sphere(3)]", "");
    assert_eq!(heights(&drawn), [0.0, 1.0]);
}

#[test]
fn skies_shine_with_their_own_power_and_colour() {
    let plain = draw("Sky()", "");
    let Background::Uniform(radiance) = plain.scene.environment.sky else {
        panic!("a sky")
    };
    assert!((radiance.sum() * PI - 50.0).abs() < 1e-12);
    assert!(plain.summary.has_light);
    let red = draw(
        "[Sky.(setPowerDensity(3 * 2), setShader(RED), setLayer(1)) Sphere(1)]",
        "",
    );
    let Background::Uniform(radiance) = red.scene.environment.sky else {
        panic!("a sky")
    };
    assert!((radiance.r * PI - 6.0).abs() < 1e-12 && radiance.g == 0.0);
}

#[test]
fn a_mesh_in_a_variable_is_drawn_again_and_again() {
    let text = "import de.grogra.xl.util.*;
static MeshNode shared;
module Leaf(float size) ==> Scale(Math.sqrt(size / shared.getSurfaceArea())) shared.(setShader(GREEN)) Sphere(0.1);
protected void init() [
  { FloatList v = new FloatList(new float[] {0, 0, 0, 0.5, 1, 0}); v.push(-0.5, 1, 0); v.add(0); v.addAll(new float[] {7, 2, 0, 7}, 1, 2);
    PolygonMesh m = new PolygonMesh(); m.setVertexData(v); m.setIndexData(new IntList(new int[] {0, 1, 2, 2, 1, 3}));
    shared = new MeshNode(m); }
  Axiom ==> M(0) [Leaf(4)] [Leaf(9)];
]";
    let mut growth = grow(text);
    let drawn = interpret(&mut growth.sketch(), Limits::default()).unwrap();
    let again = interpret(&mut growth.sketch(), Limits::default()).unwrap();
    let meshes = |of: &Interpretation| {
        let shapes = of.scene.groups.iter().flat_map(|group| &group.shapes);
        shapes.filter(|s| matches!(s.shape, Shape::Mesh(_))).count()
    };
    assert!(meshes(&drawn) > 0);
    assert_eq!(meshes(&drawn), meshes(&again));
    assert_eq!(growth.counts().iter().map(|c| c.1).sum::<usize>(), 3);
}
