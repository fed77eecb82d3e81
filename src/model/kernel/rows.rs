//! A few rows times a matrix, on one thread: what a recurrent step is made of.
//!
//! Every sum runs over the rows of the matrix in order, so a row has the same bits alone and among others. A general
//! product would pack the matrix each time, and take other paths for one row than for many.

use pulp::{Simd, WithSimd};

use super::arch;

/// Rows of the matrix that are multiplied in at once: with [`COLUMNS`] they stay in the first-level cache.
const DEPTH: usize = 8;
/// Columns of the matrix that are gone through at once.
const COLUMNS: usize = 256;

/// `out (B, n) += x (B, k) · w (k, n)`, all row major.
///
/// # Panics
/// When the lengths are not those of such matrices.
pub fn accumulate(x: &[f32], k: usize, w: &[f32], out: &mut [f32]) {
    let n = w.len() / k;
    assert_eq!(w.len(), k * n, "the matrix has no whole rows");
    assert_eq!(x.len() * n, out.len() * k, "rows in and rows out differ");
    arch().dispatch(Accumulate { x, k, w, n, out });
}

/// `out (B, n) = x (B, k) · w (k, n) + bias (n)`, all row major.
pub fn affine(x: &[f32], k: usize, w: &[f32], bias: &[f32], out: &mut [f32]) {
    for row in out.chunks_exact_mut(bias.len()) {
        row.copy_from_slice(bias);
    }
    accumulate(x, k, w, out);
}

/// The transpose of `w`, rows of `columns`.
pub fn transposed(w: &[f32], columns: usize) -> Vec<f32> {
    /// Rows and columns of a tile that fits the cache both ways.
    const TILE: usize = 16;
    let rows = w.len() / columns;
    let mut out = vec![0.0; w.len()];
    for top in (0..rows).step_by(TILE) {
        for left in (0..columns).step_by(TILE) {
            for i in top..(top + TILE).min(rows) {
                for j in left..(left + TILE).min(columns) {
                    out[j * rows + i] = w[i * columns + j];
                }
            }
        }
    }
    out
}

struct Accumulate<'a> {
    x: &'a [f32],
    k: usize,
    w: &'a [f32],
    n: usize,
    out: &'a mut [f32],
}

impl WithSimd for Accumulate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { x, k, w, n, out } = self;
        for start in (0..n).step_by(COLUMNS) {
            let columns = start..(start + COLUMNS).min(n);
            let mut depth = 0;
            while depth + DEPTH <= k {
                let w: [&[f32]; DEPTH] =
                    std::array::from_fn(|i| &w[(depth + i) * n..][columns.clone()]);
                let mut pairs = x.chunks_exact(2 * k);
                let mut out_pairs = out.chunks_exact_mut(2 * n);
                for (x, out) in pairs.by_ref().zip(out_pairs.by_ref()) {
                    let (x0, x1) = x.split_at(k);
                    let (out0, out1) = out.split_at_mut(n);
                    let out = [&mut out0[columns.clone()], &mut out1[columns.clone()]];
                    add(simd, [&x0[depth..], &x1[depth..]], w, out);
                }
                let (x, out) = (pairs.remainder(), out_pairs.into_remainder());
                if !x.is_empty() {
                    add(simd, [&x[depth..]], w, [&mut out[columns.clone()]]);
                }
                depth += DEPTH;
            }
            for depth in depth..k {
                let w = [&w[depth * n..][columns.clone()]];
                for (x, out) in x.chunks_exact(k).zip(out.chunks_exact_mut(n)) {
                    add(simd, [&x[depth..]], w, [&mut out[columns.clone()]]);
                }
            }
        }
    }
}

/// Adds `D` rows of the matrix, each times its number of `x`, to each of `R` rows of `out`.
#[inline(always)]
fn add<S: Simd, const R: usize, const D: usize>(
    simd: S,
    x: [&[f32]; R],
    w: [&[f32]; D],
    out: [&mut [f32]; R],
) {
    let factors: [[S::f32s; D]; R] =
        std::array::from_fn(|r| std::array::from_fn(|d| simd.splat_f32s(x[r][d])));
    let whole: [&[S::f32s]; D] = w.map(|row| S::as_simd_f32s(row).0);
    let len = whole[0].len();
    let whole = whole.map(|row| &row[..len]);
    let mut out = out.map(S::as_mut_simd_f32s);
    for j in 0..len {
        for (factors, (sums, _)) in factors.iter().zip(&mut out) {
            let mut sum = sums[j];
            for (factor, row) in factors.iter().zip(&whole) {
                sum = simd.mul_add_e_f32s(*factor, row[j], sum);
            }
            sums[j] = sum;
        }
    }
    let ends = w.map(|row| S::as_simd_f32s(row).1);
    if !ends[0].is_empty() {
        for (factors, (_, sums)) in factors.iter().zip(&mut out) {
            let mut sum = simd.partial_load_f32s(sums);
            for (factor, end) in factors.iter().zip(&ends) {
                sum = simd.mul_add_e_f32s(*factor, simd.partial_load_f32s(end), sum);
            }
            simd.partial_store_f32s(sums, sum);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(n: usize, seed: f32) -> Vec<f32> {
        (0..n)
            .map(|i| ((i as f32 + seed) * 12.9898).sin())
            .collect()
    }

    #[test]
    fn a_row_has_the_same_bits_alone_and_among_others_and_is_the_sum() {
        for (k, n) in [(18, 31), (256, 300), (5, 16), (1, 1)] {
            let (x, w, bias) = (numbers(7 * k, 1.0), numbers(k * n, 2.0), numbers(n, 3.0));
            let mut all = vec![0.0; 7 * n];
            affine(&x, k, &w, &bias, &mut all);
            for (x, row) in x.chunks_exact(k).zip(all.chunks_exact(n)) {
                let mut alone = vec![0.0; n];
                affine(x, k, &w, &bias, &mut alone);
                assert_eq!(alone, row);
                for (j, &value) in row.iter().enumerate() {
                    let exact: f64 = (0..k)
                        .map(|i| f64::from(x[i]) * f64::from(w[i * n + j]))
                        .sum();
                    let exact = exact + f64::from(bias[j]);
                    assert!(
                        (f64::from(value) - exact).abs() < 1e-4,
                        "{value}, exactly {exact}"
                    );
                }
            }
        }
    }
}
