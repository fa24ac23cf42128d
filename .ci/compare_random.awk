#!/usr/bin/awk -f
# compare_random.awk RECORDED TABLE: holds the last row of random_scenes' table against the recorded numbers of failures. The last
# line says how many there are; exit code 1 where a fault is more frequent than recorded, or the table is not of as many scenes.
NR == FNR && /^[a-z]/ { most[$1] = $2 }
NR == FNR { next }
/^ +scenes / { for (i = 1; i <= NF; ++i) name[i] = $i }
/^all / {
  for (i = 2; i <= NF; ++i) count[name[i - 1]] = $i
  columns = NF - 1
}
END {
  if (count["scenes"] != most["scenes"]) {
    printf "%d scenes judged of %d\n", count["scenes"], most["scenes"]
    exit 1
  }
  for (i = 2; i <= columns; ++i) {
    fault = name[i]
    if (fault == "cut" || fault == "step-limit") continue # no faults
    found = count[fault]
    if (found > 0) text = text ", " fault " " found
    if (found > most[fault] + 0) worse = worse ", " fault " " found " of " most[fault] + 0 " allowed"
    else if (found < most[fault]) printf "fewer than recorded: %s %d of %d\n", fault, found, most[fault]
  }
  if (worse) {
    printf "more than recorded: %s\n", substr(worse, 3)
    exit 1
  }
  print substr(text, 3)
}
