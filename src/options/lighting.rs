//! Values of options that say how light on organs is counted.

use super::value::OptionValue;
use glam::DVec2;

/// A relative error: more than 0 and less than 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fraction(pub f64);

impl OptionValue for Fraction {
    fn parse(text: &str) -> Result<Self, String> {
        let percent = text.strip_suffix('%').map(str::trim);
        let number = percent.unwrap_or(text).parse::<f64>().ok();
        let number = number.map(|x| if percent.is_some() { x / 100.0 } else { x });
        match number {
            Some(x) if x > 0.0 && x < 1.0 => Ok(Self(x)),
            _ => Err("more than 0 and less than 1, such as `0.05` or `5%`".into()),
        }
    }
}

/// Size of a plot along x and y, metres, each more than 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlotSize(pub DVec2);

impl OptionValue for PlotSize {
    fn parse(text: &str) -> Result<Self, String> {
        let parts: Option<Vec<f64>> = text.split(',').map(|x| x.trim().parse().ok()).collect();
        match parts.as_deref() {
            Some(&[x, y]) if x > 0.0 && y > 0.0 && x.is_finite() && y.is_finite() => {
                Ok(Self(DVec2::new(x, y)))
            }
            _ => Err("X,Y (two lengths in metres, more than 0)".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_and_plots_are_possible_ones() {
        assert_eq!(Fraction::parse("0.05"), Ok(Fraction(0.05)));
        assert_eq!(Fraction::parse("5 %"), Ok(Fraction(0.05)));
        for wrong in ["0", "1", "-0.1", "NaN", "x", "100%"] {
            assert!(Fraction::parse(wrong).is_err(), "{wrong}");
        }
        assert_eq!(
            PlotSize::parse("2, 3.5"),
            Ok(PlotSize(DVec2::new(2.0, 3.5)))
        );
        for wrong in ["2", "2,0", "2,3,4", "inf,1", "NaN,1"] {
            assert!(PlotSize::parse(wrong).is_err(), "{wrong}");
        }
    }
}
