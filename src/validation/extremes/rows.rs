//! Rows of form factors in closed rooms: C-8, C-10, C-12 to C-15.

use super::super::check::{Check, Setting, Trouble};
use super::super::room::{Room, at, square};
use super::exchange::{METHODS, cube, gray_cube};
use super::looks::largest;
use super::{Row, checks_of};
use crate::geometry::Shape;
use crate::integrator::radiosity::FormFactorMethod;
use crate::integrator::radiosity::laid::{Laid, Means};
use crate::material::Material;
use crate::math::tolerance::{SEVEN_DIGITS, WHOLE_ROWS};
use crate::scene::{Scene, SceneError};
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

/// The checks.
pub(super) fn checks() -> Vec<Check> {
    let mut checks = checks_of(ROWS);
    for (name, method) in METHODS {
        checks.push(of_a_ball(name, method));
        for pixels in [1, 2, 7, 32] {
            // Beside closed forms few rays may find nothing that shares the rest.
            if method != FormFactorMethod::Analytic || pixels == 32 {
                checks.extend(of_rows(name, method, pixels));
            }
        }
        // Hemicubes stand for points: between near patches of other sizes theirs differ, as Cohen and Greenberg's do.
        if method != FormFactorMethod::Hemicube {
            let what = format!(
                "furnished room, all pairs of patches, A F there and back, by {name}: largest difference, standard errors"
            );
            let measure = move |_: &Setting<'_>| there_and_back(method);
            checks.push(
                Check::within((format!("C-12-{name}"), what), 0.0, 5.0, measure).of_case("12"),
            );
        }
    }
    checks.extend(of_rows("hemicubes", FormFactorMethod::Hemicube, 1024));
    checks
}

/// Those of one kind.
const ROWS: [Row; 1] = [(
    "10",
    "C-10-cube",
    "a cube of six patches, form factors on paper: largest difference of a row from 1",
    (0.0, SEVEN_DIGITS),
    |_| rows_of_a_cube(),
)];

fn of_a_ball(name: &str, method: FormFactorMethod) -> Check {
    let (what, allowed) = match method {
        FormFactorMethod::Hemicube => ("largest error, as a part of the view", 0.01),
        FormFactorMethod::Rays | FormFactorMethod::Analytic => {
            ("mean square of errors, in those of counts", 1.2)
        }
    };
    let what = format!("inside of a ball, from each of its patches to each, by {name}: {what}");
    let measure = move |_: &Setting<'_>| in_a_ball(method);
    Check::within((format!("C-8-{name}"), what), 0.0, allowed, measure).of_case("8")
}

/// What is asked of rows: a case, what is measured, how much is allowed, and of which share.
type Part = (&'static str, &'static str, f64, fn(&Share) -> f64);

const PARTS: [Part; 3] = [
    (
        "13",
        "largest part that is lost or found twice",
        WHOLE_ROWS,
        |share| (1.0 - share.sum).abs(),
    ),
    (
        "14",
        "factors that are negative, more than 1 or no numbers",
        0.0,
        |share| share.wrong,
    ),
    ("15", "what flat walls see of themselves", 0.0, |share| {
        share.own
    }),
];

/// Whether rows of form factors are whole, legal and none of their own wall's.
fn of_rows(name: &str, method: FormFactorMethod, pixels: u32) -> Vec<Check> {
    // Whoever asks first finds them out.
    let known: Arc<OnceLock<Vec<Share>>> = Arc::default();
    let check = |(case, what, allowed, of): Part| {
        let known = known.clone();
        let what = format!(
            "furnished closed room, rows by {name} of {pixels} pixels (or as many rays): {what}"
        );
        let measure = move |setting: &Setting<'_>| {
            let shares = match known.get() {
                Some(shares) => shares,
                None => {
                    let found = shares(method, pixels, setting)?;
                    known.get_or_init(|| found)
                }
            };
            Ok(largest(shares.iter().map(of)))
        };
        Check::within(
            (format!("C-{case}-{name}-{pixels}"), what),
            0.0,
            allowed,
            measure,
        )
        .of_case(case)
    };
    PARTS.map(check).into()
}

/// Where what leaves a patch arrives.
struct Share {
    /// All of it.
    sum: f64,
    /// Factors that cannot be.
    wrong: f64,
    /// On its own flat wall.
    own: f64,
}

/// A closed room with round things in it, coarse enough to be looked at as a whole.
fn furnished() -> Result<Scene, SceneError> {
    let ball = Shape::Sphere { radius: 0.4 };
    let stretched = at(0.4, 0.4, -0.3) * DAffine3::from_scale(DVec3::new(1.0, 0.5, 0.7));
    let tube = Shape::Frustum {
        length: 0.8,
        base_radius: 0.3,
        top_radius: 0.1,
        base_cap: true,
        top_cap: false,
    };
    cube([0.5; 6])
        .with(ball, stretched, Material::default())
        .with(tube, at(-0.4, 0.4, -0.9), Material::default())
        .with(square(0.4), at(-0.5, -0.5, 0.1), Material::default())
        .scene()
}

fn shares(
    method: FormFactorMethod,
    pixels: u32,
    setting: &Setting<'_>,
) -> Result<Vec<Share>, Trouble> {
    let scene = furnished()?;
    let laid = Laid::cut(&scene, 300)?;
    let patches = laid.patches();
    let mut means = Means::new(method, pixels * pixels, pixels);
    let step = if pixels > 100 {
        means.cubes = 1;
        200
    } else {
        29
    };
    let wanted: Vec<usize> = (0..patches.len()).step_by(step).collect();
    let mut all = Vec::new();
    for patch in wanted {
        if setting.cancel.is_cancelled() {
            break;
        }
        let row = laid.rows(means, 0, [patch].into_iter());
        let row = row.into_iter().next().unwrap_or_default();
        let own =
            |side: usize| patches[side / 2].face == patches[patch].face && patches[patch].is_flat;
        let is_wrong = |factor: f64| !(0.0..=1.0).contains(&factor);
        all.push(Share {
            sum: row.iter().map(|(_, factor)| factor).sum(),
            wrong: row.iter().filter(|(_, factor)| is_wrong(*factor)).count() as f64,
            own: row
                .iter()
                .filter(|(side, _)| own(*side))
                .map(|(_, factor)| factor)
                .sum(),
        });
    }
    Ok(all)
}

/// C-8: A/4πR² from each patch to each, itself included.
fn in_a_ball(method: FormFactorMethod) -> Result<f64, Trouble> {
    let ball = Shape::Sphere { radius: 2.0 };
    let room = Room::default().with(ball, at(0., 0., 0.), Material::default());
    let scene = room.scene()?;
    let laid = Laid::cut(&scene, 32)?;
    let patches = laid.patches();
    let n_rays = 2048;
    let rows = laid.rows(Means::new(method, n_rays, 32), 1, 0..patches.len());
    let (mut squares, mut most) = (0.0, 0.0_f64);
    for row in &rows {
        for (to, patch) in patches.iter().enumerate() {
            let expected = patch.area / (16.0 * PI);
            let found = row.iter().find(|(side, _)| *side == 2 * to + 1);
            let off = found.map_or(0.0, |(_, factor)| *factor) - expected;
            squares += off * off * f64::from(n_rays) / (expected * (1.0 - expected));
            most = most.max(off.abs());
        }
    }
    Ok(match method {
        FormFactorMethod::Hemicube => most,
        FormFactorMethod::Rays | FormFactorMethod::Analytic => {
            squares / (rows.len() * patches.len()) as f64
        }
    })
}

fn rows_of_a_cube() -> Result<f64, Trouble> {
    let scene = gray_cube(0.5)?;
    let laid = Laid::cut(&scene, 6)?;
    let n = laid.patches().len();
    if n != 6 {
        return Err(Trouble(format!("{n} patches")));
    }
    let means = Means::new(FormFactorMethod::Analytic, 64, 8);
    let sum = |row: Vec<(usize, f64)>| row.iter().map(|(_, factor)| factor).sum::<f64>();
    let rows = laid.rows(means, 0, 0..n).into_iter();
    Ok(largest(rows.map(|row| (1.0 - sum(row)).abs())))
}

/// C-12: what is rarer than one count may be missed one way.
fn there_and_back(method: FormFactorMethod) -> Result<f64, Trouble> {
    let scene = furnished()?;
    let laid = Laid::cut(&scene, 100)?;
    let patches = laid.patches();
    let n_rays = 2048.0;
    let rows = laid.rows(Means::new(method, 2048, 32), 0, 0..patches.len());
    let factor = |from: usize, to: usize| {
        let found = rows[from].iter().find(|(side, _)| *side == 2 * to);
        found.map_or(0.0, |(_, factor)| *factor)
    };
    let error = |factor: f64| (factor.max(1.0 / n_rays) / n_rays).sqrt();
    let mut most = 0.0_f64;
    for one in 0..rows.len() {
        for other in 0..one {
            let (there, back) = (factor(one, other), factor(other, one));
            let (here, away) = (patches[one].area, patches[other].area);
            let errors = here * error(there) + away * error(back);
            most = most.max((here * there - away * back).abs() / errors);
        }
    }
    Ok(most)
}
