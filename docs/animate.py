#!/usr/bin/env python3
"""Makes a moving picture of the frames of springtower-viewer --png: docs/animate.py FOLDER OUT.png [--first N] [--left PIXELS]

Frames before the Nth file are left out (default 1), and so are PIXELS columns at the left. Each is shown for 1/15 s, the last for 1.5 s.
OUT.png is an animated PNG, which browsers show as such and all else as its first frame.
"""
import argparse
import pathlib
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from generator import animation  # noqa: E402


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--left", type=int, default=0)
    arguments = parser.parse_args()
    files = sorted(arguments.folder.glob("frame-*.png"))[arguments.first - 1:]
    if len(files) < 2:
        sys.exit(f"animate.py: expected at least two frame-*.png in {arguments.folder}, got {len(files)}")
    frames = [[row[3 * arguments.left:] for row in animation.read_png(file)[2]] for file in files]
    animation.write(arguments.out, frames, [67] * (len(frames) - 1) + [1500])


if __name__ == "__main__":
    main()
