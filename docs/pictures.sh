#!/usr/bin/env bash
# Makes the README's pictures again, without a display: docs/pictures.sh (after a Release build).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
viewer=build/release/bin/springtower-viewer
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# picture NAME FRAMES CAMERA OPTION...: the scene after so many frames; the camera as degrees round, degrees up, metres off.
picture() {
  "$viewer" --headless --frames "$2" --png-every "$2" --camera "$3" --size 480x600 --png "$scratch" "${@:4}"
  mv "$scratch/$(printf 'frame-%05d.png' "$2")" "docs/pictures/$1.png"
}

printf '%s\n' '[tower]' 'rows = 18' '[gravity]' 'tilt_deg = 16.0' 'direction_deg = 30.0' >"$scratch/tilted.toml"
picture tower18 60 -52:18:0.68 --scene tower:18
picture collapse 38 -14:20:1.0 --scene "$scratch/tilted.toml" --no-sleep
picture load 120 -52:18:0.44 --scene tower:9 --overlay load --arrows
picture hints 120 -52:18:0.44 --scene tower:9 --overlay hints

# The viewer as it opens, with the mouse on a block. What it was before that is opens_before.png, of commit fd7d2a2.
printf '%s\n' '1 60 120' '60 380 330' >"$scratch/mouse"
"$viewer" --headless --scene tower:18 --seed 1 --mode play --players 1 --mouse "$scratch/mouse" --size 800x600 \
  --frames 120 --png-every 120 --png "$scratch"
mv "$scratch/frame-00120.png" docs/pictures/opens.png

build/release/bin/springtower chart --scenes uniform,wall --out "$scratch/chart" \
  --peers bench/data/peers/records.csv,bench/data/peers/stacks.csv
cp "$scratch/chart/uniform_penetration_mm.png" docs/pictures/speed_accuracy.png
cp "$scratch/chart/wall_penetration_mm.png" docs/pictures/speed_accuracy_wall.png

build/release/bin/springtower profile --scenes rest --rows 3,6,7,9,12,18,24,36,54,72 --out "$scratch/profile"
cp "$scratch/profile/figure_6_23.png" docs/pictures/figure_6_23.png
