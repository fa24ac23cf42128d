#!/usr/bin/env python3
"""Records what the tables of docs/ are made of: docs/measure.py BIN_DIR [PART ...], all parts in about an hour.

BIN_DIR holds springtower, random_scenes and springtower_benchmarks (build/ci/bin, of a commit without changes; docs/remake.sh build). Each part writes files of
docs/data, as the program wrote them (of the chart what was measured here); docs/generate.py makes tables of them. Beside builds times came out up to twice as long: run it
on a quiet machine. Parts:

  runs      docs/data/runs.csv         18 rows at rest in nine ways: reports of `run`
  rows      docs/data/rows.csv         towers of 9 to 144 rows, implicit and explicit
  motion    docs/data/motion.csv       18 rows in motion
  game      docs/data/game.csv         the recorded game, and game_parts.csv: parts of it, one sample
  towers    docs/data/towers.csv       64 and 640 towers, one thread and two
  stacks    docs/data/stacks.csv       walls and pyramids, with Bullet
  starts    docs/data/starts.csv       the search for the equilibrium of towers
  falls     docs/data/falls.csv        what moves in large numbers, with Bullet
  kernels   docs/data/kernels.csv      kernels, factorisations and what the machine can do (springtower_benchmarks)
  accuracy  docs/data/accuracy.csv     the chart of speed against accuracy, every method and scene
  validate  docs/data/validation.json  the claims, in the long form
  random    docs/data/random.csv       faults of 3000 random scenes, by kind, method and masses
"""
import csv
import datetime
import json
import math
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
    "version", "commit", "cpu", "date",
]

# Part: command, file that it writes, file of docs/data.
PARTS = {
    "rows": ("profile --scenes rest --rows 9,18,36,72,144 --methods implicit,semi-implicit-euler", "profile.csv", "rows.csv"),
    "motion": ("profile --rows 18 --tolerances 5e-5,1e-5 --methods implicit --scenes rest,sway,heights,pull,pull-sleep,collapse,asleep",
               "profile.csv", "motion.csv"),
    "game": ("profile --scenes game --trace TRACE", "profile.csv", "game.csv"),
    "towers": ("profile --scenes towers --towers 64,640 --threads 1,2 --tolerances 1e-5 --methods implicit", "profile.csv",
               "towers.csv"),
    "stacks": ("profile --scenes walls,pyramids", "stacks.csv", "stacks.csv"),
    "starts": ("profile --scenes starts --peer-limit 0", "stacks.csv", "starts.csv"),
    "falls": ("profile --scenes topple,hit,heaps,piles,rain", "falls.csv", "falls.csv"),
    "accuracy": ("chart --no-resume", "chart.csv", "accuracy.csv"),
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
        figures["cpu"] = processor()
        figures["date"] = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
        rows.append(figures)
    with open(DATA / "runs.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, RUN_COLUMNS, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


# Kernels that docs/performance.md compares with what the machine can do, and factorisations.
KERNELS = "^(springs/1|contacts/1|frames/1|accelerations|multiplyAdd.*|triad.*|factoriseOurs|factoriseEigen.*|solveOurs|solveEigen.*)$"


def processor():
    """As reports name it: model name, family and model."""
    first = pathlib.Path("/proc/cpuinfo").read_text().split("\n\n", 1)[0]
    fields = dict((name.strip(), value.strip()) for name, _, value in (line.partition(":") for line in first.splitlines()))
    return f"{fields['model name']}, family {fields['cpu family']} model {fields['model']}"


def commit_of(folder):
    """The commit of which the programs are."""
    version = subprocess.run([str(folder / "springtower"), "--version"], check=True, capture_output=True, text=True).stdout
    return version.split("(")[1].split(",")[0]


def record_kernels(folder):
    folder = pathlib.Path(folder).resolve()
    command = [str(folder / "springtower_benchmarks"), f"--benchmark_filter={KERNELS}", "--benchmark_format=json", "--benchmark_repetitions=5",
               "--benchmark_min_time=0.2"]
    print(" ".join(command), flush=True)
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    date = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
    fastest = {}
    for row in json.loads(printed)["benchmarks"]:
        name = row["run_name"]
        if row["run_type"] == "iteration" and not row.get("error_occurred") and row["cpu_time"] <= fastest.get(name, row)["cpu_time"]:
            fastest[name] = row
    rows = list(fastest.values())
    columns = ["name", "cpu_time", "time_unit", "bytes_per_second", "items_per_second", "flops", "commit", "cpu", "date"]
    with open(DATA / "kernels.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, columns, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(row | {"commit": commit_of(folder), "cpu": processor(), "date": date} for row in rows)


# Frames of the recorded game, from 1, and what happens in them.
GAME_PARTS = [(91, 210, "the first block is drawn out"), (211, 515, "it is lifted, carried, laid on top"),
              (640, 770, "the second is drawn out"), (771, 991, "it is lifted, carried, laid on top"),
              (1094, 1154, "the third is drawn out; the tower slides, leans and begins to fall"),
              (1155, 1264, "the hand has let go; the rest of the fall")]


def keep_game_parts(trace, game):
    """Frames of the recorded game by part, of the last sample of a trace; `game`: game.csv of the same run."""
    frames = [event["dur"] / 1000 for event in json.loads(trace.read_text())["traceEvents"] if event.get("name") == "frame"]
    with open(game, newline="") as file:
        measured = next(csv.DictReader(file))
    if len(frames) != GAME_PARTS[-1][1]:
        sys.exit(f"measure.py: expected a trace of {GAME_PARTS[-1][1]} frames, got {len(frames)}")
    def quantile(part, share):  # as the program has it
        return part[max(0, math.ceil(share * len(part)) - 1)]
    with open(DATA / "game_parts.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["first", "last", "what", "ms_median", "ms_p99", "ms_max", "over_3_ms", "commit", "cpu", "date"])
        for first, last, what in GAME_PARTS:
            part = sorted(frames[first - 1:last])
            writer.writerow([first, last, what, quantile(part, 0.5), quantile(part, 0.99), part[-1], sum(frame > 3 for frame in part),
                             *(measured[name] for name in ("commit", "cpu", "date"))])


# As the target random_3000.
RANDOM = ["--from", "1000", "--count", "3000", "--limit", "1"]


def record_random(folder):
    """The table that random_scenes prints: a line for all scenes of a kind, of a method, of a ratio of masses."""
    folder = pathlib.Path(folder).resolve()
    print("random_scenes " + " ".join(RANDOM), flush=True)
    result = subprocess.run([str(folder / "random_scenes"), *RANDOM], stdout=subprocess.PIPE, text=True)
    print(result.stdout, end="", flush=True)
    if result.returncode != 0:
        sys.exit(f"measure.py: random_scenes: expected exit code 0, got {result.returncode}")
    keep_random(result.stdout, folder)


def keep_random(printed, folder):
    head, *lines = printed.split("\n\n", 1)[0].splitlines()
    faults = head.split()
    date = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
    with open(DATA / "random.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["scenes_of", *faults, "commit", "cpu", "date"])
        for line in lines:
            words = line.split()
            name = " ".join(words[:-len(faults)])
            writer.writerow([name, *words[-len(faults):], commit_of(folder), processor(), date])


def keep_chart(written):
    """What was measured here, without what is the same in all lines."""
    with open(written, newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["measured"] == "here"]
    columns = [name for name in rows[0] if name not in ("measured", "compiler", "flags", "cpu_s_per_simulated_s")]
    with open(DATA / "accuracy.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, columns, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def main():
    if len(sys.argv) < 2 or sys.argv[1] in ("-h", "--help"):
        sys.exit(__doc__)
    program = str(pathlib.Path(sys.argv[1], "springtower").resolve())
    known = ["runs", "kernels", *PARTS, "random"]
    parts = sys.argv[2:] or known
    unknown = [part for part in parts if part not in known]
    if unknown:
        sys.exit(f"measure.py: expected parts among {', '.join(known)}, got {unknown[0]}")
    DATA.mkdir(exist_ok=True)
    for part in parts:
        with tempfile.TemporaryDirectory() as scratch:
            if part == "runs":
                record_runs(program, scratch)
                continue
            if part == "kernels":
                record_kernels(sys.argv[1])
                continue
            if part == "random":
                record_random(sys.argv[1])
                continue
            command, written, kept = PARTS[part]
            trace = pathlib.Path(scratch, "trace.json")
            run(program, [*(word if word != "TRACE" else str(trace) for word in command.split()), "--out", scratch])
            if part == "accuracy":
                keep_chart(pathlib.Path(scratch, written))
            else:
                shutil.copyfile(pathlib.Path(scratch, written), DATA / kept)
            if part == "game":
                keep_game_parts(trace, DATA / kept)


if __name__ == "__main__":
    main()
