//! The list of cases: what must hold, and where what a process cannot measure of itself is tested.

/// What a case is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Group {
    /// Form factors, radiosity.
    Exchange,
    /// Scale, position, degenerate geometry.
    Geometry,
    /// Photons.
    Photons,
    /// Path tracing, optics.
    Optics,
    /// Arithmetic, random numbers, concurrency.
    Arithmetic,
    /// Light in canopies.
    Canopies,
}

impl Group {
    /// For people.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exchange => "Form factors and radiosity",
            Self::Geometry => "Scale, position, degenerate geometry",
            Self::Photons => "Photons",
            Self::Optics => "Path tracing and optics",
            Self::Arithmetic => "Arithmetic, random numbers, concurrency",
            Self::Canopies => "Light in canopies",
        }
    }
}

/// A line of the list.
pub(super) struct Line {
    /// Its number, such as `17` or `20b`.
    pub(super) case: &'static str,
    /// What it is about.
    pub(super) group: Group,
    /// What must hold.
    pub(super) what: &'static str,
    /// What of it no check here measures, and the test that does; empty if all is measured.
    pub(super) elsewhere: &'static str,
}

const fn line(case: &'static str, group: Group, what: &'static str) -> Line {
    Line {
        case,
        group,
        what,
        elsewhere: "",
    }
}

const fn partly(
    case: &'static str,
    group: Group,
    what: &'static str,
    elsewhere: &'static str,
) -> Line {
    Line {
        case,
        group,
        what,
        elsewhere,
    }
}

use Group::{Arithmetic, Canopies, Exchange, Geometry, Optics, Photons};

/// All cases in their order.
pub(super) const LINES: [Line; 74] = [
    line(
        "1",
        Exchange,
        "parallel rectangles have their form factor, near and far",
    ),
    line(
        "2",
        Exchange,
        "perpendicular rectangles with a common edge have their form factor",
    ),
    line("3", Exchange, "coaxial disks have their form factor"),
    line(
        "4",
        Exchange,
        "a ball gives a disk on its axis its form factor",
    ),
    line(
        "5",
        Exchange,
        "a small area has the form factor to what is parallel or perpendicular to it",
    ),
    line(
        "6",
        Exchange,
        "a small area has the form factor (r/d)² cos θ to a ball",
    ),
    line(
        "7",
        Exchange,
        "concentric spheres: all from within, (r₁/r₂)² from without",
    ),
    line(
        "8",
        Exchange,
        "on the inside of a ball every patch gives every other A/4πR²",
    ),
    line(
        "9",
        Exchange,
        "a hemisphere over its base: all of the base's light, half of its own",
    ),
    line("10", Exchange, "the factors of a cube add up to 1"),
    line(
        "11",
        Exchange,
        "infinite strips have the form factor of crossed strings",
    ),
    line("12", Exchange, "exchange is the same both ways"),
    line(
        "13",
        Exchange,
        "all that leaves a patch of a closed room arrives somewhere",
    ),
    line(
        "14",
        Exchange,
        "hemicubes of 1, 2, an odd number of and 1024 pixels are whole",
    ),
    line(
        "15",
        Exchange,
        "a flat wall does not see itself, edges and corners shared or not",
    ),
    line(
        "16",
        Exchange,
        "two plates, a thousandth of their width apart, light each other as endless ones",
    ),
    line(
        "17",
        Exchange,
        "in a closed room that shines evenly there is E/(1 - ρ), up to ρ 0.999",
    ),
    line(
        "18",
        Exchange,
        "a closed room of albedo 1 ends, says that there is no solution, and holds no NaN",
    ),
    line(
        "19",
        Exchange,
        "albedo 0: what is sent is what shines, at once",
    ),
    line(
        "20",
        Exchange,
        "subdivision: depth 0 is the mesh itself, threshold 0 and depth 30 end at the memory",
    ),
    line(
        "20b",
        Exchange,
        "gathering, shooting and stochastic shooting find the same light",
    ),
    partly(
        "20c",
        Exchange,
        "a room with four lamps: radiosity against the path tracer",
        "the study's own scene, picture by picture: `tests/radiosity.rs`",
    ),
    line(
        "21",
        Geometry,
        "a picture does not depend on the unit of length, 2^-20 to 2^20 and 10^-6 to 10^6",
    ),
    line(
        "22",
        Geometry,
        "a picture does not depend on the place, up to 10^7 m from the origin",
    ),
    line(
        "23",
        Geometry,
        "no ray leaves a closed mesh, whatever its size, wherever it is",
    ),
    line(
        "24",
        Geometry,
        "no ray finds the surface that it starts on, grazing or not, at any scale",
    ),
    line(
        "25",
        Geometry,
        "thin layers 10^-5 to 10^-7 m apart are seen in order",
    ),
    line(
        "26",
        Geometry,
        "triangles without area, needles and duplicates do no harm",
    ),
    line(
        "27",
        Geometry,
        "NaN, infinite and huge coordinates are refused and named",
    ),
    line(
        "28",
        Geometry,
        "grazing and axis-parallel rays, signed zeros: all finite",
    ),
    line(
        "29",
        Geometry,
        "of what coincides, the lowest number is seen",
    ),
    line(
        "30",
        Geometry,
        "instances of any scale, stretched or mirrored show the right side; singular ones are refused",
    ),
    line(
        "31",
        Photons,
        "the mean light does not depend on the photon area, ×1/4 to ×16",
    ),
    line(
        "32",
        Photons,
        "even light is found with the noise of its photons",
    ),
    line(
        "33",
        Photons,
        "a gradient costs nothing, curvature its share of the square of the radius",
    ),
    line("34", Photons, "kernels of no size and of all size: finite"),
    line("35", Photons, "edges and corners neither leak nor darken"),
    line(
        "36",
        Photons,
        "a leaf smaller than the kernel has exactly its own light",
    ),
    line("37", Photons, "no photon, one photon, one stored photon"),
    line(
        "38",
        Photons,
        "100,000 coincident or coplanar photons are all found",
    ),
    line(
        "39",
        Photons,
        "10^8 photons: refused before they are sent if they will not fit, otherwise made",
    ),
    line(
        "40",
        Photons,
        "aiming photons keeps the mean and lowers the noise",
    ),
    partly(
        "41",
        Photons,
        "the squared error of progressive passes falls with their number to the power of -2/3",
        "photons of a scene, in the memory of one pass: `tests/progressive.rs`",
    ),
    line("42", Photons, "photons of the other side do not count"),
    line(
        "43",
        Photons,
        "emitted = absorbed + escaped + lost, to the last quantum",
    ),
    line(
        "44",
        Photons,
        "a lamp in a closed box: outside exactly nothing, inside all of it",
    ),
    line(
        "45",
        Photons,
        "a lamp 10^12 times weaker than another lights its own room",
    ),
    line(
        "46",
        Optics,
        "white furnace: what absorbs nothing vanishes in an even surrounding",
    ),
    partly(
        "47",
        Optics,
        "scattering is the same both ways, its density integrates to 1, sampling follows it",
        "χ² of samples against densities, all lobes: `tests/optics.rs`, `tests/sampling.rs`",
    ),
    line("48", Optics, "a refractive index of 1 is no object"),
    line(
        "49",
        Optics,
        "a refractive index below 1: total reflection exactly beyond the critical angle",
    ),
    line(
        "50",
        Optics,
        "Fresnel: Brewster's angle, normal incidence, sheets of glass",
    ),
    line(
        "51",
        Optics,
        "integrating sphere: Φ ρ/(π A (1 - ρ)), up to ρ 0.999",
    ),
    line(
        "52",
        Optics,
        "lamps with and without extent give the irradiance that they should; distance 0 too",
    ),
    line(
        "53",
        Optics,
        "the camera inside a body, glass, a lamp; the terminator of smoothed bodies",
    ),
    line(
        "54",
        Optics,
        "empty scenes, only lamps, no lamps: black or the sky, after a query or two",
    ),
    line("55", Optics, "all ways of finding light have the same mean"),
    line(
        "56",
        Optics,
        "roulette, early, late and never, has the same mean",
    ),
    line(
        "57",
        Arithmetic,
        "the mean of 10^9 samples of a pixel is right to 10^-7",
    ),
    line(
        "58",
        Arithmetic,
        "2^20 neighbouring counters: no equal numbers, no correlation, even bytes",
    ),
    line(
        "59",
        Arithmetic,
        "the same bytes on 1, 2, 3, 7 and 16 threads",
    ),
    partly(
        "60",
        Arithmetic,
        "what is left out because a scene does not require it changes nothing when it is forced on",
        "one switch after the other, by every renderer: `tests/requirements.rs`, `tests/guiding.rs`",
    ),
    partly(
        "61",
        Arithmetic,
        "light that was written, read and looked at is the light that was not",
        "through files and the program: `tests/photon_solution.rs`, `tests/radiosity_solution.rs`",
    ),
    line(
        "62",
        Arithmetic,
        "radiances of 10^30 and 10^-30 survive; what is not finite is left out and counted",
    ),
    line(
        "63",
        Arithmetic,
        "choosing in proportion: one weight, weight 0, weights 60 decades apart, NaN",
    ),
    partly(
        "64",
        Arithmetic,
        "stopped at any block and resumed is the same as not stopped",
        "flights that are stopped and go on, frame by frame: `tests/fly.rs`",
    ),
    partly(
        "65",
        Arithmetic,
        "what does not fit into the memory is refused before it is asked for",
        "resident memory of the program under `--max-memory`: `tests/cli.rs`, `tests/progressive.rs`",
    ),
    line(
        "66",
        Canopies,
        "level black leaves at random let exp(-L) pass, whatever the sun's height",
    ),
    line(
        "67",
        Canopies,
        "black leaves of all directions let exp(-L/(2 sin β)) pass",
    ),
    line(
        "68",
        Canopies,
        "a canopy that absorbs nothing keeps nothing",
    ),
    line(
        "69",
        Canopies,
        "photons forward, rays backward and radiosity find the same on each organ",
    ),
    line(
        "70",
        Canopies,
        "each sky has the irradiance that it states; the sun below the horizon gives none",
    ),
    line(
        "71",
        Canopies,
        "the halves of a leaf absorb what the whole absorbs",
    ),
    line(
        "72",
        Canopies,
        "a scene that is turned and moved with its lights absorbs the same",
    ),
];
