#!/usr/bin/env python3
"""Moves each constant of core/tuning.def by a tenth and records what changes: docs/sensitivity.py PROGRAM [CONSTANT ...]

PROGRAM is springtower of the preset `tune` (build/tune/bin/springtower), which reads constants from a file. Every constant, or those
named, is made a tenth less and a tenth more (whole numbers by 1 at least), and what nothing else is on record for also half and twice
as large, one at a time, and short scenes are run with it, one thread each, in some thirty minutes. Written to docs/data/constants.csv: for each value the number of scenes whose end state differs
in any bit, those that end otherwise (stand, fall, diverge), for each kind of scene the work and the depth over those of the constants
as they are, and the largest rise of energy in a frame of what falls, as a share of what there was. docs/generate.py makes docs/sensitivity.md of it.

Work is counted, not timed: evaluations of contact points, and for iterations and factorisations so many as take the same time. Scenes that fall
are sensitive to anything, so that the same is done with changes of a millionth, which mean nothing: what these change by is recorded
as scatter, and is no effect.
"""
import concurrent.futures
import csv
import datetime
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
OUT = ROOT / "docs" / "data" / "constants.csv"
PARTIAL = OUT.with_suffix(".csv.partial")  # what is recorded stays until all is measured

COMMIT = subprocess.run(["git", "rev-parse", "--short=12", "HEAD"], cwd=ROOT, capture_output=True, text=True).stdout.strip()
DATE = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")

# Kinds of scenes: arguments of `springtower run`.
SCENES = {
    "rest": ["tower:18 --seconds 2 --no-sleep", "uneven:18 --gravity-tilt 8 --seconds 1 --no-sleep", "heavy:9 --seconds 1 --no-sleep",
             "holes --seconds 2 --no-sleep", "swaying:6 --seconds 2", "tower:40 --seconds 0.3 --no-sleep", "touching:3 --seconds 0.5",
             "wall:20x12 --seconds 0.3 --no-sleep", "cubes:22 --seconds 0.1 --no-sleep", "bricks:12 --seconds 0.3 --no-sleep",
             "slope --seconds 1", "tower:6 --seconds 6", "tower:9 --tolerance 5e-6 --seconds 0.5 --no-sleep"],
    "falls": ["collapse:18 --seconds 1.2", "collapse:6 --seconds 1.5", "shot:6 --seconds 3", "shot:9 --seconds 2",
              "heap:40 --seconds 2.5", "heap:60 --seconds 2.5", "heap:80 --seconds 2", "rain:20 --seconds 3", "rain:40 --seconds 3",
              "askew:5 --seconds 2", "falling-rows:3 --seconds 1", "falling-rows:5 --seconds 1", "dropped-flat --seconds 1",
              "dropped-on-corner --seconds 1", "sliding --seconds 1", "spinning --seconds 1", "thrown --seconds 1",
              "thin-wall --seconds 1", "sleeper --seconds 3", "scenes/two_thrown_blocks.toml --seconds 1"],
    "hand": ["scenes/moves.toml --seconds 33", "scenes/prototypes.toml --seconds 1"],
    "methods": ["tower:3 --method semi-implicit-euler --seconds 0.5", "falling-rows:2 --method semi-implicit-euler --seconds 0.5",
                "tower:3 --method report --seconds 1", "scenes/report_t3.toml --seconds 1",
                "scenes/dropped_block.toml --method midpoint --seconds 0.5", "tower:2 --method runge-kutta-4 --seconds 0.3",
                "tower:6 --method implicit-euler --seconds 1", "tower:6 --method rigid-pgs --seconds 1",
                "collapse:4 --method rigid-pgs --seconds 1", "askew:3 --method rigid-lcp --seconds 1",
                "tower:4 --method xpbd --seconds 1"],
}
# Arguments of `springtower statics`, for the constants of statics.
STATICS = ["tower:6 --pull 2:2,+x --pull 1:1,-y", "(111)-(1L1)-(010)", "tower:9 --heights-sigma 0.0002 --seed 5",
           "tower:12 --heights-sigma 0.0002 --seed 3 --no-removals", "tower:6 --gravity-tilt 8 --no-removals", "tower:6 --mass-sigma 0.004",
           "wall:6x4", "pyramid:5", "heavy:6", "holes", "slope"]
COLUMNS = ["constant", "by", "value", "states", "ends"] + [f"{kind}_{figure}" for kind in SCENES for figure in ("work", "depth")] + ["rise", "verdicts", "margin_deg", "load_weights", "commit", "date"]
# Evaluations of a contact's points (22 ns each) that take as long as one iteration of Newton's method and one factorisation, a
# block, in the tower of 18 rows (0.024 and 0.059 ms for its 54 blocks).
ITERATION = 20
FACTORISATION = 50
# Constants that are moved together by millionths for the scatter.
SCATTERED = ["kNewtonResidual", "kNearPointMargin", "kSweepMargin", "kRigidModeBaumgarte"]
SCATTER_RUNS = 12


def constants():
    """{name: (type, value)} of all that a file may replace."""
    definition = (ROOT / "core" / "tuning.def").read_text()
    return {name: kind for kind, name in re.findall(r"^TUNING\(([^,]+), (\w+),", definition, re.MULTILINE)}


def outcome(program, values, scene):
    """(end state, how it ended, work, depth in mm, rise of energy) of a scene with these values of constants."""
    with tempfile.TemporaryDirectory() as folder:
        given = pathlib.Path(folder, "constants")
        given.write_text("".join(f"{name} {value!r}\n" for name, value in values.items()))
        report = pathlib.Path(folder, "report.json")
        try:
            ran = subprocess.run([program, "run", *scene.split(), "--threads", "1", "--report", str(report)], cwd=ROOT,
                                 env={"SPRINGTOWER_TUNING": str(given)}, capture_output=True, timeout=60)
        except subprocess.TimeoutExpired:
            return "", "takes a minute", math.nan, math.nan, math.nan
        if ran.returncode not in (0, 1) or not report.exists():
            return "", f"ends with exit code {ran.returncode}", math.nan, math.nan, math.nan
        figures = json.loads(report.read_text())
    counters, blocks = figures["counters"], figures["blocks"]
    work = figures["contact_evaluations"] + blocks * (
        ITERATION * counters["implicit_iterations"] + FACTORISATION * counters["factorisations"])
    end = "stands" if figures["stands"] else "falls"
    return figures["state_hash"], end, work, figures["max_penetration_all_mm"], figures["max_energy_rise"]


def statics_outcome(program, values, scene):
    """(verdicts, margins in degrees, loads in weights of a block) of statics with these values of constants; None where it fails."""
    with tempfile.TemporaryDirectory() as folder:
        given, report = pathlib.Path(folder, "constants"), pathlib.Path(folder, "report.json")
        given.write_text("".join(f"{name} {value!r}\n" for name, value in values.items()))
        try:
            subprocess.run([program, "statics", *scene.split(), "--threads", "1", "--report", str(report)], cwd=ROOT,
                           env={"SPRINGTOWER_TUNING": str(given)}, capture_output=True, timeout=120)
            found = json.loads(report.read_text())
        except (subprocess.TimeoutExpired, FileNotFoundError):
            return None
    blocks = found["blocks"]
    whole = [found, *(block["removal"] for block in blocks if block.get("removal"))]
    flags = [(one["stands"], one["leans"]) for one in whole] + [(block.get("covered"), block.get("loose")) for block in blocks]
    weight = sum(block.get("weight_n", 1.0) for block in blocks) / len(blocks)  # blocks of what falls have no loads
    loads = [block.get(key) for block in blocks for key in ("above_n", "least_above_n", "greatest_above_n")]
    loads += [pull["limit_n"] for pull in found["pulls"]]
    return flags, [one["tilt_deg"] for one in whole], [load / weight if load is not None else math.inf for load in loads]


def statics_change(before, after):
    """(verdicts that differ, largest change of a margin in degrees, of a load in weights) over the scenes."""
    verdicts, margin, load = 0, 0.0, 0.0
    for one, other in zip(before, after):
        if other is None or [len(part) for part in one] != [len(part) for part in other]:
            verdicts += 1
            continue
        verdicts += sum(a != b for a, b in zip(one[0], other[0]))
        margin = max([margin, *(abs(a - b) for a, b in zip(one[1], other[1]) if a is not None and b is not None)])
        load = max([load, *(abs(a - b) for a, b in zip(one[2], other[2]) if math.isfinite(a) and math.isfinite(b))])
    return {"verdicts": verdicts, "margin_deg": margin, "load_weights": load}


def outcomes(program, pool, values):
    """{scene: outcome}"""
    scenes = [scene for kind in SCENES.values() for scene in kind]
    return dict(zip(scenes, pool.map(lambda scene: outcome(program, values, scene), scenes)))


def mean_ratio(before, after):
    """The geometric mean of after / before over scenes in which both are more than 0."""
    logs = [math.log(b / a) for a, b in zip(before, after) if a > 0 and b > 0]
    return math.exp(sum(logs) / len(logs)) if logs else 1.0


def row(name, by, value, usual, found, statics=None):
    """A line of the file: what `found` is beside `usual`."""
    ends = [f"{scene.split(' --')[0]} {found[scene][1]}" for scene in usual if found[scene][1] != usual[scene][1]]
    line = {"constant": name, "by": by, "value": value, "states": sum(found[s][0] != usual[s][0] for s in usual), "ends": "; ".join(ends)}
    for kind, scenes in SCENES.items():
        for figure, at in (("work", 2), ("depth", 3)):
            line[f"{kind}_{figure}"] = round(mean_ratio([usual[s][at] for s in scenes], [found[s][at] for s in scenes]), 4)
    line["commit"], line["date"] = COMMIT, DATE
    line["rise"] = max((found[s][4] for s in SCENES["falls"] if found[s][4] == found[s][4]), default=0.0)
    return line | (statics or {})


def moved(kind, value, bare):
    """(how, value) of the values a tenth less and a tenth more; of a constant that rests on nothing else half and twice of it too."""
    if kind in ("double", "float"):
        return [("tenth", value * 0.9), ("tenth", value * 1.1)] + ([("half", value * 0.5), ("twice", value * 2.0)] if bare else [])
    step = max(1, round(abs(value) / 10))
    near = [("tenth", int(v)) for v in (value - step, value + step) if v >= 1]
    return near + ([("half", max(1, int(value) // 2)), ("twice", 2 * int(value))] if bare else [])


def main():
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    program, named = sys.argv[1], sys.argv[2:]
    kinds = constants()
    listed = json.loads(subprocess.run([program, "settings", "--all", "--json"], capture_output=True, check=True).stdout)["tuning"]
    values = {entry["name"]: entry["value"] for entry in listed if entry["name"] in kinds}
    bare = {entry["name"] for entry in listed if entry["evidence"] == "none"}
    of_statics = {entry["name"] for entry in listed if entry["group"] == "statics"}
    unknown = [name for name in named if name not in values]
    if unknown:
        sys.exit(f"sensitivity.py: expected constants of core/tuning.def that are no sizes of arrays, got {', '.join(unknown)}")
    with concurrent.futures.ThreadPoolExecutor(2) as pool, open(PARTIAL, "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        usual = outcomes(program, pool, {})
        at_rest = list(pool.map(lambda scene: statics_outcome(program, {}, scene), STATICS))
        writer.writerow(row("none", "", "", usual, usual))
        for run in range(1, SCATTER_RUNS + 1):
            change = {name: values[name] * (1.0 + 1e-6 * run) for name in SCATTERED}
            writer.writerow(row("scatter", "", run, usual, outcomes(program, pool, change)))
        for number, name in enumerate(named or values):
            print(f"{number + 1} of {len(named or values)}: {name}", flush=True)
            for by, value in moved(kinds[name], values[name], name in bare):
                statics = None
                if name in of_statics:
                    statics = statics_change(at_rest, pool.map(lambda scene: statics_outcome(program, {name: value}, scene), STATICS))
                writer.writerow(row(name, by, value, usual, outcomes(program, pool, {name: value}), statics))
            file.flush()
    if named:
        print(f"of some constants: {PARTIAL}")
    else:
        PARTIAL.replace(OUT)


if __name__ == "__main__":
    main()
