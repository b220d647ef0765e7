//! R of a QR factorisation whose rows come one after the other (Householder, G. H. Golub and C. F. Van Loan, "Matrix Computations", 5.1).
//!
//! Rows are gathered in blocks and reduced onto the triangle so far: reflector k has one entry in the triangle, R_kk, and the block's column
//! k below it. Columns of a block are contiguous and sums run in eight interleaved parts, so that the same operations, in the same order, run
//! at the widest vectors of the machine. The sensitivities of a run span four to eight orders of magnitude: normal equations would lose the
//! weak directions.

use nalgebra::DMatrix;
use stillrate::Real;

/// Rows that are reduced together.
const BLOCK: usize = 64;
/// Parts of a sum.
const PARTS: usize = 8;

type Column = [f64; BLOCK];

/// Accumulates rows into an upper-triangular R.
#[derive(Clone, Debug)]
pub(super) struct Triangle {
    block: Vec<Column>,
    used: usize,
    root: Vec<Vec<f64>>,
}

impl Triangle {
    /// An empty system with this many columns.
    pub(super) fn new(columns: usize) -> Self {
        Self { block: vec![[0.0; BLOCK]; columns], used: 0, root: vec![vec![0.0; columns]; columns] }
    }

    /// Adds a row.
    pub(super) fn push(&mut self, row: impl IntoIterator<Item = f64>) {
        for (column, value) in self.block.iter_mut().zip(row) {
            column[self.used] = value;
        }
        self.used += 1;
        if self.used == BLOCK {
            self.reduce();
        }
    }

    fn reduce(&mut self) {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the feature was just detected.
            unsafe { reduce_avx2(&mut self.block, &mut self.root) };
            self.used = 0;
            return;
        }
        reduce(&mut self.block, &mut self.root);
        self.used = 0;
    }

    /// R (square, rows of zeros where there were too few rows).
    pub(super) fn finish(mut self) -> DMatrix<f64> {
        if self.used > 0 {
            let used = self.used;
            self.block.iter_mut().for_each(|column| column[used..].fill(0.0));
            self.reduce();
        }
        let n = self.root.len();
        DMatrix::from_fn(n, n, |i, j| if i <= j { self.root[i][j] } else { 0.0 })
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn reduce_avx2(block: &mut [Column], root: &mut [Vec<f64>]) {
    reduce(block, root);
}

/// Reflects a block onto the triangle.
#[inline(always)]
fn reduce(block: &mut [Column], root: &mut [Vec<f64>]) {
    for (k, row) in root.iter_mut().enumerate() {
        let (head, rest) = block[k..].split_at_mut(1);
        let v = &head[0];
        let below = dot(v, v);
        if below == 0.0 {
            continue;
        }
        // H = I - beta (v0, v) (v0, v)^T takes (r_kk, column) to (-sign(r_kk) length, 0).
        let length = (row[k] * row[k] + below).root();
        let first = if row[k] < 0.0 { row[k] - length } else { row[k] + length };
        let beta = 2.0 / (first * first + below);
        row[k] = if first < 0.0 { length } else { -length };
        for (r, column) in row[k + 1..].iter_mut().zip(rest) {
            let weight = beta * (first * *r + dot(v, column));
            *r -= weight * first;
            for (c, v) in column.iter_mut().zip(v) {
                *c -= weight * v;
            }
        }
    }
}

#[inline(always)]
fn dot(a: &Column, b: &Column) -> f64 {
    let mut sums = [0.0; PARTS];
    for (a, b) in a.as_chunks::<PARTS>().0.iter().zip(b.as_chunks::<PARTS>().0) {
        for l in 0..PARTS {
            sums[l] += a[l] * b[l];
        }
    }
    ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_and_four_make_five() {
        let mut triangle = Triangle::new(2);
        triangle.push([3.0, 1.0]);
        triangle.push([4.0, 1.0]);
        assert!((triangle.finish()[(0, 0)].abs() - 5.0).abs() < 1e-15);
    }

    #[test]
    fn has_the_normal_matrix_of_its_rows() {
        let row = |k: usize| (0..7).map(move |j| f64::from(((k * 37 + j * j * 11) % 23) as u32) - 9.0);
        for count in [3, 64, 65, 300] {
            let mut triangle = Triangle::new(7);
            (0..count).for_each(|k| triangle.push(row(k)));
            let root = triangle.finish();
            let all = DMatrix::from_row_iterator(count, 7, (0..count).flat_map(row));
            let normal = all.transpose() * all;
            assert!((root.transpose() * &root - &normal).abs().max() < 1e-12 * normal.abs().max());
        }
    }
}
