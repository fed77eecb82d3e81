//! A few rows times a matrix, on one thread: what a recurrent step is made of.
//!
//! Every sum runs over the rows of the matrix in order, so a row has the same bits alone and among others. A general
//! product would pack the matrix each time, and take other paths for one row than for many.

use pulp::{Simd, WithSimd};

use super::arch;

/// Rows of the matrix that are multiplied in at once: with [`COLUMNS`] they stay in the first-level cache.
const DEPTH: usize = 4;
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
                let (mut fours, mut out_fours) =
                    (x.chunks_exact(4 * k), out.chunks_exact_mut(4 * n));
                for (x, out) in fours.by_ref().zip(out_fours.by_ref()) {
                    let (out01, out23) = out.split_at_mut(2 * n);
                    let (out0, out1) = out01.split_at_mut(n);
                    let (out2, out3) = out23.split_at_mut(n);
                    let out = [out0, out1, out2, out3].map(|row| &mut row[columns.clone()]);
                    let x = std::array::from_fn(|r| four(&x[r * k + depth..]));
                    add_to_four(simd, x, w, out);
                }
                let rest = fours.remainder().chunks_exact(k);
                for (x, out) in rest.zip(out_fours.into_remainder().chunks_exact_mut(n)) {
                    add_to_one(simd, four(&x[depth..]), w, &mut out[columns.clone()]);
                }
                depth += DEPTH;
            }
            for depth in depth..k {
                let w = &w[depth * n..][columns.clone()];
                for (x, out) in x.chunks_exact(k).zip(out.chunks_exact_mut(n)) {
                    add_scaled(simd, x[depth], w, &mut out[columns.clone()]);
                }
            }
        }
    }
}

#[inline(always)]
fn four(x: &[f32]) -> [f32; DEPTH] {
    [x[0], x[1], x[2], x[3]]
}

/// `sum + x₀ w₀ + x₁ w₁ + x₂ w₂ + x₃ w₃`, in that order.
#[inline(always)]
fn chain<S: Simd>(simd: S, x: [S::f32s; DEPTH], w: [S::f32s; DEPTH], sum: S::f32s) -> S::f32s {
    let sum = simd.mul_add_e_f32s(x[0], w[0], sum);
    let sum = simd.mul_add_e_f32s(x[1], w[1], sum);
    let sum = simd.mul_add_e_f32s(x[2], w[2], sum);
    simd.mul_add_e_f32s(x[3], w[3], sum)
}

/// Four rows of the matrix, each times its number of `x`, added to one row.
#[inline(always)]
fn add_to_one<S: Simd>(simd: S, x: [f32; DEPTH], w: [&[f32]; DEPTH], out: &mut [f32]) {
    let x = x.map(|x| simd.splat_f32s(x));
    let [(w0, e0), (w1, e1), (w2, e2), (w3, e3)] = w.map(S::as_simd_f32s);
    let (sums, end) = S::as_mut_simd_f32s(out);
    for ((((sum, &w0), &w1), &w2), &w3) in sums.iter_mut().zip(w0).zip(w1).zip(w2).zip(w3) {
        *sum = chain(simd, x, [w0, w1, w2, w3], *sum);
    }
    if !end.is_empty() {
        let w = [e0, e1, e2, e3].map(|row| simd.partial_load_f32s(row));
        let sum = chain(simd, x, w, simd.partial_load_f32s(end));
        simd.partial_store_f32s(end, sum);
    }
}

/// The same for four rows at once, which share what is read of the matrix. The numbers of `x` fill sixteen registers.
#[inline(always)]
fn add_to_four<S: Simd>(simd: S, x: [[f32; DEPTH]; 4], w: [&[f32]; DEPTH], out: [&mut [f32]; 4]) {
    let [x0, x1, x2, x3] = x.map(|x| x.map(|x| simd.splat_f32s(x)));
    let [(w0, e0), (w1, e1), (w2, e2), (w3, e3)] = w.map(S::as_simd_f32s);
    let [(s0, end0), (s1, end1), (s2, end2), (s3, end3)] = out.map(S::as_mut_simd_f32s);
    let sums = s0.iter_mut().zip(s1).zip(s2).zip(s3);
    let rows = w0.iter().zip(w1).zip(w2).zip(w3);
    for ((((s0, s1), s2), s3), (((&w0, &w1), &w2), &w3)) in sums.zip(rows) {
        let w = [w0, w1, w2, w3];
        *s0 = chain(simd, x0, w, *s0);
        *s1 = chain(simd, x1, w, *s1);
        *s2 = chain(simd, x2, w, *s2);
        *s3 = chain(simd, x3, w, *s3);
    }
    if !end0.is_empty() {
        let w = [e0, e1, e2, e3].map(|row| simd.partial_load_f32s(row));
        for (x, end) in [(x0, end0), (x1, end1), (x2, end2), (x3, end3)] {
            let sum = chain(simd, x, w, simd.partial_load_f32s(end));
            simd.partial_store_f32s(end, sum);
        }
    }
}

/// One row of the matrix, times `x`, added to a row.
#[inline(always)]
fn add_scaled<S: Simd>(simd: S, x: f32, w: &[f32], out: &mut [f32]) {
    let x = simd.splat_f32s(x);
    let (whole, end) = S::as_simd_f32s(w);
    let (sums, sums_end) = S::as_mut_simd_f32s(out);
    for (sum, &w) in sums.iter_mut().zip(whole) {
        *sum = simd.mul_add_e_f32s(x, w, *sum);
    }
    if !end.is_empty() {
        let sum = simd.partial_load_f32s(sums_end);
        let sum = simd.mul_add_e_f32s(x, simd.partial_load_f32s(end), sum);
        simd.partial_store_f32s(sums_end, sum);
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
