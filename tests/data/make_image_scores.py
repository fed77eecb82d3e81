"""Writes image_scores.json: pairs of images and scikit-image's scores of them. Needs scikit-image (0.26 wrote it)."""

import json
from pathlib import Path

import numpy as np
from skimage.metrics import peak_signal_noise_ratio, structural_similarity

rng = np.random.default_rng(3)
rows, columns = np.mgrid[0:12, 0:16]
smooth = (0.5 + 0.4 * np.sin(columns / 3.0) * np.cos(rows / 4.0)).astype(np.float32)
noise = rng.random((12, 16)).astype(np.float32)
pairs = [
    (smooth, np.clip(smooth + 0.05 * noise, 0, 1)),
    (smooth, noise),
    (noise, np.float32(1) - noise),
    (smooth, np.full_like(smooth, 0.5)),
    (smooth[:7, :7], noise[:7, :7]),
]
known = []
for a, b in pairs:
    # Four decimals, so that the file is short and says exactly what was scored.
    a, b = (np.round(x.astype(np.float64), 4).astype(np.float32).astype(np.float64) for x in (a, b))
    known.append(
        {
            "width": a.shape[1],
            "a": [round(float(x), 4) for x in a.ravel()],
            "b": [round(float(x), 4) for x in b.ravel()],
            "squared_error": float(((a - b) ** 2).sum()),
            "ssim": float(structural_similarity(a, b, data_range=1.0)),
            "psnr_db": float(peak_signal_noise_ratio(a, b, data_range=1.0)),
        }
    )
path = Path(__file__).with_name("image_scores.json")
path.write_text("[\n" + ",\n".join(json.dumps(k) for k in known) + "\n]\n")
