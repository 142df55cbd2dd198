//! Numbers become colours: dark where pictures agree, light where they differ.

/// Colours, evenly apart from 0 to 1, bytes of sRGB: the map *magma* of matplotlib (S. van der Walt, N. Smith, 2015), which grows
/// evenly lighter and stays readable without colour.
const MAGMA: [[f64; 3]; 9] = [
    [0.0, 0.0, 4.0],
    [28.0, 16.0, 68.0],
    [79.0, 18.0, 123.0],
    [129.0, 37.0, 129.0],
    [181.0, 54.0, 122.0],
    [229.0, 80.0, 100.0],
    [251.0, 135.0, 97.0],
    [254.0, 194.0, 135.0],
    [252.0, 253.0, 191.0],
];

/// Three bytes for each number of 0..=1; what lies outside is like the nearest end.
#[must_use]
pub(super) fn colors(values: &[f64]) -> Vec<u8> {
    let color = |value: &f64| {
        let last = MAGMA.len() - 1;
        let at = value.clamp(0.0, 1.0) * last as f64;
        let below = (at as usize).min(last - 1);
        let part = at - below as f64;
        [0, 1, 2].map(|i| {
            let [low, high] = [MAGMA[below][i], MAGMA[below + 1][i]];
            (low + part * (high - low)).round() as u8
        })
    };
    values.iter().flat_map(color).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_grow_lighter() {
        let bytes = colors(&(0..=100).map(|i| f64::from(i) / 100.0).collect::<Vec<_>>());
        let lightness =
            |rgb: &[u8]| 2 * u32::from(rgb[0]) + 5 * u32::from(rgb[1]) + u32::from(rgb[2]);
        let all: Vec<u32> = bytes.chunks_exact(3).map(lightness).collect();
        assert!(all.is_sorted(), "{all:?}");
        assert_eq!(colors(&[-1.0, 2.0]), [0, 0, 4, 252, 253, 191]);
    }
}
