#!/usr/bin/env python3
"""Counts the instructions of fixed scenes under callgrind and compares them with the committed baseline.

Times are too noisy on shared machines to fail a build on; counts of instructions are not. Each scene of gate_scenes runs on one
thread, its last frames are counted, and with them its accuracy and the hash of its state are printed. The command fails when a
count is off by more than 3 % either way (a baseline that is too high would hide the next regression), or when a hash differs.

  bench/callgrind.py             checks build/ci against bench/baseline.json
  bench/callgrind.py --update    takes the counts and hashes over; commit the file with the change that made the difference

valgrind has no AVX-512, and no kernel of ours uses more than AVX2: counts are the same on any machine that has AVX2.
"""

import argparse
import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
TOLERANCE = 0.03
FIGURES = ("max_penetration_mm", "bottom_row_compression_mm", "max_strain", "speed_mm_s", "energy_j")
SETTLED_FRAMES = 300  # 5 s: from then on the design judges accuracy
SETTLING = ("rest", "uneven")  # scenes that come to rest


def fail(message):
    print(f"callgrind.py: {message}", file=sys.stderr)
    sys.exit(2)


def run(command):
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        fail(f"{' '.join(map(str, command))} ended with {done.returncode}:\n{done.stderr[-2000:]}")
    return done


def measure(program, scene):
    """Runs one scene: its figures as the program prints them, and the instructions of its counted frames. Those that settle run
    on without valgrind: what they settle to is `settled`."""
    done = run(["valgrind", "--tool=callgrind", "--instr-atstart=no", "--callgrind-out-file=/dev/null", program, scene])
    collected = re.search(r"Collected : (\d+)", done.stderr)
    figures = json.loads(done.stdout)
    figures["instructions"] = int(collected.group(1)) if collected else 0
    if figures["instructions"] == 0:
        fail("nothing was counted: was gate_scenes built where valgrind's header is (package valgrind)?")
    if scene.split()[0] in SETTLING:
        settled = json.loads(run([program, scene, str(SETTLED_FRAMES)]).stdout)
        figures["settled"] = {key: settled[key] for key in (*FIGURES, "state_hash")}
    return figures


def compare(scene, now, before):
    """What is wrong with a scene, one line each."""
    if before is None:
        return ["is not in the baseline"]
    complaints = []
    change = now["instructions"] / before["instructions"] - 1.0
    if change > TOLERANCE:
        complaints.append(f"takes {100 * change:.1f} % more instructions")
    elif change < -TOLERANCE:
        complaints.append(f"takes {-100 * change:.1f} % fewer instructions: take the better figure over")
    for when, new, old in (("", now, before), ("settled: ", now.get("settled"), before.get("settled"))):
        if new is None or new["state_hash"] == old["state_hash"]:
            continue
        complaints.append(f"{when}ends in another state")
        complaints += [f"{when}{key} {old[key]:.6g} -> {new[key]:.6g}" for key in FIGURES if new[key] != old[key]]
    return complaints


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", nargs="?", default=ROOT / "build/ci", help="the build folder (default build/ci)")
    parser.add_argument("--update", action="store_true", help="writes the baseline instead of comparing with it")
    parser.add_argument("--baseline", default=ROOT / "bench/baseline.json", help="another baseline")
    options = parser.parse_args()
    program = pathlib.Path(options.build) / "bin/gate_scenes"
    baseline_file = pathlib.Path(options.baseline)
    if not program.exists():
        fail(f"{program} is not built")
    if shutil.which("valgrind") is None:
        fail("valgrind is not installed (apt-get install valgrind)")

    scenes = run([program]).stdout.splitlines()
    with concurrent.futures.ThreadPoolExecutor(max_workers=len(os.sched_getaffinity(0))) as pool:
        results = dict(zip(scenes, pool.map(lambda scene: measure(program, scene), scenes)))
    build = {key: results[scenes[0]][key] for key in ("compiler", "flags")}
    for figures in results.values():
        for key in ("scene", *build):
            del figures[key]

    if options.update:
        baseline_file.write_text(json.dumps({**build, "scenes": results}, indent=1) + "\n")
    if not baseline_file.exists():
        fail(f"there is no {baseline_file}; make it with --update")
    baseline = json.loads(baseline_file.read_text())

    print(
        f"{'scene':<28}{'instructions':>15}{'baseline':>15}{'change':>9}  {'state':<18}"
        f"{'penetration mm':>15}{'squash mm':>11}{'speed mm/s':>12}"
    )
    complaints = []
    for scene, now in results.items():
        before = baseline["scenes"].get(scene)
        count = before["instructions"] if before else 0
        change = f"{100 * (now['instructions'] / count - 1):+.2f} %" if count else "new"
        print(
            f"{scene:<28}{now['instructions']:>15}{count:>15}{change:>9}  {now['state_hash']:<18}"
            f"{now['max_penetration_mm']:>15.4g}{now['bottom_row_compression_mm']:>11.4g}{now['speed_mm_s']:>12.3g}"
        )
        if (settled := now.get("settled")) is not None:
            print(
                f"{'  after 5 s':<67}  {settled['state_hash']:<18}{settled['max_penetration_mm']:>15.4g}"
                f"{settled['bottom_row_compression_mm']:>11.4g}{settled['speed_mm_s']:>12.3g}"
            )
        complaints += [f"{scene}: {complaint}" for complaint in compare(scene, now, before)]
    complaints += [f"{scene}: is in the baseline only" for scene in baseline["scenes"] if scene not in results]
    for complaint in complaints:
        print(f"callgrind.py: {complaint}", file=sys.stderr)
    if not complaints:
        return 0
    if build != {key: baseline[key] for key in build}:
        print(f"callgrind.py: the baseline was made by {baseline['compiler']} {baseline['flags']}", file=sys.stderr)
    print("callgrind.py: if this is meant, run bench/callgrind.py --update and commit bench/baseline.json", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
