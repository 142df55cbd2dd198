//! Every numeric tolerance of the program, each with what it bounds and what breaks if it were another.

/// The sine of the angle below which two directions count as parallel.
///
/// A cross product of unit vectors has rounding errors near 1e-16; at this sine its direction is still right to about
/// eight digits. Ten times larger would refuse cameras that look almost straight down and are well defined; ten times
/// smaller would give their horizon fewer digits. Used by [`crate::camera`] and [`crate::turtle`].
pub const PARALLEL_SINE: f64 = 1e-8;

/// How far a number that is exact on paper may be off by rounding in a check of the light transport, relative.
///
/// A ray, a hit, a shading and a product are some dozen roundings of 2⁻⁵³, a shadow ray starts about 1e-12 beside its surface.
/// Ten times larger would still see every fault of a formula; a thousand times smaller would refuse right ones. Used by
/// [`crate::validation`].
pub const CLOSED_FORM: f64 = 1e-9;

/// The same where the number on paper is printed with eight decimals.
///
/// Half a unit of the last is 2e-8 of the smallest such number. Used by [`crate::validation`].
pub const PRINTED_DIGITS: f64 = 1e-7;

/// By how much cones of directions are taken wider than they are, in radians and as a cosine.
///
/// A lamp must not count as turned away, and so never be chosen, by the rounding of a sum of angles. Ten times larger would
/// still be invisible; smaller than a few roundings of 2⁻⁵³ under a square root (1e-8) only what gives next to nothing is lost.
/// Used by [`crate::light`].
pub const CONE_SLACK: f64 = 1e-8;

/// The angle, in radians, below which a tropism does not turn the turtle: GroIMP's own limit.
///
/// The axis of the turn is a cross product that vanishes with the angle. Ten times larger would change no model that can
/// be told apart; ten times smaller would turn about axes that are rounding errors. Used by [`crate::turtle`].
pub const TROPISM_ANGLE: f64 = 1e-10;

/// How far reflectance + transmittance may exceed 1 before a material counts as making light. Dimensionless.
///
/// A model's colours are `f32`, so a sum that is 1 on paper carries up to two roundings of 2⁻²⁴. Used by
/// `material`. Ten times larger would let 0.01 ‰ of extra light through per bounce; ten times smaller refuses 0.7 + 0.3.
pub const ENERGY_EXCESS: f64 = 2.0 * f32::EPSILON as f64;

/// What a pixel's squared luminance is raised by before an error is divided by it, as a share of the picture's mean
/// luminance squared. Dimensionless.
///
/// Pixels darker than a tenth of the mean are judged by absolute, not relative, error. Ten times larger would hide
/// the grain of shadows; ten times smaller would let a few nearly black pixels decide. Used by [`crate::film`].
pub const DARK_PIXEL_FLOOR: f64 = 0.01;

/// How far the length of a given unit vector may be from 1.
///
/// A direction that went through a model's `f32` vectors and a product of matrices carries about ten roundings of
/// 2⁻²⁴. Ten times larger would let a vector pass that nobody normalised; ten times smaller would refuse turned lamps.
/// Used by [`crate::light`].
pub const UNIT_LENGTH: f64 = 1e-6;

/// Bound on the relative error of `n` chained roundings in `f64`: n·u / (1 - n·u) with u = 2⁻⁵³.
///
/// Source: [Higham2002, lemma 3.1](crate::references#higham2002). Used by the scene for the error that a surface point carries.
#[must_use]
pub const fn gamma(n: u32) -> f64 {
    let nu = n as f64 * (f64::EPSILON / 2.0);
    nu / (1.0 - nu)
}

/// Relative widening of the far end of a box interval in `f32`: 1 + 2γ₃ with γ₃ the bound of three roundings.
///
/// Source: [Ize2013](crate::references#ize2013). Used by [`crate::accel`]. Smaller lets rays slip between touching boxes; ten times larger only
/// opens a few boxes in vain.
pub const BOX_SLACK: f32 = 1.0 + 6.0 * f32::EPSILON;

/// By how much stored boxes are widened on every side, in the normalised units of a group (its diagonal is
/// 2¹²..2¹³): eight units in the last place of the largest coordinate.
///
/// A ray enters a group at a point rounded to `f32` (half a unit) and with a direction that drifts by at most two units
/// across the group; the rest is reserve. Half of it would still be enough; four times less leaks. Used by
/// [`crate::scene`].
pub const BOX_PADDING: f32 = 1.0 / 512.0;

/// How far beside a triangle or parallelogram a ray may pass, in the normalised units of a group, and still count as a candidate
/// for the exact test, per length of its two edges.
///
/// Coordinates up to 2¹² are stored with an error of 2⁻¹³ and the point of the ray beside them with one of 2⁻¹²; shearing doubles
/// both, which times the edges makes at most 2⁻⁹. Four times less loses hits; ten times larger only lets the exact test refuse
/// more. Used by [`crate::accel`].
pub const FLAT_MARGIN: f32 = 1.0 / 256.0;

/// The same per unit of distance from the point of the ray that coordinates are counted from, and of length of the edges.
///
/// The roundings of about forty operations on them, 2⁻²⁴ each, make 2⁻¹⁸·⁶; the rest is reserve. Ten times larger would double the
/// candidates among triangles of a hundred units. Used by [`crate::accel`].
pub const FLAT_DRIFT: f32 = 1.0 / 131_072.0;

/// What the coordinates of a hit, times the area, must exceed at least before it counts as certain.
///
/// Triangles so tiny that `f32` cannot hold their areas are left to the exact test. Ten times larger or smaller is the same.
/// Used by [`crate::accel`].
pub const FLAT_FLOOR: f32 = 1e-24;

/// How much later or earlier than the limits a ray may meet the plane of a triangle or parallelogram and still count as a candidate,
/// in normalised units: roundings of corner, start and limits, each at most 2⁻¹¹ and together below 2⁻⁷. Ten times larger
/// costs nothing that could be measured. Used by [`crate::accel`].
pub const FLAT_DEPTH_MARGIN: f32 = 1.0 / 64.0;

/// By how much the side and the caps of a frustum overlap at the rim, in radii and lengths.
///
/// A ray through the rim sees the side end and the cap begin with different roundings; without an overlap it could slip
/// between. Ten times smaller would leave slits, ten times larger is still invisible.
pub const RIM_OVERLAP: f64 = 32.0 * f64::EPSILON;

/// How many times the carried error bound a ray starts off its surface, along the geometric normal.
///
/// Measured: ×1 gives 60 false self-hits in 400 000 bounces, ×4 none once the flat primitive of origin is excluded too.
/// Used by [`crate::scene`].
pub const SPAWN_SAFETY: f64 = 4.0;

/// The part of its length by which a ray to a point of a surface stops short of it, so that it does not hit what it aims at.
///
/// Far above the rounding of a ray (1e-15) and far below any gap of a plant: at 100 m it is a nanometre. Used by
/// [`crate::scene`].
pub const SHADOW_GAP: f64 = 1e-11;

/// The largest coordinate of a scene, in metres. What lies beyond is a mistake of the model and is refused.
///
/// Squares and cubes of it stay finite in `f64` with room for the scaling of nested groups.
pub const MAX_COORDINATE: f64 = 1e15;

/// The smallest extent, in metres, that a group is normalised by; smaller groups stay smaller than the others inside.
///
/// It keeps powers of two and their inverses far from overflow. A millionth of an atom's nucleus.
pub const MIN_EXTENT: f64 = 1e-21;

/// The smallest |det| of a transform relative to the product of the lengths of its columns.
///
/// Below it the columns lie in a plane up to rounding and the inverse has no correct digits. Used by [`crate::scene`].
pub const SINGULAR_DETERMINANT: f64 = 1e-12;

/// How far, relative to the scale, a matrix may be from a scaled rotation and still be stored as one.
///
/// Turning, scaling and inverting leaves about ten roundings of 2⁻⁵³. Ten times larger would move a tree of 20 m by less
/// than a millionth of a millimetre; ten times smaller would keep many similarities whole, at twice the memory. Used by
/// [`crate::scene`].
pub const SIMILARITY: f64 = 16.0 * f64::EPSILON;

/// How far, relative to its coordinates, a point of a surface keeps from the edges of its face.
///
/// Rays start off a face by up to about 64 units of rounding (see [`SPAWN_SAFETY`]); a start nearer to an edge than that may
/// lie behind the neighbouring face. Measured: without it, 2 million bounces that graze the walls escape once through the
/// rim of a frustum. Ten times larger is still invisible (a nanometre at 10 km); ten times smaller lets rays out again.
pub const EDGE_MARGIN: f64 = 256.0 * f64::EPSILON;

/// The largest part of a face that [`EDGE_MARGIN`] may become for faces that are tiny for where they are.
pub const EDGE_MARGIN_LIMIT: f64 = 1e-3;

/// Boxes that reach no further than this part of the scene's size beyond what was found are not opened when it is framed.
///
/// Nobody sees a hundred-thousandth of a picture's height; without it, the search for the furthest point would open every one of
/// many things that reach equally far. Used by [`crate::scene`].
pub const FRAMING_SLACK: f64 = 1e-5;

/// The α (squared perceived roughness) of facets below which a surface counts as smooth.
///
/// Mirror images are then blurred by less than a third of a minute of arc, which no eye sees. Ten times larger would show in
/// far reflections; ten times smaller is still computed well, but light sampling finds such reflections no more. Used by
/// [`crate::material`].
pub const SMOOTHEST_ALPHA: f64 = 1e-4;

/// Below this solid angle, in steradian, a rectangular lamp is sampled by area.
///
/// Its solid angle is a difference of angles near 2π, known to about 1e-15: to 1e-12 of itself here. Distance and slant hardly
/// vary over so small a lamp. Used by [`crate::scene`].
pub const LEAST_SOLID_ANGLE: f64 = 1e-3;

/// How near to 1 the sine of half the angle that a ball subtends may come before it is sampled by area.
///
/// Nearer, the point is within 1e-9 radii of the ball, and rounding may bring the edge of the cone past the horizon. Used by
/// [`crate::scene`].
pub const BALL_HORIZON: f64 = 1e-9;

/// How near, relative to its size, two ends of a curve or surface are that count as one: a closed seam, a pole.
///
/// Far above the rounding of an evaluation (a few units of 2⁻⁵³ times the degree) and far below any gap that was meant. Used
/// by [`crate::geometry::curved`].
pub const SEAM: f64 = 1e-9;

/// How far beside a place without a normal (a pole, a corner) of a curved surface its normal is taken, relative to its range.
///
/// The normal turns by less than that share of the surface's own turn; a hundred times smaller, at a pole, its digits would
/// drown in rounding. Used by [`crate::geometry::curved`].
pub const BESIDE: f64 = 1e-6;

/// 1 - cosine of the smallest angle between two tangents that counts as a crease: half a degree.
///
/// Less is not seen as one; much less and rounding would crease smooth seams. Used by [`crate::geometry::curved`].
pub const CREASE: f64 = 4e-5;

/// Radius of the smallest kernel of photon mapping, as a share of the scene's diagonal.
///
/// Positions of photons are stored with 24 bits, an error of 10⁻⁷ of the scene; the kernel tells photons on its plane from others
/// to a tenth of its radius. Ten times smaller would begin to lose photons of the plane itself; ten times larger would blur
/// what 10⁸ photons show. Used by [`crate::integrator::photon_map`].
pub const SMALLEST_KERNEL: f64 = 1e-5;

/// Radius of the largest kernel that is chosen automatically, as a share of the scene's diagonal.
///
/// A kernel that is larger would show no shape of indirect light at all; with fewer photons than it needs the picture is noisy
/// instead. Mitsuba's default too. Used by [`crate::integrator::photon_map`].
pub const LARGEST_KERNEL: f64 = 0.05;

/// By how much boxes that photons are aimed at are widened, as a share of their distance from the origin and of their size.
///
/// Their corners went through a few roundings in `f64`, 10⁻¹⁵ each. Ten times larger or smaller would change nothing that can be
/// measured; ten million times smaller would let photons miss the rim of what they are aimed at. Used by
/// [`crate::integrator::photon`].
pub const TARGET_SLACK: f64 = 1e-9;

/// Photons are not sent to rings of an endless plane that may throw back less towards the scene than this part of the light that
/// the scene gets itself.
pub const RING_SHARE: f64 = 1e-3;

/// How near corners of neighbouring elements are to each other, as a share of the size of the scene.
///
/// The same corner, reached from two faces through their frames, differs by a few roundings in `f64`; different corners are apart by
/// more than a millionth unless elements are that small, whose light may be shared. Used by [`crate::integrator::radiosity`].
pub const WELD: f64 = 1e-9;

/// How far a corner of one face may lie behind the plane of another that still sees all of it, as a share of its size.
///
/// A few roundings in `f64` of frames that both went through; a million times larger would take the form factor of what is partly
/// below the horizon for one of what is above it. Used by [`crate::integrator::radiosity`].
pub const FACING_SLACK: f64 = 1e-9;

/// How far from the middle of a hemicube geometry is drawn from, as a share of the width of its face, unless `--hemicube-size` says.
///
/// What is nearer covers what lies behind it all the same if it is larger than that, and only crossing faces have anything as near.
/// Used by [`crate::integrator::radiosity`].
pub const HEMICUBE_NEAR: f64 = 1e-4;

/// How high above the plane of a face, in parts of the distance, something must be for its hemicube to show it.
///
/// Neighbours in the same plane differ by a few roundings in `f64`; what is that low sends 10⁻¹⁸ of its light. Used by
/// [`crate::integrator::radiosity`].
pub const HEMICUBE_HORIZON: f64 = 1e-9;

/// How far above a surface the eye is that looks straight down on it for its colour, as a share of the size of the scene.
///
/// Larger than the steps that keep rays off the surface they leave, smaller than what is drawn apart from it. Used by
/// [`crate::integrator::radiosity`].
pub const ABOVE_SURFACE: f64 = 1e-6;

/// What rounding may move cells of a grid by against the point that is searched round, as a share of them.
///
/// Places are known to `f64`, so only grids of more than 10⁶ cells along an axis come near it; those that cannot tell cells apart search
/// all. Used by [`crate::integrator::grid`].
pub const CELL_SLACK: f64 = 1e-9;

/// How far beyond a polygon, in pixels, the middle of a pixel of a hemicube may lie that still shows it.
///
/// Corners are projected with errors of some 10⁻¹³ pixels; the middle of a pixel on the edge between two walls must not miss both. What
/// it shows then is right to that part of a pixel. Used by [`crate::integrator::radiosity`].
pub const PIXEL_SLACK: f64 = 1e-9;

/// Relative squared noise at which the reference of `trade` is good enough: a thousandth of what the best settings reach.
pub const REFERENCE_NOISE: f64 = 1e-6;

/// Floors that a fit of errors over work tries, as parts of the least error: less is as good as none, and at the least error itself
/// nothing could still fall.
pub const FIT_FLOORS: [f64; 2] = [1e-3, 0.999];

/// The step of the logarithm of a fitted price at which it is found.
pub const FIT_STEP: f64 = 1e-12;

/// How different a picture may be whose world is measured in another unit, as a relative mean squared error.
///
/// Rays that pass an edge on the other side by rounding change single pixels of few samples. Ten times larger and a light that grows
/// with the unit in one corner would pass; ten times smaller and one pixel in a hundred thousand may not flip. Used by
/// [`crate::validation::extremes`].
pub const SAME_PICTURE_IN_OTHER_UNITS: f64 = 1e-5;

/// The same for a picture whose world lies elsewhere, up to 10⁷ m: there coordinates have nine digits left behind the point.
///
/// Ten times larger would hide that single edges move; ten times smaller would refuse right pictures. Used by
/// [`crate::validation::extremes`].
pub const SAME_PICTURE_ELSEWHERE: f64 = 1e-6;

/// How much the light of a leaf that is smaller than two kernels may differ between them, relative.
///
/// All its photons are summed in the same order by both; powers are kept with 24 bits. Ten times smaller would be met too; a thousand
/// times larger would hide that the kernel cuts some off. Used by [`crate::validation::extremes`].
pub const BINNED_LIGHT: f64 = 1e-6;

/// How far form factors that are known on paper may be off, relative, once they were kept as `f32`.
///
/// Two roundings of 2⁻²⁴ and a sum of a few. Ten times larger would hide a wrong digit of the quadrature; ten times smaller refuses right
/// ones. Used by [`crate::validation::extremes`].
pub const SEVEN_DIGITS: f64 = 3e-7;

/// The same for numbers printed with nine decimals and kept as `f32`, absolute.
pub const SIX_DIGITS: f64 = 1e-6;

/// How much of what leaves a patch of a closed room may not arrive anywhere: roundings of some hundred factors that are kept as `f32`.
///
/// Ten times larger and a crack between two walls of a thousandth of a pixel would pass. Used by [`crate::validation::extremes`].
pub const WHOLE_ROWS: f64 = 1e-5;

/// How far the power of photons that are aimed at boxes may be off, relative: the boxes are a little wider than what is in them.
///
/// Ten times larger would still be far below the noise of any number of photons. Used by [`crate::validation::extremes`].
pub const AIMED_BOXES: f64 = 1e-7;

/// How far the mean of up to 10⁹ samples of a pixel may be off, relative.
///
/// Sums in `f64` are off by less than a millionth of it; sums in `f32` by 2 %, after 10⁷ samples by as much as they round. A thousand times
/// larger would pass a compensated `f32`. Used by [`crate::validation::extremes`].
pub const LONG_SUM: f64 = 1e-7;

/// How far probabilities, shares and reflectances that are known on paper may be off: some roundings of 2⁻⁵³.
///
/// Ten times smaller would be met by most; a thousand times larger would hide a probability that is not handed out. Used by
/// [`crate::validation::extremes`].
pub const EXACT_SHARES: f64 = 1e-12;

/// How far from 1 the reflectance may be so little before the critical angle: it rises with the square root of the angle.
///
/// Used by [`crate::validation::extremes`].
pub const STEEP_FRESNEL: f64 = 1e-4;

/// How much a picture may change that is so many times brighter and then divided by that, relative.
///
/// Photons keep their power as `f32` of the mean, patches form factors; both round alike for powers of two. Ten times larger would hide a
/// threshold in watts. Used by [`crate::validation::extremes`].
pub const ANY_STRENGTH: f64 = 1e-6;
