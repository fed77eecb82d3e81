//! The few loops that the speed rests on, each entered from candle tensors through a custom op with a tested
//! backward. They know nothing of the networks they serve.
//!
//! Networks run channels last: a convolution is a gather and a matrix product, a transposed one a matrix product and a
//! scatter. Element-wise loops are compiled for AVX-512, AVX2 and portable code and chosen at run time; they use no
//! fused multiply-add, so all three give the same bits. Matrix products differ in the last places between them.

pub mod adam;
pub mod apply;
pub mod cell;
pub mod chain;
pub mod gather;
pub mod layer;
pub mod matmul;
pub mod memory;
pub mod pointwise;
pub mod recurrence;
pub mod rows;
pub mod running_mean;
pub mod squared_error;
pub mod weight_norm;

#[cfg(test)]
mod tests;

use std::ffi::OsStr;
use std::sync::OnceLock;

use candle_core::backend::BackendStorage as _;
use candle_core::{CpuStorage, Layout, Result, Tensor, bail};
use pulp::Arch;

/// The environment variable that forces the portable code path when set to anything but `0`.
pub const PORTABLE_ENV: &str = "POESCOPE_PORTABLE";

/// The instruction set of this machine, or the portable one where [`PORTABLE_ENV`] asks for it.
pub fn arch() -> Arch {
    static ARCH: OnceLock<Arch> = OnceLock::new();
    *ARCH.get_or_init(|| choose(std::env::var_os(PORTABLE_ENV).as_deref()))
}

/// The instruction set to compute with when [`PORTABLE_ENV`] has this value.
fn choose(portable: Option<&OsStr>) -> Arch {
    match portable {
        Some(value) if value != "0" => Arch::Scalar,
        _ => Arch::new(),
    }
}

/// Runs `f` compiled for this machine's instruction set. `f` must be marked `#[inline(always)]`.
fn vectorised<R>(f: impl FnMut() -> R) -> R {
    struct Inlined<F>(F);
    impl<R, F: FnMut() -> R> pulp::NullaryFnOnce for Inlined<F> {
        type Output = R;

        // By `FnMut`, which is the closure itself: `FnOnce` goes through a shim that is not always inlined, and then
        // runs as portable code.
        #[inline(always)]
        fn call(mut self) -> R {
            (self.0)()
        }
    }
    arch().dispatch(Inlined(f))
}

/// Calls `f` with the numbers of a contiguous f32 tensor on the CPU.
pub fn read<R>(tensor: &Tensor, f: impl FnOnce(&[f32]) -> Result<R>) -> Result<R> {
    let (guard, layout) = tensor.storage_and_layout();
    f(chain::cpu(&guard, layout)?)
}

/// The numbers of a contiguous f32 tensor on the CPU.
fn values<'a>(storage: &'a CpuStorage, layout: &Layout) -> Result<&'a [f32]> {
    match (layout.contiguous_offsets(), storage) {
        (Some((start, end)), CpuStorage::F32(data)) => Ok(&data[start..end]),
        (None, _) => bail!("a kernel wants a contiguous tensor, got {layout:?}"),
        (_, other) => bail!("a kernel wants f32 numbers, got {:?}", other.dtype()),
    }
}
