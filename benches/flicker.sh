#!/bin/sh
# How much films flicker at which cost: the tables of the README. Needs a built program and python3; five minutes on two quiet cores.
#
#     cargo build --release && benches/flicker.sh [target/release/understory]
#
# Cost is processor time (all cores together, so that a busy machine gives the same): that of more frames less that of two, over
# the number of frames between. Flicker is that of frames 10 and 11.
set -eu
program=$(realpath "${1:-target/release/understory}")
examples=$(realpath "$(dirname "$0")/../examples")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
PROGRAM=$program EXAMPLES=$examples python3 - <<'TABLE'
import json, os, resource, subprocess
program, examples = os.environ['PROGRAM'], os.environ['EXAMPLES']
def processor():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
n_runs = 0
def fly(model, size, words, n, pairs):
    """Processor seconds and report of a film of n frames, from frame 10 on."""
    global n_runs
    n_runs += 1
    before = processor()
    subprocess.run([program, 'fly', f'{examples}/{model}', '--size', size, '--orbit', '--flight-frames', '250', '--exposure', '0',
                    '--frames', f'10..{10 + n}', '--flicker', str(pairs), '-o', str(n_runs), '--report', 'report.json', '--quiet',
                    *words.split()], check=True, stdout=subprocess.DEVNULL)
    return processor() - before, json.load(open('report.json'))
def row(model, size, words, n):
    flicker = fly(model, size, words, 2, 1)[1]['flicker']
    seconds = (fly(model, size, words, 2 + n, 0)[0] - fly(model, size, words, 2, 0)[0]) / n
    print(f"| `{words}` | {seconds:.2f} | {flicker['flicker']:.2g} | {flicker['flicker_with_new_noise']:.2g} |", flush=True)
for model, size, rows in [
    ('study/cornell.rgg', '160x120', [
        ('--renderer path --samples 16', 8),
        ('--renderer radiosity --supersampling auto --samples 4', 16),
        ('--renderer radiosity --supersampling auto --samples 16', 8),
        ('--renderer radiosity --supersampling auto --samples 64', 8),
        ('--renderer photon --final-gather 0 --samples 64', 2),
        ('--renderer photon --global-photons 1000000 --caustic-photons 1000000 --final-gather 256 --samples 16', 2),
    ]),
    ('forest.rgg', '160x90', [
        ('--renderer path --samples 4', 2),
        ('--renderer path --samples 16', 2),
        ('--renderer raytracer --supersampling auto --samples 16', 2),
    ]),
]:
    print(f'\n`examples/{model}`, {size}\n\n| options | processor s per frame | flicker, levels | new random numbers in each frame |\n|---|---|---|---|')
    for words, n in rows:
        row(model, size, words, n)
TABLE
