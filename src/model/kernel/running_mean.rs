//! A running mean of parameters, in place.

use candle_core::{CpuStorage, InplaceOp2, Layout, Result, Tensor, bail};
use rayon::prelude::*;

use super::{values, vectorised};

/// `mean += part (newest − mean)`, both flat and of one length.
pub fn towards(mean: &Tensor, newest: &Tensor, part: f32) -> Result<()> {
    mean.inplace_op2(newest, &Towards(part))
}

struct Towards(f32);

impl InplaceOp2 for Towards {
    fn name(&self) -> &'static str {
        "running-mean"
    }

    fn cpu_fwd(
        &self,
        mean: &mut CpuStorage,
        layout: &Layout,
        newest: &CpuStorage,
        newest_layout: &Layout,
    ) -> Result<()> {
        let newest = values(newest, newest_layout)?;
        let (CpuStorage::F32(mean), Some((start, end))) = (mean, layout.contiguous_offsets())
        else {
            bail!("a running mean wants contiguous f32 parameters");
        };
        let chunk = 1 << 16;
        let chunks = mean[start..end].par_chunks_mut(chunk);
        chunks
            .zip(newest.par_chunks(chunk))
            .for_each(|(mean, newest)| {
                vectorised(
                    #[inline(always)]
                    || {
                        for (m, &n) in mean.iter_mut().zip(newest) {
                            *m += self.0 * (n - *m);
                        }
                    },
                );
            });
        Ok(())
    }
}
