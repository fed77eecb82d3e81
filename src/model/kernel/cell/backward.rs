//! The gradients of the cell's step.

use super::{Kept, Sizes};
use crate::model::kernel::matmul::{Mat, Write, matmul};
use crate::model::kernel::pointwise::sum_rows;

/// Gradients of h, x and the flat weights for the gradient `dout` of the output `out`.
pub(super) fn step(
    sizes: Sizes,
    h: &[f32],
    x: &[f32],
    flat: &[f32],
    out: &[f32],
    dout: &[f32],
    kept: &Kept,
) -> [Vec<f32>; 3] {
    let Sizes {
        latent,
        inputs,
        hidden,
        mixtures,
    } = sizes;
    let w = sizes.weights(flat);
    let batch = x.len() / inputs;
    let (gates, head, maps) = (3 * hidden, mixtures + latent, mixtures * latent);
    let state: Vec<f32> = out
        .chunks_exact(sizes.outputs())
        .flat_map(|line| line[..hidden].iter().copied())
        .collect();

    let (dhead, dmapped) = through_mixture(sizes, dout, kept);
    let mut dstate: Vec<f32> = dout
        .chunks_exact(sizes.outputs())
        .flat_map(|line| line[..hidden].iter().copied())
        .collect();
    matmul(
        (batch, hidden, head),
        Mat::rows(&dhead, head),
        Mat::transposed(w.head, head),
        &mut dstate,
        Write::Add,
    );
    let Gates {
        dgates,
        drecurrent,
        mut dh,
    } = through_gates(sizes, h, &dstate, kept);

    let mut dflat = vec![0.0; sizes.parameters()];
    let mut rest = &mut dflat[..];
    let mut parts = sizes.parts().map(|len| {
        let (part, tail) = std::mem::take(&mut rest).split_at_mut(len);
        rest = tail;
        part
    });
    let [
        dinput,
        drecurrent_w,
        dinput_bias,
        drecurrent_bias,
        dhead_w,
        dhead_bias,
        dbases,
    ] = &mut parts;
    let outer = |a: &[f32], m: usize, b: &[f32], n: usize, dw: &mut [f32]| {
        matmul(
            (m, n, batch),
            Mat::transposed(a, m),
            Mat::rows(b, n),
            dw,
            Write::Replace,
        );
    };
    outer(x, inputs, &dgates, gates, dinput);
    outer(h, hidden, &drecurrent, gates, drecurrent_w);
    outer(&state, hidden, &dhead, head, dhead_w);
    outer(&dmapped, maps, x, inputs, dbases);
    sum_rows(&dgates, dinput_bias);
    sum_rows(&drecurrent, drecurrent_bias);
    sum_rows(&dhead, dhead_bias);

    let recurrent = Mat::transposed(w.recurrent, gates);
    matmul(
        (batch, hidden, gates),
        Mat::rows(&drecurrent, gates),
        recurrent,
        &mut dh,
        Write::Add,
    );
    let mut dx = vec![0.0; batch * inputs];
    matmul(
        (batch, inputs, gates),
        Mat::rows(&dgates, gates),
        Mat::transposed(w.input, gates),
        &mut dx,
        Write::Replace,
    );
    matmul(
        (batch, inputs, maps),
        Mat::rows(&dmapped, maps),
        Mat::rows(w.bases, inputs),
        &mut dx,
        Write::Add,
    );
    [dh, dx, dflat]
}

/// Gradients of the head (logits and log-variance side by side) and of each `M_k x`.
fn through_mixture(sizes: Sizes, dout: &[f32], kept: &Kept) -> (Vec<f32>, Vec<f32>) {
    let Sizes {
        latent,
        hidden,
        mixtures,
        ..
    } = sizes;
    let (head, maps) = (mixtures + latent, mixtures * latent);
    let batch = dout.len() / sizes.outputs();
    let (mut dhead, mut dmapped) = (vec![0.0; batch * head], vec![0.0; batch * maps]);
    let lines = dout
        .chunks_exact(sizes.outputs())
        .zip(kept.mixture.chunks_exact(mixtures));
    let lines = lines.zip(kept.mapped.chunks_exact(maps));
    let targets = dhead
        .chunks_exact_mut(head)
        .zip(dmapped.chunks_exact_mut(maps));
    for (((dout, mixture), mapped), (dhead, dmapped)) in lines.zip(targets) {
        let (dmean, dlog_var) = dout[hidden..].split_at(latent);
        let (dlogits, dhead_log_var) = dhead.split_at_mut(mixtures);
        let each = dlogits
            .iter_mut()
            .zip(mixture)
            .zip(mapped.chunks_exact(latent));
        for (((dlogit, weight), mapped), dmapped) in each.zip(dmapped.chunks_exact_mut(latent)) {
            *dlogit = mapped.iter().zip(dmean).map(|(p, d)| p * d).sum();
            for (to, d) in dmapped.iter_mut().zip(dmean) {
                *to = weight * d;
            }
        }
        // Softmax: dlogit_k = α_k (dα_k − Σ_j α_j dα_j).
        let mean: f32 = dlogits.iter().zip(mixture).map(|(d, a)| d * a).sum();
        for (d, a) in dlogits.iter_mut().zip(mixture) {
            *d = a * (*d - mean);
        }
        dhead_log_var.copy_from_slice(dlog_var);
    }
    (dhead, dmapped)
}

/// Gradients before the gates' nonlinearities, on the input's and on the state's side, and of the state itself.
struct Gates {
    dgates: Vec<f32>,
    drecurrent: Vec<f32>,
    dh: Vec<f32>,
}

fn through_gates(sizes: Sizes, h: &[f32], dstate: &[f32], kept: &Kept) -> Gates {
    let hidden = sizes.hidden;
    let (mut dgates, mut drecurrent) = (vec![0.0; 3 * h.len()], vec![0.0; 3 * h.len()]);
    let mut dh = vec![0.0; h.len()];
    for b in 0..h.len() / hidden {
        let gates = &kept.gates[b * 3 * hidden..(b + 1) * 3 * hidden];
        let dgates = &mut dgates[b * 3 * hidden..(b + 1) * 3 * hidden];
        let drecurrent = &mut drecurrent[b * 3 * hidden..(b + 1) * 3 * hidden];
        for i in 0..hidden {
            let (r, z, n) = (gates[i], gates[hidden + i], gates[2 * hidden + i]);
            let d = dstate[b * hidden + i];
            let dn = d * (1.0 - z) * (1.0 - n * n);
            let dz = d * (h[b * hidden + i] - n) * z * (1.0 - z);
            let dr = dn * kept.recurrent_n[b * hidden + i] * r * (1.0 - r);
            dh[b * hidden + i] = d * z;
            (dgates[i], dgates[hidden + i], dgates[2 * hidden + i]) = (dr, dz, dn);
            (
                drecurrent[i],
                drecurrent[hidden + i],
                drecurrent[2 * hidden + i],
            ) = (dr, dz, dn * r);
        }
    }
    Gates {
        dgates,
        drecurrent,
        dh,
    }
}
