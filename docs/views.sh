#!/usr/bin/env bash
# Makes the pictures of docs/inspection.md from the sample data: docs/views.sh
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --release
mkdir -p docs/views
picture() { # name size keys
  target/release/poescope --print --size "$2" --keys "$3" | python3 docs/picture.py "docs/views/$1_$2.png"
}
for size in 80x24 120x40; do
  for view in overview fuse predict position consistency lattice; do
    picture "$view" "$size" "llllllll :view<space>$view<enter> <esc>"
  done
done
picture damage 120x40 "llllllll v x2xxx====<esc>"
picture controls 120x40 "llllllll 1 r===<esc> vvv"
picture episodes 120x40 "n E"
picture palette 80x24 "llllllll :cor"
