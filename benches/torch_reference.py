#!/usr/bin/env python3
"""The peer of the speed benches: the network of `vhp` in stock PyTorch layers, timed on two threads.

    python3 benches/torch_reference.py                 # as PyTorch is installed
    python3 benches/torch_reference.py --best          # the fastest f32 setting found, see `BEST`
    python3 benches/torch_reference.py --check tests/data/reference_vhp.json

Needs `pip install torch numpy`. It prints one line of JSON for each number: `{"id": "step", "setting": "installed",
"ms": 1090.0}`, a median after warm-up. `--check` fills the network by the formula of the reference numbers (see
`tests/it/golden.rs`) and compares losses over five updates with them: what is timed is the same network.

B episodes of T beliefs, latent Z, control U, M experts with the prior last. All sizes are those of the released script:
64 x 64 frames with the one before stacked under each, one joint window of 12 channels x 32 samples.
"""

import argparse
import json
import os
import statistics
import sys
import time
import warnings

Z, U, HIDDEN, MIXTURES = 16, 2, 256, 15
FRAMES, CHANNELS, SAMPLES, SIDE = 2, 12, 32, 64
THREADS = 2
# By default glibc gives freed blocks of this size back to the system, and each update faults them in again. Beside
# these: channels last, Adam in one kernel, and for looking weights folded once. `torch.compile` was slower.
BEST = {
    "MALLOC_TRIM_THRESHOLD_": str(1 << 34),
    "MALLOC_MMAP_THRESHOLD_": str(1 << 34),
    "MALLOC_TOP_PAD_": str(1 << 28),
    "THP_MEM_ALLOC_ENABLE": "1",
}
# Read when a process starts: `--best` starts itself again with them.
if __name__ == "__main__" and "--best" in sys.argv and any(os.environ.get(k) != v for k, v in BEST.items()):
    os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, **BEST})

warnings.filterwarnings("ignore", category=FutureWarning)  # weight_norm has a successor, of the same equation

import numpy as np
import torch
from torch import nn
from torch.nn.functional import mse_loss
from torch.nn.utils import clip_grad_norm_, remove_weight_norm, weight_norm


def alternate(layers):
    """Each layer with weight norm and an ELU behind it."""
    return [module for layer in layers for module in (weight_norm(layer), nn.ELU())]


class Encoder(nn.Module):
    """An observation (N, channels, ...) to an expert's mean and log-variance, (N, Z) each."""

    def __init__(self, layer, inputs, features, **options):
        super().__init__()
        sizes = [inputs, 32, 64, 128, 256]
        self.layers = nn.Sequential(*alternate(layer(i, o, bias=False, **options) for i, o in zip(sizes, sizes[1:])))
        self.fc_mu = weight_norm(nn.Linear(features, Z))
        self.fc_logvar = weight_norm(nn.Linear(features, Z))

    def forward(self, x):
        x = self.layers(x).flatten(1)
        return self.fc_mu(x), self.fc_logvar(x)


class Decoder(nn.Module):
    """A latent (N, Z) to an observation: a linear layer to `start`, then transposed convolutions."""

    def __init__(self, layer, start, sizes, kernels, last, **options):
        super().__init__()
        self.start = start
        self.linear = weight_norm(nn.Linear(Z, int(np.prod(start)), bias=False))
        channels = zip([start[0], *sizes], sizes, kernels)
        layers = alternate(layer(i, o, k, bias=False, **options) for i, o, k in channels)
        self.layers = nn.Sequential(*layers[:-1], last)

    def forward(self, z):
        return self.layers(nn.functional.elu(self.linear(z)).unflatten(1, self.start))


class Dynamics(nn.Module):
    """p(z_t+1 | z_t, u_t): a recurrent state weighs K base matrices."""

    def __init__(self):
        super().__init__()
        self.A = nn.Parameter(torch.eye(Z) + 0.05 * torch.randn(MIXTURES, Z, Z))
        self.B = nn.Parameter(0.05 * torch.randn(MIXTURES, Z, U))
        self.rnn = nn.GRUCell(Z + U, HIDDEN)
        self.linear = weight_norm(nn.Linear(HIDDEN, MIXTURES))
        self.fc_logvar = weight_norm(nn.Linear(HIDDEN, Z))

    def forward(self, z, u, hidden):
        """Mean and log-variance of the next prior, and the state that states it; N rows each."""
        hidden = self.rnn(torch.cat([z, u], 1), hidden)
        weights = self.linear(hidden).softmax(1)
        matrix = (weights @ torch.cat([self.A, self.B], 2).flatten(1)).unflatten(1, (Z, Z + U))
        mean = matrix @ torch.cat([z, u], 1).unsqueeze(2)
        return mean.squeeze(2), self.fc_logvar(hidden), hidden

    def filter(self, experts, controls, alphas=None, noise=None):
        """Beliefs of B episodes. Experts (B, T, Z), controls (B, T - 1, U), alphas (B, T, M), noise (B, T, Z).

        Returns (mean, log-variance) of posterior and prior, the latents fed on and the states, (B, T, ...) each.
        """
        precisions = [(-log_var).exp() for _, log_var in experts]
        if alphas is not None:
            precisions = [p * alphas[..., i : i + 1] for i, p in enumerate(precisions)]
        sensed = sum(precisions)
        weighted = sum(p * mean for p, (mean, _) in zip(precisions, experts))
        batch, steps = sensed.shape[:2]
        prior = sensed.new_zeros(batch, Z), sensed.new_full((batch, Z), 20.0).log()
        hidden = sensed.new_zeros(batch, HIDDEN)
        rows = []
        for t in range(steps):
            precision = (-prior[1]).exp()
            if alphas is not None:
                precision = precision * alphas[:, t, -1:]
            variance = 1 / (sensed[:, t] + precision)
            mean = variance * (weighted[:, t] + precision * prior[0])
            log_var = (variance + 1e-8).log()
            z = mean if noise is None else mean + (0.5 * log_var).exp() * noise[:, t]
            rows.append((mean, log_var, *prior, z, hidden))
            if t + 1 < steps:
                *prior, hidden = self(z, controls[:, t], hidden)
        mean, log_var, prior_mean, prior_log_var, z, hidden = (torch.stack(row, 1) for row in zip(*rows))
        return (mean, log_var), (prior_mean, prior_log_var), z, hidden


class Model(nn.Module):
    """`vhp`: vision, and haptic and proprio joined."""

    def __init__(self):
        super().__init__()
        self.img_enc = Encoder(nn.Conv2d, FRAMES, 1024, kernel_size=4, stride=2)
        self.context_enc = Encoder(nn.Conv1d, CHANNELS, 256 * SAMPLES, kernel_size=3, padding=1)
        frames, kernels = [128, 64, 32, FRAMES], [5, 5, 6, 6]
        self.img_dec = Decoder(nn.ConvTranspose2d, (1024, 1, 1), frames, kernels, nn.Sigmoid(), stride=2)
        windows = [128, 64, 32, CHANNELS]
        self.context_dec = Decoder(nn.ConvTranspose1d, (256, SAMPLES), windows, [3] * 4, nn.Identity(), padding=1)
        self.dyn = Dynamics()

    def encode(self, images, windows, episodes):
        """Both experts of images (B T, 2, 64, 64) and windows (B T, 12, 32): (B, T, Z) each."""
        experts = self.img_enc(images), self.context_enc(windows)
        return [tuple(x.unflatten(0, (episodes, -1)) for x in expert) for expert in experts]

    def loss(self, images, windows, controls, n_step, noise=None):
        """Squared errors of both decoders and the KL over `n_step` steps, each a mean over beliefs."""
        experts = self.encode(images, windows, len(controls))
        posterior, prior, z, hidden = self.dyn.filter(experts, controls, noise=noise)
        latents = z.flatten(0, 1)
        image = mse_loss(self.img_dec(latents), images, reduction="sum") / len(latents)
        window = mse_loss(self.context_dec(latents), windows, reduction="sum") / len(latents)
        divergence = kl(*posterior, *prior)
        mean, hidden = prior[0][:, 1:], hidden[:, 1:]
        for n in range(2, n_step + 1):
            rows = z.shape[1] - n
            states = mean[:, :rows], controls[:, n - 1 :], hidden[:, :rows]
            pushed = self.dyn(*(x.flatten(0, 1) for x in states))
            mean, log_var, hidden = (x.unflatten(0, (-1, rows)) for x in pushed)
            divergence = divergence + kl(*(x[:, n:] for x in posterior), mean, log_var)
        return image, window, divergence


def kl(mean, log_var, prior_mean, prior_log_var):
    """KL(posterior || prior) in nats, a mean over beliefs."""
    own, other = log_var.exp() + 1e-8, prior_log_var.exp() + 1e-8
    terms = (own + (prior_mean - mean) ** 2) / other + other.log() - own.log() - 1
    return 0.5 * terms.sum(2).mean()


def update(model, optimiser, *batch):
    """One update: forward, backward, each network's gradient clipped, Adam. The terms of the loss before it."""
    terms = model.loss(*batch)
    optimiser.zero_grad()
    sum(terms).backward()
    for network in model.children():
        clip_grad_norm_(network.parameters(), 0.5)
    optimiser.step()
    return terms


def fold(model):
    """Replaces every weight by its product g v / |v|: for looking, nothing changes them."""
    for module in model.modules():
        if hasattr(module, "weight_g"):
            remove_weight_norm(module)


def timed(run, secs=1.0, least=7):
    """Median time in ms, after three runs to warm up, over `secs` seconds and at least `least` runs."""
    for _ in range(3):
        run()
    times, until = [], time.perf_counter() + secs
    while len(times) < least or time.perf_counter() < until:
        start = time.perf_counter()
        run()
        times.append(1e3 * (time.perf_counter() - start))
    return statistics.median(times)


def measure(best):
    """Yields (id, run) for everything that is timed."""
    torch.manual_seed(0)
    layout = torch.channels_last if best else torch.contiguous_format

    def observed(beliefs):
        images = torch.rand(beliefs, FRAMES, SIDE, SIDE).to(memory_format=layout)
        return images, torch.randn(beliefs, CHANNELS, SAMPLES)

    model = Model()
    for network in (model.img_enc, model.img_dec):
        network.to(memory_format=layout)
    optimiser = torch.optim.Adam(model.parameters(), lr=3e-4, fused=best or None)
    images, windows = observed(32 * 15)
    controls, noise = torch.randn(32, 14, U), torch.randn(32, 15, Z)
    yield "step", lambda: update(model, optimiser, images, windows, controls, 2, noise)
    model.requires_grad_(False)
    if best:
        fold(model)
    with torch.inference_mode():
        images, windows = observed(15)
        controls, latents = torch.randn(1, 14, U), torch.randn(15, Z)
        experts = model.encode(images, windows, 1)
        yield "filter_episode", lambda: model.dyn.filter(model.encode(images, windows, 1), controls)
        blind = torch.tensor([0.0, 1.0, 1.0]).expand(1, 15, 3)
        yield "switch", lambda: model.dyn.filter(experts, controls, blind)
        yield "encode_frame", lambda: model.img_enc(images[:1])
        yield "decode_1", lambda: model.img_dec(latents[:1])
        yield "decode_15", lambda: model.img_dec(latents)
        # Every set but the empty one of vision, haptic, proprio and the prior: an episode of 48 steps under each.
        sets = torch.tensor([[float(s >> i & 1) for i in range(4)] for s in range(1, 16)])
        alphas, controls = sets[:, None].expand(15, 48, 4), torch.randn(1, 47, U).expand(15, 47, U)
        experts = [(torch.randn(1, 48, Z), torch.randn(1, 48, Z)) for _ in range(3)]
        yield "lattice_48", lambda: model.dyn.filter(experts, controls, alphas)


def formula(tensor, count):
    """The reference's numbers in [-1, 1) for the elements of a tensor: splitmix64 of its number and their index."""
    x = np.arange(count, dtype=np.uint64) + np.uint64((tensor << 32) + 0x9E3779B97F4A7C15)
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
        x = (x ^ (x >> np.uint64(shift))) * np.uint64(factor)
    return ((x ^ (x >> np.uint64(31))) >> np.uint64(40)).astype(np.float64) / 2**23 - 1


def filled(name, tensor, shape):
    """The reference's value of a parameter."""
    h = formula(tensor, int(np.prod(shape))).reshape(shape)
    if name == "dyn.A":
        return 0.15 * h + 0.8 * np.eye(Z)
    if name == "dyn.B":
        return 0.5 * h
    if "rnn.weight" in name:
        return 2 * h / np.sqrt(shape[1])
    if "bias" in name:
        return 0.25 * h
    if name.endswith("weight_v"):
        return h
    gains = {"img_dec.layers.6": 0.75, "img_dec": 2.0, "context_dec.layers.6": 0.5, "context_dec": 1.0}
    gains |= {"dyn.linear": 4.0, "dyn.fc_logvar": 3.0, "": 1.5}
    return next(gain for start, gain in gains.items() if name.startswith(start)) * (1 + 0.25 * h)


def recorded():
    """The reference's two episodes: images, windows and controls as the model takes them."""
    b, t, y, x = np.meshgrid(*(np.arange(n) for n in (2, 16, SIDE, SIDE)), indexing="ij")
    squared = (x - (18 + 2 * t + 6 * b)) ** 2 + (y - (44 - t - 9 * b)) ** 2
    image = 0.1 + 0.8 * 36 / (36 + squared) + 0.1 * ((3 * x + 5 * y + t) % 8) / 8
    images = np.stack([image[:, 1:], image[:, :-1]], 2)
    wrench, noise = (formula(n, 2 * 16 * 32 * 6).reshape(2, 16, 32, 6) for n in (1000, 1001))
    _, t, f, d = np.meshgrid(*(np.arange(n) for n in wrench.shape), indexing="ij")
    motion = ((f / 31 - 0.5) + 0.05 * t) * (1 - 0.25 * d) + 0.1 * noise
    windows = np.concatenate([0.5 * wrench, motion], 3)[:, 1:].swapaxes(2, 3)
    controls = 0.5 * formula(1002, 2 * 16 * 2).reshape(2, 16, 2)[:, 2:]
    flat = images.reshape(30, FRAMES, SIDE, SIDE), windows.reshape(30, CHANNELS, SAMPLES), controls
    return [torch.tensor(x, dtype=torch.float32) for x in flat]


def check(path):
    """Exits with a message unless the losses agree with the reference's to 1e-4 relative."""
    with open(path) as file:
        reference = json.load(file)
    model, batch = Model(), recorded()
    numbers = {f"{each['net']}.{each['name']}": each["t"] for each in reference["tensors"]}
    for name, parameter in model.named_parameters():
        number = numbers[name + "_l0" if ".rnn." in name else name]
        value = filled(name, number, parameter.shape)
        parameter.data.copy_(torch.tensor(value, dtype=torch.float32))
    pairs = [(model.loss(*batch, n), reference["elbo"][f"n_step_{n}"]) for n in (1, 2, 3)]
    optimiser = torch.optim.Adam(model.parameters(), lr=3e-4)
    pairs += [(update(model, optimiser, *batch, 2), theirs) for theirs in reference["adam_5_steps_n_step_2"]]
    worst = 0.0
    for terms, theirs in pairs:
        for ours, key in zip(terms, ("image_rec", "context_rec", "kl")):
            worst = max(worst, abs(ours.item() / theirs[key] - 1))
    print(f"{3 * len(pairs)} loss terms, largest relative difference {worst:.1e}", file=sys.stderr)
    if not worst <= 1e-4:
        sys.exit("this is not the reference's network")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--best", action="store_true", help="the fastest f32 setting, instead of PyTorch as installed")
    parser.add_argument("--check", metavar="PATH", help="compare with the reference numbers instead of timing")
    arguments = parser.parse_args()
    torch.set_num_threads(THREADS)
    if arguments.check:
        return check(arguments.check)
    for name, run in measure(arguments.best):
        line = {"id": name, "setting": "best" if arguments.best else "installed", "ms": round(timed(run), 4)}
        print(json.dumps(line), flush=True)


if __name__ == "__main__":
    main()
