//! What the position probe reads of a difference of latents: its bias drops out, `Δp = W Δz`.

/// `W Δz` in metres; `weights` is the probe's W, `(2, Z)` row major. None where the sizes do not fit or a number
/// is not finite.
pub(super) fn moved(weights: &[f32], difference: &[f64]) -> Option<[f64; 2]> {
    let latent = difference.len();
    if latent == 0 || weights.len() != 2 * latent {
        return None;
    }
    let along = |axis: &[f32]| -> f64 {
        axis.iter()
            .zip(difference)
            .map(|(&w, dz)| f64::from(w) * dz)
            .sum()
    };
    let moved = [along(&weights[..latent]), along(&weights[latent..])];
    moved.iter().all(|x| x.is_finite()).then_some(moved)
}
