#!/usr/bin/python3
"""Makes the pictures of the documents with the library's own renderer.

    make.py BIN [NAME…]    BIN: the folder of a build's programs, build/release/bin

Without names all: `parameters` (three values of each parameter, beside each other), `tutorial` (a picture for each stage) `moving` (the
README's), `foam` and `view` (pbf-view's, where the build has it). `mill-wheel` is the program in docs/shapes.md. Writes WebP files beside itself. Needs python3-pil. Bits, and so pictures, may differ on other instruction sets.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image, ImageDraw, ImageFont

HERE = pathlib.Path(__file__).resolve().parent
SCENES = HERE / "scenes"
BACKGROUND = (13, 18, 32)
GAP = 6

# name: scene, time at which it is drawn, speed of the last colour, [(label, settings)], options
PARAMETERS = {
    "spacing": ("drop-into-pool", 0.75, 4, [(f"d = {d}", "", n) for d, n in
                                           (("0.1", "--finer 0.5"), ("0.05", ""), ("0.033", "--finer 1.5"))]),
    "smoothing_radius": (SCENES / "basin.json", 2, 2, [("h = 2 d", "smoothing_radius=0.08", ""), ("h = 2.5 d", "smoothing_radius=0.1", ""),
                                                       ("h = 3 d", "smoothing_radius=0.12", "")]),
    "time_step": (SCENES / "basin.json", 3, 1, [("1/30 s", "time_step=0.0333333333333333", ""), ("1/120 s", "time_step=0.00833333333333333", ""),
                                          ("1/480 s", "time_step=0.00208333333333333", "")]),
    "iterations": (SCENES / "deep.json", 2, 1, [("1", "pressure_grid=0 iterations=1", ""), ("4", "pressure_grid=0 iterations=4", ""),
                                                ("16", "pressure_grid=0 iterations=16", "")]),
    "pressure_grid": (SCENES / "deep.json", 2, 1, [("0: none", "pressure_grid=0", ""), ("−1: where it is deep", "pressure_grid=-1", ""),
                                                   ("2", "pressure_grid=2", "")]),
    "viscosity": ("drop-into-pool", 0.75, 4, [("0", "viscosity=0", ""), ("0.02", "viscosity=0.02", ""), ("0.2", "viscosity=0.2", "")]),
    "vorticity": (SCENES / "basin.json", 2.5, 1.5, [("0", "vorticity=0", ""), ("0.03", "vorticity=0.03", ""), ("0.12", "vorticity=0.12", "")]),
    "scorr_k": (SCENES / "basin.json", 0.5, 3, [("0", "scorr_k=0", ""), ("0.01 h²", "scorr_k=0.000144", ""), ("0.3 h²", "scorr_k=0.0043", "")]),
    "wall_density": (SCENES / "basin.json", 3, 1, [("0", "wall_density=0", ""), ("0.5", "wall_density=0.5", ""), ("1", "wall_density=1", "")]),
    "damping_compensation": (SCENES / "basin.json", 4, 1.5, [("0", "damping_compensation=0", ""), ("0.5", "damping_compensation=0.5", ""),
                                                            ("1", "damping_compensation=1", "")]),
    "drag": ("drop-into-pool", 0.6, 4, [("0", "drag=0", ""), ("2", "drag=2", ""), ("8", "drag=8", "")]),
    "gravity": ("dam-break-2d", 0.75, 6, [("−1.6: the Moon", "gravity.1=-1.6", ""), ("−9.81", "gravity.1=-9.81", ""), ("−25: Jupiter", "gravity.1=-25", "")]),
    "attraction": ("zero-gravity-drop", 1.5, 1.5, [("0", "attraction=0", ""), ("1", "attraction=1", ""), ("10", "attraction=10", "")]),
    "surface_tension": (SCENES / "cube.json", 1, 0.5, [("0", "surface_tension=0", ""), ("0.01", "surface_tension=0.01", ""),
                                                      ("0.05", "surface_tension=0.05", "")]),
    "wall_friction": (SCENES / "heap.json", 0.5, 4, [("0", "wall_friction=0", ""), ("0.3", "wall_friction=0.3", ""), ("1", "wall_friction=1", "")]),
    "wall_no_slip": (SCENES / "heap.json", 1, 2, [("0", "viscosity=0.1 wall_no_slip=0", ""), ("0.5", "viscosity=0.1 wall_no_slip=0.5", ""),
                                                 ("1", "viscosity=0.1 wall_no_slip=1", "")]),
    "wall_adhesion": (SCENES / "drop.json", 21, 0.2, [("0.1: 143 degrees", "wall_adhesion=0.1", ""), ("0.5: 90 degrees", "wall_adhesion=0.5", ""),
                                                      ("0.75: 60 degrees", "wall_adhesion=0.75", "")]),
    "wall_amplitude": (SCENES / "wave-maker.json", 3.5, 1.5, [("0", "wall_amplitude.0=0 wall_frequency.0=3", ""), ("0.1", "wall_amplitude.0=0.1 wall_frequency.0=3", ""),
                                                             ("0.2", "wall_amplitude.0=0.2 wall_frequency.0=3", "")]),
    "periodic": (SCENES / "wind.json", 0.6, 4, [("walls", "drag=2", ""), ("periodic along x", "periodic=x", "")]),
    "prestabilization": (SCENES / "packed.json", 0.1, 4, [("0: never", "prestabilization=0", ""), ("0.02", "prestabilization=0.02", "")]),
    "max_substeps": (SCENES / "long-steps.json", 2, 3, [("0", "max_substeps=0", ""), ("2", "max_substeps=2", ""), ("8", "max_substeps=8", "")]),
    "solver": ("dam-break-2d", 0.75, 6, [
        ("the paper's", "solver=jacobi kernel=poly6_spiky over_relaxation=1 cohesion=1 min_diagonal=0 wall_density=0 cfm=1.5", ""),
        ("Jacobi", "solver=jacobi", ""), ("Chebyshev", "solver=chebyshev", "")]),
}
VIEWS = {"cube": "-0.8 -0.6 -0.6 0.8 0.6 0.6", "zero-gravity-drop": "-1.3 -0.9 -0.9 1.3 0.9 0.9", "dam-break-2d": "0 0 3 2.05", "drop": "0.2 0 0.2 1.4 0.7 1.4", "wave-maker": "-0.25 0 2 1.2"}
WIDTHS = {"iterations": 190, "pressure_grid": 190}  # a column's pixels, 260 of others
HEIGHT_OF_LABEL = 20


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"make.py: {' '.join(map(str, command))}\n{done.stderr}")


def font(size):
    for name in ("DejaVuSans.ttf", "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"):
        try:
            return ImageFont.truetype(name, size)
        except OSError:
            continue
    sys.exit("make.py: the font DejaVu Sans is missing (fonts-dejavu-core)")


def time_step_of(scene, settings, finer):
    path = scene if isinstance(scene, pathlib.Path) else HERE.parents[1] / "bench/scenes" / f"{scene}.json"
    step = json.loads(path.read_text())["params"]["time_step"]
    for setting in settings:
        if setting.startswith("time_step="):
            step = float(setting.partition("=")[2])
    return step / (float(finer.split()[1]) if finer else 1)


def frame(programs, folder, scene, time, fastest, setting, finer, width):
    settings = [each for each in setting.split() if "=" in each]
    steps = round(time / time_step_of(scene, settings, finer))
    view = VIEWS.get(scene if isinstance(scene, str) else scene.stem)
    run(programs / "pbf-bench", "run", "--scene", scene, "--backend", "threads", "--steps", steps, "--pictures", folder,
        "--width", width, "--fastest", fastest, *[word for each in settings for word in ("--set", each)], *finer.split(),
        *(["--view", *view.split()] if view else []))
    return Image.open(folder / f"{steps:06d}.png").convert("RGB")


def parameters(programs):
    for name, (scene, time, fastest, values) in PARAMETERS.items():
        parameter(programs, name, scene, time, fastest, values)


def parameter(programs, name, scene, time, fastest, values):
    with tempfile.TemporaryDirectory() as folder:
        frames = [frame(programs, pathlib.Path(folder) / str(i), scene, time, fastest, setting, finer, WIDTHS.get(name, 260))
                  for i, (_, setting, finer) in enumerate(values)]
    width = sum(each.width for each in frames) + GAP * (len(frames) - 1)
    sheet = Image.new("RGB", (width, max(each.height for each in frames) + HEIGHT_OF_LABEL), BACKGROUND)
    x = 0
    for (label, _, _), picture in zip(values, frames):
        ImageDraw.Draw(sheet).text((x + 4, 3), label, (200, 208, 224), font(12))
        sheet.paste(picture, (x, HEIGHT_OF_LABEL))
        x += picture.width + GAP
    write(sheet, f"{name}.webp")


def tutorial(programs):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        states = []
        for stage in ("1_dam", "2_cup", "3_tap", "4_machine"):
            states.append(folder / f"tutorial_{stage}.state")
            run(programs / f"tutorial_{stage}", states[-1])
        run(programs / "pbf-bench", "picture", "--width", 480, "--folder", folder, *states)
        for state in states:
            write(Image.open(state.with_suffix(".png")).convert("RGB"), state.with_suffix(".webp").name)


def moving(programs):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        run(programs / "tutorial_5_frames", folder, 0.03)
        run(programs / "pbf-bench", "picture", "--width", 520, "--fastest", 5, "--folder", folder, *sorted(folder.glob("*.state")))
        frames = [Image.open(path).convert("RGB") for path in sorted(folder.glob("*.png"))[::2]]
    out = HERE / "moving.webp"
    frames[0].save(out, save_all=True, append_images=frames[1:], duration=1000 // 15, loop=0, quality=45, method=6)
    print(f"{out.name}: {out.stat().st_size // 1000} KB, {len(frames)} frames")
    write(frames[38], "tutorial_5_frames.webp")


def foam(programs):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        run(programs / "foam", folder / "foam.ply", folder / "foam.state")
        run(programs / "pbf-bench", "picture", "--width", 620, "--folder", folder, folder / "foam.state")
        write(Image.open(folder / "foam.png").convert("RGB"), "foam.webp")


def view(programs):
    with tempfile.TemporaryDirectory() as name:
        path = pathlib.Path(name) / "view.png"
        run(programs / "pbf-view", "--scene", "drop-into-pool", "--headless", 100, "--width", 1000, "--height", 640, "--panel", "--picture", path)
        write(Image.open(path).convert("RGB"), "view.webp")


def write(picture, name):
    picture.save(HERE / name, quality=72, method=6)
    print(f"{name}: {(HERE / name).stat().st_size // 1000} KB")


def main(programs, *names):
    programs = pathlib.Path(programs).resolve()
    every = {"parameters": parameters, "tutorial": tutorial, "moving": moving, "foam": foam, "view": view}
    for name in names or every:
        if name in every:
            every[name](programs)
        elif name in PARAMETERS:
            parameter(programs, name, *PARAMETERS[name])
        else:
            sys.exit(f"make.py: {name} is none of {', '.join([*every, *PARAMETERS])}")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(*sys.argv[1:])
