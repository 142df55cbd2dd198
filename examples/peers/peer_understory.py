"""understory as one of the compared renderers: an adapter for their harness (README.md here says how it is called).

    python3 peer_understory.py --scene S1 --out x.npy --spp 64 --seed 1 --threads 2 [--harness DIR] [--program FILE]

Like the adapters there it writes a float32 array (height, width, 3) of linear radiance, top row first, and ends with one line
of JSON: wall and CPU seconds of start, setup and rendering. Needs numpy and OpenEXR (`pip install numpy OpenEXR`).

`--against REF.npy` also prints the harness' error against that picture, and the ratio of the means of each channel."""
import argparse, json, os, resource, subprocess, sys, tempfile
import numpy as np
import OpenEXR

HERE = os.path.dirname(os.path.abspath(__file__))


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--scene", required=True, help="S1 .. S4")
    p.add_argument("--out", required=True, help="the array to write")
    p.add_argument("--spp", type=int, default=16)
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--threads", type=int, default=2)
    p.add_argument("--program", default=os.path.join(HERE, "../../target/release/understory"))
    p.add_argument("--harness", help="folder of the peers (for --against)")
    p.add_argument("--against", help="reference to compare with, .npy")
    return p.parse_args()


def render(a, folder):
    """The picture, and the phases of the render with their seconds."""
    picture, report = os.path.join(folder, "x.exr"), os.path.join(folder, "x.json")
    # Linear pictures are not exposed; saying so spares the small render that would decide how much.
    subprocess.run([a.program, "render", os.path.join(HERE, a.scene + ".rgg"), "-o", picture, "--report", report, "--quiet",
                    "--exposure", "0", "--samples", str(a.spp), "--seed", str(a.seed), "--threads", str(a.threads)], check=True)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    wall = json.load(open(report))["seconds"]
    setup = sum(wall[phase] for phase in wall if phase not in ("render", "write"))
    rest = wall["render"] + wall["write"]
    # The program does not tell its processor time phase by phase: all of it stands with the render.
    seconds = {"start_s": 0.0, "setup_s": setup, "render_s": rest,
               "start_cpu_s": 0.0, "setup_cpu_s": 0.0, "render_cpu_s": used.ru_utime + used.ru_stime}
    channels = OpenEXR.File(picture).channels()
    image = channels["RGB"].pixels if "RGB" in channels else np.dstack([channels[c].pixels for c in "RGB"])
    return image[:, :, :3].astype(np.float32), {k: round(v, 3) for k, v in seconds.items()}


def compare(a, image):
    """Prints how far the picture is from the reference, by the harness' own measure."""
    sys.path.insert(0, a.harness or os.path.dirname(os.path.dirname(os.path.abspath(a.against))))
    from common import errors, light_mask, load_scene
    scene, reference = load_scene(a.scene), np.load(a.against)
    e = errors(image, reference, scene)
    dark = ~light_mask(reference, scene)
    ratio = image[dark].astype(float).mean(0) / reference[dark].astype(float).mean(0)
    print("relMSE %.4g  trimmed %.4g  8x8 %.3g  mean %.4f %.4f %.4f" % (e["relmse"], e["relmse_t"], e["relmse_b8"], *ratio))


def main():
    a = arguments()
    with tempfile.TemporaryDirectory() as folder:
        image, seconds = render(a, folder)
    np.save(a.out, image)
    if a.against:
        compare(a, image)
    print("\n" + json.dumps(seconds), flush=True)


if __name__ == "__main__":
    main()
