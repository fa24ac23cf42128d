#!/usr/bin/env bash
# Installs what is missing, builds the programs, then lets the tower of 18 rows stand for 10 simulated seconds.
# Arguments go to `springtower run`, after the scene: ./run.sh --gravity-tilt 10
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
