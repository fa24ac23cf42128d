#!/usr/bin/env python3
"""Holds docs/reports.md against what the programs write: report_keys.py BIN_DIR

Every key of a report is on the page between backticks, and every word between backticks that looks like a key is one of a report, or
a value of a key. Prints each that is missing; exit code 1 where there is any.
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PAGE = "docs/reports.md"
# Words of the page that are values of keys, and a setting.
VALUES = {"complete", "out_of_time", "cancelled", "floor", "falls", "continuous_tests"}
SCENE = """seconds = 30.0
[tower]
code = "(111)-(111)-(111)"
[[force]]
block = 8
force_n = [0.01, 0.0, 0.0]
start_s = 0.0
end_s = 60.0
[[moves]]
do = "take"
row = 1
position = 3
towards = "+x"
speed_m_s = 0.04
allowed_m = 0.001
"""


def keys(value):
    """All keys of a JSON value, at any depth."""
    if isinstance(value, dict):
        for key, part in value.items():
            yield key
            yield from keys(part)
    elif isinstance(value, list):
        for part in value:
            yield from keys(part)


def report(program, folder, command, *arguments):
    file = folder / f"{command}.json"
    subprocess.run([program, command, *arguments, "--report", file], check=True, stdout=subprocess.DEVNULL)
    return set(keys(json.loads(file.read_text())))


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    program = str(pathlib.Path(sys.argv[1], "springtower"))
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scene = folder / "scene.toml"
        scene.write_text(SCENE)
        written = report(program, folder, "run", scene, "--forces") | report(program, folder, "statics", "tower:3", "--contacts", "--pull", "1:2,+x")
    listed = set(re.findall(r"`([a-z][a-z0-9_]*)`", (ROOT / PAGE).read_text())) - VALUES
    for key in sorted(written - listed):
        print(f"{PAGE}: expected the key {key}, which a report has, found none")
    for key in sorted(listed - written):
        print(f"{PAGE}: expected keys of a report, found {key}, which none has")
    if written != listed:
        sys.exit(1)


if __name__ == "__main__":
    main()
