#!/usr/bin/env python3
"""Records what the tables of docs/ are made of: docs/measure.py BIN_DIR [PART ...], all parts in some tens of minutes.

BIN_DIR holds springtower (build/release/bin, of a commit without changes; run ./run.sh before). Each part writes files of
docs/data, as the program wrote them; docs/generate.py makes tables of them. Beside builds times came out up to twice as long: run it
on a quiet machine. Parts:

  runs      docs/data/runs.csv         18 rows at rest in nine ways: reports of `run`
  rows      docs/data/rows.csv         towers of 9 to 144 rows, implicit and explicit
  motion    docs/data/motion.csv       18 rows in motion
  game      docs/data/game.csv         the recorded game
  towers    docs/data/towers.csv       64 and 640 towers, one thread and two
  stacks    docs/data/stacks.csv       walls and pyramids, with Bullet
  falls     docs/data/falls.csv        what moves in large numbers, with Bullet
  validate  docs/data/validation.json  the claims, in the long form
"""
import csv
import datetime
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = ROOT / "docs" / "data"

# Arguments of `springtower run` for the rows of runs.csv.
RUNS = [
    [],
    ["--tolerance", "1e-5"],
    *[["--heights-sigma", "0.0002", "--seed", str(seed)] for seed in range(1, 6)],
    ["--gravity-tilt", "10"],
    ["--method", "semi-implicit-euler"],
]
RUN_COLUMNS = [
    "arguments", "max_penetration_mm", "bottom_row_compression_mm", "creep_mm", "jitter_mm_s", "cpu_ms_median", "stands",
    "version", "commit", "date",
]

# Part: command, file that it writes, file of docs/data.
PARTS = {
    "rows": ("profile --scenes rest --rows 9,18,36,72,144 --methods implicit,semi-implicit-euler", "profile.csv", "rows.csv"),
    "motion": ("profile --rows 18 --tolerances 1e-5 --methods implicit --scenes rest,sway,heights,pull,pull-sleep,collapse,asleep",
               "profile.csv", "motion.csv"),
    "game": ("profile --scenes game", "profile.csv", "game.csv"),
    "towers": ("profile --scenes towers --towers 64,640 --threads 1,2 --tolerances 1e-5 --methods implicit", "profile.csv",
               "towers.csv"),
    "stacks": ("profile --scenes walls,pyramids", "stacks.csv", "stacks.csv"),
    "falls": ("profile --scenes topple,hit,heaps,piles,rain", "falls.csv", "falls.csv"),
    "validate": ("validate --full", "validation.json", "validation.json"),
}


def run(program, arguments):
    """Runs the program, shows what it prints, and ends on an error."""
    print("springtower " + " ".join(arguments), flush=True)
    result = subprocess.run([program, *arguments], cwd=ROOT)
    if result.returncode != 0:
        sys.exit(f"measure.py: springtower {arguments[0]}: expected exit code 0, got {result.returncode}")


def record_runs(program, scratch):
    rows = []
    for arguments in RUNS:
        report = pathlib.Path(scratch) / "report.json"
        run(program, ["run", "tower:18", "--seconds", "60", "--no-sleep", "--threads", "1", *arguments, "--report", str(report)])
        figures = json.loads(report.read_text())
        figures["arguments"] = " ".join(arguments)
        figures["cpu_ms_median"] = figures["ms_per_frame"]["cpu_median"]
        figures["date"] = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
        rows.append(figures)
    with open(DATA / "runs.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, RUN_COLUMNS, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def main():
    if len(sys.argv) < 2 or sys.argv[1] in ("-h", "--help"):
        sys.exit(__doc__)
    program = str(pathlib.Path(sys.argv[1], "springtower").resolve())
    parts = sys.argv[2:] or ["runs", *PARTS]
    unknown = [part for part in parts if part != "runs" and part not in PARTS]
    if unknown:
        sys.exit(f"measure.py: expected parts among runs, {', '.join(PARTS)}, got {unknown[0]}")
    DATA.mkdir(exist_ok=True)
    for part in parts:
        with tempfile.TemporaryDirectory() as scratch:
            if part == "runs":
                record_runs(program, scratch)
                continue
            command, written, kept = PARTS[part]
            run(program, [*command.split(), "--out", scratch])
            shutil.copyfile(pathlib.Path(scratch, written), DATA / kept)


if __name__ == "__main__":
    main()
