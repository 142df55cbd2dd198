//! Radiosity in closed rooms and between plates: C-16 to C-20.

use super::super::check::{Check, Setting, Trouble};
use super::super::room::{Room, at, gray, square};
use super::exchange::{METHODS, cube, gray_cube};
use super::looks::{largest, prepared, seen};
use super::{Row, checks_of};
use crate::geometry::Shape;
use crate::integrator::radiosity::laid::{Front, Fronts, Laid, Means, PatchView};
use crate::integrator::radiosity::{FormFactorMethod, Solver};
use crate::integrator::{Integrator, Path, Radiosity, RenderError, Solution};
use crate::light::Light;
use crate::material::Material;
use crate::math::{Ray, rng};
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;

/// Steps after which solvers of what has a solution are stopped.
const ENOUGH: u32 = 10_000;

/// What solvers there are.
const SOLVERS: [(&str, Solver); 3] = [
    ("gathering", Solver::Gather),
    ("shooting", Solver::Shoot),
    ("stochastic", Solver::Stochastic),
];

/// The checks.
pub(super) fn checks() -> Vec<Check> {
    let mut checks = checks_of(ROWS);
    for (name, method) in METHODS {
        let plates = format!(
            "what two plates, 1 m wide and 1 mm apart, send, by {name}: largest relative error"
        );
        let measure = move |setting: &Setting<'_>| between_plates(method, setting);
        checks.push(
            Check::within((format!("C-16-{name}"), plates), 0.0, 0.01, measure).of_case("16"),
        );
        let furnace = format!(
            "evenly shining box, rho 0, 0.5, 0.9, 0.99, 0.999, by {name}, gathered: largest relative error in any patch"
        );
        let measure = move |setting: &Setting<'_>| in_a_furnace(method, setting);
        checks.push(
            Check::within((format!("C-17-{name}"), furnace), 0.0, 0.0001, measure).of_case("17"),
        );
    }
    for (name, solver) in SOLVERS {
        let white = format!(
            "white cube, {name}, 100 steps: claims to be done (1), or irradiances that are negative or no numbers"
        );
        let measure = move |setting: &Setting<'_>| without_loss(solver, setting);
        checks
            .push(Check::within((format!("C-18-{name}"), white), 0.0, 0.0, measure).of_case("18"));
        let walls = format!(
            "cube of rho 0.6, one wall lit, {name}: largest relative difference of a wall's light from what gathering finds by other rays"
        );
        let measure = move |setting: &Setting<'_>| against_gathering(solver, setting);
        checks.push(
            Check::within((format!("C-20b-{name}"), walls), 0.0, 0.03, measure).of_case("20b"),
        );
    }
    checks
}

/// Those of one kind.
const ROWS: [Row; 8] = [
    (
        "18",
        "C-18-method",
        "white cube with a lamp, the whole method: says that there is a solution (1), or radiances that are no numbers",
        (0.0, 0.0),
        white_room,
    ),
    (
        "19",
        "C-19-steps",
        "cube that reflects nothing, all solvers: steps of gathering, shooting and iterations",
        (0.0, 0.0),
        |setting| black_room(setting, |found| f64::from(found.steps)),
    ),
    (
        "19",
        "C-19-light",
        "the same: what is sent, W/m²",
        (0.0, 0.0),
        |setting| black_room(setting, |found| largest(found.radiosity.clone())),
    ),
    (
        "20",
        "C-20-depth-0",
        "a cube of 54 patches, light that differs everywhere, threshold 0, depth 0: elements over patches",
        (1.0, 0.0),
        |setting| elements_of_a_cube(0, 1 << 20, setting),
    ),
    (
        "20",
        "C-20-depth-2",
        "the same, depth 2: elements over patches",
        (16.0, 0.0),
        |setting| elements_of_a_cube(2, 1 << 20, setting),
    ),
    (
        "20",
        "C-20-depth-30",
        "the same, depth 30 and memory for 2000 cells: elements, over those",
        (0.5, 0.5),
        |setting| Ok(elements_of_a_cube(30, 2000, setting)? * 54.0 / 2000.0),
    ),
    (
        "20",
        "C-20-method",
        "a lamp over a floor, the whole method, threshold 0, depth 30, 4 MB: radiances that are no numbers",
        (0.0, 0.0),
        endlessly_split,
    ),
    (
        "20c",
        "C-20c-four-lamps",
        "a room with four lamps, 100 places: mean relative difference of radiosity from the path tracer",
        (0.0, 0.05),
        four_lamps,
    ),
];

/// C-16: B₁ = (E₁ + ρ₁ E₂)/(1 - ρ₁ ρ₂).
fn between_plates(method: FormFactorMethod, setting: &Setting<'_>) -> Result<f64, Trouble> {
    let (rho, shine) = ([0.5, 0.8], [1.0, 3.0]);
    let upper = at(0.0, 0.0, 0.001) * DAffine3::from_rotation_x(PI);
    let scene = Room::default()
        .with(square(0.5), at(0., 0., 0.), Material::lambert(gray(rho[0])))
        .with(square(0.5), upper, Material::lambert(gray(rho[1])))
        .scene()?;
    let laid = Laid::cut(&scene, 100)?;
    let patches = laid.patches();
    // What shines sends by itself what it sends when light of 1/ρ of that falls on it.
    let front = |patch: &PatchView| {
        let k = patch.face as usize;
        Front {
            rho: rho[k],
            source: shine[k] / rho[k],
        }
    };
    let fronts: Vec<Front> = patches.iter().map(front).collect();
    let by = (Solver::Gather, Means::new(method, 64, 16));
    let solved = laid.solve(by, &fronts, (1.0 / 1e5, ENOUGH), &setting.context());
    let off = [0, 1].map(|k| {
        let expected = (shine[k] + rho[k] * shine[1 - k]) / (1.0 - rho[0] * rho[1]);
        let own = patches
            .iter()
            .zip(&solved.radiosity)
            .filter(|(patch, _)| patch.face as usize == k);
        let sent: Vec<f64> = own.map(|(_, sent)| *sent).collect();
        (sent.iter().sum::<f64>() / sent.len() as f64 / expected - 1.0).abs()
    });
    Ok(largest(off))
}

/// C-17: E/(1 - ρ) in every patch.
fn in_a_furnace(method: FormFactorMethod, setting: &Setting<'_>) -> Result<f64, Trouble> {
    let scene = gray_cube(0.5)?;
    let laid = Laid::cut(&scene, 100)?;
    let by = (Solver::Gather, Means::new(method, 128, 16));
    let mut all = Vec::new();
    for rho in [0.0, 0.5, 0.9, 0.99, 0.999] {
        let fronts = vec![Front { rho, source: 1.0 }; laid.patches().len()];
        let solved = laid.solve(by, &fronts, (1.0 / 1e6, ENOUGH), &setting.context());
        if !solved.is_converged {
            return Err(Trouble(format!("rho {rho} has no end")));
        }
        let expected = rho / (1.0 - rho);
        // Where nothing is reflected nobody asks what arrives from others.
        let sent = solved
            .radiosity
            .iter()
            .map(|sent| (sent - expected).abs() / expected.max(1.0));
        all.extend(sent);
    }
    Ok(largest(all))
}

fn all_fronts(laid: &Laid<'_>, rho: f64) -> Vec<Front> {
    vec![Front { rho, source: 1.0 }; laid.patches().len()]
}

fn without_loss(solver: Solver, setting: &Setting<'_>) -> Result<f64, Trouble> {
    let scene = gray_cube(1.0)?;
    let laid = Laid::cut(&scene, 600)?;
    let by = (solver, Means::new(FormFactorMethod::Rays, 4, 8));
    let found = laid.solve(
        by,
        &all_fronts(&laid, 1.0),
        (0.001, 100),
        &setting.context(),
    );
    let is_wrong = |light: &&f64| !(light.is_finite() && **light >= 0.0);
    let wrong = found.irradiance.iter().filter(is_wrong).count() as f64;
    let claims = found.is_converged || found.residual < 0.1 || found.residual.is_nan();
    Ok(wrong + f64::from(claims))
}

/// The whole method, in a white cube with a lamp.
fn white_room(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let lamp = Light::point(DVec3::new(0.1, 0.2, 0.3), gray(10.0));
    let scene = cube([1.0; 6]).lit_by(lamp).scene()?;
    let method = Radiosity {
        solver: Some(Solver::Gather),
        hemicube_pixels: 4,
        subdivision_depth: 0,
        // For 200 patches.
        memory: 200 << 10,
        ..Radiosity::default()
    };
    let Solution::Radiosity(solution) = method.solve(&scene, &setting.context())? else {
        return Err(Trouble("no solution of radiosity".into()));
    };
    let claims = f64::from(solution.is_converged);
    let estimator = method.view(&scene, &Solution::Radiosity(solution), &setting.context())?;
    let looks = super::looks::around(DVec3::ZERO, 50);
    let is_wrong = |ray: &&Ray| !seen(&*estimator, ray, 1, 1).is_finite();
    Ok(claims + looks.iter().filter(is_wrong).count() as f64)
}

/// C-19: the sum over solvers of something they find in a black room.
fn black_room(setting: &Setting<'_>, of: impl Fn(&Fronts) -> f64) -> Result<f64, Trouble> {
    let scene = gray_cube(0.0)?;
    let laid = Laid::cut(&scene, 100)?;
    let fronts = all_fronts(&laid, 0.0);
    let mut sum = 0.0;
    for (_, solver) in SOLVERS {
        let by = (solver, Means::new(FormFactorMethod::Rays, 16, 8));
        let found = laid.solve(by, &fronts, (0.001, ENOUGH), &setting.context());
        if !found.is_converged {
            return Err(Trouble("no end".into()));
        }
        sum += of(&found);
    }
    Ok(sum)
}

fn elements_of_a_cube(depth: u32, most: usize, setting: &Setting<'_>) -> Result<f64, Trouble> {
    let scene = gray_cube(0.5)?;
    let [patches, elements] = Laid::cut(&scene, 60)?.split(depth, most, &setting.context());
    if patches == 54 {
        Ok(elements as f64 / patches as f64)
    } else {
        Err(Trouble(format!("{patches} patches")))
    }
}

fn endlessly_split(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let lamp = Light::point(DVec3::new(0.1, 0.2, 0.7), gray(10.0));
    let scene = cube([0.5; 6]).lit_by(lamp).scene()?;
    let method = Radiosity {
        hemicube_pixels: 4,
        subdivision_threshold: 0.0,
        subdivision_depth: 30,
        // For 4000 patches and elements.
        memory: 4 << 20,
        ..Radiosity::default()
    };
    let estimator = match method.prepare(&scene, &setting.context()) {
        Ok(estimator) => estimator,
        // To be told is as good.
        Err(RenderError::TooManyPatches { .. } | RenderError::TooManyFactors { .. }) => {
            return Ok(0.0);
        }
        Err(other) => return Err(other.into()),
    };
    let looks = super::looks::around(DVec3::ZERO, 200);
    let is_wrong = |ray: &&Ray| {
        let light = seen(&*estimator, ray, 1, 1);
        !light.is_finite() || light.g <= 0.0
    };
    Ok(looks.iter().filter(is_wrong).count() as f64)
}

/// C-20b: light of each wall, the first of which gets 1 W/m².
fn walls(solver: Solver, n_rays: u32, setting: &Setting<'_>) -> Result<[f64; 6], Trouble> {
    let scene = gray_cube(0.6)?;
    let laid = Laid::cut(&scene, 600)?;
    let patches = laid.patches();
    let front = |patch: &PatchView| Front {
        rho: 0.6,
        source: f64::from(patch.face == 0),
    };
    let fronts: Vec<Front> = patches.iter().map(front).collect();
    let by = (solver, Means::new(FormFactorMethod::Rays, n_rays, 16));
    let found = laid.solve(by, &fronts, (0.001, ENOUGH), &setting.context());
    if !found.is_converged {
        return Err(Trouble("no end".into()));
    }
    let mut walls = [0.0; 6];
    for (patch, light) in patches.iter().zip(found.irradiance) {
        walls[patch.face as usize] += light * patch.area / 4.0;
    }
    // One wall gets 1; all together get 1/(1 - 0.6), and 1 of that is not from other walls.
    let sum: f64 = walls.iter().sum();
    if (sum / 1.5 - 1.0).abs() < 0.01 {
        Ok(walls)
    } else {
        Err(Trouble(format!("all walls get {sum} instead of 1.5")))
    }
}

fn against_gathering(solver: Solver, setting: &Setting<'_>) -> Result<f64, Trouble> {
    let found = walls(solver, 64, setting)?;
    let truth = walls(Solver::Gather, 100, setting)?;
    let pairs = found.iter().zip(truth);
    Ok(largest(
        pairs.map(|(found, truth)| (found / truth - 1.0).abs()),
    ))
}

/// C-20c: a floor and a wall under four lamps of different power.
fn four_lamps(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let room = [
        (-0.5, -0.5, 1.0),
        (0.5, -0.5, 2.0),
        (-0.5, 0.5, 4.0),
        (0.5, 0.5, 8.0),
    ]
    .into_iter()
    .fold(cube([0.6; 6]), |room, (x, y, power)| {
        room.lit_by(Light::point(DVec3::new(x, y, 0.6), gray(power)))
    });
    let box_on_floor = Shape::Box {
        half_x: 0.2,
        half_y: 0.2,
        length: 0.6,
    };
    let scene = room
        .with(
            box_on_floor,
            at(0.1, -0.1, -1.0),
            Material::lambert(gray(0.4)),
        )
        .scene()?;
    let radiosity = Radiosity::default();
    let (found, truth) = (
        prepared(&radiosity, &scene, setting)?,
        prepared(&Path::default(), &scene, setting)?,
    );
    let mut sum = 0.0;
    let places = super::looks::around(DVec3::new(0.6, 0.5, 0.2), 100);
    for (stream, ray) in (0_u64..).zip(&places) {
        let stream = rng::hash(&[setting.seed, stream]);
        let truth = seen(&*truth, ray, stream, 256).g;
        sum += (seen(&*found, ray, stream, 16).g / truth - 1.0).abs();
    }
    Ok(sum / places.len() as f64)
}
