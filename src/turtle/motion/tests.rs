#![allow(
    clippy::approx_constant,
    reason = "the numbers are what GroIMP printed, rounded"
)]

use super::*;
use crate::turtle::effect::{Effect, Target};
use crate::turtle::{builtin_types, types};

/// Golden 01-turtle-rotations: mark, commands, where they lead, which way the head looks there.
const GOLDEN_01: &[(&str, &str, [f64; 3], [f64; 3])] = &[
    ("RU30", "RU(30)", [0.0, 0.0, 0.0], [0.5, 0.0, 0.86603]),
    ("RU90", "RU(90)", [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
    ("RU-30", "RU(-30)", [0.0, 0.0, 0.0], [-0.5, 0.0, 0.86603]),
    ("RL30", "RL(30)", [0.0, 0.0, 0.0], [0.0, -0.5, 0.86603]),
    ("RL90", "RL(90)", [0.0, 0.0, 0.0], [0.0, -1.0, 0.0]),
    ("RH30", "RH(30)", [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
    (
        "RH30RU90",
        "RH(30) RU(90)",
        [0.0, 0.0, 0.0],
        [0.86603, 0.5, 0.0],
    ),
    (
        "RH90RU90",
        "RH(90) RU(90)",
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
    ),
    (
        "RH90RL90",
        "RH(90) RL(90)",
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
    ),
    (
        "RU30RH90RU30",
        "RU(30) RH(90) RU(30)",
        [0.0, 0.0, 0.0],
        [0.43301, 0.5, 0.75],
    ),
    (
        "mix",
        "RL(30) RU(45) RH(20) M(2)",
        [1.41421, -0.70711, 1.22474],
        [0.70711, -0.35355, 0.61237],
    ),
    ("Plus30", "Plus(30)", [0.0, 0.0, 0.0], [0.5, 0.0, 0.86603]),
    (
        "Minus30",
        "Minus(30)",
        [0.0, 0.0, 0.0],
        [-0.5, 0.0, 0.86603],
    ),
    ("RU400", "RU(400)", [0.0, 0.0, 0.0], [0.64279, 0.0, 0.76604]),
];

/// Golden 02-turtle-move: mark, commands, where they lead, which way the head looks there.
const GOLDEN_02: &[(&str, &str, [f64; 3], [f64; 3])] = &[
    ("none", "", [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
    ("M2", "M(2)", [0.0, 0.0, 2.0], [0.0, 0.0, 1.0]),
    ("M-2", "M(-2)", [0.0, 0.0, -2.0], [0.0, 0.0, 1.0]),
    ("M", "M", [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]),
    ("F3", "F(3)", [0.0, 0.0, 3.0], [0.0, 0.0, 1.0]),
    ("F3d", "F(3,0.5)", [0.0, 0.0, 3.0], [0.0, 0.0, 1.0]),
    ("F3dc", "F(3,0.5,4)", [0.0, 0.0, 3.0], [0.0, 0.0, 1.0]),
    ("F", "F", [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]),
    ("F0", "F0", [0.0, 0.0, 100.0], [0.0, 0.0, 1.0]),
    ("M0", "M0", [0.0, 0.0, 100.0], [0.0, 0.0, 1.0]),
    ("L2F0", "L(2) F0", [0.0, 0.0, 2.0], [0.0, 0.0, 1.0]),
    ("L2M0", "L(2) M0", [0.0, 0.0, 2.0], [0.0, 0.0, 1.0]),
    ("L2F0F0", "L(2) F0 F0", [0.0, 0.0, 4.0], [0.0, 0.0, 1.0]),
    (
        "LMul",
        "L(3) LMul(0.5) F0",
        [0.0, 0.0, 1.5],
        [0.0, 0.0, 1.0],
    ),
    (
        "LAdd",
        "L(3) LAdd(0.5) F0",
        [0.0, 0.0, 3.5],
        [0.0, 0.0, 1.0],
    ),
    ("Ll", "L(3) Ll(1) F0", [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]),
    ("Ll2", "L(3) Ll(1) F0 F0", [0.0, 0.0, 4.0], [0.0, 0.0, 1.0]),
    (
        "LlMul",
        "L(3) LlMul(0.5) F0",
        [0.0, 0.0, 1.5],
        [0.0, 0.0, 1.0],
    ),
    (
        "LlAdd",
        "L(3) LlAdd(0.5) F0 F0",
        [0.0, 0.0, 6.5],
        [0.0, 0.0, 1.0],
    ),
    ("L0", "L(3) L0 F0", [0.0, 0.0, 100.0], [0.0, 0.0, 1.0]),
    ("FAdd", "L(3) FAdd(1)", [0.0, 0.0, 4.0], [0.0, 0.0, 1.0]),
    ("FMul", "L(3) FMul(2)", [0.0, 0.0, 6.0], [0.0, 0.0, 1.0]),
    ("MAdd", "L(3) MAdd(1)", [0.0, 0.0, 4.0], [0.0, 0.0, 1.0]),
    ("MMul", "L(3) MMul(2)", [0.0, 0.0, 6.0], [0.0, 0.0, 1.0]),
    ("F-1", "F(3) F(-1)", [0.0, 0.0, 2.0], [0.0, 0.0, 1.0]),
];

/// Golden 05-turtle-adjust-tropism: mark, commands, where they lead, which way the head looks there.
const GOLDEN_05: &[(&str, &str, [f64; 3], [f64; 3])] = &[
    (
        "RV0.1@90",
        "RU(90) RV(0.1)",
        [0.0, 0.0, 0.0],
        [0.99504, 0.0, -0.0995],
    ),
    (
        "RV1@90",
        "RU(90) RV(1)",
        [0.0, 0.0, 0.0],
        [0.70711, 0.0, -0.70711],
    ),
    (
        "RV-0.5@90",
        "RU(90) RV(-0.5)",
        [0.0, 0.0, 0.0],
        [0.89443, 0.0, 0.44721],
    ),
    (
        "RV0.5@45",
        "RU(45) RV(0.5)",
        [0.0, 0.0, 0.0],
        [0.95968, 0.0, 0.28108],
    ),
    ("RV1@0", "RV(1)", [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
    (
        "RV-1@180",
        "RU(180) RV(-1)",
        [0.0, 0.0, 0.0],
        [0.0, 0.0, -1.0],
    ),
    (
        "RV2@60",
        "RU(60) RV(2)",
        [0.0, 0.0, 0.0],
        [0.5, 0.0, -0.86603],
    ),
    (
        "RVmix",
        "RU(30) RL(30) RV(0.4)",
        [0.0, 0.0, 0.0],
        [0.57864, -0.66815, 0.46771],
    ),
    ("RG", "RU(70) RG", [0.0, 0.0, 0.0], [0.0, 0.0, -1.0]),
    (
        "RGRU90",
        "RU(70) RL(20) RG RU(90)",
        [0.0, 0.0, 0.0],
        [-0.88074, 0.47361, 0.0],
    ),
    (
        "RDx0.5",
        "RU(40) RD(1,0,0,0.5)",
        [0.0, 0.0, 0.0],
        [0.8825, 0.0, 0.47031],
    ),
    (
        "RDy1",
        "RD(0,1,0,1)",
        [0.0, 0.0, 0.0],
        [0.0, 0.84147, 0.5403],
    ),
    (
        "RDz5",
        "RU(40) RD(0,0,5,0.5)",
        [0.0, 0.0, 0.0],
        [-0.78879, 0.0, 0.61466],
    ),
    (
        "RP",
        "M(1) RP(1,0,1,0.5)",
        [0.0, 0.0, 1.0],
        [0.47943, 0.0, 0.87758],
    ),
    (
        "RPorigin",
        "RU(30) M(1) RP(0,0,0,0.5)",
        [0.5, 0.0, 0.86603],
        [0.5, 0.0, 0.86603],
    ),
    (
        "RPfar",
        "M(1) RP(5,0,1,0.5)",
        [0.0, 0.0, 1.0],
        [0.47943, 0.0, 0.87758],
    ),
    (
        "RPoblique",
        "RU(20) M(1) RP(3,1,2,0.5)",
        [0.34202, 0.0, 0.93969],
        [0.63913, 0.16082, 0.7521],
    ),
    (
        "RO",
        "RU(40) RO(1,0,0,0.5)",
        [0.0, 0.0, 0.0],
        [0.36789, 0.0, 0.92987],
    ),
    (
        "HDir30",
        "RU(70) HDir(30)",
        [0.0, 0.0, 0.0],
        [0.5, 0.0, 0.86603],
    ),
    (
        "HDir90",
        "RU(70) RL(20) HDir(90)",
        [0.0, 0.0, 0.0],
        [0.9325, -0.36118, 0.0],
    ),
    (
        "HDir45@0",
        "HDir(45)",
        [0.0, 0.0, 0.0],
        [0.0, -0.70711, 0.70711],
    ),
    (
        "AdjX",
        "RU(70) RH(40) AdjustLU RU(90)",
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
    ),
    (
        "AdjY",
        "RU(70) RH(40) AdjustLU RL(90)",
        [0.0, 0.0, 0.0],
        [0.34202, 0.0, -0.93969],
    ),
    (
        "AdjL70",
        "RL(70) RH(10) AdjustLU RL(90)",
        [0.0, 0.0, 0.0],
        [0.0, -0.34202, -0.93969],
    ),
    (
        "Adj@0",
        "AdjustLU RL(90)",
        [0.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
    ),
    (
        "V0.4RV0",
        "RU(80) RL(15) V(0.4) RV0",
        [0.0, 0.0, 0.0],
        [0.93921, -0.25554, -0.22933],
    ),
    (
        "V0.4F",
        "RU(80) V(0.4) F(1)",
        [0.98481, 0.0, 0.17365],
        [0.98481, 0.0, 0.17365],
    ),
    (
        "VaddmulRV0",
        "RU(80) V(0.4) VAdd(0.1) VMul(2) RV0",
        [0.0, 0.0, 0.0],
        [0.76604, 0.0, -0.64279],
    ),
    (
        "VF3",
        "RU(90) V(0.3) F(1) RV0 F(1) RV0 F(1)",
        [2.81031, 0.0, -0.8101],
        [0.85249, 0.0, -0.52275],
    ),
];

/// Golden 07-geometry-moves: mark, commands, where they lead, which way the head looks there.
const GOLDEN_07: &[(&str, &str, [f64; 3], [f64; 3])] = &[
    ("Box", "Box(2,3,4)", [0.0, 0.0, 2.0], [0.0, 0.0, 1.0]),
    ("Box()", "Box", [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]),
    (
        "Cylinder",
        "Cylinder(2,0.5)",
        [0.0, 0.0, 2.0],
        [0.0, 0.0, 1.0],
    ),
    ("Cone", "Cone(2,0.5)", [0.0, 0.0, 2.0], [0.0, 0.0, 1.0]),
    (
        "Frustum",
        "Frustum(2,0.5,0.2)",
        [0.0, 0.0, 2.0],
        [0.0, 0.0, 1.0],
    ),
    ("Sphere", "Sphere(0.7)", [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
    (
        "Parallelogram",
        "Parallelogram(2,1)",
        [0.0, 0.0, 2.0],
        [0.0, 0.0, 1.0],
    ),
    ("Plane", "Plane", [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
    ("TextLabel", "TextLabel", [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
    (
        "BoxBox",
        "Box(2,3,4) Box(2,3,4)",
        [0.0, 0.0, 4.0],
        [0.0, 0.0, 1.0],
    ),
    (
        "CylCone",
        "Cylinder(1,0.5) Cone(1,0.5)",
        [0.0, 0.0, 2.0],
        [0.0, 0.0, 1.0],
    ),
    (
        "RUCyl",
        "RU(90) Cylinder(2,0.1)",
        [2.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
    ),
    (
        "CylEnd1",
        "Cylinder(2,0.5)",
        [0.0, 0.0, 2.0],
        [0.0, 0.0, 1.0],
    ),
    (
        "CylStart-0.5",
        "Cylinder(2,0.5)",
        [0.0, 0.0, 2.0],
        [0.0, 0.0, 1.0],
    ),
    ("BoxShift", "Box(2,3,4)", [0.0, 0.0, 2.0], [0.0, 0.0, 1.0]),
    (
        "SphereTransform",
        "Sphere(1)@1,2,3",
        [1.0, 2.0, 3.0],
        [0.0, 0.0, 1.0],
    ),
    ("LightNode", "LightNode()", [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
];

/// The action of a command written as `RU(30)`, `RD(1,0,0,0.5)` or `F`, by the table of built-in types. Geometry with a
/// translation of its own is written `Sphere(1)@1,2,3`.
fn actions(command: &str) -> Vec<Action> {
    let (command, offset) = command.split_once('@').unwrap_or((command, ""));
    let (name, args) = command.split_once('(').unwrap_or((command, ""));
    let args: Vec<f64> = numbers(args.trim_end_matches(')'));
    let ty = builtin_types().find(|ty| ty.name == name).unwrap();
    let table = types();
    let id = table.find(name).unwrap();
    let parameters = ty
        .constructors
        .iter()
        .filter(|list| list.len() <= args.len())
        .max_by_key(|list| list.len());
    let number = |field: &str| -> f64 {
        let given = parameters
            .and_then(|list| list.iter().position(|p| *p == field))
            .and_then(|i| args.get(i).copied());
        let default = || {
            table
                .field(id, field)
                .map(|f| table[id].fields[usize::from(f.0)].default)
        };
        given.or_else(default).unwrap_or(0.0)
    };
    let triple = |fields: [&str; 3]| DVec3::from_array(fields.map(number));
    let bend = || (DVec3::from_slice(&args), args[3]);
    let action = match ty.effect {
        Effect::None | Effect::Group | Effect::Instance | Effect::Grid => Action::None,
        Effect::Step { length, is_shoot } => {
            let field = if length == StepLength::Own {
                "length"
            } else {
                "argument"
            };
            let own = number(field) as f32;
            Action::Step {
                length,
                own,
                is_shoot,
            }
        }
        Effect::Turn(axis, sign) => Action::Turn(axis, f64::from(sign) * number("angle")),
        Effect::SetInclination => Action::SetInclination(number("angle")),
        Effect::AdjustUp => Action::AdjustUp,
        Effect::HeadDown => Action::HeadDown,
        Effect::Gravitropism => Action::Gravitropism(number("strength")),
        Effect::RegisterGravitropism => Action::RegisterGravitropism,
        Effect::Tropism(Target::Direction) => Action::BendTowards(bend().0, bend().1),
        Effect::Tropism(Target::Plane) => Action::BendAcross(bend().0, bend().1),
        Effect::Tropism(Target::Point | Target::Node) => Action::BendToPoint(bend().0, bend().1),
        Effect::Assign(register, change, scope) => {
            Action::Assign(register, change, scope, number("argument") as f32)
        }
        Effect::Translate => Action::Translate(triple(["translateX", "translateY", "translateZ"])),
        Effect::Rotate => Action::Rotate(triple(["rotateX", "rotateY", "rotateZ"])),
        Effect::Scale => Action::Scale(triple(["scaleX", "scaleY", "scaleZ"]) * number("scale")),
        Effect::Draw(primitive) if primitive.moves() => Action::Walk(number("length")),
        Effect::Draw(_) => Action::None,
    };
    if offset.is_empty() {
        return vec![action];
    }
    vec![
        Action::Translate(DVec3::from_slice(&numbers(offset))),
        action,
    ]
}

fn numbers(list: &str) -> Vec<f64> {
    list.split(',')
        .filter(|x| !x.is_empty())
        .map(|x| x.parse().unwrap())
        .collect()
}

fn after(commands: &str) -> TurtleState {
    let mut state = TurtleState::default();
    for action in commands.split_whitespace().flat_map(actions) {
        state.execute(&action);
    }
    state
}

/// Five decimals, as the golden models print.
fn rounded(v: DVec3) -> [f64; 3] {
    // Adding 0 makes -0 a 0, as Java's `Math.round` does.
    v.to_array()
        .map(|x| (x * 100_000.0).round() / 100_000.0 + 0.0)
}

fn check(golden: &[(&str, &str, [f64; 3], [f64; 3])]) {
    for &(name, commands, place, direction) in golden {
        let state = after(commands);
        assert_eq!(rounded(state.position()), place, "{name}: {commands}");
        assert_eq!(rounded(state.head()), direction, "{name}: {commands}");
    }
}

#[test]
fn golden_rotations() {
    check(GOLDEN_01);
}

#[test]
fn golden_moves() {
    check(GOLDEN_02);
}

#[test]
fn golden_adjustments_and_tropisms() {
    check(GOLDEN_05);
}

#[test]
fn golden_primitives() {
    check(GOLDEN_07);
}

/// Golden 04: radius and colour index that each `F` (and the `F0`) of one long shoot ends up with.
#[test]
fn golden_shoot_values() {
    let commands = "F F(2) F(2,0.6) F(2,0.6,4) D(0.4) F(1) Dl(0.8) F(1) F(1) DMul(0.5) F(1) DAdd(0.1) F(1) DlMul(2) \
        F(1) F(1) DlAdd(1) F(1) F(1) P(2) F(1) Pl(3) F(1) F(1) D0 P0 F(1) L(5) F0 D(0.2) F(1) F(0) F(1,0) F(1,0.3,0)";
    let mut state = TurtleState::default();
    let mut found = Vec::new();
    for command in commands.split_whitespace() {
        if command.starts_with('F') {
            let (_, args) = command.split_once('(').unwrap_or(("", ""));
            let args = numbers(args.trim_end_matches(')'));
            let own = |i: usize| args.get(i).map_or(-1.0, |x| *x);
            let radius = rounded(DVec3::splat(state.shoot_radius(own(1) as f32)))[0];
            found.push((radius, state.shoot_color(own(2) as i32)));
        }
        for action in actions(command) {
            state.execute(&action);
        }
    }
    let expected = [
        (0.05, 14),
        (0.05, 14),
        (0.3, 14),
        (0.3, 4),
        (0.2, 14),
        (0.4, 14),
        (0.2, 14),
        (0.1, 14),
        (0.15, 14),
        (0.3, 14),
        (0.15, 14),
        (0.65, 14),
        (0.15, 14),
        (0.15, 2),
        (0.15, 3),
        (0.15, 2),
        (0.05, 14),
        (0.05, 14),
        (0.1, 14),
        (0.1, 14),
        (0.0, 14),
        (0.15, 0),
    ];
    assert_eq!(found, expected);
    assert_eq!(state.generative_distance, 1 + 22);
}

#[test]
fn rotate_turns_about_x_then_y_then_z_and_scale_is_inherited() {
    let both = after("Rotate(10,20,30)").transform.matrix3;
    let one_by_one = after("RL(10) RU(20) RH(30)").transform.matrix3;
    assert!(both.abs_diff_eq(one_by_one, 1e-15));
    assert_eq!(
        after("Scale(2) M(3) Translate(1,0,0)").position(),
        DVec3::new(2.0, 0.0, 6.0)
    );
    assert_eq!(
        after("Scale(1,1,-2) M(3)").position(),
        DVec3::new(0.0, 0.0, -6.0)
    );
}

#[test]
fn right_angles_are_exact() {
    assert_eq!(
        after("RU(90) RL(270) RH(-180) RU(450)")
            .transform
            .matrix3
            .determinant(),
        1.0
    );
    assert_eq!(after("RU(90)").head(), DVec3::X);
    assert_eq!(after("RU(-450)").head(), DVec3::NEG_X);
}

#[test]
fn vertical_and_degenerate_heads_stay_finite() {
    for commands in [
        "RG",
        "RG RG",
        "RG HDir(30)",
        "RV(0.3)",
        "Scale(0) RD(1,0,0,0.5)",
        "Scale(0) HDir(20) RG AdjustLU RV(1)",
        "RP(0,0,0,1)",
        "RD(0,0,0,1)",
        "RU(180) RG",
        "Scale(1,0,1) RU(30) RD(1,0,0,1)",
    ] {
        let state = after(commands);
        assert!(state.transform.is_finite(), "{commands}");
    }
    assert_eq!(after("RG").head(), DVec3::NEG_Z);
    assert_eq!(rounded(after("RG HDir(30)").head())[2], 0.86603);
}

#[test]
fn an_uneven_scale_does_not_tilt_the_inclination() {
    let state = after("Scale(3) RU(70) RH(10) HDir(30)");
    assert_eq!(rounded(state.head()), [0.5, 0.0, 0.86603]);
    let m = state.transform.matrix3;
    assert!((m.determinant() - 27.0).abs() < 1e-12);
}

/// The registers with the commands that set, add, multiply and reset them, and their first values.
const REGISTERS: [(&str, Register, f32); 7] = [
    ("L", Register::Length, 100.0),
    ("D", Register::Diameter, 0.1),
    ("V", Register::Tropism, 0.0),
    ("N", Register::Parameter, 0.0),
    ("C", Register::Carbon, 0.0),
    ("H", Register::Heartwood, 0.0),
    ("U", Register::InternodeCount, 0.0),
];

/// Global and local value after the command `X…` of each row, one after the other; a shoot and a move stand among them.
const REGISTER_COMMANDS: [(&str, f32, f32); 13] = [
    ("X(3)", 3.0, 3.0),
    ("XAdd(2)", 5.0, 5.0),
    ("XMul(2)", 10.0, 10.0),
    ("Xl(7)", 10.0, 7.0),
    ("XlAdd(1)", 10.0, 8.0),
    ("XlMul(2)", 10.0, 16.0),
    ("M(1)", 10.0, 16.0),
    ("F(1)", 10.0, 10.0),
    ("Xl(-1)", 10.0, -1.0),
    ("XMul(-0.5)", -5.0, -5.0),
    ("XAdd(-1)", -6.0, -6.0),
    ("XlAdd(4)", -6.0, -2.0),
    ("F0", -6.0, -6.0),
];

#[test]
fn every_register_obeys_its_commands_and_no_others() {
    for (letter, register, first) in REGISTERS {
        let mut state = TurtleState::default();
        assert_eq!(state.registers.global(register), first, "{letter}");
        for (command, global, local) in REGISTER_COMMANDS {
            let command = command.replace('X', letter);
            for action in actions(&command) {
                state.execute(&action);
            }
            let found = (
                state.registers.global(register),
                state.registers.local(register),
            );
            assert_eq!(found, (global, local), "{command}");
            for (other, register, first) in REGISTERS.iter().filter(|row| row.0 != letter) {
                assert_eq!(
                    state.registers.global(*register),
                    *first,
                    "{command}: {other}"
                );
                assert_eq!(
                    state.registers.local(*register),
                    *first,
                    "{command}: {other}"
                );
            }
        }
        let reset = after(&format!("{letter}(3) {letter}l(4) {letter}0")).registers;
        assert_eq!(reset.global(register), first, "{letter}0");
        assert_eq!(reset.local(register), first, "{letter}0");
    }
    let color = |commands: &str| after(commands).registers.color_index();
    assert_eq!(color(""), 14);
    assert_eq!(color("P(2)"), 2);
    assert_eq!(color("P(2) Pl(3)"), 3);
    assert_eq!(color("P(2) Pl(3) M(1)"), 3);
    assert_eq!(color("P(2) Pl(3) F(1)"), 2);
    assert_eq!(color("P(2) P0"), 14);
}

/// The table above names every register command there is.
#[test]
fn every_register_command_is_tested() {
    let mut tested: Vec<String> = ["P", "P0", "Pl"].map(str::to_owned).to_vec();
    for (letter, _, _) in REGISTERS {
        for suffix in ["", "Add", "Mul", "0", "l", "lAdd", "lMul"] {
            tested.push(format!("{letter}{suffix}"));
        }
    }
    let is_assignment = |effect| matches!(effect, Effect::Assign(..));
    let mut names: Vec<&str> = builtin_types()
        .filter(|ty| is_assignment(ty.effect))
        .map(|ty| ty.name)
        .collect();
    names.sort_unstable();
    tested.sort_unstable();
    assert_eq!(names, tested);
}

/// Steps that use the length register: shoots the local value (here 1), moves the global one (here 3).
#[test]
fn steps_use_the_length_register() {
    for (step, z) in [
        ("F0", 1.0),
        ("FAdd(0.5)", 1.5),
        ("FMul(0.5)", 0.5),
        ("FRel(0.25)", -0.75),
        ("M0", 3.0),
        ("MAdd(0.5)", 3.5),
        ("MMul(0.5)", 1.5),
        ("MRel(0.25)", -2.25),
        ("F(2)", 2.0),
        ("M(2)", 2.0),
    ] {
        let state = after(&format!("L(3) Ll(1) {step}"));
        assert_eq!(state.position(), DVec3::new(0.0, 0.0, z), "{step}");
        let is_shoot = step.starts_with('F');
        assert_eq!(state.generative_distance, 1 + u32::from(is_shoot), "{step}");
        let local = state.registers.local(Register::Length);
        assert_eq!(local, if is_shoot { 3.0 } else { 1.0 }, "{step}");
    }
}

/// Where the local x, y and z axes look after a quarter turn, and back.
#[test]
fn every_turn_is_right_handed() {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    for (name, sign, axes) in [
        ("RU", 1.0, [-z, y, x]),
        ("RL", 1.0, [x, z, -y]),
        ("RH", 1.0, [y, -x, z]),
        ("Plus", 1.0, [-z, y, x]),
        ("Minus", -1.0, [-z, y, x]),
    ] {
        let turned = after(&format!("{name}({})", sign * 90.0)).transform.matrix3;
        assert_eq!(
            turned,
            DMat3::from_cols(axes[0], axes[1], axes[2]),
            "{name}"
        );
        let back = after(&format!("{name}(37) {name}(-37)")).transform.matrix3;
        assert!(back.abs_diff_eq(DMat3::IDENTITY, 1e-15), "{name}");
        let other = after(&format!("{name}({})", sign * -90.0))
            .transform
            .matrix3;
        assert_eq!(other, turned.transpose(), "{name}");
    }
    for (commands, same) in [
        ("Rotate(90,0,0)", "RL(90)"),
        ("Rotate(0,90,0)", "RU(90)"),
        ("Rotate(0,0,90)", "RH(90)"),
    ] {
        assert_eq!(
            after(commands).transform,
            after(same).transform,
            "{commands}"
        );
    }
}

/// A negative strength bends the other way, by the same angle from an upright head.
#[test]
fn tropisms_change_sides_with_their_sign() {
    for (towards, away) in [
        ("RD(1,0,0,0.5)", "RD(1,0,0,-0.5)"),
        ("RD(1,0,0,0.5)", "RD(-1,0,0,0.5)"),
        ("RP(4,0,0,0.5)", "RP(4,0,0,-0.5)"),
        ("RP(4,0,0,0.5)", "RP(-4,0,0,0.5)"),
    ] {
        let (a, b) = (after(towards).head(), after(away).head());
        assert!(a.x > 0.4, "{towards}: {a}");
        assert!(
            a.abs_diff_eq(DVec3::new(-b.x, b.y, b.z), 1e-15),
            "{towards}: {a}, {b}"
        );
    }
    // A plane across the head: towards it the head sinks, away from it it rises.
    let slanted = after("RU(40)").head().z;
    assert!(after("RU(40) RO(0,0,1,0.2)").head().z < slanted);
    assert!(after("RU(40) RO(0,0,1,-0.2)").head().z > slanted);
    assert!(after("RU(40) RV(0.2)").head().z < slanted);
    assert!(after("RU(40) RV(-0.2)").head().z > slanted);
}
