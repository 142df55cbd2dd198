//! What renderers can leave out.

use std::fmt;
use std::str::FromStr;

/// Something that a renderer does for scenes that require it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Feature {
    /// Light that surfaces throw on each other.
    Bounces,
    /// Photons of their own for caustics.
    Caustics,
    /// Photons that miss everything they are wanted for.
    UnaimedPhotons,
    /// Learning where light comes from before paths are traced.
    Guide,
    /// Choosing among lights.
    LightChoice,
    /// Weighing light that rays happen to meet against light that was asked for.
    LightHits,
    /// Remembering which clear bodies a ray is in.
    Bodies,
    /// Shadow rays that look at each surface in order.
    ClearShadows,
    /// Light that reaches surfaces on ways on which no source is asked for it.
    UnaskedLight,
    /// The inner sides of closed bodies.
    Insides,
    /// Texture coordinates.
    Coordinates,
    /// Groups of shapes that an instance of saves nothing.
    Groups,
}

/// What is promised of a picture when a feature is kept that its scene does not require.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Promise {
    /// The same bits.
    SameBits,
    /// The same but for rounding.
    SameRounded,
    /// The same mean, other noise.
    SameMean,
}

impl Feature {
    /// All of them, in the order in which they are explained.
    pub const ALL: [Self; 12] = [
        Self::Bounces,
        Self::Caustics,
        Self::UnaimedPhotons,
        Self::Guide,
        Self::LightChoice,
        Self::LightHits,
        Self::Bodies,
        Self::ClearShadows,
        Self::UnaskedLight,
        Self::Insides,
        Self::Coordinates,
        Self::Groups,
    ];

    /// Its name, as it is written.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bounces => "bounces",
            Self::Caustics => "caustics",
            Self::UnaimedPhotons => "unaimed-photons",
            Self::Guide => "guide",
            Self::LightChoice => "light-choice",
            Self::LightHits => "light-hits",
            Self::Bodies => "bodies",
            Self::ClearShadows => "clear-shadows",
            Self::UnaskedLight => "unasked-light",
            Self::Insides => "insides",
            Self::Coordinates => "coordinates",
            Self::Groups => "groups",
        }
    }

    /// The work that is saved without it.
    #[must_use]
    pub const fn work(self) -> &'static str {
        match self {
            Self::Bounces => "all light but that which sources send straight",
            Self::Caustics => "the photons sent for caustics, and their map",
            Self::UnaimedPhotons => "photons sent past what they are wanted for",
            Self::Guide => "photons that show paths the way",
            Self::LightChoice => "choosing a light, and the tree of lights",
            Self::LightHits => "weighing light that rays happen to meet",
            Self::Bodies => "remembering the bodies that a ray is in",
            Self::ClearShadows => "looking at each surface on a shadow ray in order",
            Self::UnaskedLight => "rays from patches that look for such light",
            Self::Insides => "light and form factors of inner sides",
            Self::Coordinates => "texture coordinates where rays meet round shapes",
            Self::Groups => "a change of frame for each group that a ray enters",
        }
    }

    /// The renderers, and `light`, that use it.
    #[must_use]
    pub const fn users(self) -> &'static [&'static str] {
        match self {
            Self::Bounces => &["path", "photon", "radiosity"],
            Self::Caustics => &["photon"],
            Self::UnaimedPhotons => &["photon", "light"],
            Self::Guide | Self::LightHits => &["path"],
            Self::LightChoice => &["path", "photon"],
            Self::ClearShadows => &["raytracer"],
            Self::UnaskedLight | Self::Insides => &["radiosity"],
            Self::Bodies | Self::Coordinates | Self::Groups => {
                &["path", "raytracer", "photon", "radiosity", "light"]
            }
        }
    }

    /// What pictures with it and without it have in common where the scene does not require it.
    #[must_use]
    pub const fn promise(self) -> Promise {
        match self {
            Self::Bounces
            | Self::Caustics
            | Self::LightChoice
            | Self::LightHits
            | Self::Bodies
            | Self::UnaskedLight
            | Self::Insides
            | Self::Coordinates => Promise::SameBits,
            // Panes and alpha along a shadow ray are multiplied in another order.
            Self::ClearShadows => Promise::SameRounded,
            Self::UnaimedPhotons | Self::Guide | Self::Groups => Promise::SameMean,
        }
    }
}

/// A set of features.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Features(u32);

impl Features {
    /// None.
    pub const NONE: Self = Self(0);

    /// All.
    #[must_use]
    pub fn all() -> Self {
        Feature::ALL.into_iter().collect()
    }

    /// Whether one is in it.
    #[must_use]
    pub const fn contains(self, feature: Feature) -> bool {
        self.0 >> feature as u32 & 1 == 1
    }

    /// With one more.
    #[must_use]
    pub const fn with(self, feature: Feature) -> Self {
        Self(self.0 | 1 << feature as u32)
    }
}

impl FromIterator<Feature> for Features {
    fn from_iter<I: IntoIterator<Item = Feature>>(features: I) -> Self {
        features.into_iter().fold(Self::NONE, Self::with)
    }
}

impl FromStr for Features {
    /// What is allowed.
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim() {
            "none" => return Ok(Self::NONE),
            "all" => return Ok(Self::all()),
            _ => {}
        }
        let of_name = |name: &str| Feature::ALL.into_iter().find(|known| known.name() == name);
        let features: Option<Self> = text.split(',').map(|name| of_name(name.trim())).collect();
        features.ok_or_else(|| {
            let names = Feature::ALL.map(|feature| format!("`{}`", feature.name()));
            format!(
                "`none`, `all`, or with commas between them {}",
                names.join(", ")
            )
        })
    }
}

impl fmt::Display for Features {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = Feature::ALL
            .into_iter()
            .filter(|feature| self.contains(*feature));
        let names: Vec<&str> = names.map(Feature::name).collect();
        f.write_str(if names.is_empty() { "none" } else { "" })?;
        f.write_str(&names.join(","))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_read_and_written() {
        let some: Features = " bounces, guide".parse().unwrap();
        assert_eq!(some.to_string(), "bounces,guide");
        assert!(some.contains(Feature::Guide) && !some.contains(Feature::Bodies));
        assert_eq!("none".parse(), Ok(Features::NONE));
        assert_eq!(Features::NONE.to_string(), "none");
        let all = Features::all();
        assert_eq!("all".parse(), Ok(all));
        assert!(
            Feature::ALL
                .into_iter()
                .all(|feature| all.contains(feature))
        );
        assert_eq!(all.to_string().parse(), Ok(all));
        for wrong in ["", "bounces,", "Bounces", "all,guide"] {
            let error = wrong.parse::<Features>().unwrap_err();
            assert!(error.contains("`caustics`"), "{wrong}: {error}");
        }
    }
}
