#!/usr/bin/env bash
# Installs what is missing, builds with warnings as errors, checks layout and names, and runs every test.
#   ./test.sh              all of it
#   ./test.sh --sanitize   builds with the address and undefined behaviour sanitizers and runs every test
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

preset=ci
case "${1-}" in
  "") ;;
  --sanitize) preset=asan ;;
  *)
    sed -n '2,4s/^# \{0,1\}//p' "${BASH_SOURCE[0]##*/}" >&2
    exit 2
    ;;
esac

step() { printf '\n== %s (after %d s)\n' "$1" "$SECONDS"; }

step "packages"
source .ci/packages.sh
extra=()
[[ $preset == ci ]] || extra=(long)
installPackages run test "${extra[@]}"

if [[ $preset == ci ]]; then
  # Before the build: it takes seconds, and the build minutes.
  step "layout: clang-format"
  find . -path ./build -prune -o \( -name '*.cpp' -o -name '*.h' \) -print0 | xargs -0 clang-format --dry-run --Werror
fi

step "build"
cmake --preset "$preset" --log-level=WARNING
cmake --build --preset "$preset"

if [[ $preset == ci ]]; then
  step "names and common mistakes: clang-tidy"
  # Joined, they take a third of the time. A name that two sources give to different things shows here too.
  cmake --preset lint --log-level=WARNING
  sed -n 's/^ *"file": "\(.*\)",\{0,1\}$/\1/p' build/lint/compile_commands.json |
    xargs -r -d '\n' -n 1 -P "$(nproc)" clang-tidy -p build/lint --quiet 2>&1 |
    sed -E '/^[0-9]+ warnings? generated\.$/d'
fi

step "tests"
ctest --preset "$preset" -j "$(nproc)"

if [[ $preset == ci ]]; then
  step "instruction counts and hashes of fixed scenes: callgrind"
  bench/callgrind.py "build/$preset"
fi
