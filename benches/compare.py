#!/usr/bin/env python3
"""Our speed beside PyTorch's: runs both in turn and prints a Markdown table.

    python3 benches/compare.py

Takes two to three minutes on a quiet machine, plus what a build takes. Needs cargo and a python3 with PyTorch and NumPy
(`pip install torch numpy`, in a virtual environment for instance, whose python3 then runs this script).
"""

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PEER = [sys.executable, "benches/torch_reference.py"]
# What is timed, in words, and what it is held to: at most so many ms, or so much of either setting of PyTorch's time.
ROWS = {
    "step": ("training update, 32 episodes x 15 beliefs", "0.40 x installed, 0.55 x best"),
    "filter_episode": ("encode and filter an episode of 15", "3 ms"),
    "switch": ("filter again, experts cached", "0.5 ms"),
    "encode_frame": ("encode a frame", ""),
    "decode_1": ("decode a frame", "1 ms"),
    "decode_15": ("decode 15 frames", ""),
    "lattice_48": ("15 sets of experts over 48 steps", "8 ms"),
}


def times(command):
    """Milliseconds by id, from the lines of JSON that a command prints."""
    print("running", *command, file=sys.stderr)
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)} failed with exit code {done.returncode}; its message is above")
    lines = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
    return {line["id"]: line["ms"] for line in lines if "ms" in line}


def digits(ms):
    """Three of them."""
    return f"{ms:.0f}" if ms >= 100 else f"{ms:.3g}"


def main():
    missing = [name for name in ("torch", "numpy") if importlib.util.find_spec(name) is None]
    if missing:
        lack = f"{sys.executable} lacks {' and '.join(missing)}"
        sys.exit(f"{lack}; run this with a python3 that has them (`pip install torch numpy`)")
    busy = os.getloadavg()[0]
    if busy > 0.5:
        print(f"note: {busy:.1f} processes were running in the last minute; times will be too long", file=sys.stderr)
    ours = {}
    for bench in ("step", "looking"):
        ours |= times(["cargo", "bench", "--quiet", "--bench", bench, "--", "--json"])
    installed, best = times(PEER), times([*PEER, "--best"])
    print("| | ours, ms | PyTorch as installed, ms | ratio | PyTorch at its best, ms | ratio | target: at most |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name, (words, target) in ROWS.items():
        if name not in ours:
            sys.exit(f"neither bench printed a line of JSON with the id {name!r}")
        peers = [f"{digits(peer[name])} | {ours[name] / peer[name]:.2f}" for peer in (installed, best)]
        print(f"| {words} (`{name}`) | {digits(ours[name])} | {' | '.join(peers)} | {target} |")


if __name__ == "__main__":
    main()
