#!/usr/bin/env bash
# Installs what is missing, builds the programs, lets the tower of 18 rows stand for 10 simulated seconds, then opens the viewer
# if there is a display. Arguments go to `springtower run`, after the scene: ./run.sh --gravity-tilt 10
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
if [[ ${1-} == -h || ${1-} == --help ]]; then
  sed -n '2,3s/^# //p' "${BASH_SOURCE[0]##*/}"
  exit 0
fi

source .ci/packages.sh
installPackages run
cmake --preset release --log-level=WARNING
cmake --build --preset release

mkdir -p out
build/release/bin/springtower run tower:18 --seconds 10 --report out/tower18.json --picture out/tower18.png "$@"
echo
echo "report:  $PWD/out/tower18.json"
echo "picture: $PWD/out/tower18.png"
echo
if [[ -n ${DISPLAY-} || -n ${WAYLAND_DISPLAY-} ]]; then
  echo "viewer:  build/release/bin/springtower-viewer --players 2 (escape ends it)"
  if build/release/bin/springtower-viewer --players 2; then exit 0; fi
  echo "viewer:  it did not open; the rest is done"  # it has said why
fi
echo "viewer:  where there is a display: build/release/bin/springtower-viewer --players 2"
echo "         pictures without one: build/release/bin/springtower-viewer --headless --frames 60 --png out"
