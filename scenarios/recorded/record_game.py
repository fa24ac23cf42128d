#!/usr/bin/env python3
"""Records game.jsonl, the game that the scene `game` of `springtower profile` plays: record_game.py VIEWER

VIEWER is springtower-viewer (build/release/bin/springtower-viewer). A mouse that moves as a hand does plays in it, without a
display, on the usual tower of 18 rows: it draws out a loose block, with pauses and once back again, lifts it, hesitates above the
top and lays it down; then a second one; then it draws a block that carries the tower, fast, and the tower falls. The viewer records
the inputs of each frame. Kept are the scene and the inputs, with ten decimals; not the hashes, since those of every change of the
physics would differ: they are pinned (tests/data/pinned.json).

Places of the mouse are pixels of the window of 1280 x 800 as it opens. Where another change moves blocks by more than some pixels
they have to be read anew from pictures (`springtower-viewer --headless --overlay hints --png DIR`); and where frames shift, the
parts whose instructions are counted (recorded_game.cpp) shift with them, as a test says.
"""

import json
import pathlib
import random
import subprocess
import sys
import tempfile

TARGET = pathlib.Path(__file__).resolve().parent / "game.jsonl"
OUT_OF_THE_LEFT_FACE = (-0.81, 0.58)  # where a block goes that is drawn out of it, of a pixel
OUT_OF_THE_RIGHT_FACE = (0.925, 0.38)
AFTER_THE_FALL = 90  # pictures
LETS_GO_BEFORE = 10  # frames before the first block touches the floor


class Mouse:
    """A mouse in a hand: strokes that begin and end slowly, a fast tremor of half a pixel and a slow wander of a pixel or two."""

    def __init__(self, x, y):
        self.x, self.y = x, y
        self.random = random.Random(18)
        self.tremor, self.wander = [0.0, 0.0], [0.0, 0.0]
        self.lines = []

    def noise(self):
        return sum(self.random.random() for _ in range(4)) - 2.0

    def show(self, x, y, act=""):
        for axis in range(2):
            self.tremor[axis] = 0.6 * self.tremor[axis] + 0.5 * self.noise()
            self.wander[axis] = 0.97 * self.wander[axis] + 0.4 * self.noise()
        x += self.tremor[0] + self.wander[0]
        y += self.tremor[1] + self.wander[1]
        self.lines.append(f"{len(self.lines) + 1} {x:.1f} {y:.1f} {act}".rstrip())

    def wait(self, pictures):
        for _ in range(pictures):
            self.show(self.x, self.y)

    def press(self):
        self.show(self.x, self.y, "press")

    def release(self):
        self.show(self.x, self.y, "release")

    def stroke(self, dx, dy, pictures):
        """The least jerk from rest to rest."""
        for i in range(1, pictures + 1):
            share = i / pictures
            done = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
            self.show(self.x + done * dx, self.y + done * dy)
        self.x += dx
        self.y += dy

    def go(self, x, y, pictures):
        self.stroke(x - self.x, y - self.y, pictures)

    def draw(self, way, *strokes):
        """Strokes along a way, each of so many pixels in so many pictures, and a rest after it."""
        for pixels, pictures, rest in strokes:
            self.stroke(pixels * way[0], pixels * way[1], pictures)
            self.wait(rest)


def play():
    mouse = Mouse(900, 250)
    mouse.wait(20)
    # The middle block of the fourth row. It comes a little, goes back, and comes out in four pulls.
    mouse.go(640, 560, 25)
    mouse.wait(8)
    mouse.go(594, 597, 14)
    mouse.wait(12)
    mouse.press()
    mouse.wait(4)
    mouse.draw(OUT_OF_THE_LEFT_FACE, (45, 24, 12), (-12, 9, 16), (72, 30, 10), (60, 22, 14), (-6, 6, 0), (60, 26, 12))
    # Up, over the top, a look, some pixels back and forth; the right place seems to be found.
    mouse.stroke(-6, -60, 22)
    mouse.wait(9)
    mouse.stroke(10, -50, 26)
    mouse.wait(12)
    mouse.stroke(110, 25, 28)
    mouse.wait(12)
    mouse.stroke(95, 30, 24)
    mouse.wait(14)
    mouse.stroke(-14, -10, 9)
    mouse.wait(10)
    mouse.stroke(8, 9, 10)
    mouse.wait(15)
    mouse.release()
    mouse.wait(20)
    # It looks on while the block is laid down, then for the next one: the middle block of the ninth row.
    mouse.go(860, 560, 40)
    mouse.wait(50)
    mouse.go(690, 470, 30)
    mouse.wait(10)
    mouse.go(702, 438, 12)
    mouse.wait(12)
    mouse.press()
    mouse.wait(3)
    mouse.draw(OUT_OF_THE_RIGHT_FACE, (30, 14, 8), (40, 18, 22), (-14, 10, 6), (80, 30, 12), (110, 34, 10))
    mouse.stroke(4, -70, 24)
    mouse.wait(10)
    mouse.stroke(-90, -10, 26)
    mouse.wait(14)
    mouse.stroke(-60, 5, 20)
    mouse.wait(8)
    mouse.stroke(10, -6, 8)
    mouse.wait(12)
    mouse.release()
    mouse.wait(71)
    # A block that is tight, beside where the first one was: without it the tower falls. One fast pull.
    mouse.go(600, 520, 35)
    mouse.wait(10)
    mouse.go(564, 573, 24)
    mouse.wait(7)
    mouse.go(556, 587, 9)
    mouse.wait(9)
    mouse.press()
    mouse.wait(2)
    mouse.draw(OUT_OF_THE_LEFT_FACE, (260, 24, 60))
    mouse.wait(AFTER_THE_FALL)
    return mouse.lines


def kept(line):
    """A line of the recording without its hash, the hand's numbers to ten decimals."""
    frame = json.loads(line)
    frame.pop("hash", None)
    for key, value in frame.get("hand", {}).items():
        if key != "block":
            frame["hand"][key] = [round(one, 10) for one in value] if isinstance(value, list) else round(value, 10)
    return frame


def letGoEarly(frames):
    """The hand lets go some frames before the game is over, which it is in another frame when the physics changes a little."""
    last = max(at for at, frame in enumerate(frames) if "hand" in frame)
    for frame in frames[last + 1 - LETS_GO_BEFORE : last + 1]:
        frame.pop("hand", None)
    return frames


def main():
    if len(sys.argv) != 2 or sys.argv[1] in ("-h", "--help"):
        sys.exit(__doc__)
    lines = play()
    with tempfile.TemporaryDirectory() as scratch:
        mouse, recorded = (pathlib.Path(scratch) / name for name in ("mouse", "recorded.jsonl"))
        mouse.write_text("\n".join(lines) + "\n")
        game = ["--headless", "--players", "1", "--scene", "tower:18", "--size", "1280x800", "--frames", str(len(lines))]
        subprocess.run([sys.argv[1], *game, "--mouse", str(mouse), "--record", str(recorded)], check=True)
        frames = letGoEarly([kept(line) for line in recorded.read_text().splitlines()])
    TARGET.write_text("".join(json.dumps(frame, separators=(",", ":")) + "\n" for frame in frames))
    held = sum("hand" in frame for frame in frames)
    print(f"{TARGET.name}: {len(frames) - 1} frames, {held} of them with a block in the hand, {TARGET.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
