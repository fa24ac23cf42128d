#!/usr/bin/env bash
# Runs fuzzers one after the other, each for its share of an hour, and ends with a table. Called by the build target fuzz_hour.
#   tests/fuzz/run.sh PROGRAMS CORPORA OUT TARGET...
# PROGRAMS  folder of the programs fuzz_TARGET
# CORPORA   folder of the kept corpora, one folder a target, and of the dictionaries TARGET.dict
# OUT       what is found goes there: OUT/TARGET/corpus grows from run to run, OUT/TARGET/crash-* and the like are faults
# SPRINGTOWER_FUZZ_SECONDS in the environment: seconds in all, an hour without. Exit code 1 where there is a fault.
set -euo pipefail
programs=$1 corpora=$2 out=$3
shift 3
seconds=${SPRINGTOWER_FUZZ_SECONDS:-3600}
[[ $seconds =~ ^[1-9][0-9]{0,6}$ ]] || {
  echo "SPRINGTOWER_FUZZ_SECONDS: expected a whole number from 1 to 9999999, got '$seconds'" >&2
  exit 2
}
share=$((seconds / $#))
((share > 0)) || share=1

# The last of libFuzzer's figures of one name.
figure() { sed -n "s/^stat::$2: *//p" "$1" | tail -n 1; }

table=
faults=0
for target in "$@"; do
  folder=$out/$target
  log=$folder/log.txt
  mkdir -p "$folder/corpus"
  # Binary inputs are of a fixed size; of texts small ones come first.
  options=(-max_len=4000)
  case $target in
    time_of_impact | manifold) options=(-max_len=300 -len_control=0) ;;
  esac
  [[ ! -f $corpora/$target.dict ]] || options+=("-dict=$corpora/$target.dict")
  echo "$target: $share s; log in $log"
  result=0
  "$programs/fuzz_$target" "${options[@]}" -max_total_time="$share" -timeout=25 -rss_limit_mb=4096 -print_final_stats=1 \
    -artifact_prefix="$folder/" "$folder/corpus" "$corpora/$target" >"$log" 2>&1 || result=$?
  coverage=$(grep -o 'cov: [0-9]*' "$log" | tail -n 1 | tr -dc 0-9 || true)
  verdict=passed
  if ((result != 0)); then
    verdict=FAULT
    faults=$((faults + 1))
    # What does not hold, the sanitizer's complaint, or the frames of ours.
    grep -E '^does not hold|ERROR:|runtime error|Test unit written' "$log" | head -n 4 | sed 's/^/   | /' || true
  fi
  table+=$(printf '%-16s %-7s %9s %12s %9s %9s MB' "$target" "$verdict" "$share s" "$(figure "$log" number_of_executed_units)" \
    "${coverage:--}" "$(figure "$log" peak_rss_mb)")$'\n'
done
echo
printf '%-16s %-7s %9s %12s %9s %12s\n' target "" time inputs edges memory
echo -n "$table"
((faults == 0))
