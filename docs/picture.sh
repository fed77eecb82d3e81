#!/usr/bin/env bash
# Makes the README's picture from the sample data: docs/picture.sh
set -euo pipefail
cd "$(dirname "$0")/.."
cargo run --release -- --keys "llllllll" --print --size 120x40 | python3 docs/picture.py docs/terminal.png
