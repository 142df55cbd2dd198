//! Choosing directions where a sky is bright: a density that is constant over each cell of a grid of directions.

use crate::math::functions::atan2;
use crate::math::warp;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Share of the average radiance that every cell counts with at least, so that no direction with light is impossible.
const LEAST_SHARE: f64 = 0.01;

/// Piecewise constant density over directions. Rows are bands of the height z of the unit vector, columns equal steps of
/// azimuth from +x towards +y.
#[derive(Clone, Debug)]
pub(super) struct SkyTable {
    /// Heights between which the rows lie, rising.
    edges: Vec<f64>,
    n_columns: usize,
    /// Running sums of the rows' shares, from 0 to 1.
    rows: Vec<f64>,
    /// Per row, running sums of the shares of its columns, from 0 to 1.
    columns: Vec<f64>,
    is_black: bool,
}

impl SkyTable {
    /// A table for the mean radiances of cells, row by row from the lowest up; `edges` has one height more than there are
    /// rows.
    pub(super) fn new(edges: Vec<f64>, mut cells: Vec<f64>) -> Self {
        let n_rows = edges.len() - 1;
        let n_columns = cells.len() / n_rows;
        let height = |row: usize| edges[row + 1] - edges[row];

        // A least share everywhere keeps the weights of samples bounded.
        let bands = cells.chunks(n_columns).enumerate();
        let total: f64 = bands
            .map(|(row, band)| height(row) * band.iter().sum::<f64>())
            .sum();
        let mean = total / ((edges[n_rows] - edges[0]) * n_columns as f64);
        for cell in &mut cells {
            *cell = cell.max(LEAST_SHARE * mean);
        }
        let row_sums: Vec<f64> = cells
            .chunks(n_columns)
            .enumerate()
            .map(|(row, band)| height(row) * band.iter().sum::<f64>())
            .collect();
        let columns = cells.chunks(n_columns).flat_map(running_shares).collect();
        Self {
            rows: running_shares(&row_sums),
            columns,
            edges,
            n_columns,
            is_black: mean <= 0.0,
        }
    }

    /// Whether no cell has any light.
    pub(super) fn is_black(&self) -> bool {
        self.is_black
    }

    fn row_of_columns(&self, row: usize) -> &[f64] {
        &self.columns[row * (self.n_columns + 1)..(row + 1) * (self.n_columns + 1)]
    }

    /// A direction, chosen with a point of the unit square.
    pub(super) fn sample(&self, u: DVec2) -> DVec3 {
        let (row, along_row) = invert(&self.rows, u.x);
        let (column, along_column) = invert(self.row_of_columns(row), u.y);
        let z = self.edges[row] + along_row * (self.edges[row + 1] - self.edges[row]);
        warp::direction(z, (column as f64 + along_column) / self.n_columns as f64)
    }

    /// Density per steradian with which [`sample`](Self::sample) chooses `w`, a unit vector not below the lowest row.
    pub(super) fn pdf_solid_angle(&self, w: DVec3) -> f64 {
        let turn = atan2(w.y, w.x) / TAU;
        let turn = if turn < 0.0 { turn + 1.0 } else { turn };
        let last_row = self.edges.len() - 2;
        let row = self.edges[1..=last_row].partition_point(|edge| *edge <= w.z);
        let column = ((turn * self.n_columns as f64) as usize).min(self.n_columns - 1);
        let columns = self.row_of_columns(row);
        let share = (self.rows[row + 1] - self.rows[row]) * (columns[column + 1] - columns[column]);
        let solid_angle = (self.edges[row + 1] - self.edges[row]) * TAU / self.n_columns as f64;
        share / solid_angle
    }
}

/// Running sums of weights, scaled to end at exactly 1; even shares if all weights are 0.
fn running_shares(weights: &[f64]) -> Vec<f64> {
    let total: f64 = weights.iter().sum();
    let n = weights.len() as f64;
    let share = |w: f64| if total > 0.0 { w / total } else { 1.0 / n };
    let mut sums = Vec::with_capacity(weights.len() + 1);
    let mut sum = 0.0;
    sums.push(0.0);
    for weight in weights {
        sum += share(*weight);
        sums.push(sum.min(1.0));
    }
    if let Some(last) = sums.last_mut() {
        *last = 1.0;
    }
    sums
}

/// The cell of running sums that `u` in [0, 1) falls into, and how far along the cell it lies, 0..1.
fn invert(sums: &[f64], u: f64) -> (usize, f64) {
    let cell = sums
        .partition_point(|sum| *sum <= u)
        .clamp(1, sums.len() - 1)
        - 1;
    let width = sums[cell + 1] - sums[cell];
    let along = if width > 0.0 {
        ((u - sums[cell]) / width).clamp(0.0, 1.0)
    } else {
        0.5
    };
    (cell, along)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverting_running_shares_meets_every_cell() {
        let sums = running_shares(&[1.0, 0.0, 3.0]);
        assert_eq!(sums, [0.0, 0.25, 0.25, 1.0]);
        assert_eq!(invert(&sums, 0.0), (0, 0.0));
        assert_eq!(invert(&sums, 0.25).0, 2);
        assert_eq!(invert(&sums, 1.0).0, 2);
        assert_eq!(running_shares(&[0.0, 0.0]), [0.0, 0.5, 1.0]);
    }

    #[test]
    fn uneven_rows_of_equal_radiance_give_an_even_density() {
        let table = SkyTable::new(vec![-1.0, -0.9, 0.2, 1.0], vec![2.0; 12]);
        assert!(!table.is_black());
        for i in 0..100 {
            let u = DVec2::new(f64::from(i) / 100.0, f64::from(i * 37 % 100) / 100.0);
            let w = table.sample(u);
            assert!((table.pdf_solid_angle(w) * 2.0 * TAU - 1.0).abs() < 1e-12);
            assert!((w.z - (2.0 * u.x - 1.0)).abs() < 1e-12);
        }
        assert!(SkyTable::new(vec![0.0, 1.0], vec![0.0; 4]).is_black());
    }
}
