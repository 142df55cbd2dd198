//! Pictures on surfaces: light on them against closed forms, how models name them, and files that are none.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[allow(dead_code, reason = "shared with tests that use more of it")]
#[path = "support/statistics.rs"]
mod statistics;
#[allow(dead_code, reason = "shared with tests that use more of it")]
#[path = "support/room.rs"]
mod room;

use glam::{DAffine3, DVec2, DVec3};
use room::{Room, at, gray, square};
use statistics::assert_mean;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::sync::Arc;
use understory::check::{SourceModel, check};
use understory::color::Rgb;
use understory::diag::{Diagnostic, SourceMap};
use understory::eval::files::{FileFault, ModelFiles};
use understory::geometry::Shape;
use understory::growth::{Growth, GrowthOptions};
use understory::integrator::{
    CancelToken, Integrator, Path, RadianceEstimator, RayCounts, Raytracer, RenderContext,
};
use understory::interpret::{DecodedPictures, Interpretation, Limits, interpret, interpret_again};
use understory::light::{Environment, Sky};
use understory::material::image::Image;
use understory::material::texture::{Filter, Layer, Pictures, Texture};
use understory::material::{Material, Side};
use understory::math::stats::RunningStats;
use understory::math::{Ray, rng};
use understory::sampler::{Sampler, SamplerKind};
use understory::scene::Scene;
use understory::syntax::parse;

// ── light ──

/// Two by two fields, light at the upper left and the lower right.
fn checker(light: f32, dark: f32, coverage: [f32; 2]) -> Texture {
    let texel = |value, coverage| [value, value, value, coverage];
    let (first, second) = (texel(light, coverage[0]), texel(dark, coverage[1]));
    let image = Image::linear(2, 2, vec![first, second, second, first]).unwrap();
    Texture {
        filter: Filter::Nearest,
        ..Texture::new(Arc::new(image))
    }
}

/// A matt surface in the colours of a picture, with its holes.
fn wearing(texture: &Texture) -> Material {
    let side = Side {
        reflectance: Rgb::WHITE,
        transmittance: Rgb::BLACK,
    };
    let pictures = Pictures {
        layers: vec![Layer {
            texture: texture.clone(),
            sides: [side; 2],
        }],
        holes: vec![texture.clone()],
    };
    Material {
        pictures: Some(Box::new(pictures)),
        ..Material::matt([Side::default(); 2])
    }
}

fn under_white_sky(room: Room) -> Scene {
    room.under(Environment {
        sky: Sky::Uniform(gray(1.0)),
        sun: None,
    })
    .build()
}

/// The mean of eight samples along `ray(i)`, of so many i.
fn observe(
    scene: &Scene,
    integrator: &dyn Integrator,
    n: u64,
    ray: impl Fn(u64) -> Ray,
) -> RunningStats {
    let cancel = CancelToken::default();
    let context = RenderContext {
        seed: 0,
        cancel: &cancel,
        progress: &|_| {},
    };
    let estimator: Box<dyn RadianceEstimator + '_> = integrator.prepare(scene, &context).unwrap();
    let mut seen = RunningStats::default();
    for i in 0..n {
        let sum: f64 = (0..8)
            .map(|index| {
                let stream = rng::hash(&[0x7E57, i]);
                let mut sampler = Sampler::new(SamplerKind::OwenSobol, stream, index);
                let rays = &mut RayCounts::default();
                estimator.incident_radiance(&ray(i), &mut sampler, rays).g
            })
            .sum();
        seen.push(sum / 8.0);
    }
    seen
}

/// In a hollow sphere every point sees every other equally well. So under walls that shine with radiance 1 and reflect ρ(x), the
/// light on them is the same everywhere, 1 / (1 - ρ̄) with the mean ρ̄ over the area, and a wall shows 1 + ρ(x) / (1 - ρ̄).
/// The four fields of a checker on a sphere are equally large. Catches colours that are decoded, looked up or sampled wrongly.
#[test]
fn a_furnace_of_two_colours_is_as_bright_as_its_mean_says() {
    let walls = wearing(&checker(0.9, 0.1, [1.0; 2])).emitting(gray(1.0), gray(1.0));
    let walls = Material {
        pictures: walls.pictures.map(|pictures| {
            Box::new(Pictures {
                holes: vec![],
                ..*pictures
            })
        }),
        ..walls
    };
    let sphere = Shape::Sphere { radius: 1.0 };
    let scene = Room::default().with(sphere, at(0., 0., 0.), walls).build();
    let toward = |x: f64, y: f64, z: f64| move |_| Ray::new(DVec3::ZERO, DVec3::new(x, y, z));
    // Light fields: u in the first half turn with v above the middle, and the other way round.
    let cases = [
        ("light", toward(0.0, 0.6, 0.8), 1.0 + 0.9 / 0.5),
        ("dark", toward(0.0, 0.6, -0.8), 1.0 + 0.1 / 0.5),
        ("light below", toward(0.0, -0.6, -0.8), 1.0 + 0.9 / 0.5),
    ];
    for (name, ray, truth) in cases {
        let seen = observe(&scene, &Path::default(), 6000, ray);
        assert_mean(name, &seen, truth, 3);
    }
}

/// Seen from above, a black sheet with holes before a white sky shows the share of its holes, whatever the renderer; so do
/// shadow rays. With soft edges the share is the mean of the coverages: what lies between texels is linear along u and v, so
/// that a grid of points in the middles of even cells finds its mean exactly.
#[test]
fn what_a_sheet_lets_through_is_the_share_of_its_holes() {
    let soft: Vec<[f32; 4]> = (0..16)
        .map(|i| [0.0, 0.0, 0.0, [0.0, 0.25, 1.0, 0.5][(i * 7 + i / 4) % 4]])
        .collect();
    let covered = soft.iter().map(|texel| f64::from(texel[3])).sum::<f64>() / 16.0;
    let soft = Texture::new(Arc::new(Image::linear(4, 4, soft).unwrap()));
    let hard = checker(0.0, 0.0, [1.0, 0.0]);
    let side = 24;
    let grid = |i: u64| {
        let middle = |i: u64| (i as f64 + 0.5) / side as f64 - 0.5;
        let at = DVec2::new(middle(i % side), middle(i / side));
        Ray::new(at.extend(2.0), DVec3::NEG_Z)
    };
    for (name, texture, truth) in [("soft", soft, 1.0 - covered), ("hard", hard, 0.5)] {
        let room = Room::default().with(square(0.5), at(0., 0., 0.), wearing(&texture));
        let scene = under_white_sky(room);
        let seen = observe(&scene, &Raytracer::default(), side * side, grid);
        assert!(
            (seen.mean() - truth).abs() < 1e-9,
            "{name}: {}",
            seen.mean()
        );
        let through: f64 = (0..side * side)
            .map(|i| scene.transmittance(&grid(i)).g)
            .sum();
        let through = through / (side * side) as f64;
        assert!((through - truth).abs() < 1e-9, "{name}: {through}");
        // The path tracer passes by chance, in eighths of its stratified numbers.
        let seen = observe(&scene, &Path::default(), side * side, grid);
        assert!(
            (seen.mean() - truth).abs() < 0.01,
            "{name}: {}",
            seen.mean()
        );
    }
}

/// The light on a white floor under a sheet with holes, near to it: each hole lets the sky through, and nothing else does.
#[test]
fn holes_cast_no_shadow() {
    let sheet = wearing(&checker(0.0, 0.0, [1.0, 0.0]));
    let room = Room::default()
        .with(square(0.5), at(0.0, 0.0, 0.001), sheet)
        .with(square(0.5), at(0., 0., 0.), Material::lambert(gray(0.5)));
    let scene = under_white_sky(room);
    // Below the middle of a field: u runs along y, v along x.
    let from = |x: f64, y: f64| Ray::new(DVec3::new(x, y, 0.0005), DVec3::NEG_Z);
    for (x, y, truth) in [(-0.25, -0.25, 0.5), (0.25, 0.25, 0.5), (0.25, -0.25, 0.0)] {
        let seen = observe(&scene, &Path::default(), 500, |_| from(x, y));
        assert!(
            (seen.mean() - truth).abs() < 0.01,
            "{x} {y} {}",
            seen.mean()
        );
    }
}

/// Where colours of a picture come out on the shapes of a model, as GroIMP lays them.
#[test]
fn pictures_stand_upright_on_every_shape() {
    // Red, green above blue, white.
    let row = |texels: [[f32; 3]; 2]| texels.map(|[r, g, b]| [r, g, b, 1.0]);
    let texels = [
        row([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
        row([[0.0, 0.0, 1.0], [1.0, 1.0, 1.0]]),
    ];
    let image = Image::linear(2, 2, texels.concat()).unwrap();
    let picture = wearing(&Texture {
        filter: Filter::Nearest,
        ..Texture::new(Arc::new(image))
    });
    let cases: [(&str, Shape, [f64; 3], [f64; 3]); 5] = [
        // From outside, v runs up and u against the clock seen from above.
        (
            "sphere",
            Shape::Sphere { radius: 1.0 },
            [2.0, 2.0, 2.0],
            [1.0, 0.0, 0.0],
        ),
        (
            "cylinder",
            Shape::Frustum {
                length: 1.0,
                base_radius: 0.5,
                top_radius: 0.5,
                base_cap: true,
                top_cap: true,
            },
            [0.0, -2.0, 0.25],
            [1.0, 1.0, 1.0],
        ),
        (
            "box",
            Shape::Box {
                half_x: 0.5,
                half_y: 0.5,
                length: 1.0,
            },
            [-0.25, -2.0, 0.75],
            [1.0, 0.0, 0.0],
        ),
        (
            "parallelogram",
            Shape::Parallelogram {
                corner: DVec3::new(-0.5, 0.0, 0.0),
                edge_u: DVec3::Z,
                edge_v: DVec3::X,
            },
            [-0.25, 2.0, 0.75],
            [1.0, 0.0, 0.0],
        ),
        ("plane", Shape::Plane, [1.25, -0.25, 2.0], [1.0, 0.0, 0.0]),
    ];
    for (name, shape, from, expected) in cases {
        let scene = Room::default()
            .with(shape.clone(), DAffine3::IDENTITY, picture.clone())
            .build();
        let from = DVec3::from_array(from);
        let toward = match name {
            "sphere" => -from,
            "plane" => DVec3::NEG_Z,
            "parallelogram" => DVec3::NEG_Y,
            _ => DVec3::Y,
        };
        let ray = Ray::new(from, toward.normalize());
        let point = scene.surface(&ray, &scene.closest(&ray).unwrap());
        let shown = scene.optics(&point).scattering.sides[0].reflectance;
        assert!(
            (shown - Rgb::from_array(expected))
                .map(f64::abs)
                .max_channel()
                < 1e-6,
            "{name}: {shown:?}"
        );
    }
}

// ── models ──

#[derive(Clone, Default)]
struct Files(BTreeMap<String, Vec<u8>>);

impl ModelFiles for Files {
    fn place(&self, path: &str) -> Result<String, FileFault> {
        if path.starts_with('/') {
            return Err(FileFault::Refused {
                message: format!("`{path}` is outside"),
                hint: "allow it".to_owned(),
            });
        }
        Ok(path.to_owned())
    }

    fn read(&self, path: &str) -> Result<String, FileFault> {
        Ok(String::from_utf8(self.read_bytes(path)?).unwrap())
    }

    fn read_bytes(&self, path: &str) -> Result<Vec<u8>, FileFault> {
        let found = self.0.get(&self.place(path)?).cloned();
        found.ok_or_else(|| FileFault::Missing(format!("{path} (No such file or directory)")))
    }

    fn may_write(&self, path: &str) -> Result<String, FileFault> {
        self.place(path)
    }

    fn list(&self, _: &str) -> Result<Option<Vec<String>>, FileFault> {
        Ok(Some(self.0.keys().cloned().collect()))
    }
}

fn png(texels: &[[u8; 4]]) -> Vec<u8> {
    let width = u32::try_from(texels.len()).unwrap();
    let picture = image::RgbaImage::from_raw(width, 1, texels.concat()).unwrap();
    let mut file = Cursor::new(vec![]);
    picture
        .write_to(&mut file, image::ImageFormat::Png)
        .unwrap();
    file.into_inner()
}

/// A green picture of which half is a hole, a white one, and files that are none.
fn files() -> Files {
    let green = png(&[[0, 255, 0, 255], [0, 255, 0, 0]]);
    let mut cut = green.clone();
    cut.truncate(50);
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
    Files(BTreeMap::from([
        ("leaf.png".to_owned(), green.clone()),
        ("copy.png".to_owned(), green),
        ("images/bark.png".to_owned(), png(&[[255, 255, 255, 255]])),
        ("mask.png".to_owned(), png(&[[255; 4], [0, 0, 0, 255]])),
        ("cut.png".to_owned(), cut),
        ("text.png".to_owned(), b"this is no picture".to_vec()),
        (
            "m/rock.obj".to_owned(),
            format!("mtllib rock.mtl\n{triangle}usemtl stone\nf 1/1 2/2 3/3\n").into_bytes(),
        ),
        (
            "m/rock.mtl".to_owned(),
            b"newmtl stone\nKd 0.5 0.5 0.5\nmap_Kd ../leaf.png\n".to_vec(),
        ),
        (
            "plain.obj".to_owned(),
            format!("{triangle}f 1/1 2/2 3/3\n").into_bytes(),
        ),
        ("../leaf.png".to_owned(), vec![]),
    ]))
}

/// A model that has drawn nothing yet.
fn grown(rules: &str) -> Growth {
    let text = format!("protected void init() [ Axiom ==> {rules}; ]");
    let file = SourceMap::default().add("model.rgg", text.as_str());
    let (ast, mut diagnostics) = parse(file, &text);
    let (model, checked) = check(&[SourceModel {
        name: "model".into(),
        ast,
    }]);
    diagnostics.append(checked);
    assert!(diagnostics.is_empty(), "{rules}: {diagnostics:#?}");
    let ignore = Box::new(|_: &str| {});
    let mut growth =
        Growth::new(&model, GrowthOptions::default(), ignore, Box::new(|| false)).unwrap();
    growth.set_files(Box::new(all_files()));
    growth.init().unwrap();
    growth
}

fn all_files() -> Files {
    let mut files = files();
    let leaf = files.0["leaf.png"].clone();
    files.0.insert("m/../leaf.png".to_owned(), leaf);
    files
}

fn draw(rules: &str) -> Result<Interpretation, Box<Diagnostic>> {
    interpret(&mut grown(rules).sketch(), Limits::default())
}

/// The materials of what is drawn, without complaints.
fn materials(rules: &str) -> Vec<Material> {
    let drawn = draw(rules).unwrap_or_else(|fault| panic!("{rules}: {fault:#?}"));
    assert!(drawn.warnings.is_empty(), "{rules}: {:#?}", drawn.warnings);
    Scene::build(drawn.scene.clone()).unwrap();
    drawn.scene.materials
}

/// What the front reflects and lets scatter through, and alpha, at a point of the only material.
fn shown(rules: &str, u: f64, v: f64) -> ([f64; 3], [f64; 3], f64) {
    let [material] = materials(rules).try_into().unwrap();
    let optics = material.optics_at(DVec2::new(u, v));
    let [front, _] = optics.scattering.sides;
    let (back, through) = (front.reflectance, front.transmittance);
    (back.to_array(), through.to_array(), optics.alpha)
}

const GREEN: [f64; 3] = [0.0, 1.0, 0.0];
const NONE: [f64; 3] = [0.0; 3];

#[test]
fn a_shader_by_the_name_of_a_picture_has_its_colours_and_holes() {
    for shader in [
        "shader(\"leaf.png\")",
        "shader(\"leaf\")",
        "new ShaderRef(\"leaf\")",
        "new Phong().(setDiffuse(image(\"leaf.png\")))",
        "new Phong().(setDiffuse(new ImageMap(\"leaf.png\")))",
        "new Phong().(setDiffuse(new ImageMap().(setImageAdapter(image(\"leaf\")))))",
    ] {
        let rules = format!("Parallelogram(1, 1).(setShader({shader}))");
        assert_eq!(shown(&rules, 0.25, 0.5), (GREEN, NONE, 1.0), "{shader}");
        assert_eq!(shown(&rules, 0.75, 0.5).2, 0.0, "{shader}");
    }
    let bark = shown("F(1).(setShader(shader(\"bark\")))", 0.3, 0.3);
    assert_eq!(bark, ([1.0; 3], NONE, 1.0));
}

#[test]
fn pictures_are_moved_repeated_and_turned() {
    let at = |change: &str, u: f64| {
        let map = format!("image(\"leaf.png\").(setBilinearFiltering(false), {change})");
        let rules = format!("Sphere(1).(setShader(new Phong().(setDiffuse({map}))))");
        shown(&rules, u, 0.25).2
    };
    assert_eq!(
        (at("setRepeat(2, 1)", 0.2), at("setRepeat(2, 1)", 0.3)),
        (1.0, 0.0)
    );
    assert_eq!(
        (at("setOffset(0.5, 0)", 0.2), at("setOffset(0.5, 0)", 0.7)),
        (0.0, 1.0)
    );
    // Turned by a quarter against the clock, what was right is above.
    assert_eq!((at("setTurn(90)", 0.2), at("setTurn(90)", 0.9)), (1.0, 1.0));
    let groimp = "setInput(new AffineUVTransformation().(setOffsetU(0.5), setScaleU(2)))";
    assert_eq!((at(groimp, 0.6), at(groimp, 0.8)), (1.0, 0.0));
}

#[test]
fn leaves_share_the_light_of_a_picture() {
    let leaf = shown(
        "Parallelogram(1, 1).(setShader(new LeafShader(image(\"leaf.png\"), 0.25)))",
        0.25,
        0.5,
    );
    assert_eq!(leaf, ([0.0, 0.75, 0.0], [0.0, 0.25, 0.0], 1.0));
    let leaf = "new LeafShader(image(\"leaf.png\"), new RGBColor(0.5, 0, 0))";
    let leaf = shown(
        &format!("Parallelogram(1, 1).(setShader({leaf}))"),
        0.25,
        0.5,
    );
    assert_eq!(leaf, (GREEN, [0.5, 0.0, 0.0], 1.0));
    let two = "new SideSwitchShader(shader(\"leaf.png\"), new RGBAShader(0, 0, 1))";
    let [two] = materials(&format!("Parallelogram(1, 1).(setShader({two}))"))
        .try_into()
        .unwrap();
    let [front, back] = two.optics_at(DVec2::new(0.25, 0.5)).scattering.sides;
    assert_eq!(front.reflectance.to_array(), GREEN);
    assert_eq!(back.reflectance.to_array(), [0.0, 0.0, 1.0]);
    assert!(two.has_holes());
}

#[test]
fn a_picture_as_transparency_cuts_holes_where_it_is_white() {
    let masked =
        "new Phong().(setDiffuse(new RGBColor(0.5, 0, 0)), setTransparency(image(\"mask.png\")))";
    let rules = format!("Parallelogram(1, 1).(setShader({masked}))");
    assert_eq!(shown(&rules, 0.25, 0.5).2, 0.0);
    assert_eq!(shown(&rules, 0.75, 0.5), ([0.5, 0.0, 0.0], NONE, 1.0));
}

#[test]
fn checkers_are_those_of_groimp() {
    let rules = "Plane().(setShader(new Phong().(setDiffuse(new Checker().(setColor1(new Graytone(0.5)))))))";
    let at = |u: f64, v: f64| shown(rules, u, v).0[0];
    assert_eq!((at(0.1, 0.1), at(0.6, 0.1)), (0.0, 0.5));
    assert_eq!((at(0.1, 0.6), at(-0.4, -0.4)), (0.5, 0.0));
}

#[test]
fn equal_pictures_are_one_and_equal_shaders_one_material() {
    let drawn = draw(
        "for (int i : 1:50) ([Parallelogram(1, 1).(setShader(shader(\"leaf.png\")))]) \
         [Parallelogram(1, 1).(setShader(shader(\"copy.png\")))]",
    );
    assert_eq!(drawn.unwrap().scene.materials.len(), 1);
}

/// A model that asks for light at each step is drawn as often: its pictures are decoded once, and again if they change.
#[test]
fn pictures_are_decoded_once_for_all_drawings() {
    let mut growth = grown(
        "[Parallelogram(1, 1).(setShader(shader(\"leaf.png\")))] \
         [Parallelogram(1, 1).(setShader(shader(\"mask.png\")))]",
    );
    let mut pictures = DecodedPictures::default();
    let mut draw = |growth: &mut Growth, memory: u64| {
        let limits = Limits {
            memory,
            ..Limits::default()
        };
        let drawn = interpret_again(&mut growth.sketch(), limits, &mut pictures);
        drawn.map(|drawn| (drawn.scene.materials, pictures.n_decoded()))
    };
    let room = Limits::default().memory;
    let (first, n) = draw(&mut growth, room).unwrap();
    let (second, still) = draw(&mut growth, room).unwrap();
    assert_eq!((n, still, first == second), (2, 2, true));
    let mut files = all_files();
    let other = files.0["mask.png"].clone();
    files.0.insert("leaf.png".to_owned(), other);
    growth.set_files(Box::new(files));
    let (third, still) = draw(&mut growth, room).unwrap();
    // Both are now the one that is known, and the other is forgotten.
    assert_eq!((still, third.len(), third == first), (2, 1, false));
    growth.set_files(Box::new(all_files()));
    assert_eq!(draw(&mut growth, room).unwrap(), (first, 3));
    // What is decoded already takes its memory all the same: the same limit is the least that is enough.
    let enough = |draws: &mut dyn FnMut(u64) -> bool| (0..2000).map(|n| 8 * n).find(|n| draws(*n));
    let mut again = |memory| {
        draw(&mut growth, room).unwrap();
        draw(&mut growth, memory).is_ok()
    };
    let known = enough(&mut again);
    let mut fresh = |memory| {
        let limits = Limits {
            memory,
            ..Limits::default()
        };
        interpret(&mut growth.sketch(), limits).is_ok()
    };
    assert_eq!(known, enough(&mut fresh));
    assert!(known.is_some());
}

#[test]
fn meshes_have_the_pictures_of_their_files() {
    let [stone] = materials("Mesh(\"m/rock.obj\")").try_into().unwrap();
    let optics = stone.optics_at(DVec2::new(0.25, 0.5));
    assert_eq!(
        optics.scattering.sides[0].reflectance.to_array(),
        [0.0, 0.5, 0.0]
    );
    assert_eq!(
        (optics.alpha, stone.alpha_at(DVec2::new(0.75, 0.5))),
        (1.0, 0.0)
    );
}

#[test]
fn a_mesh_without_materials_looks_as_the_turtle_does() {
    let color = |rules: &str| {
        let all = materials(rules);
        all.last().unwrap().sides[0].reflectance.to_array()
    };
    assert_eq!(color("Mesh(\"plain.obj\")"), [0.5; 3]);
    let ega = color("P(4) F(1)");
    assert_eq!(color("P(4) F(1) Mesh(\"plain.obj\")"), ega);
    assert_eq!(
        color("[F(1).(setShader(RED)) Mesh(\"plain.obj\")]"),
        [1.0, 0.0, 0.0]
    );
    assert_eq!(
        color("Mesh(\"plain.obj\").(setShader(RED))"),
        [1.0, 0.0, 0.0]
    );
    // Two looks, two groups; the file's own materials are not touched.
    let drawn =
        draw("Mesh(\"plain.obj\") P(4) F(1) Mesh(\"plain.obj\") Mesh(\"m/rock.obj\")").unwrap();
    assert_eq!(drawn.scene.materials.len(), 3);
}

#[test]
fn what_is_wrong_with_a_picture_is_told() {
    let fault = |rules: &str| {
        let fault = draw(rules).unwrap_err();
        assert!(fault.primary.is_some() || !fault.secondary.is_empty() || !fault.hints.is_empty());
        format!("{} {}", fault.message, fault.hints.join(" "))
    };
    let of = |name: &str| fault(&format!("F(1).(setShader(shader(\"{name}\")))"));
    for (name, parts) in [
        ("leav.png", ["`leav.png`", "did you mean `leaf.png`?"]),
        ("cut.png", ["`cut.png`", "cannot be decoded"]),
        ("text.png", ["`text.png`", "neither a PNG nor a JPEG"]),
        ("/etc/leaf.png", ["outside", "allow it"]),
    ] {
        let told = of(name);
        assert!(
            parts.iter().all(|part| told.contains(part)),
            "{name}: {told}"
        );
    }
    let drawn = draw("F(1).(setShader(shader(\"nobark\")))").unwrap();
    assert_eq!(drawn.scene.materials[0].sides[0].reflectance, gray(0.5));
    let [warning] = drawn.warnings.sorted().try_into().unwrap();
    assert!(warning.message.contains("`nobark`"), "{}", warning.message);
    let drawn = draw("F(1).(setShader(new Phong().(setDiffuse(new Graytone(0)), setSpecular(image(\"leaf.png\")))))").unwrap();
    assert_eq!(drawn.warnings.sorted().len(), 1);
}
