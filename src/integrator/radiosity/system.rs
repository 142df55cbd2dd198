//! The equations: what patches get from each other, and what they send back.
//!
//! Each patch has two sides, and what falls on one may leave by the other. With H the irradiance of a side and R what it sends out,
//! W/m² per channel: R⁺ = ρ⁺H⁺ + τ⁻H⁻, R⁻ = ρ⁻H⁻ + τ⁺H⁺, H = S + Σ F R, where S comes from light sources. Form factors F are
//! the same for all channels, unless there are coloured mirrors or panes on the way.
//! Source: [`CohenWallace1993`](crate::references#cohenwallace1993).

use crate::color::Rgb;

/// A side of a patch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct PatchSide {
    /// ρ of light that falls on this side.
    pub(super) reflectance: Rgb,
    /// τ of light that falls on this side.
    pub(super) transmittance: Rgb,
    /// Irradiance from light sources, W/m².
    pub(super) source: Rgb,
    /// The part of it that views do not ask for at the point they see.
    pub(super) stray: Stray,
    /// Whether it is known that no light ever falls on it.
    pub(super) is_dark: bool,
}

/// Light from sources on ways on which they are not asked, W/m² on a surface or W/(m² sr) along a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Stray {
    /// All of it.
    pub(super) all: Rgb,
    /// What mirrors and glass throw: rays of views that gather leave that out, for they would find a few bright points.
    pub(super) focused: Rgb,
}

impl Stray {
    /// Adds some of it.
    pub(super) fn add(&mut self, light: Rgb, is_focused: bool) {
        self.all += light;
        if is_focused {
            self.focused += light;
        }
    }
}

impl PatchSide {
    /// Whether it does anything with light that falls on it, and any may.
    pub(super) fn is_needed(&self) -> bool {
        self.scatters() && !self.is_dark
    }

    /// Whether it does anything with light.
    pub(super) fn scatters(&self) -> bool {
        !(self.reflectance.is_black() && self.transmittance.is_black())
    }
}

/// A patch: its front and back.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Patch {
    /// m².
    pub(super) area: f64,
    /// The area that it counts with where solvers decide what is worth their while, m²: cells of an endless plane are huge, and all
    /// else would be lost in their light.
    pub(super) weight: f64,
    pub(super) sides: [PatchSide; 2],
}

/// Form factors from one side of a cell to sides of patches, `2 · patch + side` (0 front), each at most once.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Row {
    /// The same for all channels.
    pub(super) plain: Vec<(u32, f32)>,
    /// Through coloured mirrors or panes.
    pub(super) tinted: Vec<(u32, [f32; 3])>,
}

impl Row {
    /// The sum of what these pairs say, sorted.
    pub(super) fn of(mut found: Vec<(u32, Rgb)>) -> Self {
        found.sort_by_key(|(side, _)| *side);
        let mut row = Self::default();
        for same in found.chunk_by(|a, b| a.0 == b.0) {
            let sum: Rgb = same.iter().map(|(_, weight)| *weight).sum();
            if sum.r == sum.g && sum.g == sum.b {
                row.plain.push((same[0].0, sum.g as f32));
            } else {
                row.tinted
                    .push((same[0].0, sum.to_array().map(|c| c as f32)));
            }
        }
        row.plain.shrink_to_fit();
        row
    }

    /// All factors.
    pub(super) fn entries(&self) -> impl Iterator<Item = (usize, Rgb)> {
        let plain = self.plain.iter();
        let plain = plain.map(|(side, f)| (*side as usize, Rgb::splat(f64::from(*f))));
        let tinted = self.tinted.iter();
        let tinted = tinted.map(|(side, f)| (*side as usize, Rgb::from_array(f.map(f64::from))));
        plain.chain(tinted)
    }

    /// Memory that it takes.
    pub(super) fn bytes(&self) -> u64 {
        (size_of::<Self>() + size_of_val(&*self.plain) + size_of_val(&*self.tinted)) as u64
    }

    /// Σ F R.
    pub(super) fn gather(&self, radiosity: &[Rgb]) -> Rgb {
        let mut sum = Rgb::BLACK;
        for (side, factor) in &self.plain {
            sum += radiosity[*side as usize] * f64::from(*factor);
        }
        for (side, factor) in &self.tinted {
            sum += radiosity[*side as usize] * Rgb::from_array(factor.map(f64::from));
        }
        sum
    }
}

/// Where form factors come from.
pub(super) trait FormFactors: Sync {
    /// The row of side `side` (0 front) of a node of the mesh. A pure function of both.
    fn row(&self, node: u32, side: usize) -> Row;
}

/// What came of solving.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Solved {
    /// Irradiance of each side of each patch from other patches, W/m².
    pub(super) irradiance: Vec<Rgb>,
    /// What each side sends out, W/m².
    pub(super) radiosity: Vec<Rgb>,
    /// Light that is still unaccounted for, as a part of all.
    pub(super) residual: f64,
    /// Whether the residual is as small as it was to be.
    pub(super) is_converged: bool,
}

/// What the side `2·patch + side` sends out under these irradiances.
pub(super) fn sent(patches: &[Patch], side: usize, irradiance: impl Fn(usize) -> Rgb) -> Rgb {
    let patch = &patches[side / 2];
    let (own, other) = (side % 2, 1 - side % 2);
    patch.sides[own].reflectance * irradiance(side)
        + patch.sides[other].transmittance * irradiance(side ^ 1)
}

/// What all sides send out when light from sources has fallen on them.
pub(super) fn first_sent(patches: &[Patch]) -> Vec<Rgb> {
    let source = |side: usize| patches[side / 2].sides[side % 2].source;
    (0..2 * patches.len())
        .map(|side| sent(patches, side, source))
        .collect()
}

/// Σ of weight times what is sent, over channels: power, but for endless planes.
pub(super) fn power(patches: &[Patch], sent: &[Rgb]) -> f64 {
    let each = sent.iter().enumerate();
    each.map(|(side, sent)| patches[side / 2].weight * sent.sum())
        .sum()
}

/// The largest part of light that any patch sends back, in any channel, 0..=1.
pub(super) fn whitest(patches: &[Patch]) -> f64 {
    let sides = patches.iter().flat_map(|patch| &patch.sides);
    sides
        .map(|side| (side.reflectance + side.transmittance).max_channel())
        .fold(0.0, f64::max)
        .min(1.0)
}
