//! Every lobe and mixture of surfaces: sampling against the density it claims (χ²), the density's integral, reciprocity, white
//! furnaces, and what panes and flux have to do with each other.
//!
//! Error probabilities are stated per family and divided among its members (Bonferroni).

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use glam::{DVec2, DVec3};
use std::f64::consts::TAU;
use understory::color::Rgb;
use understory::material::{
    Density, Lobe, LobeKind, Material, Reflection, ScatterNumbers, ScatterSample, ScatteringFrame,
    Side, Transport,
};
use understory::math::frame::Frame;
use understory::math::stats::{RunningStats, chi_squared_upper_tail, family_z};
use understory::math::{rng, warp};

use Transport::{Importance, Radiance};

/// Normal of the surfaces here, tilted so that no axis is special.
const NORMAL: DVec3 = DVec3::new(0.48, -0.6, 0.64);

fn flat() -> ScatteringFrame {
    ScatteringFrame {
        normal_g: NORMAL,
        normal_s: NORMAL,
    }
}

/// A direction at this angle (degrees) to the front normal.
fn at(degrees: f64) -> DVec3 {
    let angle = degrees.to_radians();
    let local = DVec3::new(angle.sin() * 0.8, angle.sin() * 0.6, angle.cos());
    Frame::from_normal(NORMAL).to_world(local).normalize()
}

fn numbers(i: u64) -> ScatterNumbers {
    let [a, b, c, d] = [0, 1, 2, 3].map(|k| rng::unit_f64(rng::hash(&[0x0F71C5, i, k])));
    ScatterNumbers {
        direction: DVec2::new(a, b),
        lobe: DVec2::new(c, d),
    }
}

fn gray(value: f64) -> Rgb {
    Rgb::splat(value)
}

fn of(kind: LobeKind, weight: f64) -> Material {
    Material::of_lobes(vec![Lobe::new(kind, gray(weight))])
}

/// Every smooth lobe, and mixtures of them with each other, with matt parts and with single directions.
fn smooth() -> Vec<(&'static str, Material)> {
    let side = |rho, tau| Side {
        reflectance: gray(rho),
        transmittance: gray(tau),
    };
    let phong = of(LobeKind::Phong { exponent: 20.0 }, 1.0);
    let haze = of(LobeKind::Haze { exponent: 8.0 }, 1.0);
    let varnish = LobeKind::Rough {
        alpha: 0.3,
        reflection: Reflection::Varnish(1.5),
    };
    let metal = Material::metal(Rgb::new(1.0, 0.7, 0.3), 0.5);
    let rough_glass = Material::glass(1.5, 0.6, Rgb::BLACK);
    let matt = Material::matt([side(0.5, 0.2), side(0.1, 0.6)]);
    let mixed = |a: &Material, b: &Material| Material::mixed(a, b, 0.6);
    vec![
        ("phong 0", of(LobeKind::Phong { exponent: 0.0 }, 0.8)),
        ("phong 20", phong.clone()),
        ("haze", haze.clone()),
        ("metal", metal.clone()),
        ("metal, as rough as can be", Material::metal(gray(0.9), 1.0)),
        ("varnish", of(varnish, 1.0)),
        ("rough glass", rough_glass.clone()),
        ("rough bubble", Material::glass(1.0 / 1.5, 0.7, Rgb::BLACK)),
        ("very rough diamond", Material::glass(2.4, 1.0, Rgb::BLACK)),
        ("matt and phong", mixed(&matt, &phong)),
        ("matt, metal and haze", mixed(&mixed(&matt, &metal), &haze)),
        ("matt and rough glass", mixed(&matt, &rough_glass)),
        (
            "phong and mirror",
            mixed(&phong, &Material::mirror(gray(0.9))),
        ),
        (
            "matt and glass",
            mixed(&matt, &Material::glass(1.5, 0.0, Rgb::BLACK)),
        ),
        (
            "matt and pane",
            mixed(&matt, &Material::pane(1.5, gray(0.9))),
        ),
        (
            "metal in front, phong behind",
            Material::two_sided(&metal, &phong),
        ),
    ]
}

/// Angles of `wo` to the front normal: straight, slanted, grazing, on both sides.
const ANGLES: [f64; 6] = [0.0, 40.0, 85.0, 95.0, 130.0, 180.0];

// ── sampling ──

/// Cells: rows of equal height along the normal, columns of equal azimuth; one more for what is in single directions, one for
/// nothing.
const ROWS: usize = 24;
const COLUMNS: usize = 24;
const N_CELLS: usize = ROWS * COLUMNS;

fn cell(w: DVec3) -> usize {
    let local = Frame::from_normal(NORMAL).to_local(w);
    let turn = (local.y.atan2(local.x) / TAU).rem_euclid(1.0);
    let row = ((0.5 * (local.z + 1.0)) * ROWS as f64) as usize;
    let column = (turn * COLUMNS as f64) as usize;
    row.min(ROWS - 1) * COLUMNS + column.min(COLUMNS - 1)
}

/// Probability of each cell, by the midpoint rule on `FINE` × `FINE` points per cell; in the outermost rows they crowd towards
/// the poles, where light that goes straight on is found.
fn integrate(mut pdf: impl FnMut(DVec3) -> f64) -> Vec<f64> {
    const FINE: usize = 16;
    let frame = Frame::from_normal(NORMAL);
    let height = 2.0 / ROWS as f64;
    let mut cells = vec![0.0; N_CELLS];
    for row in 0..ROWS {
        for step in 0..FINE {
            let t = (step as f64 + 0.5) / FINE as f64;
            // Height above the lower edge of the row, and how much of it the step stands for.
            let (up, share) = match row {
                0 => (t * t, 2.0 * t),
                last if last == ROWS - 1 => (1.0 - t * t, 2.0 * t),
                _ => (t, 1.0),
            };
            let z = (row as f64 + up) * height - 1.0;
            let weight = share * height / FINE as f64 * TAU / (COLUMNS * FINE) as f64;
            for column in 0..COLUMNS * FINE {
                let turn = (column as f64 + 0.5) / (COLUMNS * FINE) as f64;
                let w = frame.to_world(warp::direction(z, turn));
                cells[row * COLUMNS + column / FINE] += pdf(w) * weight;
            }
        }
    }
    cells
}

/// p-value of the counts; cells that expect fewer than five are pooled.
fn p_value(counts: &[f64], probabilities: &[f64], n: f64) -> f64 {
    let (mut chi, mut degrees) = (0.0, -1.0);
    let mut pooled = [0.0; 2];
    for (count, probability) in counts.iter().zip(probabilities) {
        let expected = probability * n;
        if expected < 5.0 {
            pooled[0] += count;
            pooled[1] += expected;
        } else {
            chi += (count - expected).powi(2) / expected;
            degrees += 1.0;
        }
    }
    if pooled[1] > 5.0 {
        chi += (pooled[0] - pooled[1]).powi(2) / pooled[1];
        degrees += 1.0;
    } else if pooled[0] > pooled[1] + 40.0 {
        return 0.0;
    }
    if degrees < 1.0 {
        return 1.0;
    }
    chi_squared_upper_tail(chi, degrees)
}

/// Where the samples of a surface fall: the cells, single directions, nothing.
fn counted(draw: impl Fn(u64) -> Option<ScatterSample>, n: u64) -> Vec<f64> {
    let mut counts = vec![0.0; N_CELLS + 2];
    for i in 0..n {
        let place = match draw(i) {
            Some(sample) if sample.density != Density::Delta => cell(sample.wi),
            Some(_) => N_CELLS,
            None => N_CELLS + 1,
        };
        counts[place] += 1.0;
    }
    counts
}

/// C-47: χ² of where samples fall against the density, for every lobe.
#[test]
fn samples_follow_the_density() {
    // The density is integrated by a rule with an error of its own of about 1e-3 of each cell; few samples do not see that.
    let (n, frame) = (30_000, flat());
    let cases = smooth();
    let false_alarm = 1e-6 / (cases.len() * ANGLES.len()) as f64;
    for (name, material) in &cases {
        let scattering = material.scattering();
        for degrees in ANGLES {
            let wo = at(degrees);
            let counts = counted(|i| scattering.sample(&frame, wo, numbers(i), Radiance), n);
            let mut probabilities =
                integrate(|w| scattering.pdf_solid_angle(&frame, wo, w, Radiance));
            // What is not smooth is either single directions or nothing; both are counted, their sum is known.
            let smooth: f64 = probabilities.iter().sum();
            assert!(
                smooth < 1.004,
                "{name} at {degrees}: integrates to {smooth}"
            );
            let mut found = counts[..N_CELLS].to_vec();
            found.push(counts[N_CELLS] + counts[N_CELLS + 1]);
            probabilities.push((1.0 - smooth).max(0.0));
            let p = p_value(&found, &probabilities, n as f64);
            assert!(
                p > false_alarm,
                "{name} at {degrees}°: p = {p}, smooth {smooth}"
            );

            // The twin: a sampler that is stuck in one direction for 5 % of its numbers.
            let likely = |a: &usize, b: &usize| probabilities[*a].total_cmp(&probabilities[*b]);
            let stuck = (0..N_CELLS).max_by(likely).unwrap();
            let mut moved: Vec<f64> = found.iter().map(|count| 0.95 * count).collect();
            moved[stuck] += 0.05 * n as f64;
            let p = p_value(&moved, &probabilities, n as f64);
            assert!(
                p < false_alarm,
                "{name} at {degrees}°: fault unseen, p = {p}"
            );
        }
    }
}

/// C-47: the weight that sampling hands out is f · cos / pdf, and the density it states is the density.
#[test]
fn weights_are_value_over_density() {
    let frame = flat();
    for (name, material) in &smooth() {
        let scattering = material.scattering();
        for degrees in ANGLES {
            let wo = at(degrees);
            for transport in [Radiance, Importance] {
                for i in 0..200 {
                    let Some(s) = scattering.sample(&frame, wo, numbers(i), transport) else {
                        continue;
                    };
                    let Density::SolidAngle(pdf) = s.density else {
                        continue;
                    };
                    let again = scattering.pdf_solid_angle(&frame, wo, s.wi, transport);
                    assert!((pdf / again - 1.0).abs() < 1e-9, "{name}");
                    let value = scattering.value_cos(&frame, wo, s.wi, transport);
                    let ratio = (value / pdf - s.weight).map(f64::abs).max_channel();
                    assert!(
                        ratio < 1e-9 * (1.0 + s.weight.max_channel()),
                        "{name} {degrees}"
                    );
                    assert!((s.wi.length() - 1.0).abs() < 1e-12);
                }
            }
        }
    }
}

// ── energy ──

/// Mean weight of flux that arrives along `wo`: the share of it that is scattered.
fn scattered(material: &Material, frame: &ScatteringFrame, wo: DVec3, n: u64) -> RunningStats {
    let scattering = material.scattering();
    (0..n)
        .map(|i| {
            let sample = scattering.sample(frame, wo, numbers(i), Importance);
            sample.map_or(0.0, |sample| sample.weight.g)
        })
        .collect()
}

/// C-46. White surfaces: nothing is lost and nothing made. Radiance of an even surrounding is `(n_o/n_i)²` in glass, so flux is asked.
#[test]
fn white_furnace() {
    let white = |m: Material| m;
    let exact = [
        ("lambert", Material::lambert(Rgb::WHITE)),
        ("leaf", Material::leaf(gray(0.3), gray(0.7))),
        ("mirror", white(Material::mirror(Rgb::WHITE))),
        ("glass", Material::glass(1.5, 0.0, Rgb::BLACK)),
        ("bubble", Material::glass(1.0 / 1.5, 0.0, Rgb::BLACK)),
        (
            "mixture",
            Material::mixed(
                &Material::leaf(gray(0.5), gray(0.5)),
                &Material::mixed(
                    &Material::mirror(Rgb::WHITE),
                    &Material::glass(1.3, 0.0, Rgb::BLACK),
                    0.3,
                ),
                0.4,
            ),
        ),
    ];
    for (name, material) in &exact {
        for degrees in [0.0, 35.0, 60.0, 89.0, 91.0, 150.0] {
            let seen = scattered(material, &flat(), at(degrees), 2000);
            assert!(
                (seen.mean() - 1.0).abs() < 1e-9,
                "{name} at {degrees}°: {}",
                seen.mean()
            );
        }
    }
    // A pane sends back what it does not let through.
    let pane = Material::pane(1.5, Rgb::WHITE);
    for degrees in [0.0, 35.0, 60.0, 89.0, 130.0] {
        let back = scattered(&pane, &flat(), at(degrees), 10).mean();
        let through = pane.optics().passage(at(degrees).dot(NORMAL)).g;
        assert!((back + through - 1.0).abs() < 1e-9, "pane at {degrees}°");
    }
}

/// C-46. Facets lose what would meet a second facet; Phong's lobe loses what would go into the surface. Neither makes light.
#[test]
fn known_deficits() {
    let rough = |roughness| Material::metal(Rgb::WHITE, roughness);
    let glass = Material::glass(1.5, 0.6, Rgb::BLACK);
    let phong = of(LobeKind::Phong { exponent: 20.0 }, 1.0);
    let haze = of(LobeKind::Haze { exponent: 20.0 }, 1.0);
    // Directional albedo at 0°, 45° and 80°: at least so much, as measured.
    let cases = [
        ("metal 0.3", rough(0.3), [0.98, 0.98, 0.89]),
        ("metal 1", rough(1.0), [0.30, 0.36, 0.64]),
        ("glass 0.6", glass, [0.97, 0.95, 0.87]),
        ("phong 20", phong, [0.99, 0.70, 0.19]),
        ("haze 20", haze, [0.99, 0.70, 0.19]),
    ];
    for (name, material, least) in &cases {
        for (degrees, least) in [0.0, 45.0, 80.0].into_iter().zip(least) {
            let seen = scattered(material, &flat(), at(degrees), 4000);
            let slack = family_z(1e-6, 15) * seen.standard_error();
            assert!(
                seen.mean() < 1.0 + slack,
                "{name} at {degrees}° makes light: {}",
                seen.mean()
            );
            assert!(
                seen.mean() > least - slack,
                "{name} at {degrees}°: {}",
                seen.mean()
            );
        }
    }
    // Known on paper at normal incidence: facets of α = 1 keep ∫ (2 - 1/u) du over ½..1 = 1 - ln 2, and Phong's normalisation
    // is exact, (n + 2)/2π ∫ cosⁿ⁺¹ = 1.
    let facets = scattered(&cases[1].1, &flat(), NORMAL, 20_000);
    let error = facets.mean() - (1.0 - 2.0_f64.ln());
    assert!(error.abs() < family_z(1e-6, 1) * facets.standard_error());
    assert!(facets.standard_error() < 0.003);
    let phong = scattered(&cases[3].1, &flat(), NORMAL, 4000);
    assert!((phong.mean() - 1.0).abs() < family_z(1e-6, 1) * phong.standard_error() + 1e-9);
}

// ── symmetry ──

/// C-47: f(a, b) = f(b, a); across a boundary the value per squared index of the side it leaves on is symmetric.
#[test]
fn reciprocity() {
    let frame = flat();
    let cases = smooth()
        .into_iter()
        .filter(|(name, _)| !name.contains("matt"));
    let leaf = Material::leaf(gray(0.3), gray(0.4));
    let metal = Material::metal(gray(0.8), 0.4);
    let symmetric = [
        ("leaf", leaf.clone()),
        ("leaf, metal", Material::mixed(&leaf, &metal, 0.5)),
    ];
    for (name, material) in cases.chain(symmetric) {
        let scattering = material.scattering();
        let index = |w: DVec3| {
            let inside = material.lobes.iter().find_map(|lobe| match lobe.kind {
                LobeKind::Dielectric { ior, .. } => Some(ior),
                _ => None,
            });
            if frame.is_in_front(w) {
                1.0
            } else {
                inside.unwrap_or(1.0)
            }
        };
        for i in 0..2000 {
            let [a, b] = [2 * i, 2 * i + 1].map(|i| warp::sphere(numbers(i).direction));
            let f = |o: DVec3, i: DVec3| {
                let value = scattering.value_cos(&frame, o, i, Radiance).g;
                value / (i.dot(NORMAL).abs() * index(o) * index(o))
            };
            let (ab, ba) = (f(a, b), f(b, a));
            assert!((ab - ba).abs() <= 1e-9 * (ab + ba), "{name}: {ab} {ba}");
        }
    }
}

/// C-47: flux carried one way and radiance gathered the other way along the same path are the same, also under smoothed normals:
/// `value(flux, a → b) / |b · n_g| = value(radiance, b ← a) / |a · n_g|`, both per projected solid angle of the true surface.
#[test]
fn flux_is_the_adjoint_of_radiance() {
    let bent = ScatteringFrame {
        normal_g: NORMAL,
        normal_s: (NORMAL + DVec3::new(0.2, 0.3, -0.1)).normalize(),
    };
    let leaf = Material::matt([
        Side {
            reflectance: gray(0.5),
            transmittance: gray(0.2),
        },
        Side {
            reflectance: gray(0.1),
            transmittance: gray(0.6),
        },
    ]);
    for frame in [flat(), bent] {
        for (name, material) in smooth().into_iter().chain([("leaf", leaf.clone())]) {
            let scattering = material.scattering();
            let mut n_seen = 0;
            for i in 0..2000 {
                let [a, b] = [2 * i, 2 * i + 1].map(|i| warp::sphere(numbers(i).direction));
                // Where a smoothed normal turns away from a direction, the two ways use different normals.
                if [a, b]
                    .iter()
                    .any(|w| w.dot(frame.normal_s) * w.dot(NORMAL) <= 0.0)
                {
                    continue;
                }
                let flux = scattering.value_cos(&frame, a, b, Importance).g;
                let radiance = scattering.value_cos(&frame, b, a, Radiance).g;
                let (x, y) = (flux / b.dot(NORMAL).abs(), radiance / a.dot(NORMAL).abs());
                assert!((x - y).abs() <= 1e-9 * (x + y), "{name}: {x} {y}");
                n_seen += usize::from(x > 0.0);
            }
            assert!(n_seen > 300, "{name}: only {n_seen} pairs");
        }
    }
}

/// Smooth glass: what comes in of flux goes out again; radiance is compressed inside by n² and back.
#[test]
fn refraction_compresses_radiance_and_not_flux() {
    let glass = Material::glass(1.5, 0.0, Rgb::BLACK);
    for (wo, expected) in [(at(30.0), 1.0 / 2.25), (at(160.0), 2.25)] {
        for i in 0..100 {
            let radiance = glass
                .scattering()
                .sample(&flat(), wo, numbers(i), Radiance)
                .unwrap();
            let flux = glass
                .scattering()
                .sample(&flat(), wo, numbers(i), Importance)
                .unwrap();
            assert_eq!(radiance.wi, flux.wi);
            assert_eq!(flux.weight, Rgb::WHITE);
            assert_eq!(flux.compression, 1.0);
            let crosses = flat().is_in_front(wo) != flat().is_in_front(radiance.wi);
            let expected = if crosses { expected } else { 1.0 };
            assert!((radiance.weight.g - expected).abs() < 1e-12);
            assert!((radiance.compression - expected).abs() < 1e-12);
        }
    }
}

// ── sides and mixtures ──

#[test]
fn sides_show_their_own_surface() {
    let mirror = Material::mirror(gray(0.9));
    let switch = Material::two_sided(&mirror, &Material::lambert(gray(0.4)));
    assert_eq!(switch.validate(), Ok(()));
    let front = switch
        .scattering()
        .sample(&flat(), at(20.0), numbers(1), Radiance)
        .unwrap();
    assert_eq!(front.density, Density::Delta);
    assert!((front.weight.g - 0.9).abs() < 1e-12);
    let back = switch
        .scattering()
        .sample(&flat(), at(160.0), numbers(1), Radiance)
        .unwrap();
    assert!(matches!(back.density, Density::SolidAngle(_)));
    assert!((back.weight.g - 0.4).abs() < 1e-12);
    // Light that would have to pass glass and paint does not pass; equal glass on both sides is that glass.
    let glass = Material::glass(1.5, 0.0, Rgb::BLACK);
    assert!(
        Material::two_sided(&glass, &mirror)
            .lobes
            .iter()
            .all(|lobe| !lobe.transmits())
    );
    assert_eq!(Material::two_sided(&glass, &glass), glass);
    assert_eq!(Material::two_sided(&mirror, &mirror), mirror);
    // Unequal alphas: the larger holds, and the thinner side scatters less.
    let thin = Material::lambert(gray(0.8)).with_alpha(0.5);
    let both = Material::two_sided(&thin, &Material::lambert(gray(0.6)));
    assert_eq!((both.alpha, both.sides[0].reflectance), (1.0, gray(0.4)));
}

#[test]
fn what_a_renderer_can_ask() {
    let matt = Material::lambert(gray(0.5));
    let glass = Material::glass(1.5, 0.0, gray(2.0));
    let pane = Material::pane(1.5, Rgb::WHITE);
    let rough = Material::metal(gray(0.9), 0.5);
    assert!(matt.is_matt() && !matt.is_specular() && matt.is_opaque());
    assert!(glass.is_specular() && glass.has_body() && glass.is_opaque() && !glass.is_matt());
    assert_eq!(glass.scattering().body(), Some(gray(2.0)));
    assert!(pane.is_specular() && !pane.is_opaque() && !pane.has_body());
    assert!(!rough.is_specular() && !rough.is_matt() && rough.scattering().is_smooth());
    assert!(!glass.scattering().is_smooth());
    // Nothing to see: index 1 without absorption.
    assert!(
        Material::glass(1.0, 0.3, Rgb::BLACK)
            .optics()
            .is_nothing_else()
    );
    assert_eq!(
        Material::pane(1.0, Rgb::WHITE).optics().passage(0.3),
        Rgb::WHITE
    );
    for (name, material) in smooth() {
        assert_eq!(material.validate(), Ok(()), "{name}");
        assert!(material.claim(true).max_channel() <= 1.0 + 1e-9, "{name}");
    }
}
