"""Writes lime.png, the leaf of a lime tree with a transparent background, for lime.rgg:

    cd examples/textures && python3 make_leaf.py

The outline is a heart with small teeth, the veins are lines of lighter green; sRGB, 8 bits, and nothing but Python is needed."""
import math, struct, zlib

WIDTH, HEIGHT = 96, 112
FINE = 4  # points per pixel and axis


def half_width(t):
    """Half the width at height t (0 base, 1 tip), in widths of the picture."""
    heart = 0.62 * math.sin(math.pi * t ** 0.62) ** 0.8 * (1 - 0.25 * t)
    teeth = 0.014 * (1 - abs(1 - 2 * (t * 26 % 1)))
    return max(0.0, 0.8 * heart - teeth) if 0 < t < 1 else 0.0


def color(x, y):
    """Red, green, blue and coverage at x (-0.5..0.5) and y (0 below, 1 above)."""
    if y < 0.12 and abs(x) < 0.012:
        return 122, 140, 70, 1
    t = (y - 0.06) / 0.92
    lobe = 0.06 * (1 - min(1, abs(x) / 0.16))  # the notch of the heart
    if t < lobe or abs(x) > half_width(t):
        return 0, 0, 0, 0
    side = abs(x)
    vein = (t - 0.75 * side) * 7
    is_vein = side < 0.010 or abs(vein - round(vein)) < 0.055 * (1 - 0.8 * side) and side > 0.005
    shade = 1 - 0.18 * math.cos(2 * math.pi * (vein - 0.5)) * 0.5 - 0.12 * side
    base = (150, 172, 92) if is_vein else (92, 138, 48)
    return tuple(c * shade for c in base) + (1,)


rows = []
for j in range(HEIGHT):
    row = bytearray([0])
    for i in range(WIDTH):
        sums = [0.0] * 4
        for k in range(FINE * FINE):
            x = (i + (k % FINE + 0.5) / FINE) / WIDTH - 0.5
            y = 1 - (j + (k // FINE + 0.5) / FINE) / HEIGHT
            *rgb, a = color(x, y)
            for c in range(3):
                sums[c] += rgb[c] * a
            sums[3] += a
        n = sums[3]
        row += bytes([*(round(s / n) if n else 0 for s in sums[:3]), round(255 * n / FINE ** 2)])
    rows.append(bytes(row))
chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 6, 0, 0, 0)
with open("lime.png", "wb") as h:
    h.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"".join(rows), 9)) + chunk(b"IEND", b""))
