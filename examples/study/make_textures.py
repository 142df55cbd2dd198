"""Writes the pictures that complex_room.rgg lays on its surfaces, planks.png, tiles.png and print.png, each a few kilobytes:

    cd examples/study && python3 make_textures.py

They are computed from waves and a counter-based hash, in sRGB, and need nothing but Python."""
import math, struct, zlib


def hashed(*keys):
    """A number in 0..1 that belongs to whole numbers."""
    return zlib.crc32(struct.pack("<%di" % len(keys), *keys)) / 2 ** 32


def smooth(x, y, period, seed):
    """Value noise that repeats after `period` cells along x and y."""
    i, j = math.floor(x), math.floor(y)
    u, v = x - i, y - j
    u, v = u * u * (3 - 2 * u), v * v * (3 - 2 * v)
    at = lambda a, b: hashed((i + a) % period[0], (j + b) % period[1], seed)
    low = at(0, 0) * (1 - u) + at(1, 0) * u
    high = at(0, 1) * (1 - u) + at(1, 1) * u
    return low * (1 - v) + high * v


def mixed(a, b, t):
    return [x + (y - x) * t for x, y in zip(a, b)]


def planks(x, y):
    """Three boards across, each two lengths, with grain along y."""
    board = int(x * 3)
    across = x * 3 - board
    along = (y + (0.0, 0.37, 0.71)[board]) % 1
    length = int(along * 2)
    seam = min(across, 1 - across) < 0.018 or min(along * 2 % 1, 1 - along * 2 % 1) < 0.008
    wave = 2.5 * smooth(x * 6, y * 2, (6, 2), 3 + length)
    grain = 0.5 + 0.5 * math.sin(2 * math.pi * (across * 5 + wave))
    tone = hashed(board, length, 7)
    light, dark = mixed([196, 146, 92], [172, 118, 70], tone), mixed([150, 100, 58], [128, 82, 46], tone)
    return [40, 24, 14] if seam else mixed(dark, light, 0.35 + 0.65 * grain)


def tiles(x, y):
    """Four by four glazed tiles with gray joints, a blue lozenge on every other."""
    i, j = int(x * 4), int(y * 4)
    u, v = x * 4 - i - 0.5, y * 4 - j - 0.5
    if max(abs(u), abs(v)) > 0.47:
        return [150, 146, 138]
    shade = 0.9 + 0.1 * hashed(i, j, 11)
    inside = (i + j) % 2 == 0 and abs(u) + abs(v) < 0.3
    ring = (i + j) % 2 == 0 and 0.33 < abs(u) + abs(v) < 0.38
    return [c * shade for c in ([58, 96, 150] if inside or ring else [232, 226, 212])]


def print_(x, y):
    """A sun over hills, in a white border."""
    if min(x, 1 - x) < 0.07 or min(y, 1 - y) < 0.05:
        return [238, 234, 224]
    y = 1 - y
    for level, bend, color in ((0.30, 0.05, [38, 70, 62]), (0.42, 0.07, [78, 122, 92]), (0.52, 0.09, [150, 172, 120])):
        if y < level + bend * math.sin(2 * math.pi * (1.3 * x + level * 5)):
            return color
    if math.hypot(x - 0.62, (y - 0.72) * 1.4) < 0.13:
        return [236, 120, 52]
    return mixed([246, 214, 150], [108, 156, 186], min(1, (y - 0.4) * 1.7))


def write(name, width, height, color):
    rows = []
    for j in range(height):
        row = bytearray([0])
        for i in range(width):
            row += bytes(min(255, max(0, round(c))) for c in color((i + 0.5) / width, (j + 0.5) / height))
        rows.append(bytes(row))
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    with open(name, "wb") as h:
        h.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"".join(rows), 9)) + chunk(b"IEND", b""))


write("planks.png", 96, 128, planks)
write("tiles.png", 128, 128, tiles)
write("print.png", 96, 128, print_)
