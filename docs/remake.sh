#!/usr/bin/env bash
# Makes every generated table and every picture of the documents again, from the programs of the tree as it is. On two quiet cores it
# takes about two hours; what differs afterwards are times, and how many random scenes are slow or run out of time. Recordings
# of other engines (bench/data/peers), docs/pictures/opens_before.png and figures within sentences are of the commits they name.
#   docs/remake.sh             every part
#   docs/remake.sh PART...     these parts:
#     build       build/ci and build/tune
#     data        docs/data, of which the tables of times, claims and random scenes are made (docs/measure.py)
#     constants   docs/data/constants.csv: what changes with each constant (docs/sensitivity.py)
#     pictures    docs/pictures (docs/pictures.sh, docs/film.sh)
#     pages       the generated parts of pages, manual pages and completions (docs/generate.py)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build() {
  cmake --preset ci --log-level=WARNING
  cmake --build --preset ci
  cmake --preset tune --log-level=WARNING
  cmake --build --preset tune --target springtower_program
}
data() { python3 docs/measure.py build/ci/bin; }
constants() { python3 docs/sensitivity.py build/tune/bin/springtower; }
pictures() {
  SPRINGTOWER_BIN=build/ci/bin docs/pictures.sh
  docs/film.sh build/ci/bin/springtower-viewer
}
pages() { python3 docs/generate.py build/ci/bin; }

(($#)) || set -- build data constants pictures pages
for part in "$@"; do
  case $part in
    build | data | constants | pictures | pages) "$part" ;;
    *)
      echo "docs/remake.sh: expected build, data, constants, pictures or pages, got $part" >&2
      exit 2
      ;;
  esac
done
