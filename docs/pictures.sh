#!/usr/bin/env bash
# Makes the pictures of docs/pictures again, without a display, after a Release build.
#   docs/pictures.sh             all
#   docs/pictures.sh PART...     of moving (README's moving picture), stills, charts
# Environment: SPRINGTOWER_BIN  the folder of the programs, build/release/bin without it
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
bin=${SPRINGTOWER_BIN:-build/release/bin}
viewer=$bin/springtower-viewer
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# The fall of scenes/lost_block.toml from 0.2 to 1.4 s, at half its speed: every second frame, 15 of them shown a second.
moving() {
  mkdir "$scratch/moving"
  "$viewer" --headless --scene scenes/lost_block.toml --frames 84 --png-every 2 --size 720x400 --camera -28:14:0.95 --png "$scratch/moving"
  docs/animate.py "$scratch/moving" docs/pictures/lost_block.png --first 6 --left 110
}

# still NAME FRAMES CAMERA OPTION...: the scene after so many frames; the camera as degrees round, degrees up, metres off.
still() {
  "$viewer" --headless --frames "$2" --png-every "$2" --camera "$3" --size 480x600 --png "$scratch" "${@:4}"
  mv "$scratch/$(printf 'frame-%05d.png' "$2")" "docs/pictures/$1.png"
}

# The viewer as it opens, with the mouse on a block. What it was before that is opens_before.png, of commit fd7d2a2.
opens() {
  printf '%s\n' '1 60 120' '60 380 330' >"$scratch/mouse"
  "$viewer" --headless --scene tower:18 --seed 1 --mode play --players 1 --mouse "$scratch/mouse" --size 800x600 \
    --frames 120 --png-every 120 --png "$scratch"
  mv "$scratch/frame-00120.png" docs/pictures/opens.png
}

stills() {
  still load 120 -52:18:0.44 --scene tower:9 --overlay load --arrows
  still hints 120 -52:18:0.44 --scene tower:9 --overlay hints
  opens
}

charts() {
  "$bin/springtower" chart --scenes uniform,wall --out "$scratch/chart" \
    --peers bench/data/peers/records.csv,bench/data/peers/stacks.csv
  cp "$scratch/chart/uniform_penetration_mm.png" docs/pictures/speed_accuracy.png
  cp "$scratch/chart/wall_penetration_mm.png" docs/pictures/speed_accuracy_wall.png
  "$bin/springtower" profile --scenes rest --rows 3,6,7,9,12,18,24,36,54,72 --out "$scratch/profile"
  cp "$scratch/profile/figure_6_23.png" docs/pictures/figure_6_23.png
}

(($#)) || set -- moving stills charts
for part in "$@"; do
  case $part in
    moving | stills | charts) "$part" ;;
    *)
      echo "docs/pictures.sh: expected moving, stills or charts, got $part" >&2
      exit 2
      ;;
  esac
done
