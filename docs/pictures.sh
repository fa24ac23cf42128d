#!/usr/bin/env bash
# Makes the README's pictures again: docs/pictures.sh (after a Release build).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
program=build/release/bin/springtower
"$program" run tower:18 --seconds 2 --picture docs/pictures/tower18.png
"$program" run tower:18 --seconds 0.55 --gravity-tilt 16 --gravity-direction 30 --no-sleep --picture docs/pictures/collapse.png
"$program" chart --scenes uniform --peers bench/data/peers/records.csv --out out/chart
cp out/chart/uniform_penetration_mm.png docs/pictures/speed_accuracy.png
