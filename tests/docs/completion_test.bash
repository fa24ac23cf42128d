#!/usr/bin/env bash
# Completes words as bash does at a tab: completion_test.bash SOURCE_DIR. Exit code 1, with what was expected, where an answer differs.
set -euo pipefail
cd "$1"
source docs/completion/springtower.bash
failed=0

# expect 'ANSWER ...' WORD...: the answers to a tab after the last word; colons are words of their own, as bash splits them.
expect() {
  local expected=$1
  shift
  local function
  function=$(complete -p "$1") && function=${function#*-F } && function=${function%% *}
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=()
  "$function"
  [[ ${COMPREPLY[*]-} == "$expected" ]] && return
  echo "$*<tab>: expected '$expected', got '${COMPREPLY[*]-}'"
  failed=1
}

expect 'run' springtower ru
expect 'statics' springtower stat
expect '--method' springtower run --me
expect 'rigid-pgs rigid-lcp' springtower run tower:18 --method rig
expect 'cuboid' springtower verdict towers.jsonl --inertia c
expect 'tower: towers: touching:' springtower run to
expect '' springtower run wall : 2
expect 'scenes/moves.toml' springtower run scenes/mo
expect 'rest,pull rest,pull-sleep' springtower profile --scenes rest,pu
expect 'pull' springtower validate --only pu
expect 'docs' springtower validate --out do
expect 'bench/data/peers/records.csv' springtower chart --peers bench/data/peers/rec
expect '' springtower run tower:18 --seconds 1
expect '--overlay' springtower-viewer --ov
expect 'hints' springtower-viewer --overlay hi
expect 'wall:' springtower-viewer --scene wa
exit "$failed"
