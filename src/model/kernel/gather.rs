//! The geometry of a convolution: windows of a channels-last image laid out as rows, and rows added back.

use super::vectorised;

/// Windows of `kernel_height × kernel_width` pixels moved by `stride` over a channels-last image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Windows {
    /// Rows of the image.
    pub height: usize,
    /// Columns of the image.
    pub width: usize,
    /// Channels of the image.
    pub channels: usize,
    /// Rows of a window.
    pub kernel_height: usize,
    /// Columns of a window.
    pub kernel_width: usize,
    /// Pixels between two windows, along both axes.
    pub stride: usize,
    /// Columns of zeros on the left and on the right.
    pub padding: usize,
}

impl Windows {
    /// Windows along a column.
    pub fn down(&self) -> usize {
        (self.height - self.kernel_height) / self.stride + 1
    }

    /// Windows along a row.
    pub fn across(&self) -> usize {
        (self.width + 2 * self.padding - self.kernel_width) / self.stride + 1
    }

    /// Windows of an image.
    pub fn count(&self) -> usize {
        self.down() * self.across()
    }

    /// Numbers in a window.
    pub fn len(&self) -> usize {
        self.kernel_height * self.kernel_width * self.channels
    }

    /// Whether a window holds nothing.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Numbers in the image.
    pub fn image_len(&self) -> usize {
        self.height * self.width * self.channels
    }

    /// Whether the only window is the whole image, so that its row is the image itself.
    pub fn is_whole(&self) -> bool {
        self.kernel_height == self.height && self.kernel_width == self.width && self.padding == 0
    }

    /// The image as rows, `(count, len)`.
    pub fn gather(&self, image: &[f32], rows: &mut [f32]) {
        vectorised(
            #[inline(always)]
            || match (self.padding, self.kernel_width * self.channels) {
                // Of a known length a copy is one or two moves; the first layers have such runs by the million.
                (0, 8) => self.gather_short::<8>(image, rows),
                (0, 12) => self.gather_short::<12>(image, rows),
                _ => self.runs(|in_image, in_rows, length, zero_before, zero_after| {
                    rows[in_rows - zero_before..in_rows].fill(0.0);
                    rows[in_rows..in_rows + length]
                        .copy_from_slice(&image[in_image..in_image + length]);
                    rows[in_rows + length..in_rows + length + zero_after].fill(0.0);
                }),
            },
        );
    }

    /// Adds rows, `(count, len)`, back onto the image: the adjoint of [`Self::gather`].
    pub fn scatter_add(&self, rows: &[f32], image: &mut [f32]) {
        vectorised(
            #[inline(always)]
            || match (self.padding, self.kernel_width * self.channels) {
                (0, 8) => self.scatter_short::<8>(rows, image),
                (0, 12) => self.scatter_short::<12>(rows, image),
                _ => self.runs(|in_image, in_rows, length, _, _| {
                    let source = &rows[in_rows..in_rows + length];
                    for (to, &from) in image[in_image..in_image + length].iter_mut().zip(source) {
                        *to += from;
                    }
                }),
            },
        );
    }

    /// Gathers windows whose rows have `RUN` numbers, without padding.
    #[inline(always)]
    fn gather_short<const RUN: usize>(&self, image: &[f32], rows: &mut [f32]) {
        let (step, wide) = (self.stride * self.channels, self.width * self.channels);
        let rows = rows.as_chunks_mut::<RUN>().0;
        let lines = rows.chunks_exact_mut(self.across() * self.kernel_height);
        for (y, line) in lines.enumerate() {
            for k in 0..self.kernel_height {
                let source = &image[(y * self.stride + k) * wide..][..wide];
                let windows = line.iter_mut().skip(k).step_by(self.kernel_height);
                for (to, from) in windows.zip(source.windows(RUN).step_by(step)) {
                    to.copy_from_slice(from);
                }
            }
        }
    }

    /// The adjoint of [`Self::gather_short`].
    #[inline(always)]
    fn scatter_short<const RUN: usize>(&self, rows: &[f32], image: &mut [f32]) {
        let (step, wide) = (self.stride * self.channels, self.width * self.channels);
        let lines = rows.as_chunks::<RUN>().0;
        let lines = lines.chunks_exact(self.across() * self.kernel_height);
        for (y, line) in lines.enumerate() {
            for k in 0..self.kernel_height {
                let target = &mut image[(y * self.stride + k) * wide..][..wide];
                let windows = line.iter().skip(k).step_by(self.kernel_height);
                for (x, from) in windows.enumerate() {
                    if let Some(to) = target[x * step..].first_chunk_mut::<RUN>() {
                        for (to, from) in to.iter_mut().zip(from) {
                            *to += from;
                        }
                    }
                }
            }
        }
    }

    /// Calls `run(offset in the image, offset in the rows, length, zeros before, zeros after)` for each contiguous run:
    /// one row of one window.
    #[inline(always)]
    fn runs(&self, mut run: impl FnMut(usize, usize, usize, usize, usize)) {
        let c = self.channels;
        let mut in_rows = 0;
        for y in 0..self.down() {
            for x in 0..self.across() {
                let left = x * self.stride;
                let before = self.padding.saturating_sub(left);
                let start = left + before - self.padding;
                let end = (left + self.kernel_width - self.padding).min(self.width);
                let after = self.kernel_width - before - (end - start);
                for k in 0..self.kernel_height {
                    let row = y * self.stride + k;
                    run(
                        (row * self.width + start) * c,
                        in_rows + before * c,
                        (end - start) * c,
                        before * c,
                        after * c,
                    );
                    in_rows += self.kernel_width * c;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scatter_is_the_adjoint_of_gather() {
        for windows in [
            Windows {
                height: 7,
                width: 6,
                channels: 3,
                kernel_height: 3,
                kernel_width: 4,
                stride: 2,
                padding: 0,
            },
            Windows {
                height: 8,
                width: 9,
                channels: 2,
                kernel_height: 6,
                kernel_width: 6,
                stride: 2,
                padding: 0,
            },
            Windows {
                height: 1,
                width: 5,
                channels: 2,
                kernel_height: 1,
                kernel_width: 3,
                stride: 1,
                padding: 1,
            },
        ] {
            let image: Vec<f32> = (0..windows.image_len())
                .map(|i| (i as f32 * 0.7).sin())
                .collect();
            let other: Vec<f32> = (0..windows.count() * windows.len())
                .map(|i| (i as f32 * 0.3).cos())
                .collect();
            let mut rows = vec![9.0; other.len()];
            windows.gather(&image, &mut rows);
            let mut plain = vec![9.0; other.len()];
            windows.runs(|in_image, in_rows, length, before, after| {
                plain[in_rows - before..in_rows].fill(0.0);
                plain[in_rows..][..length].copy_from_slice(&image[in_image..][..length]);
                plain[in_rows + length..][..after].fill(0.0);
            });
            assert_eq!(rows, plain);
            let mut back = vec![0.0; image.len()];
            windows.scatter_add(&other, &mut back);
            let dot = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f32>();
            assert!((dot(&rows, &other) - dot(&image, &back)).abs() < 1e-4);
        }
    }
}
