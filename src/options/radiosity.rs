//! Values of options of radiosity.

use super::value::OptionValue;
use crate::integrator::radiosity::{FormFactorMethod, Solver};

impl OptionValue for Solver {
    fn parse(text: &str) -> Result<Self, String> {
        match text {
            "gather" => Ok(Self::Gather),
            "shoot" => Ok(Self::Shoot),
            "stochastic" => Ok(Self::Stochastic),
            _ => Err("`gather`, `shoot` or `stochastic`".into()),
        }
    }
}

impl OptionValue for FormFactorMethod {
    fn parse(text: &str) -> Result<Self, String> {
        match text {
            "rays" => Ok(Self::Rays),
            "hemicube" => Ok(Self::Hemicube),
            "analytic" => Ok(Self::Analytic),
            _ => Err("`rays`, `hemicube` or `analytic`".into()),
        }
    }
}

/// A length in metres, more than 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Width(pub f64);

impl OptionValue for Width {
    fn parse(text: &str) -> Result<Self, String> {
        match text.parse::<f64>() {
            Ok(width) if width > 0.0 && width.is_finite() => Ok(Self(width)),
            _ => Err("a number of metres greater than 0".into()),
        }
    }
}

/// How large a difference may be, as a part of the mean: 0 or more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Threshold(pub f64);

impl OptionValue for Threshold {
    fn parse(text: &str) -> Result<Self, String> {
        match text.parse::<f64>() {
            Ok(part) if part >= 0.0 && part.is_finite() => Ok(Self(part)),
            _ => Err("a number from 0 on".into()),
        }
    }
}

/// How often a patch may be split, 0 to 30.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SplitDepth(pub u32);

impl OptionValue for SplitDepth {
    fn parse(text: &str) -> Result<Self, String> {
        match text.parse() {
            Ok(n @ 0..=30) => Ok(Self(n)),
            _ => Err("a whole number from 0 to 30".into()),
        }
    }
}

/// Pixels along an edge of a hemicube, 1 to 1024.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HemicubePixels(pub u32);

impl OptionValue for HemicubePixels {
    fn parse(text: &str) -> Result<Self, String> {
        match text.parse() {
            Ok(n @ 1..=1024) => Ok(Self(n)),
            _ => Err("a whole number from 1 to 1024".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_numbers_are_the_possible_ones() {
        assert_eq!(Solver::parse("shoot"), Ok(Solver::Shoot));
        assert!(Solver::parse("guess").is_err());
        assert_eq!(
            FormFactorMethod::parse("hemicube"),
            Ok(FormFactorMethod::Hemicube)
        );
        assert!(FormFactorMethod::parse("cube").is_err());
        assert!(Width::parse("0").is_err() && Width::parse("0.1").is_ok());
        assert!(Threshold::parse("-0.1").is_err() && Threshold::parse("0").is_ok());
        assert!(SplitDepth::parse("31").is_err() && SplitDepth::parse("30").is_ok());
        assert_eq!(HemicubePixels::parse("1024"), Ok(HemicubePixels(1024)));
        for wrong in ["0", "1025", "-1", "1.5", ""] {
            assert!(HemicubePixels::parse(wrong).is_err(), "{wrong}");
        }
    }
}
