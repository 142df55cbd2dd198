"""Writes S1.obj .. S4.obj, S4-leaves.obj, the colours S*.mtl and S4-trees.txt from the neutral files of the peers' scenes:

    python3 make_meshes.py PATH/TO/peers/scenes

The peers' world has y up, ours z: (x, y, z) there is (x, -z, y) here. Numbers are those of the binary files, in full."""
import json, os, struct, sys


def read_ply(path):
    with open(path, "rb") as h:
        nv = nf = 0
        while True:
            t = h.readline().decode().split()
            if t[:2] == ["element", "vertex"]:
                nv = int(t[2])
            elif t[:2] == ["element", "face"]:
                nf = int(t[2])
            elif t[0] == "end_header":
                break
        v = [struct.unpack("<3f", h.read(12)) for _ in range(nv)]
        f = [struct.unpack("<B3i", h.read(13))[1:] for _ in range(nf)]
    return v, f


def number(x):
    """The shortest text that is this 32-bit float."""
    for digits in range(1, 10):
        t = "%.*g" % (digits, x)
        if struct.pack("<f", float(t)) == struct.pack("<f", x):
            return t if t != "-0" else "0"


def write(name, parts, materials):
    with open(name + ".mtl", "w") as h:
        for m in sorted({m for _, _, m in parts}):
            h.write("newmtl %s\nKd %s\n" % (m, " ".join("%g" % c for c in materials[m]["reflectance"])))
    with open(name + ".obj", "w") as h:
        h.write("mtllib %s.mtl\n" % os.path.basename(name))
        base = 1
        for v, f, m in parts:
            h.write("usemtl %s\n" % m)
            for x, y, z in v:
                h.write("v %s %s %s\n" % (number(x), number(-z), number(y)))
            for t in f:
                h.write("f %d %d %d\n" % tuple(i + base for i in t))
            base += len(v)


def main(scenes):
    for name in ("S1", "S2", "S3", "S4"):
        d = os.path.join(scenes, name)
        s = json.load(open(os.path.join(d, "scene.json")))
        load = lambda o: read_ply(os.path.join(d, o["ply"])) + (o["material"],)
        parts = [load(o) for o in s["objects"] if o["type"] == "mesh" and s["materials"][o["material"]]["type"] == "diffuse"]
        if "instancing" in s:
            write("S4-ground", parts, s["materials"])
            for o in s["instancing"]["prototype"]:
                write("S4-" + o["name"].split("_")[1], [load(o)], s["materials"])
            m = json.load(open(os.path.join(d, s["instancing"]["transforms"])))["matrices"]
            with open("S4-trees.txt", "w") as h:
                # Each tree: where it stands, and the first column of its turn times its size.
                for t in m:
                    h.write("%.6f %.6f %.6f %.6f\n" % (t[3], -t[11], t[0], -t[8]))
        else:
            write(name, parts, s["materials"])


main(sys.argv[1])
