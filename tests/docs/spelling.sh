#!/usr/bin/env bash
# Common misspellings: spelling.sh CODESPELL SOURCE_DIR. Prints file, line, word and what it may stand for; fails where there is one.
set -euo pipefail
cd "$2"
# statics: the science. Strack: of Cundall and Strack. fro: to and fro. toi: time of impact, as the query sets call it. trough: of a
# vibration. onTop, onOther: names in the code. metod: a test's wrong input.
find . \( -path ./build -o -path ./.git -o -path ./tests/data -o -path ./out \) -prune -o \
  \( -name '*.md' -o -name '*.h' -o -name '*.cpp' -o -name '*.py' -o -name '*.sh' -o -name '*.bib' -o -name '*.toml' -o -name '*.def' \
  -o -name '*.cff' -o -name '*.1' -o -name CMakeLists.txt -o -name '*.cmake' \) -type f -print0 |
  xargs -0 "$1" --ignore-words-list statics,strack,fro,toi,trough,ontop,onother,metod
