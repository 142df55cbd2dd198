//! What the language has and this program has not: refused by name, with what to write instead.

use super::Checker;
use crate::diag::{Diagnostic, Span};
use crate::library::FunctionId;
use crate::syntax::ast;

/// Types of GroIMP and Java that models use and that are not supported, with what to do instead.
const TYPES: &[(&[&str], &str)] = &[
    (
        &[
            "FunctionRef",
            "BiFunction",
            "Supplier",
            "Consumer",
            "Predicate",
        ],
        "write a method, or a function value of one parameter: `FloatToFloat f = float t => float t * t;`",
    ),
    (
        &["Vector2d", "Point2d", "Tuple2d", "Vector2f", "Point2f"],
        "write `Vector3d` or `Point3d` with z = 0",
    ),
    (
        &[
            "Calendar",
            "GregorianCalendar",
            "LocalDate",
            "LocalTime",
            "LocalDateTime",
            "Instant",
            "Duration",
        ],
        "growth knows no clock, so that a run can be repeated: count the days in a variable",
    ),
    (
        &["Point3f", "Vector3f", "Tuple3f", "Color3f", "Point4d"],
        "write `Point3d`, `Vector3d` or `Tuple3d`; for a colour `RGBColor`",
    ),
    (
        &[
            "Matrix3f",
            "Matrix4f",
            "GMatrix",
            "AxisAngle4d",
            "Quat4d",
            "Math2",
            "VMAtrix",
        ],
        "write `Translate`, `Rotate` and `Scale` nodes, or turn with a `Matrix4d`",
    ),
    (
        &["Lognormal", "Normal", "Uniform", "Exponential", "Weibull"],
        "of `jsc.distributions` write `lognormal(mean, sd)`, `normal(mean, sd)` or `random(a, b)`",
    ),
    (
        &[
            "FluxLightModelTag",
            "Measurement",
            "ChannelSPD",
            "IrregularSpectralCurve",
            "ChromaticitySPD",
        ],
        "spectra are not computed: take the three bands of a `Spectrum3d`, such as `lm.getAbsorbedPower3d(node)`",
    ),
    (
        &[
            "SensorNodeGrid",
            "SensorAreaGrid",
            "SensorGrid",
            "AreaSensorNode",
        ],
        "place `SensorNode`s in a loop",
    ),
    (
        &["ColorGradient", "ColorMap"],
        "compute the colour yourself: `new RGBAShader(red, green, blue)`",
    ),
    (
        &[
            "Camera",
            "CameraBase",
            "CameraNode",
            "PerspectiveCamera",
            "ParallelCamera",
            "Projection",
            "PerspectiveProjection",
            "ParallelProjection",
        ],
        "the camera belongs to the picture: give `--eye`, `--target` and `--fov`, or `[camera]` in the file beside the model",
    ),
    (
        &["Line", "Arrow"],
        "draw a thin cylinder: `F(length, diameter)` or `Cylinder(length, radius)`",
    ),
    (
        &["Cube", "Ellipsoid", "Disc", "Lamella", "Patch", "Leaf3d"],
        "use `Box`, `Cylinder`, `Sphere` or `Parallelogram`, with `Scale` before it where it is stretched",
    ),
    (
        &["Fog", "Interior", "SolidInterior", "IORShader"],
        "media inside of bodies are not supported: leave it out",
    ),
    (
        &[
            "NURBSCurve",
            "HeightField",
            "CSGNode",
            "Supershape",
            "BSplineCurveImpl",
            "BSplineSurfaceImpl",
            "SwungSurface",
            "VertexSequence",
        ],
        "of curved shapes there are `NURBSSurface` with a `BezierSurface`, `BSplineGrid` or `ProfileSweep`, and `Sweep` for stems",
    ),
    (
        &["VertexGrid", "PointCloud"],
        "give a `PolygonMesh` arrays of `float` and `int`, or draw primitives",
    ),
    (
        &[
            "Laplace3D",
            "Granite3D",
            "Granite",
            "Gradient",
            "BumpMap",
            "ChannelBlend",
            "VolumeChecker",
            "FixedImageAdapter",
        ],
        "of patterns there are `ImageMap` (a picture from a file: `image(\"leaf.png\")`) and `Checker`",
    ),
    (
        &["SunSkyLight"],
        "the sky belongs to the picture: give `--sun` and `--turbidity`, or `[sky]` in the file beside the model",
    ),
    (
        &["Thread", "Runnable", "Timer", "ExecutorService", "Callable"],
        "models run in one thread: call the method directly",
    ),
    (
        &[
            "Socket",
            "ServerSocket",
            "URL",
            "HttpResponse",
            "InetAddress",
        ],
        "models cannot use the network: read a file instead",
    ),
    (
        &["Method", "Field", "Reflection", "Constructor"],
        "reflection is not supported: name the class, method or field in the text",
    ),
    (
        &["ObjectMapper", "JsonNode", "JSONObject", "JSONArray"],
        "Jackson and JSON are not supported: write lines with `PrintWriter`",
    ),
    (
        &[
            "NormalDistribution",
            "UnivariateFunction",
            "BrentSolver",
            "SplineInterpolator",
            "RealMatrix",
        ],
        "commons-math is not supported: write the computation as a method",
    ),
    (
        &["CommandLine", "Options", "DefaultParser"],
        "commons-cli is not supported: change the parameters in the model",
    ),
    (
        &["Test", "Assert", "TestCase"],
        "JUnit is not supported: compare the numbers and print them",
    ),
    (
        &[
            "Workbench",
            "JFrame",
            "JPanel",
            "Registry",
            "Item",
            "Transaction",
            "Command",
            "UI",
        ],
        "there is no workbench, registry or transaction here: leave it out",
    ),
    (
        &[
            "ODE",
            "Integrator",
            "AdaptiveStepsizeIntegrator",
            "Rate",
            "Monitor",
        ],
        "differential equations (`:'=`) are not supported: write one step of the integration yourself",
    ),
    (
        &["VVProducer", "VVGraph", "HalfEdge"],
        "meshes that are edited by their vertices are not supported: use `Parallelogram`, or a `Mesh(\"file.obj\")`",
    ),
    (
        &["SRoot", "TypeRoot", "TypeAxiom"],
        "models of several scales are not supported: write one module for each scale",
    ),
    (&["PriorityQueue"], "use `ArrayList` and `Collections.sort`"),
    (
        &[
            "InputStreamReader",
            "FileInputStream",
            "FileOutputStream",
            "ObjectOutputStream",
            "Files",
            "Paths",
            "Path",
        ],
        "read with `BufferedReader` and `FileReader`, write with `PrintWriter` and `FileWriter`",
    ),
];

/// Functions that are not supported, with what to do instead.
const FUNCTIONS: &[(&[&str], &str)] = &[
    (&["image", "reference"], "write `new RGBAShader(r, g, b)`"),
    (&["makeRendering"], "render with `understory render`"),
    (&["dataset", "data"], "write `new DatasetRef(\"name\")`"),
    (
        &["run", "graph", "view", "closeWorkbench", "startup"],
        "there is no workbench here; call the method directly",
    ),
    (
        &["import3d", "import3D"],
        "write a `Mesh(\"file.obj\")` node: `.obj`, `.glb` and `.gltf` files are read",
    ),
    (
        &["integrate", "solver", "setIntegrator"],
        "differential equations are not supported: write one step of the integration yourself",
    ),
    (
        &["povray", "renderPOV", "exportPOV"],
        "POV-Ray is not called: render with `understory render`",
    ),
    (
        &[
            "forName",
            "newInstance",
            "getDeclaredMethod",
            "getDeclaredField",
        ],
        "reflection is not supported: name the class, method or field in the text",
    ),
    (
        &["applyInterpretation"],
        "interpretive rules are not supported: give the module a body, `module A ==> F(1);`",
    ),
    (&["getHours", "execute"], "models cannot reach the machine"),
];

fn hint(table: &[(&[&'static str], &'static str)], name: &str) -> Option<&'static str> {
    table
        .iter()
        .find(|(names, _)| names.contains(&name))
        .map(|(_, hint)| *hint)
}

/// What to use instead of a type that is not supported.
pub(super) fn type_hint(name: &str) -> Option<&'static str> {
    hint(TYPES, name)
}

/// What to use instead of a function that is not supported.
pub(super) fn function_hint(name: &str) -> Option<&'static str> {
    hint(FUNCTIONS, name)
}

/// Functions that are accepted and do nothing that a user would expect of them: what they would do, and what does it here.
fn idle(id: FunctionId) -> Option<(&'static str, &'static str)> {
    match id {
        FunctionId::Snapshot | FunctionId::SnapshotSized => {
            Some(("makes no picture", "make pictures with `understory render`"))
        }
        FunctionId::Export3d => Some(("writes nothing", "a model cannot export its geometry")),
        FunctionId::SaveGraph => Some((
            "writes nothing",
            "`understory derive --json FILE` tells what a graph holds",
        )),
        _ => None,
    }
}

impl Checker<'_> {
    /// Warns of the call of a function that does nothing here.
    pub(super) fn warn_of_nothing(&mut self, id: FunctionId, span: Span) {
        if let Some((what, hint)) = idle(id) {
            let message = format!("`{}` {what}", id.signature().name);
            self.report(Diagnostic::warning("does-nothing", span, message).hint(hint));
        }
    }

    /// Classes inside methods.
    pub(super) fn refuse_class(&mut self, class: &ast::Class) {
        let keyword = class.keyword.name.as_str();
        let message = format!("a `{keyword}` inside a method is not supported");
        let fault = Diagnostic::error("unsupported-class", class.name.span, message);
        self.report(fault.hint("declare it outside of the method"));
        self.refused.insert(class.name.name.clone());
    }

    /// A module inside a module.
    pub(super) fn refuse_nested_module(&mut self, module: &ast::Module) {
        let fault = Diagnostic::error(
            "nested-module",
            module.name.span,
            "a module cannot stand inside another one",
        );
        self.report(fault.hint("declare it beside the other"));
        self.refused.insert(module.name.name.clone());
    }

    /// `operator$add`: an operator that would get a new meaning.
    pub(super) fn refuse_operator(&mut self, method: &ast::Method) {
        let name = &method.name.name;
        let message =
            format!("operators with a meaning of the model's own (`{name}`) are not supported");
        let fault = Diagnostic::error("unsupported-operator", method.name.span, message);
        self.report(fault.hint("write a method with a name and call it"));
    }

    /// A method without a result type that is no constructor.
    pub(super) fn refuse_constructor(&mut self, method: &ast::Method) {
        let name = &method.name.name;
        let message = format!("method `{name}` has no result type");
        let hint = format!("write `void {name}(…)` if it gives no value");
        self.report(Diagnostic::error("no-result-type", method.name.span, message).hint(hint));
        self.refused.insert(name.clone());
    }
}
