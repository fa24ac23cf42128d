#!/usr/bin/env bash
# Makes docs/pictures/film.png, a film of eight seconds (a hint, a pull, the fall, and the fall again), without a display:
# docs/film.sh (after a Release build). The film is an animated PNG, which browsers show; Python packs it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
viewer=${1:-build/release/bin/springtower-viewer}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# Pictures of 1/60 s: the rules, the hint of a block that carries the tower, its pull, and the rest of the fall cut short.
cat >"$scratch/mouse" <<'MOUSE'
1 100 150
40 100 150
65 290 300
125 290 300 press
195 150 395
240 150 395 release
430 150 300 skip
MOUSE
"$viewer" --headless --mode play --players 1 --scene tower:18 --seed 1 --size 640x420 --mouse "$scratch/mouse" \
  --frames 480 --png-every 6 --png "$scratch/frames" --report "$scratch/report.json"

python3 - "$scratch/frames" docs/pictures/film.png <<'PYTHON'
"""Packs pictures into an animated PNG: colours in steps of 8, and of each picture the rectangle that has changed."""
import pathlib, struct, sys, zlib

def chunks(data):
    at = 8
    while at < len(data):
        size, = struct.unpack(">I", data[at:at + 4])
        yield data[at + 4:at + 8], data[at + 8:at + 8 + size]
        at += 12 + size

def pixels(path):
    """Width, height and rows of red, green, blue of a PNG of 8 bits without interlace."""
    parts = list(chunks(path.read_bytes()))
    width, height, depth, kind = struct.unpack(">IIBB", parts[0][1][:10])
    assert depth == 8 and kind in (2, 6), path
    step = 3 if kind == 2 else 4
    raw = zlib.decompress(b"".join(data for name, data in parts if name == b"IDAT"))
    rows, before = [], bytes(width * step)
    for y in range(height):
        start = y * (width * step + 1)
        how, line = raw[start], bytearray(raw[start + 1:start + 1 + width * step])
        for i in range(len(line) if how else 0):
            left = line[i - step] if i >= step else 0
            up = before[i]
            corner = before[i - step] if i >= step else 0
            near = min((left, up, corner), key=lambda v: abs(left + up - corner - v))
            line[i] = (line[i] + (0, left, up, (left + up) // 2, near)[how]) & 255
        before = bytes(line)
        rows.append(before)
    coarse = bytes(min(255, (v + 4) // 8 * 8) for v in range(256))
    if step == 4:
        rows = [b"".join(row[4 * x:4 * x + 3] for x in range(width)) for row in rows]
    return width, height, [row.translate(coarse) for row in rows]

def chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

def packed(rows):
    """The smaller of two filters for all rows: none, and the difference to the row above."""
    up = [rows[0]] + [bytes((a - b) & 255 for a, b in zip(row, above)) for above, row in zip(rows, rows[1:])]
    plain = zlib.compress(b"".join(b"\0" + row for row in rows), 9)
    other = zlib.compress(b"\0" + up[0] + b"".join(b"\2" + row for row in up[1:]), 9)
    return min(plain, other, key=len)

frames = sorted(pathlib.Path(sys.argv[1]).glob("frame-*.png"))
body, sequence, shown = b"", 0, None
for number, path in enumerate(frames):
    width, height, rows = pixels(path)
    x, y, part = 0, 0, rows
    if shown is not None:
        changed = [i for i in range(height) if rows[i] != shown[i]] or [0]
        y, end = changed[0], changed[-1] + 1
        columns = [i for i in range(width) if any(rows[j][3 * i:3 * i + 3] != shown[j][3 * i:3 * i + 3] for j in range(y, end))] or [0]
        x, right = columns[0], columns[-1] + 1
        part = [row[3 * x:3 * right] for row in rows[y:end]]
    hold = 1500 if path == frames[-1] else 100  # ms
    control = struct.pack(">IIIIIHHBB", sequence, len(part[0]) // 3, len(part), x, y, hold, 1000, 0, 0)
    sequence += 1
    body += chunk(b"fcTL", control)
    if number == 0:
        body += chunk(b"IDAT", packed(part))
    else:
        body += chunk(b"fdAT", struct.pack(">I", sequence) + packed(part))
        sequence += 1
    shown = rows
head = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) + chunk(b"acTL", struct.pack(">II", len(frames), 0))
pathlib.Path(sys.argv[2]).write_bytes(b"\x89PNG\r\n\x1a\n" + head + body + chunk(b"IEND", b""))
print(f"{sys.argv[2]}: {len(frames)} pictures, {pathlib.Path(sys.argv[2]).stat().st_size / 1e6:.2f} MB")
PYTHON
