use super::*;
use crate::color::{Rgb, palette};
use crate::diag::{Diagnostic, FileId, Span};
use crate::eval::files::{ModelFiles, NoFiles};
use crate::eval::freeform::Freeform;
use crate::geometry::Shape;
use crate::graph::{EdgeBits, Graph, NodeId, Payload, TypeId, TypeTable};
use crate::light::{Light, Sky};
use crate::material::Material;
use crate::rewrite::Instantiated;
use crate::scene::Scene;
use crate::scene::description::{OrganId, PlacedShape};
use crate::turtle::types;
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;

#[derive(Clone, Copy, Debug, Default)]
enum Object {
    #[default]
    Null,
    Node(NodeId),
    /// Reflectance, transmittance and alpha.
    Surface([Rgb; 2], f64),
    Lamp(Lamp),
}

impl Payload for Object {
    fn is_null(&self) -> bool {
        matches!(self, Self::Null)
    }

    fn as_node(&self) -> Option<NodeId> {
        match self {
            Self::Node(node) => Some(*node),
            Self::Null | Self::Surface(..) | Self::Lamp(_) => None,
        }
    }

    fn as_vector(&self) -> Option<DVec3> {
        None
    }

    fn as_transform(&self) -> Option<DAffine3> {
        None
    }

    fn text(&self) -> String {
        format!("{self:?}")
    }
}

impl Appearance for Object {
    fn surface(&self, _: Purpose, _: &mut Finder<'_>) -> Option<Material> {
        match self {
            Self::Surface([back, through], alpha) => {
                Some(Material::leaf(*back, *through).with_alpha(*alpha))
            }
            Self::Null | Self::Node(_) | Self::Lamp(_) => None,
        }
    }

    fn lamp(&self) -> Option<Lamp> {
        match self {
            Self::Lamp(lamp) => Some(*lamp),
            Self::Null | Self::Node(_) | Self::Surface(..) => None,
        }
    }

    fn freeform(&self) -> Option<Freeform> {
        None
    }

    fn words(&self) -> Option<&str> {
        None
    }
}

/// Where built-in nodes are made: in the declaration of a module, and elsewhere.
static MADE: [Span; 2] = [
    Span {
        file: FileId(0),
        start: 5,
        end: 7,
    },
    Span {
        file: FileId(0),
        start: 20,
        end: 24,
    },
];

type MakeBody = fn(&mut World, &mut Instantiated);

/// A hand-made model.
struct World {
    graph: Graph<Object>,
    bodies: Vec<(TypeId, Body, MakeBody)>,
    n_runs: usize,
    fails: bool,
    is_stopped: bool,
}

impl World {
    /// Built-in types and modules of `Null` without fields of these names.
    fn new(modules: &[&str]) -> Self {
        let mut table: TypeTable = types();
        let null = table.find("Null").unwrap();
        for name in modules {
            table.add_module(name, null, false, &[]);
        }
        Self {
            graph: Graph::new(Arc::new(table), 20_000_000).unwrap(),
            bodies: vec![],
            n_runs: 0,
            fails: false,
            is_stopped: false,
        }
    }

    fn define(&mut self, module: &str, is_pure: bool, make: MakeBody) {
        let ty = self.graph.types().find(module).unwrap();
        self.bodies.push((ty, Body { is_pure }, make));
    }

    /// A floating node from a text such as `F(2,0.5)`.
    fn create(&mut self, text: &str) -> NodeId {
        let (name, args) = text.split_once('(').unwrap_or((text, ""));
        let args = args
            .trim_end_matches(')')
            .split(',')
            .filter(|a| !a.is_empty());
        let args: Vec<f64> = args.map(|a| a.parse().unwrap()).collect();
        let ty = self
            .graph
            .types()
            .find(name)
            .unwrap_or_else(|| panic!("{name}"));
        let node = self.graph.create(ty).unwrap();
        let row = crate::turtle::builtin(ty);
        let lists = row.map_or(&[] as &[_], |row| row.constructors);
        let fields = lists.iter().find(|list| list.len() == args.len());
        for (field, value) in fields.unwrap_or(&(&[] as &[_])).iter().zip(args) {
            let field = self.graph.types().field(ty, field).unwrap();
            self.graph.set_f64(node, field, value).unwrap();
        }
        node
    }

    /// Hangs nodes on `start`: words, with brackets as in a rule. Gives the last node.
    fn grow(&mut self, start: NodeId, text: &str) -> NodeId {
        let (mut at, mut open, mut bits) = (start, vec![], EdgeBits::SUCCESSOR);
        for word in text.split_whitespace() {
            match word {
                "[" => {
                    open.push(at);
                    bits = EdgeBits::BRANCH;
                }
                "]" => {
                    at = open.pop().unwrap();
                    bits = EdgeBits::SUCCESSOR;
                }
                _ => {
                    let node = self.create(word);
                    self.graph.insert(node).unwrap();
                    self.graph.add_edge(at, node, bits).unwrap();
                    (at, bits) = (node, EdgeBits::SUCCESSOR);
                }
            }
        }
        at
    }

    fn root(&self) -> NodeId {
        self.graph.root()
    }

    fn set(&mut self, node: NodeId, field: &str, value: Object) {
        let ty = self.graph.type_of(node).unwrap();
        let field = self.graph.types().field(ty, field).unwrap();
        self.graph.set_object(node, field, value).unwrap();
    }

    fn draw(&mut self) -> Interpretation {
        interpret(self, Limits::default()).unwrap()
    }

    fn refuse(&mut self, limits: Limits) -> Failure {
        interpret(self, limits).unwrap_err()
    }
}

impl Source for World {
    type Object = Object;

    fn graph(&self) -> &Graph<Object> {
        &self.graph
    }

    fn body(&self, ty: TypeId) -> Option<Body> {
        let found = self.bodies.iter().find(|(of, ..)| *of == ty);
        found.map(|(_, body, _)| *body)
    }

    fn instantiate(&mut self, node: NodeId) -> Result<Instantiated, Failure> {
        if self.fails {
            return Err(Box::new(Diagnostic::error(
                "test",
                Span::default(),
                "division by zero",
            )));
        }
        self.n_runs += 1;
        let ty = self.graph.type_of(node).unwrap();
        let (_, _, make) = self.bodies.iter().find(|(of, ..)| *of == ty).unwrap();
        let mut made = Instantiated::default();
        make(self, &mut made);
        Ok(made)
    }

    fn release(&mut self, made: Instantiated) {
        for node in made.nodes {
            self.graph.remove(node);
        }
    }

    fn files(&self) -> &dyn ModelFiles {
        &NoFiles
    }

    fn is_stopped(&self) -> bool {
        self.is_stopped
    }

    fn declared_at(&self, ty: TypeId) -> Option<Span> {
        let is_module = crate::turtle::builtin(ty).is_none();
        is_module.then(|| Span::new(FileId(0), 3, 9))
    }

    fn made_at(&self, ty: TypeId) -> &[Span] {
        if crate::turtle::builtin(ty).is_some() {
            &MADE
        } else {
            &[]
        }
    }
}

/// Makes what `text` says, with brackets and commas.
fn make(world: &mut World, made: &mut Instantiated, text: &str) {
    let (mut at, mut open, mut bits) = (None, vec![], EdgeBits::SUCCESSOR);
    for word in text.split_whitespace() {
        match word {
            "[" => {
                open.push(at);
                bits = EdgeBits::BRANCH;
            }
            "]" => {
                at = open.pop().unwrap();
                bits = EdgeBits::SUCCESSOR;
            }
            "," => at = None,
            _ => {
                let node = world.create(word);
                match at {
                    Some(at) => world.graph.add_edge(at, node, bits).unwrap(),
                    None => made.heads.push((node, bits == EdgeBits::BRANCH)),
                }
                made.nodes.push(node);
                (at, bits) = (Some(node), EdgeBits::SUCCESSOR);
            }
        }
    }
}

fn shapes(drawn: &Interpretation) -> &[PlacedShape] {
    &drawn.scene.groups[drawn.scene.root.unwrap().0 as usize].shapes
}

fn reflectance(drawn: &Interpretation, shape: &PlacedShape) -> Rgb {
    drawn.scene.materials[shape.material.0 as usize].sides[0].reflectance
}

fn slugs(drawn: &Interpretation) -> Vec<&'static str> {
    drawn.warnings.sorted().iter().map(|w| w.slug).collect()
}

/// Position and head of a shape, five decimals.
fn pose(shape: &PlacedShape) -> [f64; 6] {
    let (p, h) = (shape.to_group.translation, shape.to_group.matrix3.z_axis);
    [p.x, p.y, p.z, h.x, h.y, h.z].map(|x| (x * 1e5).round() / 1e5 + 0.0)
}

#[test]
fn grids_of_copies_are_instances() {
    let mut world = World::new(&[]);
    let root = world.root();
    world.grow(root, "[ GridClonerNode F(1) ] GridClonerNode F(1)");
    let drawn = world.draw();
    assert_eq!((slugs(&drawn), shapes(&drawn).len()), (vec![], 0));
    let world = &drawn.scene.groups[drawn.scene.root.unwrap().0 as usize];
    assert_eq!(world.instances.len(), 200, "ten by ten each");
}

#[test]
fn each_node_is_drawn_where_the_turtle_is() {
    let mut world = World::new(&[]);
    let root = world.root();
    world.grow(
        root,
        "F(2,0.5) [ RU(90) F(3,0.2) ] [ RL(90) P(2) F(1) ] Sphere(0.5) F(-1,0.2)",
    );
    let drawn = world.draw();
    let found: Vec<[f64; 6]> = shapes(&drawn).iter().map(pose).collect();
    let expected = [
        [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, 2.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 2.0, 0.0, -1.0, 0.0],
        [0.0, 0.0, 2.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
    ];
    assert_eq!(found, expected);
    assert_eq!(reflectance(&drawn, &shapes(&drawn)[0]), palette::ega(14));
    assert_eq!(reflectance(&drawn, &shapes(&drawn)[2]), palette::ega(2));
    assert_eq!(
        reflectance(&drawn, &shapes(&drawn)[3]),
        palette::ega(14),
        "a ball without a shader looks as the shoot it hangs on"
    );
    let names: Vec<_> = (0..5)
        .map(|i| drawn.organs.type_name(OrganId(i)).unwrap())
        .collect();
    assert_eq!(names, ["F", "F", "F", "Sphere", "F"]);
    assert!((drawn.summary.bounds.max - DVec3::new(3.0, 0.5, 2.5)).length() < 1e-12);
    assert!(!drawn.summary.has_light && !drawn.summary.has_plane);
    assert!(Scene::build(drawn.scene).is_ok());
}

#[test]
fn every_primitive_becomes_its_shape() {
    let mut world = World::new(&[]);
    let root = world.root();
    world.grow(
        root,
        "[ Sphere(1) ] [ Box(3,1,2) ] [ Cylinder(2,0.5) ] [ Cone(2,0.5) ] [ Frustum(2,0.5,0.25) ] \
         [ Parallelogram(2,1) ] [ Plane ] [ TextLabel ] [ LightNode ] [ F(0,1) ] [ F(1,0) ] [ M(3) ]",
    );
    let drawn = world.draw();
    let frustum = |base_radius, top_radius, top_cap| Shape::Frustum {
        length: 2.0,
        base_radius,
        top_radius,
        base_cap: true,
        top_cap,
    };
    let expected = [
        Shape::Sphere { radius: 1.0 },
        Shape::Box {
            half_x: 0.5,
            half_y: 1.0,
            length: 3.0,
        },
        frustum(0.5, 0.5, true),
        frustum(0.5, 0.0, false),
        frustum(0.5, 0.25, true),
        Shape::Parallelogram {
            corner: DVec3::new(-0.5, 0.0, 0.0),
            edge_u: DVec3::new(0.0, 0.0, 2.0),
            edge_v: DVec3::new(1.0, 0.0, 0.0),
        },
        Shape::Plane,
    ];
    let found: Vec<&Shape> = shapes(&drawn).iter().map(|s| &s.shape).collect();
    assert_eq!(found, expected.iter().collect::<Vec<_>>());
    assert!(drawn.summary.has_plane);
    assert!(Scene::build(drawn.scene).is_ok());
}

#[test]
fn long_chains_and_wide_forks_are_fast_and_in_order() {
    let mut world = World::new(&[]);
    let root = world.root();
    let mut at = root;
    for _ in 0..300_000 {
        at = world.grow(at, "F(1)");
    }
    for i in 0..1000 {
        world.grow(
            root,
            &format!("[ Translate({i},0,0) [ Sphere ] Cylinder(1,1) Sphere ]"),
        );
    }
    let drawn = world.draw();
    assert_eq!(shapes(&drawn).len(), 303_000);
    assert_eq!(drawn.summary.bounds.max.z, 300_000.0);
    assert_eq!(
        pose(&shapes(&drawn)[302_999]),
        [999.0, 0.0, 1.0, 0.0, 0.0, 1.0]
    );
    assert_eq!(drawn.scene.materials.len(), 2);
}

#[test]
fn a_node_with_two_parents_is_drawn_once() {
    let mut world = World::new(&[]);
    let root = world.root();
    let a = world.grow(root, "F(1)");
    let b = world.grow(root, "[ RU(90) F(2)");
    let shared = world.grow(b, "Sphere(1)");
    world
        .graph
        .add_edge(a, shared, EdgeBits::SUCCESSOR)
        .unwrap();
    let drawn = world.draw();
    assert_eq!(shapes(&drawn).len(), 3);
    assert_eq!(pose(&shapes(&drawn)[2])[0], 2.0);
}

#[test]
fn shaders_come_first_and_are_shared() {
    let mut world = World::new(&[]);
    let root = world.root();
    let red = Object::Surface([Rgb::new(1.0, 0.0, 0.0), Rgb::BLACK], 1.0);
    for _ in 0..3 {
        let node = world.grow(root, "[ F(1,1,3)");
        world.set(node, "shader", red);
    }
    let leaf = world.grow(root, "[ Sphere(1)");
    let impossible = Object::Surface([Rgb::splat(0.8); 2], 0.5);
    world.set(leaf, "shader", impossible);
    let drawn = world.draw();
    assert_eq!(drawn.scene.materials.len(), 2);
    assert_eq!(
        reflectance(&drawn, &shapes(&drawn)[1]),
        Rgb::new(1.0, 0.0, 0.0)
    );
    assert_eq!(slugs(&drawn), ["impossible-shader"]);
    assert_eq!(reflectance(&drawn, &shapes(&drawn)[3]), Rgb::splat(0.5));
    assert!(Scene::build(drawn.scene).is_ok());
}

fn lamp(kind: LampKind, power: f64) -> Object {
    Object::Lamp(Lamp {
        kind,
        color: [1.0; 3],
        power,
    })
}

#[test]
fn lamps_stand_where_their_nodes_are() {
    let mut world = World::new(&[]);
    let root = world.root();
    let down = world.grow(root, "[ Translate(0,0,10) RL(180) LightNode");
    world.set(down, "light", lamp(LampKind::Directional, 3.0));
    let bulb = world.grow(root, "[ Translate(1,2,3) LightNode");
    world.set(bulb, "light", lamp(LampKind::Point, 12.0 * PI));
    let sky = world.grow(root, "[ LightNode");
    world.set(sky, "light", lamp(LampKind::Sky, 3.0 * PI));
    let wrong = world.grow(root, "[ LightNode");
    world.set(wrong, "light", lamp(LampKind::Area { exponent: 1.0 }, 1.0));
    let drawn = world.draw();
    let expected = [
        Light::Directional {
            direction: DVec3::NEG_Z,
            irradiance: Rgb::WHITE,
            origin: DVec3::new(0.0, 0.0, 10.0),
        },
        Light::Point {
            position: DVec3::new(1.0, 2.0, 3.0),
            intensity: Rgb::WHITE,
        },
    ];
    assert_eq!(drawn.scene.lights, expected);
    assert_eq!(drawn.scene.environment.sky, Sky::Uniform(Rgb::WHITE));
    assert_eq!(slugs(&drawn), ["area-light-without-area"]);
    assert!(drawn.summary.has_light);
}

/// Golden 52: 100 W from one side, whatever the scale; the lamp's shader filters the colour, not the power.
#[test]
fn area_lights_send_their_power_from_the_front() {
    for (shader, expected) in [
        (None, [100.0 / 3.0; 3]),
        (Some([0.0; 3]), [0.0; 3]),
        (Some([1.0, 0.0, 0.0]), [100.0, 0.0, 0.0]),
        (Some([1.0; 3]), [100.0 / 3.0; 3]),
    ] {
        let mut world = World::new(&[]);
        let root = world.root();
        let panel = world.grow(root, "Scale(2) Parallelogram(3,0.5)");
        world.set(
            panel,
            "light",
            lamp(LampKind::Area { exponent: 1.0 }, 100.0),
        );
        if let Some(color) = shader {
            world.set(
                panel,
                "shader",
                Object::Surface([Rgb::from_array(color), Rgb::BLACK], 1.0),
            );
        }
        let drawn = world.draw();
        let material = &drawn.scene.materials[shapes(&drawn)[0].material.0 as usize];
        let power = material.emitted_radiance(true) * (PI * 6.0);
        let error = power - Rgb::from_array(expected);
        assert!(error.map(f64::abs).max_channel() < 1e-12, "{power:?}");
        assert!(material.emitted_radiance(false).is_black());
        assert_eq!(drawn.summary.has_light, expected[0] > 0.0);
    }
}

/// Golden 40: bodies draw with the module's turtle and do not move what follows.
#[test]
fn bodies_draw_but_do_not_move() {
    let mut world = World::new(&["Leaf", "Stalk"]);
    world.define("Leaf", true, |w, out| {
        make(w, out, "RL(90) Parallelogram(2,1)");
    });
    world.define("Stalk", false, |w, out| {
        make(w, out, "F(2,0.1) [ RU(90) F(1,0.1) ] F(3,0.1) , Sphere(1)");
    });
    let root = world.root();
    world.grow(root, "M(1) Leaf Stalk D(4) F(1)");
    let drawn = world.draw();
    let found: Vec<[f64; 6]> = shapes(&drawn).iter().map(pose).collect();
    let expected = [
        [0.0, 0.0, 1.0, 0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, 3.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 3.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
    ];
    assert_eq!(found, expected);
    let owners = shapes(&drawn)
        .iter()
        .map(|s| drawn.organs.type_name(s.organ).unwrap());
    assert_eq!(
        owners.collect::<Vec<_>>(),
        ["Leaf", "Stalk", "Stalk", "Stalk", "Stalk", "F"]
    );
    assert_eq!(world.graph.n_nodes(), 7, "what bodies made is gone");
}

#[test]
fn pure_bodies_are_drawn_once_and_placed() {
    let mut world = World::new(&["Leaf", "Twig"]);
    world.define("Leaf", true, |w, out| make(w, out, "Parallelogram(2,1)"));
    world.define("Twig", true, |w, out| {
        make(
            w,
            out,
            "F(1) [ RU(60) Leaf ] F(1) [ RU(-60) Leaf ] F(1) Leaf",
        );
    });
    let root = world.root();
    for i in 0..100 {
        world.grow(root, &format!("[ Translate({i},0,0) RH({i}) Twig"));
        world.grow(root, &format!("[ Translate({i},1,0) Leaf"));
    }
    let drawn = world.draw();
    assert_eq!(world.n_runs, 3, "twigs, leaves of twigs, grey leaves");
    let root_group = &drawn.scene.groups[drawn.scene.root.unwrap().0 as usize];
    assert_eq!(root_group.instances.len(), 100);
    assert_eq!(root_group.shapes.len(), 100);
    assert_eq!(pose(&root_group.shapes[7])[0], 7.0);
    let organ = root_group.instances[9].organ;
    assert_eq!(drawn.organs.type_name(organ), Some("Twig"));
    assert!((drawn.summary.bounds.max.z - 5.0).abs() < 1e-12);
    assert!(Scene::build(drawn.scene).is_ok());
    // A different diameter is a different twig.
    world.grow(root, "[ D(3) Twig");
    world.n_runs = 0;
    world.draw();
    assert_eq!(
        world.n_runs, 5,
        "two twigs, and the leaf at two diameters, one of them also grey"
    );
}

#[test]
fn bodies_that_feel_gravity_are_not_shared() {
    let mut world = World::new(&["Leaf"]);
    world.define("Leaf", true, |w, out| make(w, out, "RV(1) F(1)"));
    let root = world.root();
    world.grow(root, "[ RU(90) Leaf ] [ RU(120) Leaf ] [ RU(180) Leaf ]");
    let drawn = world.draw();
    let heads: Vec<f64> = shapes(&drawn).iter().map(|s| pose(s)[5]).collect();
    // h + (0, 0, -1), normalised.
    assert_eq!(
        heads,
        [-(0.5_f64.sqrt() * 1e5).round() / 1e5, -0.86603, -1.0]
    );
}

#[test]
fn endless_bodies_are_stopped() {
    let mut world = World::new(&["Again"]);
    world.define("Again", true, |w, out| make(w, out, "Again"));
    let root = world.root();
    world.grow(root, "Again");
    let failure = world.refuse(Limits::default());
    assert_eq!(failure.slug, "body-depth");
    assert!(failure.message.contains("`Again`"), "{}", failure.message);
    assert!(failure.primary.is_some());
    assert_eq!(world.graph.n_nodes(), 3, "nothing is left behind");

    let mut world = World::new(&["Again"]);
    world.define("Again", false, |w, out| {
        make(w, out, "[ Again ] [ Again ]");
    });
    let root = world.root();
    world.grow(root, "Again");
    let limits = Limits {
        body_nodes: 100,
        ..Limits::default()
    };
    assert_eq!(world.refuse(limits).slug, "body-limit");
}

#[test]
fn drawing_stops_when_told() {
    let mut world = World::new(&[]);
    let root = world.root();
    world.grow(root, &"F(1) ".repeat(5000));
    assert_eq!(shapes(&world.draw()).len(), 5000);
    world.is_stopped = true;
    assert_eq!(world.refuse(Limits::default()).slug, "cancelled");
}

#[test]
fn a_failing_body_ends_the_drawing() {
    let mut world = World::new(&["Leaf"]);
    world.define("Leaf", false, |w, out| make(w, out, "F(1)"));
    world.fails = true;
    let root = world.root();
    world.grow(root, "Leaf");
    let failure = world.refuse(Limits::default());
    assert_eq!(failure.message, "division by zero");
}

#[test]
fn instances_draw_a_subgraph_again() {
    let mut world = World::new(&["Hidden", "Tree"]);
    let root = world.root();
    let tree = world.grow(root, "[ Translate(50,0,0) Tree");
    world.grow(tree, "F(2,0.2) [ RU(90) F(1,0.1) ] Sphere(0.5)");
    let bulb = world.grow(tree, "[ M(4) LightNode");
    world.set(bulb, "light", lamp(LampKind::Point, 4.0 * PI));
    for place in ["Translate(1,0,0)", "Translate(2,0,0)", "Scale(0)"] {
        let node = world.grow(root, &format!("[ {place} Instance"));
        world.set(node, "prototype", Object::Node(tree));
    }
    let drawn = world.draw();
    let root_group = &drawn.scene.groups[drawn.scene.root.unwrap().0 as usize];
    assert_eq!(
        (root_group.shapes.len(), root_group.instances.len()),
        (3, 2)
    );
    let group = root_group.instances[0].group;
    assert_eq!(drawn.scene.groups[group.0 as usize].shapes.len(), 3);
    assert_eq!(
        pose(&drawn.scene.groups[group.0 as usize].shapes[0]),
        [0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
    );
    let places: Vec<f64> = drawn
        .scene
        .lights
        .iter()
        .map(|light| match light {
            Light::Point { position, .. } => position.x,
            _ => f64::NAN,
        })
        .collect();
    assert_eq!(places, [50.0, 1.0, 2.0]);
    assert_eq!(drawn.summary.bounds.min.x, 0.5);
    assert!(Scene::build(drawn.scene).is_ok());
}

#[test]
fn instances_within_themselves_are_refused() {
    let mut world = World::new(&["Tree"]);
    let root = world.root();
    let tree = world.grow(root, "Tree F(1)");
    let node = world.grow(tree, "Instance");
    world.set(node, "prototype", Object::Node(root));
    assert_eq!(world.refuse(Limits::default()).slug, "instance-cycle");
    world.set(node, "prototype", Object::Null);
    assert_eq!(slugs(&world.draw()), ["instance-of-null"]);
    let gone = world.create("Tree");
    world.graph.remove(gone);
    world.set(node, "prototype", Object::Node(gone));
    assert_eq!(world.refuse(Limits::default()).slug, "instance-gone");
}

#[test]
fn impossible_geometry_names_its_organ() {
    for (text, guilty) in [
        ("Sphere(NaN)", "`Sphere(NaN)`"),
        ("F(inf)", "`F("),
        (
            "M(1) Translate(NaN,0,0) F(1) Sphere(1)",
            "`Translate(NaN,0,0)`",
        ),
        ("Box(1,inf,1)", "`Box(1,"),
    ] {
        let mut world = World::new(&["Leaf"]);
        let root = world.root();
        world.grow(root, text);
        let failure = world.refuse(Limits::default());
        assert_eq!(failure.slug, "not-finite", "{text}");
        assert!(failure.message.starts_with(guilty), "{}", failure.message);
        let places: Vec<_> = failure.primary.iter().chain(&failure.secondary).collect();
        let spans: Vec<_> = places.iter().map(|label| label.span).collect();
        assert_eq!(spans, MADE, "where such nodes are made");
    }
    let mut world = World::new(&["Leaf"]);
    world.define("Leaf", true, |w, out| make(w, out, "F(NaN)"));
    let root = world.root();
    world.grow(root, "Leaf");
    let failure = world.refuse(Limits::default());
    assert!(
        failure.message.contains("`F(NaN)` in the body of `Leaf`"),
        "{}",
        failure.message
    );
    let place = failure.primary.map(|label| label.span);
    assert_eq!(place, Some(MADE[0]), "the one place in the body");
    assert!(failure.secondary.is_empty());
}

#[test]
fn what_is_scaled_away_is_skipped() {
    let mut world = World::new(&[]);
    let root = world.root();
    world.grow(
        root,
        "[ Scale(0) F(1) Sphere(1) ] [ Scale(1,1,0) Sphere(1) ] [ Scale(1,-1,1) Sphere(1) ]",
    );
    let drawn = world.draw();
    assert_eq!(shapes(&drawn).len(), 1);
    assert_eq!(slugs(&drawn), ["zero-scale", "zero-scale", "flat-scale"]);
    assert!(Scene::build(drawn.scene).is_ok());
}

#[test]
fn too_much_geometry_is_refused() {
    let mut world = World::new(&[]);
    let root = world.root();
    for _ in 0..100 {
        world.grow(root, "[ Sphere(1)");
    }
    let limits = Limits {
        memory: 10_000,
        ..Limits::default()
    };
    assert_eq!(world.refuse(limits).slug, "geometry-limit");
}

#[test]
fn lamps_of_instances_in_instances_are_counted() {
    let mut world = World::new(&["Tree"]);
    let root = world.root();
    let mut tree = world.grow(root, "[ Tree");
    let bulb = world.grow(tree, "[ M(4) LightNode");
    world.set(bulb, "light", lamp(LampKind::Point, 1.0));
    // Two of the tree before in each tree: 2^12 lamps.
    for _ in 0..12 {
        let next = world.grow(root, "[ Tree");
        for _ in 0..2 {
            let node = world.grow(next, "[ Instance");
            world.set(node, "prototype", Object::Node(tree));
        }
        tree = next;
    }
    let limits = Limits {
        memory: 100_000,
        ..Limits::default()
    };
    assert_eq!(world.refuse(limits).slug, "geometry-limit");
    assert!(world.draw().scene.lights.len() > 4096);
}

#[test]
fn scene_errors_name_the_organ() {
    let mut world = World::new(&[]);
    let root = world.root();
    world.grow(root, "Translate(1e30,0,0) Sphere(1)");
    let drawn = world.draw();
    let error = Scene::build(drawn.scene).unwrap_err();
    let told = explain(&error, &drawn.organs);
    assert!(
        told.message.starts_with("`Sphere` cannot be drawn"),
        "{}",
        told.message
    );
    assert_eq!(told.primary.map(|label| label.span), Some(MADE[0]));
}
