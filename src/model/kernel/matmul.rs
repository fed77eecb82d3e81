//! Matrix products on one thread; the callers are parallel over samples.

use pulp::Arch;

use super::arch;

/// A row-major matrix, or its transpose, as the product reads it.
#[derive(Clone, Copy)]
pub struct Mat<'a> {
    data: &'a [f32],
    row_stride: usize,
    column_stride: usize,
}

impl<'a> Mat<'a> {
    /// `data` as rows of `columns` numbers.
    pub fn rows(data: &'a [f32], columns: usize) -> Self {
        Self {
            data,
            row_stride: columns,
            column_stride: 1,
        }
    }

    /// The transpose of `data` as rows of `columns` numbers.
    pub fn transposed(data: &'a [f32], columns: usize) -> Self {
        Self {
            data,
            row_stride: 1,
            column_stride: columns,
        }
    }

    /// Length that a product over `rows × columns` reads.
    fn reach(self, rows: usize, columns: usize) -> usize {
        (rows - 1) * self.row_stride + (columns - 1) * self.column_stride + 1
    }
}

/// Whether a product replaces what was there or adds to it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Write {
    /// `out = a b`.
    Replace,
    /// `out += a b`.
    Add,
}

/// `out (m, n) = a (m, k) · b (k, n)`, row major, replacing or adding.
///
/// # Panics
/// When a slice is shorter than its shape says.
pub fn matmul(shape: (usize, usize, usize), a: Mat, b: Mat, out: &mut [f32], write: Write) {
    let (m, n, k) = shape;
    if m == 0 || n == 0 {
        return;
    }
    if k == 0 {
        if write == Write::Replace {
            out[..m * n].fill(0.0);
        }
        return;
    }
    assert!(out.len() >= m * n, "output shorter than its shape");
    assert!(
        a.data.len() >= a.reach(m, k),
        "left matrix shorter than its shape"
    );
    assert!(
        b.data.len() >= b.reach(k, n),
        "right matrix shorter than its shape"
    );
    match arch() {
        Arch::Scalar => portable(shape, a, b, out, write),
        _ => packed(shape, a, b, out, write),
    }
}

#[expect(
    unsafe_code,
    reason = "the gemm crate takes pointers; the caller has checked every length. 2 to 10 times faster than safe loops"
)]
fn packed((m, n, k): (usize, usize, usize), a: Mat, b: Mat, out: &mut [f32], write: Write) {
    // SAFETY: `matmul` has checked that each slice holds the last element its strides reach, and `out` is exclusive.
    unsafe {
        gemm::gemm(
            m,
            n,
            k,
            out.as_mut_ptr(),
            1,
            n as isize,
            write == Write::Add,
            a.data.as_ptr(),
            a.column_stride as isize,
            a.row_stride as isize,
            b.data.as_ptr(),
            b.column_stride as isize,
            b.row_stride as isize,
            1.0_f32,
            1.0_f32,
            false,
            false,
            false,
            gemm::Parallelism::None,
        );
    }
}

/// Rows of `out` as sums of scaled rows of `b`: the order a compiler vectorises without rearranging sums.
fn portable((m, n, k): (usize, usize, usize), a: Mat, b: Mat, out: &mut [f32], write: Write) {
    for (i, row) in out.chunks_exact_mut(n).take(m).enumerate() {
        if write == Write::Replace {
            row.fill(0.0);
        }
        for l in 0..k {
            let factor = a.data[i * a.row_stride + l * a.column_stride];
            let start = l * b.row_stride;
            if b.column_stride == 1 {
                for (o, &v) in row.iter_mut().zip(&b.data[start..start + n]) {
                    *o += factor * v;
                }
            } else {
                for (j, o) in row.iter_mut().enumerate() {
                    *o += factor * b.data[start + j * b.column_stride];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(n: usize, seed: u32) -> Vec<f32> {
        (0..n as u32)
            .map(|i| {
                ((i.wrapping_mul(2_654_435_761).wrapping_add(seed) >> 8) % 1000) as f32 / 500.0
                    - 1.0
            })
            .collect()
    }

    #[test]
    fn portable_and_packed_products_agree() {
        let (m, n, k) = (7, 33, 19);
        let (a, b) = (numbers(m * k, 1), numbers(k * n, 2));
        for write in [Write::Replace, Write::Add] {
            for (left, right) in [
                (Mat::rows(&a, k), Mat::rows(&b, n)),
                (Mat::transposed(&a, m), Mat::rows(&b, n)),
                (Mat::rows(&a, k), Mat::transposed(&b, k)),
            ] {
                let (mut fast, mut plain) = (vec![0.5; m * n], vec![0.5; m * n]);
                packed((m, n, k), left, right, &mut fast, write);
                portable((m, n, k), left, right, &mut plain, write);
                for (x, y) in fast.iter().zip(&plain) {
                    assert!((x - y).abs() < 1e-5, "{x} and {y}");
                }
            }
        }
    }
}
