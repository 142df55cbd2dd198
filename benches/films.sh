#!/bin/sh
# What films cost: a table for the README. Needs a built program and python3; about ten minutes on two quiet cores.
#
#     cargo build --release && benches/films.sh [target/release/understory]
#
# Trees of three forms stand on a grid with jitter, 4 m apart, with the camera 12 m above their middle. Few frames are made (three
# of each forest): one-time work and time per frame are read from the report, and the cost of 100 frames is worked out from them.
# Errors are those that the program estimates from the halves of its samples: the bias of photon mapping is not in them.
set -eu
program=$(realpath "${1:-target/release/understory}")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
cat > stand.rgg <<'MODEL'
module Tree extends Null;
module Top(int age);
module Limb(int order, float length);
const Phong LEAF = new Phong().(setDiffuse(new RGBColor(0.06, 0.13, 0.02)), setDiffuseTransparency(new RGBColor(0.09, 0.18, 0.02)));
static Tree[] stock = new Tree[3];
module Leaves ==> for (int i : 1:12) ([M(0.04 * i) RH(137.5 * i) RL(60) M(0.06) Parallelogram(0.14, 0.1).(setShader(LEAF))]);
void grow() [
	Top(t), (t < 16) ==> F(0.4, 0.02 + 0.01 * (16 - t))
		if (t > 3) for (int i : 1:3) ([RH(120 * i + random(-30, 30)) RL(random(45, 70)) Limb(1, 0.3 + 0.1 * (16 - t))])
		RH(random(50, 130)) Top(t + 1);
	Limb(o, l), (l > 0.3 && o < 3) ==> F(0.5 * l, 0.03 / o) Leaves [RU(45) Limb(o + 1, 0.6 * l)] [RU(-45) Limb(o + 1, 0.6 * l)] Limb(o, 0.6 * l);
	Limb(o, l) ==> Leaves;
]
module Land extends Null;
void nursery() [ Axiom ==> Land for (int k : 0:2) ([Null(4 * k, 2, 0) t:Tree Top(0) { stock[k] = t; }]); ]
void plant() [
	l:Land ==> l for (int i : 0:SIDE * SIDE - 1) (
		[
			Null(4 * (i % SIDE - SIDE / 2) + random(-1.5, 1.5), 4 * (i / SIDE - SIDE / 2) + random(-1.5, 1.5), 0)
			RH(random(0, 360)) Scale(random(0.7, 1.3)) Instance(stock[irandom(0, 2)])
		]
	);
]
protected void init() {
	nursery();
	derive();
	for (int i = 0; i < 20; i++) { grow(); derive(); }
	plant();
	derive();
}
MODEL
# fly SIDE NAME FLAGS…: a film over a forest of SIDE × SIDE trees, its report in NAME.json.
fly() {
	side=$1 name=$2
	shift 2
	{ echo "const int SIDE = $side;"; cat stand.rgg; } > "$name.rgg"
	timeout 300 "$program" fly "$name.rgg" -o "$name" --report "$name.json" --quiet --steps 0 --size 640x360 --quality draft \
		--flicker 0 --sun 230,40 --flight-frames 100 --key 'time=0 eye=-30,-30,12 target=10,10,4; time=4 eye=10,-10,12 target=40,40,4' "$@"
}
for side in 32 100 316 1000; do
	fly $side "path$side" --renderer path --frames 0..3
done
# One solve for 100 frames against 100 pictures that each grow, build and trace alone.
fly 100 photon --renderer photon --global-photons 300000 --final-gather 0 --frames 0..4
fly 100 single --renderer path --frames 0..1
python3 - <<'TABLE'
import json
def report(name):
    r = json.load(open(name + '.json'))
    s = r['seconds']
    frame = (s['render'] + s['write']) / r['frames'][0]
    once = sum(s.values()) - s['render'] - s['write']
    return r, frame, once
print('| trees | s per frame | once, s | share of the once in 100 frames | memory, MB |')
print('|---|---|---|---|---|')
for side in (32, 100, 316, 1000):
    r, frame, once = report(f'path{side}')
    print(f"| {side * side} | {frame:.2f} | {once:.2f} | {100 * once / (once + 100 * frame):.0f} % | {r['peak_memory_bytes'] / 1e6:.0f} |")
film, frame, once = report('photon')
one, path, alone = report('single')
equal = path * (one['relative_error'] / film['relative_error']) ** 2
print(f"\n100 frames after one solve: {once:.1f} s + 100 × {frame:.2f} s, error {film['relative_error']:.3f} each;")
print(f"100 separate pictures by path tracing: 100 × ({alone:.1f} s + {equal:.2f} s) at that error "
      f"({path:.2f} s at {one['relative_error']:.3f}).")
print(f"ratio {(once + 100 * frame) / (100 * (alone + equal)):.3f}")
TABLE
