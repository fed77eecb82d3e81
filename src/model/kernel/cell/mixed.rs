//! `A = Σ_k w_k A_k`: the linear map that a cell's state mixes, its gates frozen.

use super::forward::softmax;
use super::{Sizes, Weights};
use crate::model::kernel::rows::{accumulate, affine};

/// A for each row of the base matrices' weights, `mixture (n, K)`: `(n, Z, Z)` row major.
pub fn matrices(sizes: Sizes, w: &Weights, mixture: &[f32]) -> Vec<f32> {
    let each = sizes.latent * sizes.inputs;
    let mut both = vec![0.0; mixture.len() / sizes.mixtures * each];
    accumulate(mixture, sizes.mixtures, w.bases, &mut both);
    // A and B lie side by side.
    both.chunks_exact(sizes.inputs)
        .flat_map(|row| row[..sizes.latent].iter().copied())
        .collect()
}

/// The same of the steps that led to `states (n, hidden)`.
pub fn matrices_of(sizes: Sizes, w: &Weights, states: &[f32]) -> Vec<f32> {
    let mut heads = vec![0.0; states.len() / sizes.hidden * sizes.head()];
    affine(states, sizes.hidden, w.head, w.head_bias, &mut heads);
    let mut mixture = Vec::with_capacity(states.len() / sizes.hidden * sizes.mixtures);
    for head in heads.chunks_exact_mut(sizes.head()) {
        let logits = &mut head[..sizes.mixtures];
        softmax(logits);
        mixture.extend_from_slice(logits);
    }
    matrices(sizes, w, &mixture)
}
