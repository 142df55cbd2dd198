//! Meshes from files, from their bytes to the shapes that light sees.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use glam::{DAffine3, DVec2, DVec3};
use std::collections::BTreeMap;
use std::path::Path;
use understory::check::{SourceModel, check};
use understory::diag::{Diagnostic, SourceMap};
use understory::eval::files::{FileFault, ModelFiles};
use understory::geometry::import::{ImportError, MeshFile, read};
use understory::geometry::{Shape, TriangleMesh};
use understory::growth::{Growth, GrowthOptions};
use understory::interpret::{Interpretation, Limits, interpret};
use understory::math::Bounds3;
use understory::scene::Scene;
use understory::syntax::parse;

const MEMORY: u64 = 1 << 24;

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(Path::new("tests/meshes").join(name)).expect("a file of this test")
}

fn beside(name: &str) -> Result<Option<Vec<u8>>, String> {
    Ok(std::fs::read(Path::new("tests/meshes").join(name)).ok())
}

fn load(name: &str) -> MeshFile {
    read(name, &bytes(name), MEMORY, &mut beside).expect("it can be read")
}

/// Twice the area of each triangle, as a normal, with its corners.
fn faces(file: &MeshFile) -> Vec<(DVec3, [DVec3; 3])> {
    let part = |mesh: &TriangleMesh, to_file: DAffine3| -> Vec<_> {
        let corners = |triangle: &[u32; 3]| {
            triangle.map(|c| to_file.transform_point3(mesh.positions[c as usize]))
        };
        let all = mesh.triangles.iter().map(corners);
        all.map(|[a, b, c]| ((b - a).cross(c - a), [a, b, c]))
            .collect()
    };
    file.parts
        .iter()
        .flat_map(|p| part(&p.mesh, p.to_file))
        .collect()
}

fn area(file: &MeshFile) -> f64 {
    faces(file)
        .iter()
        .map(|(normal, _)| normal.length() / 2.0)
        .sum()
}

/// Volume within a closed surface whose front is outside.
fn volume(file: &MeshFile) -> f64 {
    faces(file)
        .iter()
        .map(|(normal, [a, ..])| normal.dot(*a) / 6.0)
        .sum()
}

fn bounds(file: &MeshFile) -> Bounds3 {
    Bounds3::of(faces(file).into_iter().flat_map(|(_, corners)| corners))
}

#[test]
fn a_house_of_polygons_is_closed_and_has_its_colours() {
    let house = load("house.obj");
    assert!(house.warnings.is_empty());
    assert!((volume(&house) - 10.0).abs() < 1e-12, "{}", volume(&house));
    let roof = 2.0 * 2.0 * 2.0_f64.sqrt();
    assert!((area(&house) - (4.0 + 4.0 * 4.0 + 2.0 + roof)).abs() < 1e-12);
    let names: Vec<&str> = house.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["wall", "roof", "floor"]);
    let of = |name| {
        house
            .parts
            .iter()
            .find(|p| p.material == names.iter().position(|n| *n == name))
            .unwrap()
    };
    assert_eq!(house.materials[0].base_color, [0.8, 0.7, 0.6]);
    assert_eq!(
        (
            of("wall").mesh.triangles.len(),
            of("roof").mesh.triangles.len()
        ),
        (10, 4)
    );
    // The top of the gable, in the middle of the image and above it.
    let wall = &of("wall").mesh;
    let top = wall.positions.iter().position(|p| p.z == 3.0).unwrap();
    assert_eq!(wall.uvs[top], DVec2::new(0.5, 1.5));
    assert!(of("roof").mesh.uvs.is_empty());
}

#[test]
fn nodes_of_gltf_stand_z_up_and_share_their_mesh() {
    for name in ["pair.glb", "pair.gltf"] {
        let pair = load(name);
        assert_eq!((pair.parts.len(), pair.materials.len()), (2, 1));
        assert!(std::sync::Arc::ptr_eq(
            &pair.parts[0].mesh,
            &pair.parts[1].mesh
        ));
        let [upright, turned] = [0, 1].map(|i| {
            let parts = vec![pair.parts[i].clone()];
            bounds(&MeshFile {
                parts,
                ..MeshFile::default()
            })
        });
        let is_box = |b: Bounds3, center: [f64; 3], size: [f64; 3]| {
            b.center().abs_diff_eq(DVec3::from_array(center), 1e-6)
                && b.diagonal().abs_diff_eq(DVec3::from_array(size), 1e-6)
        };
        // 1 × 2 × 3 with y up; the second is stretched along x and then turned about z: its length is now along y, that is up.
        assert!(
            is_box(upright, [10.0, 0.0, 5.0], [1.0, 3.0, 2.0]),
            "{upright:?}"
        );
        assert!(
            is_box(turned, [10.0, 0.0, 0.0], [2.0, 3.0, 2.0]),
            "{turned:?}"
        );
        assert!(
            (volume(&pair) - 18.0).abs() < 1e-5,
            "outside is the front: {}",
            volume(&pair)
        );
        let material = &pair.materials[0];
        assert_eq!((material.name.as_str(), material.alpha), ("ember", 0.5));
        assert_eq!((material.metallic, material.roughness), (0.25, 0.5));
        assert_eq!(material.emission, [4.0, 2.0, 0.0]);
        let mesh = &pair.parts[0].mesh;
        for (corner, normal) in mesh.positions.iter().zip(&mesh.normals) {
            assert!(normal.dot(*corner) > 0.0 && (normal.length() - 1.0).abs() < 1e-12);
        }
        // glTF's images begin at the top: there the first corner of each face has v = 1, so that it is 0 here.
        assert_eq!(mesh.uvs[..3], [DVec2::ZERO, DVec2::X, DVec2::ONE]);
    }
}

#[test]
fn files_cut_off_or_changed_anywhere_do_no_harm() {
    let mut n_refused = 0;
    for name in ["pair.glb", "pair.gltf", "house.obj"] {
        let whole = bytes(name);
        for length in 0..whole.len() {
            n_refused += usize::from(read(name, &whole[..length], MEMORY, &mut beside).is_err());
        }
        for at in 0..whole.len() {
            for value in [0, b'9', b'-', 255] {
                let mut changed = whole.clone();
                changed[at] = value;
                n_refused += usize::from(read(name, &changed, MEMORY, &mut beside).is_err());
            }
        }
    }
    assert!(n_refused > 8_000, "{n_refused}");
}

/// A document with one thing changed.
fn changed(from: &str, to: &str) -> String {
    let text = String::from_utf8(bytes("pair.gltf")).unwrap();
    assert!(text.contains(from), "{from}");
    let text = text.replacen(from, to, 1);
    let found = read("pair.gltf", text.as_bytes(), MEMORY, &mut beside);
    found.map_or_else(|error| error.to_string(), |_| String::new())
}

#[test]
fn hostile_documents_are_refused_with_their_reason() {
    for (from, to, reason) in [
        (
            "\"children\": [\n    1,",
            "\"children\": [\n    0,",
            "its node 0 hangs in two places",
        ),
        (
            "\"children\": [\n    1,",
            "\"children\": [\n    2,",
            "its node 2 hangs in two places",
        ),
        (
            "\"children\": [\n    1,",
            "\"children\": [\n    9,",
            "it names node 9",
        ),
        (
            "\"count\": 24",
            "\"count\": 4000000000",
            "names 4000000000 elements, more than",
        ),
        (
            "\"count\": 24",
            "\"count\": 18446744073709551615",
            "more than its buffer holds",
        ),
        (
            "\"byteOffset\": 288",
            "\"byteOffset\": 18446744073709551600",
            "is outside of its buffer",
        ),
        (
            "\"byteLength\": 288",
            "\"byteLength\": 99999",
            "is outside of its buffer",
        ),
        (
            "\"type\": \"VEC3\"",
            "\"type\": \"SCALAR\"",
            "holds Scalar where Vec3 is needed",
        ),
        (
            "\"componentType\": 5123",
            "\"componentType\": 5122",
            "holds no indices",
        ),
        ("\"mesh\": 0", "\"mesh\": 3", "names mesh 3"),
        (
            "\"material\": 0",
            "\"material\": 7",
            "a material that does not exist",
        ),
        (
            "\"extensionsUsed\"",
            "\"extensionsRequired\": [\"X_draco\"], \"extensionsUsed\"",
            "the extension `X_draco`",
        ),
        (
            "data:application/octet-stream;base64,",
            "secret/x.bin?",
            "its `secret/x.bin?",
        ),
        ("base64,", "base64,!", "not base64"),
        ("\"scene\": 0", "\"scene\": 5", "no such scene"),
        ("\"asset\"", "\"asset", "its document cannot be read"),
    ] {
        let message = changed(from, to);
        assert!(message.contains(reason), "{to}: {message}");
    }
}

#[test]
fn deep_nodes_and_graphs_that_multiply_end() {
    let document = |nodes: &str| {
        format!(r#"{{"asset":{{"version":"2.0"}},"nodes":[{nodes}],"scenes":[{{"nodes":[0]}}]}}"#)
    };
    let chain: Vec<String> = (1..=50_000)
        .map(|next| format!(r#"{{"children":[{next}]}}"#))
        .collect();
    let deep = document(&(chain.join(",") + ",{}"));
    let error = read("a.gltf", deep.as_bytes(), 1 << 30, &mut beside).unwrap_err();
    assert_eq!(error.to_string(), "it has no triangles");
    let double: Vec<String> = (1..=64)
        .map(|next| format!(r#"{{"children":[{next},{next}]}}"#))
        .collect();
    let error = read(
        "a.gltf",
        document(&(double.join(",") + ",{}")).as_bytes(),
        MEMORY,
        &mut beside,
    )
    .unwrap_err();
    assert!(error.to_string().contains("hangs in two places"), "{error}");
    let nested = "[".repeat(100_000);
    assert!(read("a.gltf", nested.as_bytes(), MEMORY, &mut beside).is_err());
    let small = read("pair.glb", &bytes("pair.glb"), 4096, &mut beside);
    assert_eq!(small.unwrap_err(), ImportError::TooLarge(4096));
}

/// Files that exist only here.
struct Files(BTreeMap<&'static str, Vec<u8>>);

impl ModelFiles for Files {
    fn place(&self, path: &str) -> Result<String, FileFault> {
        if path.starts_with('/') {
            return Err(FileFault::Refused {
                message: format!(
                    "the model uses the file `{path}`, which is outside of its folder"
                ),
                hint: "allow it".to_owned(),
            });
        }
        Ok(path.trim_start_matches("./").to_owned())
    }

    fn read(&self, path: &str) -> Result<String, FileFault> {
        Ok(String::from_utf8(self.read_bytes(path)?).unwrap())
    }

    fn read_bytes(&self, path: &str) -> Result<Vec<u8>, FileFault> {
        let place = self.place(path)?;
        let found = self.0.get(&*place).cloned();
        found.ok_or_else(|| FileFault::Missing(format!("{place} (No such file or directory)")))
    }

    fn may_write(&self, path: &str) -> Result<String, FileFault> {
        self.place(path)
    }

    fn list(&self, _: &str) -> Result<Option<Vec<String>>, FileFault> {
        Ok(None)
    }
}

fn draw(rules: &str) -> Result<Interpretation, Box<Diagnostic>> {
    draw_with("", rules)
}

fn draw_with(before: &str, rules: &str) -> Result<Interpretation, Box<Diagnostic>> {
    let text = format!("{before}\nprotected void init() [ Axiom ==> M(0) {rules}; ]");
    let file = SourceMap::default().add("model.rgg", text.as_str());
    let (ast, mut diagnostics) = parse(file, &text);
    let (model, checked) = check(&[SourceModel {
        name: "model.rgg".into(),
        ast,
    }]);
    diagnostics.append(checked);
    assert!(!diagnostics.has_errors(), "{diagnostics:#?}");
    let ignore = Box::new(|_: &str| {});
    let mut growth =
        Growth::new(&model, GrowthOptions::default(), ignore, Box::new(|| false)).unwrap();
    let files = [
        ("m/house.obj", bytes("house.obj")),
        ("m/house.mtl", bytes("house.mtl")),
        ("pair.glb", bytes("pair.glb")),
        ("bad.obj", b"v 0 0 0\nf 1 1 2".to_vec()),
    ];
    growth.set_files(Box::new(Files(files.into())));
    growth.init().unwrap();
    interpret(&mut growth.sketch(), Limits::default())
}

#[test]
fn a_mesh_is_read_once_and_stands_wherever_it_is_named() {
    let drawn = draw("Mesh(\"m/house.obj\") M(5) Mesh(\"./m/house.obj\").(setShader(RED)) M(5) [RU(90) Mesh(\"m/house.obj\")]").unwrap();
    assert!(drawn.warnings.is_empty(), "{:?}", drawn.warnings);
    let root = &drawn.scene.groups[drawn.scene.root.unwrap().0 as usize];
    let groups: Vec<u32> = root.instances.iter().map(|i| i.group.0).collect();
    assert_eq!(groups, [0, 1, 0]);
    let shared = |group: usize| {
        drawn.scene.groups[group]
            .shapes
            .iter()
            .map(|shape| match &shape.shape {
                Shape::Mesh(mesh) => std::sync::Arc::as_ptr(mesh),
                other => panic!("{other:?}"),
            })
    };
    assert!(shared(0).eq(shared(1)), "one copy in memory");
    let materials = |group: usize| {
        drawn.scene.groups[group]
            .shapes
            .iter()
            .map(|s| s.material.0)
            .collect::<Vec<_>>()
    };
    assert_eq!(materials(0).len(), 3);
    assert!(
        materials(1)
            .iter()
            .all(|m| *m == materials(1)[0] && !materials(0).contains(m))
    );
    assert_eq!(drawn.summary.bounds.max.z, 11.0);
    assert!(!drawn.summary.has_light);
    assert!(Scene::build(drawn.scene).is_ok());
}

#[test]
fn what_shines_in_a_file_is_a_light() {
    assert!(draw("Mesh(\"pair.glb\")").unwrap().summary.has_light);
}

#[test]
fn files_that_cannot_be_drawn_are_named_with_their_reason() {
    for (rules, slug, words) in [
        (
            "Mesh(\"bad.obj\")",
            "mesh-file",
            "`Mesh` cannot draw `bad.obj`: line 2: a corner names `v` 2",
        ),
        (
            "Mesh(\"no.obj\")",
            "mesh-file",
            "cannot draw `no.obj`: no.obj (No such file or directory)",
        ),
        (
            "Mesh(\"/etc/rock.obj\")",
            "file-access",
            "outside of its folder",
        ),
        ("Mesh(\"m/house.mtl\")", "mesh-file", "must end in"),
    ] {
        let fault = draw(rules).map(|_| ()).unwrap_err();
        assert_eq!(fault.slug, slug);
        assert!(fault.message.contains(words), "{}", fault.message);
        assert!(fault.primary.is_some(), "it says where");
    }
    let nothing = draw("Mesh").unwrap();
    assert!(!nothing.warnings.is_empty());
}

/// The meshes of all groups, in the order they were drawn.
fn meshes(drawn: &Interpretation) -> Vec<&TriangleMesh> {
    let shapes = drawn.scene.groups.iter().flat_map(|group| &group.shapes);
    shapes
        .filter_map(|placed| match &placed.shape {
            Shape::Mesh(mesh) => Some(&**mesh),
            _ => None,
        })
        .collect()
}

fn mesh_file(mesh: &TriangleMesh) -> MeshFile {
    let part = understory::geometry::import::MeshPart {
        mesh: std::sync::Arc::new(mesh.clone()),
        to_file: DAffine3::IDENTITY,
        material: None,
    };
    MeshFile {
        parts: vec![part],
        ..MeshFile::default()
    }
}

const FLAT: &str =
    "float[] flat = { 0,0,0, 1,0,0, 2,0,0, 0,0,1, 1,0,1, 2,0,1, 0,0,3, 1,0,3, 2,0,3 };\n";

#[test]
fn surfaces_of_a_model_are_drawn_once_each() {
    let rules = "NURBSSurface(new BezierSurface(flat, 3, 3)) [M(1) NURBSSurface(new BezierSurface(flat, 3, 3))] \
                 NURBSSurface(new BezierSurface(flat, 3, 3)).(setShader(RED))";
    let drawn = draw_with(FLAT, rules).unwrap();
    assert!(drawn.warnings.is_empty(), "{:?}", drawn.warnings);
    let root = &drawn.scene.groups[drawn.scene.root.unwrap().0 as usize];
    let groups: Vec<u32> = root.instances.iter().map(|i| i.group.0).collect();
    assert_eq!(groups, [0, 0, 1]);
    let all = meshes(&drawn);
    assert!(std::ptr::eq(all[0], all[1]), "one copy in memory");
    assert!((area(&mesh_file(all[0])) - 6.0).abs() < 1e-6);
    // u runs along the rows that the model gives, v from one to the next.
    let far = all[0]
        .positions
        .iter()
        .position(|p| *p == DVec3::new(2.0, 0.0, 3.0))
        .unwrap();
    assert_eq!(all[0].uvs[far], DVec2::ONE);
    assert_eq!(drawn.summary.bounds.max, DVec3::new(2.0, 0.0, 4.0));
}

#[test]
fn stems_rings_and_turned_shapes_have_their_volume() {
    let pi = std::f64::consts::PI;
    let half = "new BSplineOfVertices(new VertexListImpl(arc, 4), 2, false, true)";
    for (rules, volume_wanted, tolerance) in [
        (
            "Sweep(new float[] {0,0,0,0.1, 0,0,2,0.1}).(setError(0.0001))",
            0.02 * pi,
            3e-3,
        ),
        (
            "NURBSSurface(new ProfileSweep(new Circle(0.5), new Circle(2))).(setError(0.001))",
            pi * pi,
            3e-3,
        ),
        (
            &format!("NURBSSurface(new SurfaceOfRevolution({half})).(setError(0.0005))"),
            4.0 / 3.0 * pi,
            3e-3,
        ),
        ("MeshNode(tetra())", 1.0 / 6.0, 1e-7),
    ] {
        let before = "const float S = 0.70710678f;\n\
            float[] arc = { 0,0,-1,1, S,0,-S,S, 1,0,0,1, S,0,S,S, 0,0,1,1 };\n\
            PolygonMesh tetra() { PolygonMesh m = new PolygonMesh(); \
            m.setVertexData(new float[] {0,0,0, 1,0,0, 0,1,0, 0,0,1}); \
            m.setIndexData(new int[] {0,2,1, 0,1,3, 1,2,3, 0,3,2}); return m; }\n";
        let drawn = draw_with(before, rules).unwrap();
        let found = volume(&mesh_file(meshes(&drawn)[0]));
        assert!(
            (found / volume_wanted - 1.0).abs() < tolerance,
            "{rules}: {found} {volume_wanted}"
        );
    }
}

#[test]
fn surfaces_that_cannot_be_drawn_say_why() {
    for (rules, words) in [
        (
            "NURBSSurface(new BezierSurface(flat, 3, 4))",
            "9 points do not fill rows of 4",
        ),
        (
            "NURBSSurface(new BezierSurface(flat, 5, 3))",
            "2, 3 or 4 numbers",
        ),
        (
            "NURBSSurface(new BezierSurface(flat, 3, -3))",
            "do not fill rows of -3",
        ),
        (
            "NURBSSurface(new BSplineGrid(flat, 3, 3, 2, 7))",
            "fewer than the 8 that its degree 7 needs",
        ),
        (
            "NURBSSurface(new BSplineGrid(flat, 3, 3, 0, 1))",
            "its degree is 0",
        ),
        (
            "NURBSSurface(new ProfileSweep(new RegularPolygon(2), new Circle(1)))",
            "3 to 4096 sides, not 2",
        ),
        (
            "NURBSSurface(new ProfileSweep(new Circle(1), new InterpolatedCurve(new float[] {1,1,1})))",
            "fewer than the 2",
        ),
        (
            "NURBSSurface(new ProfileSweep(new Circle(0.0f/0.0f), new Circle(1)))",
            "not a finite number",
        ),
        (
            "NURBSSurface(new BezierSurface(flat, 3, 3)).(setError(0.0f))",
            "",
        ),
        ("Sweep(flat)", "no multiple of 4"),
        ("Sweep(new float[] {0,0,0,1, 0,0,0,2})", "fewer than the 2"),
        (
            "NURBSSurface(new ProfileSweep(new Circle(1), new Circle(2))).(setError(0.0000000001f))",
            "more than 2097152 triangles",
        ),
    ] {
        match draw_with(FLAT, rules) {
            Ok(_) => assert_eq!(words, "", "{rules}"),
            Err(fault) => {
                assert!(
                    fault.message.contains(words) && !words.is_empty(),
                    "{rules}: {}",
                    fault.message
                );
                assert_eq!(
                    (fault.slug, fault.primary.is_some()),
                    ("curved-surface", true)
                );
            }
        }
    }
    assert!(!draw("NURBSSurface").unwrap().warnings.is_empty());
}
