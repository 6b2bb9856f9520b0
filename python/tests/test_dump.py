"""What `pbf-bench run --dump` writes, read and taken to other programs."""
import json
import re
import subprocess
import sys
import xml.etree.ElementTree as xml

import numpy as np
import pytest

import pbf
from pbf.__main__ import main


@pytest.fixture
def folder(tmp_path, rng):
    """Three frames of four particles, as docs/accuracy.md describes them."""
    out = tmp_path / "dump"
    out.mkdir()
    about = {"dimension": 3, "smoothing_radius": 0.25, "spacing": 0, "gravity": [0, -9.81, 0],
             "domain_min": [0, 0, None], "domain_max": [1, 1, None], "time_step": 0.01,
             "times": {"20": 0.5}}
    (out / "dump.json").write_text(json.dumps(about))
    for step in (0, 10, 20):
        for what in ("positions", "velocities"):
            np.save(out / f"{what}_{step:06d}.npy", rng.random((4, 3), np.float32))
    np.save(out / "pressures_000020.npy", rng.random(4))
    return out


def test_frames(folder):
    dump = pbf.load_dump(folder)
    assert dump.steps == [0, 10, 20] and [frame.time for frame in dump] == [0, 0.1, 0.5]
    last = dump[-1]
    assert (last.positions == np.load(folder / "positions_000020.npy")).all()
    assert (last.pressures == np.load(folder / "pressures_000020.npy")).all()
    assert dump[0].pressures is None and [frame.step for frame in dump[1:]] == [10, 20]
    assert last.rest_distance == 0.125 and last.dimension == 3 and list(last.ids) == [0, 1, 2, 3]


def test_series_of_a_dump(folder, tmp_path, capsys):
    meshio = pytest.importorskip("meshio")
    assert main(["export", str(folder), str(tmp_path / "out" / "water.pvd")]) == 0
    assert capsys.readouterr().out.startswith("3 frames")
    sets = xml.parse(tmp_path / "out" / "water.pvd").findall(".//DataSet")
    assert [float(each.get("timestep")) for each in sets] == [0, 0.1, 0.5]
    last = meshio.read(tmp_path / "out" / sets[2].get("file"))
    assert (last.points == np.load(folder / "positions_000020.npy")).all()
    assert (last.point_data["pressure"] == np.load(folder / "pressures_000020.npy")).all()


def test_files_of_a_dump(folder, tmp_path):
    assert main(["export", str(folder), str(tmp_path / "out" / "water.ply")]) == 0
    assert sorted(each.name for each in (tmp_path / "out").iterdir()) == [
        "water_0000.ply", "water_0001.ply", "water_0002.ply"]
    assert b"property double pressure" in (tmp_path / "out" / "water_0002.ply").read_bytes()


@pytest.mark.parametrize("name, module", [("water.usdc", "pxr.Usd"), ("water.abc", "alembic3d.Abc")])
def test_points_of_a_dump(folder, tmp_path, name, module):
    pytest.importorskip(module)
    assert main(["export", str(folder), str(tmp_path / name), "--fps", "60"]) == 0
    assert (tmp_path / name).stat().st_size > 100


def test_what_is_wrong_is_said(folder, tmp_path, capsys):
    def refused(*arguments):
        assert main(["export", *map(str, arguments)]) == 1
        return capsys.readouterr().err

    assert "water.xyz" in refused(folder, tmp_path / "water.xyz")
    assert "surfaces" in refused(folder, tmp_path / "water.pvd", "--surface")
    assert "dump.json" in refused(tmp_path / "nothing", tmp_path / "water.ply")
    np.save(folder / "velocities_000010.npy", np.zeros((3, 3)))
    assert "velocities_000010.npy has shape (3, 3)" in refused(folder, tmp_path / "water.ply")
    (folder / "dump.json").write_text("{}")
    assert "has no dimension" in refused(folder, tmp_path / "water.ply")
    (folder / "dump.json").write_text("{")
    assert "is not JSON" in refused(folder, tmp_path / "water.ply")


@pytest.mark.parametrize("key, value", [
    ("dimension", None), ("dimension", [3]), ("dimension", 4), ("time_step", "abc"), ("time_step", None),
    ("spacing", "/dev/zero"), ("spacing", -1), ("gravity", 9.81), ("gravity", [0, 1]), ("gravity", [0, "a", 0]),
    ("domain_min", {"x": 0}), ("domain_max", [10**400, 1, 1]), ("times", []), ("times", {"20": "late"}),
    ("smoothing_radius", True)])
def test_members_that_are_wrong_are_named(folder, key, value):
    about = json.loads((folder / "dump.json").read_text())
    (folder / "dump.json").write_text(json.dumps({**about, key: value}))
    with pytest.raises(pbf.DataError, match=rf"dump.json: {key} is .*; it must be"):
        pbf.load_dump(folder)


def test_damaged_arrays_are_named(folder):
    path = folder / "positions_000010.npy"
    whole = path.read_bytes()
    damaged = [whole[:at] for at in range(0, len(whole), 7)]
    damaged += [whole[:at] + bytes([whole[at] ^ 1 << bit]) + whole[at + 1:] for at in range(128) for bit in range(8)]
    for content in damaged:
        path.write_bytes(content)
        try:
            assert pbf.load_dump(folder)[1].positions.shape == (4, 3)
        except pbf.DataError as error:
            assert path.name in str(error) or "_000010.npy" in str(error)
    for array in (np.zeros(12), np.array(1.0), np.zeros((4, 3), "U3"), np.zeros((4, 3), int)):
        np.save(path, array)
        with pytest.raises(pbf.DataError, match="positions_000010.npy holds .*; it must hold real numbers in 2"):
            pbf.load_dump(folder)[1]


def test_a_dump_without_end(tmp_path):
    (tmp_path / "dump.json").symlink_to("/dev/zero")
    with pytest.raises(pbf.DataError, match="dump.json has more than 16777216 bytes"):
        pbf.load_dump(tmp_path)


def test_output_that_is_lost_is_told(folder, tmp_path):
    export = f"{sys.executable} -m pbf export {folder} {tmp_path / 'water.ply'}"
    for command in (export, f"{sys.executable} -m pbf --help"):
        for where, words in (("> /dev/full", "No space left"), (">&-", "Bad file descriptor")):
            run = subprocess.run(["bash", "-c", f"{command} {where}"], capture_output=True, text=True, check=False)
            assert run.returncode == 1
            assert re.fullmatch(rf"pbf: the standard output can't be written: {words}.*\n", run.stderr)
        run = subprocess.run(["bash", "-c", f"( sleep 1; {command}; echo $? >&2 ) | true"], capture_output=True,
                             text=True, check=False)
        assert run.stderr == "1\n"
