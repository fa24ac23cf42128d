"""Moving pictures (animated PNG) from the frames that springtower-viewer writes, with nothing but Python's library."""
import struct
import zlib

SIX_BITS = bytes(value & 0xFC for value in range(256))
SIGNATURE = b"\x89PNG\r\n\x1a\n"


def read_png(path):
    """(width, height, rows) of a PNG of 8 bits a channel, RGB or RGBA; rows are bytes of RGB."""
    data = path.read_bytes()
    if data[:8] != SIGNATURE:
        raise SystemExit(f"{path}: expected a PNG, got something else")
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour, _, _, interlaced = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    if depth != 8 or colour not in (2, 6) or interlaced:
        raise SystemExit(f"{path}: expected RGB or RGBA of 8 bits, got depth {depth}, colour type {colour}")
    channels = 3 if colour == 2 else 4
    return width, height, [_rgb(row, channels) for row in _unfiltered(zlib.decompress(packed), width * channels, channels)]


def _rgb(row, channels):
    if channels == 3:
        return bytes(row)
    rgb = bytearray(len(row) // 4 * 3)
    for channel in range(3):
        rgb[channel::3] = row[channel::4]
    return bytes(rgb)


def _unfiltered(data, length, channels):
    """Rows without PNG's filters."""
    above = bytearray(length)
    for start in range(0, len(data), length + 1):
        kind, row = data[start], bytearray(data[start + 1:start + 1 + length])
        if kind == 1:
            for i in range(channels, length):
                row[i] = (row[i] + row[i - channels]) & 255
        elif kind == 2:
            for i in range(length):
                row[i] = (row[i] + above[i]) & 255
        elif kind == 3:
            for i in range(length):
                row[i] = (row[i] + ((row[i - channels] if i >= channels else 0) + above[i]) // 2) & 255
        elif kind == 4:
            for i in range(length):
                left, corner = (row[i - channels], above[i - channels]) if i >= channels else (0, 0)
                guess = left + above[i] - corner
                distances = abs(guess - left), abs(guess - above[i]), abs(guess - corner)
                nearest = left if distances[0] <= distances[1] and distances[0] <= distances[2] else (
                    above[i] if distances[1] <= distances[2] else corner)
                row[i] = (row[i] + nearest) & 255
        yield row
        above = row


def palette(frames, size=255):
    """The colours that stand for all others, by median cut, and a function from a colour to its number."""
    rows_found = {}
    for row in (row for rows in frames for row in rows):
        rows_found[row] = rows_found.get(row, 0) + 1
    counts = {}
    for row, times in rows_found.items():
        for colour in _colours(row):
            counts[colour] = counts.get(colour, 0) + times
    def extents(box):
        return [max(c[k] for c in box) - min(c[k] for c in box) for k in range(3)]
    boxes = [(max(extents(list(counts))), list(counts))]
    while len(boxes) < size:
        widest = max(boxes, key=lambda box: box[0])
        if widest[0] == 0:
            break
        boxes.remove(widest)
        channel = max(range(3), key=extents(widest[1]).__getitem__)
        ordered = sorted(widest[1], key=lambda c: (c[channel], c))
        middle = len(ordered) // 2
        for half in (ordered[:middle], ordered[middle:]):
            boxes.append((max(extents(half)) * sum(counts[c] for c in half) ** 0.25, half))
    colours, number = [], {}
    for index, (_, box) in enumerate(boxes):
        total = sum(counts[c] for c in box)
        colours.append(tuple(sum(c[k] * counts[c] for c in box) // total + 1 for k in range(3)))
        for colour in box:
            number[colour] = index
    return colours, number


def _colours(row):
    """The colours of a row, rounded to six bits a channel."""
    return zip(row[0::3].translate(SIX_BITS), row[1::3].translate(SIX_BITS), row[2::3].translate(SIX_BITS))


def _chunk(kind, body):
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def _changed(before, after):
    """(left, top, right, bottom) of what differs, at least one pixel."""
    rows = [y for y in range(len(after)) if before[y] != after[y]]
    if not rows:
        return 0, 0, 1, 1
    left = min(next(x for x in range(len(after[y])) if before[y][x] != after[y][x]) for y in rows)
    right = max(next(x for x in range(len(after[y]) - 1, -1, -1) if before[y][x] != after[y][x]) for y in rows)
    return left, rows[0], right + 1, rows[-1] + 1


def write(path, frames, delays_ms):
    """Writes frames (rows of RGB, all of one size), each shown for its time, as an animated PNG that repeats for ever."""
    colours, number = palette(frames)
    rows = {row: bytes(number[colour] for colour in _colours(row)) for picture in frames for row in set(picture)}
    pictures = [[rows[row] for row in picture] for picture in frames]
    same = len(colours)  # of a pixel that stays as it was in the picture before
    width, height = len(pictures[0][0]), len(pictures[0])
    out = [SIGNATURE, _chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)),
           _chunk(b"acTL", struct.pack(">II", len(pictures), 0)), _chunk(b"PLTE", bytes(v for c in [*colours, (0, 0, 0)] for v in c)),
           _chunk(b"tRNS", b"\xff" * same + b"\0")]
    sequence = 0
    for index, picture in enumerate(pictures):
        before = pictures[index - 1]
        left, top, right, bottom = _changed(before, picture) if index else (0, 0, width, height)
        part = [picture[y][left:right] for y in range(top, bottom)]
        if index:
            part = [bytes(same if new == old else new for new, old in zip(row, before[top + y][left:right])) for y, row in enumerate(part)]
        out.append(_chunk(b"fcTL", struct.pack(">IIIIIHHBB", sequence, right - left, bottom - top, left, top, delays_ms[index], 1000, 0, 1)))
        sequence += 1
        packed = zlib.compress(b"".join(b"\0" + row for row in part), 9)
        out.append(_chunk(b"fdAT", struct.pack(">I", sequence) + packed) if index else _chunk(b"IDAT", packed))
        sequence += 1 if index else 0
    out.append(_chunk(b"IEND", b""))
    path.write_bytes(b"".join(out))
