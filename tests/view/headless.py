"""headless.py PBF_VIEW SCENES FOLDER: what pbf-view draws without a display.

Expected places in pictures follow from the scene files: where the lattice of a block starts, and that a column of water falls to
the right."""
import json
import shutil
import subprocess
import sys
from pathlib import Path

try:
    import numpy as np
    from matplotlib.image import imread
except ImportError as missing:
    print(missing)
    sys.exit(77)

PROGRAM, SCENES, WORK = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
WIDTH, HEIGHT = 640, 480


def run(*words, code=0):
    done = subprocess.run([PROGRAM, "--width", str(WIDTH), "--height", str(HEIGHT), *words], capture_output=True, text=True)
    if code == 0 and done.returncode == 3 and "without a display" in done.stderr:
        print(done.stderr)
        sys.exit(77)
    assert done.returncode == code, (words, done.returncode, done.stderr)
    return done.stdout if code == 0 else done.stderr


def picture(*words):
    path = WORK / "picture.png"
    path.unlink(missing_ok=True)
    run(*words, "--picture", str(path))
    pixels = (255 * imread(path)[..., :3]).round().astype(int)
    assert pixels.shape == (HEIGHT, WIDTH, 3), pixels.shape
    return pixels


def water(pixels):
    """Where there is neither background nor the grey of lines: the colours of the scale have a strong hue."""
    return pixels.max(axis=2) - pixels.min(axis=2) > 60


def extent(mask):
    rows, columns = np.nonzero(mask)
    return columns.min(), columns.max() + 1, rows.min(), rows.max() + 1


def test_block_is_where_the_scene_has_it():
    scene = json.loads((SCENES / "dam-break-2d.json").read_text())
    size = scene["params"]["domain_max"]
    block = scene["blocks"][0]["max"]
    scale = min(WIDTH / size[0], HEIGHT / size[1]) / 1.06  # pixels for a length; the margin is a camera's choice
    left, right, top, bottom = extent(water(picture("--scene", "dam-break-2d", "--headless", "0")))
    assert abs(right - left - scale * block[0]) < 4, (left, right)
    assert abs(bottom - top - scale * block[1]) < 4, (top, bottom)
    assert abs(left - (WIDTH - scale * size[0]) / 2) < 4, left
    assert abs(bottom - (HEIGHT + scale * size[1]) / 2) < 4, bottom


def test_fast_water_is_red_and_in_front():
    pixels = picture("--scene", "dam-break-3d", "--headless", "40")
    red = water(pixels) & (pixels[..., 0] > pixels[..., 2] + 60)
    blue = water(pixels) & (pixels[..., 2] > pixels[..., 0] + 60)
    assert red.sum() > 200 and blue.sum() > 2000, (red.sum(), blue.sum())
    assert np.nonzero(red)[1].mean() > np.nonzero(blue)[1].mean() + 0.1 * WIDTH


def test_pressure_grows_downwards():
    pixels = picture("--scene", "dam-break-2d", "--headless", "30", "--color", "pressure")
    red = water(pixels) & (pixels[..., 0] > pixels[..., 2] + 60)
    blue = water(pixels) & (pixels[..., 2] > pixels[..., 0] + 60)
    assert np.nonzero(red)[0].mean() > np.nonzero(blue)[0].mean() + 0.1 * HEIGHT


def test_panel_is_drawn_over_the_picture():
    plain = picture("--scene", "dam-break-2d", "--headless", "0")
    panel = picture("--scene", "dam-break-2d", "--headless", "0", "--panel")
    differ = (plain != panel).any(axis=2)
    left, right, top, bottom = extent(differ)
    assert left < 20 and bottom > HEIGHT - 20 and right < 0.8 * WIDTH, (left, right, top, bottom)


def test_same_pictures_again():
    words = ("--scene", "drop-into-pool", "--headless", "10")
    assert (picture(*words) == picture(*words)).all()


def test_folder_gets_a_picture_for_each_few_steps():
    folder = WORK / "frames"
    shutil.rmtree(folder, ignore_errors=True)
    run("--scene", "dam-break-2d", "--headless", "6", "--every", "2", "--record", str(folder))
    names = sorted(path.name for path in folder.iterdir())
    assert names == ["000000.png", "000001.png", "000002.png", "000003.png"], names
    first, last = imread(folder / names[0]), imread(folder / names[-1])
    assert first.shape == (HEIGHT, WIDTH, 3) and (first != last).any()


def test_sentences():
    assert "there is no scene" in run("--scene", "nix", "--headless", "0", code=2)
    assert "keeps no pressure" in run("--set", "solver=jacobi", "--color", "pressure", "--headless", "0", code=1)
    assert "--picture" in run("--picture", "x.png", code=2)
    assert "can't be written" in run("--headless", "0", "--picture", str(WORK / "no" / "x.png"), code=1)


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            print(name)
