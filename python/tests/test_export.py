"""Files for other programs, read back by kept libraries where they are installed."""
import os
import threading
import xml.etree.ElementTree as xml
from contextlib import contextmanager

import numpy as np
import pytest

import pbf
from pbf import _files


def test_ply(dam, tmp_path):
    dam.step(3)
    path = tmp_path / "dam.ply"
    pbf.write_ply(path, dam, density=dam.densities)
    head, _, data = path.read_bytes().partition(b"end_header\n")
    assert b"element vertex 1000" in head and b"property float density" in head
    table = np.frombuffer(data, [(n, "<f4") for n in ("x", "y", "z", "vx", "vy", "vz")]
                          + [("id", "<u4"), ("density", "<f4")])
    assert (np.stack([table["x"], table["y"], table["z"]], axis=1) == dam.positions).all()
    assert (table["id"] == dam.ids).all() and (table["density"] == dam.densities).all()
    with pytest.raises(pbf.InvalidArgumentError, match="weight"):
        pbf.write_ply(path, dam, weight=np.zeros(3))
    meshio = pytest.importorskip("meshio")
    pbf.write_ply(path, dam)
    assert (meshio.read(path).points == dam.positions).all()


def test_vtk_series(dam, tmp_path):
    meshio = pytest.importorskip("meshio")
    with pbf.VtkSeries(tmp_path / "out" / "dam.pvd") as series:
        for _ in dam.frames(3, steps=2):
            series.add(dam, height=dam.positions[:, 1])
    sets = xml.parse(tmp_path / "out" / "dam.pvd").findall(".//DataSet")
    assert [float(s.get("timestep")) for s in sets] == pytest.approx([2 / 120, 4 / 120, 6 / 120])
    last = meshio.read(tmp_path / "out" / sets[2].get("file"))
    assert (last.points == dam.positions).all()
    assert (last.point_data["velocity"] == dam.velocities).all()
    assert (last.point_data["id"] == dam.ids).all()
    with pytest.raises(pbf.InvalidArgumentError, match="pvd"):
        pbf.VtkSeries("dam.vtk")


def test_usd(dam, tmp_path):
    usd = pytest.importorskip("pxr.Usd")
    from pxr import UsdGeom
    with pbf.UsdPoints(tmp_path / "dam.usda", fps=30) as file:
        for _ in dam.frames(2, steps=3):
            file.add(dam)
    stage = usd.Stage.Open(str(tmp_path / "dam.usda"))
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1
    assert stage.GetEndTimeCode() == 1 and stage.GetTimeCodesPerSecond() == 30
    points = UsdGeom.Points(stage.GetDefaultPrim())
    assert (np.array(points.GetPointsAttr().Get(1)) == dam.positions).all()
    assert np.array(points.GetWidthsAttr().Get(1)) == pytest.approx(0.05)
    assert (np.array(points.GetVelocitiesAttr().Get(1)) == dam.velocities).all()
    with pytest.raises(pbf.InvalidArgumentError, match="usd"):
        pbf.UsdPoints("dam.abc")
    with pytest.raises(pbf.InvalidArgumentError, match="fps"):
        pbf.UsdPoints(tmp_path / "dam.usda", fps=float("nan"))
    with pytest.raises(pbf.StateError, match="closed"):
        file.add(dam)


def test_alembic(dam, tmp_path):
    alembic = pytest.importorskip("alembic3d.Abc")
    from alembic3d import AbcGeom
    with pbf.AlembicPoints(tmp_path / "dam.abc", fps=30) as file:
        for _ in dam.frames(2, steps=3):
            file.add(dam)
    archive = alembic.IArchive(str(tmp_path / "dam.abc"))
    points = AbcGeom.IPoints(archive.getTop(), "fluid").getSchema()
    assert points.getNumSamples() == 2
    assert points.getTimeSampling().getSampleTime(1) == pytest.approx(1 / 30)
    last = points.getValue(alembic.ISampleSelector(1))
    as_array = lambda vectors: np.array([tuple(vector) for vector in vectors], np.float32)
    assert (as_array(last.getPositions()) == dam.positions).all()
    assert (as_array(last.getVelocities()) == dam.velocities).all()
    assert list(last.getIds()) == list(dam.ids)
    with pytest.raises(pbf.StateError, match="closed"):
        file.add(dam)
    for name, fps in (("dam.usd", 24), ("dam.abc", 0), ("dam.abc", np.inf)):
        with pytest.raises(pbf.InvalidArgumentError, match="abc|fps"):
            pbf.AlembicPoints(tmp_path / name, fps)


@contextmanager
def files_end_after(bytes_most):
    """As on a full disk, in processes of this one's, too."""
    resource = pytest.importorskip("resource")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (bytes_most, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)


def test_columns_are_what_the_format_takes(dam, tmp_path):
    file = tmp_path / "dam.ply"
    count = dam.count
    for name in ("x", "vx", "", "a b", "a\nproperty float b", "\u00e9"):
        with pytest.raises(pbf.InvalidArgumentError, match="a column can't be called"):
            pbf.write_ply(file, dam, **{name: np.zeros(count, np.float32)})
    masked = np.ma.masked_all(count, np.float32)
    for wrong in (np.zeros(count, np.int64), np.zeros(count, bool), np.zeros((count, 1)), "abc", None, 3.0, masked):
        with pytest.raises(pbf.InvalidArgumentError, match="mass"):
            pbf.write_ply(file, dam, mass=wrong)
    assert not file.exists()
    pbf.write_ply(file, dam, mass=np.arange(count, dtype=">f8"))
    assert file.read_bytes().endswith(np.float64(count - 1).tobytes())


def test_columns_of_a_series_are_what_paraview_reads(dam, tmp_path):
    meshio = pytest.importorskip("meshio")
    series, count = pbf.VtkSeries(tmp_path / "dam.pvd"), dam.count
    for name in ("velocity", "id", "", 'a"b', "a<b", "a\nb"):
        with pytest.raises(pbf.InvalidArgumentError, match="a column can't be called"):
            series.add(dam, **{name: np.zeros(count)})
    for wrong in (np.zeros(3), np.zeros(count, bool), np.zeros((count, 2, 2)), np.zeros(count, complex), "abc", None):
        with pytest.raises(pbf.InvalidArgumentError, match="mass"):
            series.add(dam, mass=wrong)
    assert os.listdir(tmp_path) == []
    read = meshio.read(series.add(dam, **{"a b": np.arange(count, dtype=">f4"), "n": np.ones((count, 2), np.uint8)}))
    assert (read.point_data["a b"] == np.arange(count)).all() and (read.point_data["n"] == 1).all()


@pytest.mark.parametrize("kind, name, module", [
    (pbf.UsdPoints, "dam.usda", "pxr.Usd"), (pbf.UsdPoints, "dam.usdc", "pxr.Usd"),
    (pbf.AlembicPoints, "dam.abc", "alembic3d.Abc")])
def test_an_old_file_stays_where_a_new_one_finds_no_room(dam, tmp_path, kind, name, module):
    pytest.importorskip(module)
    path = tmp_path / name
    path.write_bytes(b"old")
    with files_end_after(20000):
        with pytest.raises(OSError, match=f"{name} can't be written: "):
            with kind(path) as file:
                for _ in dam.frames(3, steps=1):
                    file.add(dam)
    assert path.read_bytes() == b"old" and os.listdir(tmp_path) == [name]
    with kind(path) as file:
        file.add(dam)
    assert path.stat().st_size > 20000 and os.listdir(tmp_path) == [name]


def test_names_in_files_are_names(tmp_path):
    for prim in ("fluid", "/", "", "/a b", "//", "/a/../b", None, 3):
        pytest.importorskip("pxr.Usd")
        with pytest.raises(pbf.InvalidArgumentError, match="prim"):
            pbf.UsdPoints(tmp_path / "dam.usda", prim=prim)
    for name in ("", "a/b", "a\0b", None, 3):
        pytest.importorskip("alembic3d.Abc")
        with pytest.raises(pbf.InvalidArgumentError, match="name"):
            pbf.AlembicPoints(tmp_path / "dam.abc", name=name)


def test_a_pipe_gets_what_writers_make_of_a_name(tmp_path):
    """Some put another file in its place, or go back in it."""
    pipe, found = tmp_path / "pipe.usda", []
    os.mkfifo(pipe)
    reader = threading.Thread(target=lambda: found.append(pipe.read_bytes()))
    reader.start()
    with _files.written(pipe, by_name=True) as place:
        assert place != pipe
        place.write_bytes(b"whole")
    reader.join()
    assert found == [b"whole"] and pipe.is_fifo()
    with pytest.raises(IsADirectoryError):
        with _files.written(tmp_path, by_name=True):
            pytest.fail("a folder is no file")


@pytest.mark.parametrize("kind, name, module", [
    (pbf.VtkSeries, "none.pvd", "meshio"), (pbf.UsdPoints, "none.usda", "pxr.Usd"),
    (pbf.AlembicPoints, "none.abc", "alembic3d.Abc")])
def test_frames_without_particles(make, tmp_path, kind, name, module):
    """As before a tap runs; in 2D, too."""
    pytest.importorskip(module)
    fluid = make(dimension=2, capacity=4)
    with kind(tmp_path / name) as file:
        file.add(fluid)
        fluid.add([[0.5, 0.5]])
        file.add(fluid)
    assert (tmp_path / name).exists()


def test_surface(make, tmp_path):
    """A ball: its surface is closed, at its radius, with normals outwards and its volume."""
    pytest.importorskip("pysplashsurf")
    fluid = make(pbf.fill_ball((0.5, 0.5, 0.5), 0.4, 0.05))
    mesh = pbf.surface(fluid)
    from_center = mesh.vertices - 0.5
    distance = np.linalg.norm(from_center, axis=1)
    assert distance.mean() == pytest.approx(0.4, rel=0.05)
    assert ((mesh.normals * from_center).sum(axis=1) > 0).mean() > 0.99
    assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(1, abs=1e-3)
    a, b, c = (from_center[mesh.triangles[:, k]] for k in range(3))
    volume = (np.cross(a, b) * c).sum() / 6
    assert volume == pytest.approx(4 / 3 * np.pi * 0.4**3, rel=0.12)
    edges = np.sort(np.concatenate([mesh.triangles[:, [i, j]] for i, j in ((0, 1), (1, 2), (2, 0))]))
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    mesh.save(tmp_path / "ball.ply")
    meshio = pytest.importorskip("meshio")
    read = meshio.read(tmp_path / "ball.ply")
    assert read.points == pytest.approx(mesh.vertices, abs=1e-6)
    assert (read.cells[0].data == mesh.triangles).all()
    assert read.point_data["nx"] == pytest.approx(mesh.normals[:, 0], abs=1e-6)
    for name in ("ball.obj", "ball.stl", "ball.vtu"):
        mesh.save(tmp_path / name)
        assert len(meshio.read(tmp_path / name).cells[0].data) == len(mesh.triangles)


def test_surface_of_smoothed_particles(make):
    """Those of the outside move inwards by 0.4 of their distance, and bumps go."""
    pytest.importorskip("pysplashsurf")
    fluid = make(pbf.fill_ball((0.5, 0.5, 0.5), 0.4, 0.05))
    distance = [np.linalg.norm(pbf.surface(fluid, smoothing=0, particle_smoothing=s).vertices - 0.5, axis=1)
                for s in (0, 1)]
    assert distance[0].mean() - distance[1].mean() == pytest.approx(0.4 * 0.05, rel=0.4)
    assert distance[1].std() < 0.85 * distance[0].std()


def test_surface_in_a_box_stays_in_it(dam):
    pytest.importorskip("pysplashsurf")
    mesh = pbf.surface(dam)
    assert len(mesh.triangles) > 100 and mesh.vertices.min() > -0.05


def test_surface_of_nothing(make):
    pytest.importorskip("pysplashsurf")
    assert len(pbf.surface(make()).triangles) == 0
    with pytest.raises(pbf.InvalidArgumentError, match="2D"):
        pbf.surface(make(dimension=2))
