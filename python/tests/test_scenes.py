"""Scene files. The numbers of particles and of steps are what `pbf-bench list` prints."""
import json
import pathlib
import re

import numpy as np
import pytest

import pbf
from conftest import BACKEND
from pbf.meshes import read_mesh


@pytest.mark.parametrize("name, count", [
    ("cube-collapse", 29791), ("report-30k", 30000), ("dam-break-3d", 32 * 32 * 30),
    ("moving-paddle", 68 * 12 * 20)])
def test_counts(name, count):
    positions, velocities = pbf.load_scene(name).particles()
    assert positions.shape == velocities.shape and len(positions) == count


@pytest.mark.parametrize("name", pbf.scenes())
def test_every_scene_runs(name):
    scene = pbf.load_scene(name)
    assert scene.name == pathlib.Path(name).name and scene.description and scene.steps > 0
    fluid = scene.solver(backend=BACKEND)
    fluid.step()
    came = fluid.in_out.emitted - fluid.in_out.drained
    assert fluid.count == len(scene.particles()[0]) + came and fluid.steps_done == 1
    assert fluid.time_step == scene.params["time_step"]
    fluid.close()


def test_keywords_win():
    fluid = pbf.load_scene("dam-break-2d").solver(viscosity=0.5, capacity=9000, backend=BACKEND)
    assert fluid.viscosity == 0.5 and fluid.capacity == 9000
    fluid.close()


def test_colliders_move_by_their_stretches():
    """The paddle: 0.25 s at 0.4, 0.5 s at 0.8, 0.25 s at 0.4, and back."""
    scene = pbf.load_scene("moving-paddle")
    scene.blocks = [{"shape": "lattice", "first": [3, 0.5, 0.5], "counts": [1, 1, 1]}]
    fluid = scene.solver(backend=BACKEND)
    expected = {0: 0.45, 30: 0.55, 60: 0.75, 90: 0.95, 120: 1.05, 150: 0.95, 240: 0.45, 270: 0.55}
    for step, x in expected.items():
        fluid.step(step - fluid.steps_done)
        assert fluid.colliders[0].position[0] == pytest.approx(x, abs=1e-9), step
    with fluid.stepping(30):
        pass
    fluid.step(30)
    assert fluid.colliders[0].position[0] == pytest.approx(0.95, abs=1e-9)
    with pytest.raises(pbf.InvalidArgumentError, match="after 30"):
        fluid.begin_step(31)
    other = pbf.Solver.__new__(type(fluid))
    other.__setstate__(fluid.__getstate__())
    other.step(30)
    fluid.step(30)
    assert other.hash == fluid.hash
    fluid.close()


def test_blocks_that_turn(tmp_path):
    scene = {"version": 1, "description": "d", "purpose": "p", "dimension": 2, "steps": 1,
             "params": {"smoothing_radius": 0.1, "spacing": 0.05, "time_step": 0.01,
                        "domain_min": [-2, -2], "domain_max": [2, 2]},
             "blocks": [{"shape": "ball", "center": [0.5, 0], "radius": 0.5, "velocity": [0, 3],
                         "angular_velocity": [0, 0, 2],
                         "within": [{"slopes": [1, 0], "below": 0.5}]}]}
    path = tmp_path / "turning.json"
    path.write_text(json.dumps(scene))
    loaded = pbf.load_scene(path)
    x, v = loaded.particles()
    assert x[:, 0].max() < 0.5 and len(x) == pytest.approx(np.pi * 100 / 2, rel=0.05)
    assert v == pytest.approx(np.stack([-2 * x[:, 1], 3 + 2 * (x[:, 0] - 0.5)], axis=1))
    del scene["blocks"][0]["angular_velocity"]
    scene["blocks"][0]["velocity_gradient"] = [[0, 1], [0, 0]]
    x, v = pbf.load_scene(scene).particles()
    assert v == pytest.approx(np.stack([x[:, 1], np.full(len(x), 3.0)], axis=1))


def test_refined():
    scene = pbf.load_scene("dam-break-3d").refined(0.5)
    assert len(scene.particles()[0]) == 16 * 16 * 15
    assert scene.steps == 150 and scene.params["time_step"] == pytest.approx(1 / 60)
    with scene.solver(backend=BACKEND) as fluid:
        assert fluid.smoothing_radius == 0.2


def change(path, value):
    def apply(scene):
        at = scene
        for key in path[:-1]:
            at = at[key]
        if value is None:
            del at[path[-1]]
        else:
            at[path[-1]] = value
    return apply


@pytest.mark.parametrize("changed, words", [
    (change(["steps"], None), '"steps"'), (change(["stepps"], 3), 'did you mean "steps"'),
    (change(["dimension"], 4), "/dimension: the value is 4"), (change(["params", "viscocity"], 1), "viscosity"),
    (change(["params", "gravity"], [1, 2]), "gravity"), (change(["blocks", 0, "min"], None), '"min"'),
    (change(["blocks", 0, "shape"], "cone"), "cone"), (change(["blocks"], 3), "/blocks: the value is 3"),
    (change(["blocks", 0, "max"], [1, "x", 1]), "/blocks/0/max/1"),
    (change(["colliders"], [{"shape": "torus", "position": [0, 0, 0]}]), "capsule"),
    (change(["colliders"], [{"shape": "sphere", "position": [0, 0, 0], "radus": 1}]), "radius"),
    (change(["version"], 2), "/version: the value is 2"),
    (change(["blocks"], []), "at least one where there are no emitters"),
    (change(["blocks", 0, "max"], [1, 1]), "/blocks/0/max: the list has 2 numbers"),
    (change(["blocks", 0, "phase"], 1), "/blocks/0/phase: the value is 1; the scene has 0 phases"),
    (change(["phases"], [{"rest_density": 0}]), "/phases/0/rest_density: the value is 0; wanted: a "
     "number above 0"),
    (change(["emitters"], [{"shape": "disc", "position": [0, 0, 0], "half_width": 1}]),
     '"half_width" does not belong here'),
    (change(["emitters"], [{"shape": "disc", "position": [0, 0, 0], "phase": 2}]),
     "/emitters/0/phase: the value is 2"),
    (change(["drains"], [{"shape": "box"}]), '/drains/0: "position" is missing'),
    (change(["colliders"], [{"shape": "shape", "position": [0, 0, 0]}]), '"geometry" is missing'),
    (change(["colliders"], [{"shape": "shape", "position": [0, 0, 0], "geometry": "cup"}]),
     'there is no shape "cup"'),
    (change(["shapes"], {"cup": {"from": "mesh", "cell": 0.1}}), '/shapes/cup: "vertices" is missing'),
    (change(["shapes"], {"cup": {"from": "mesh", "cell": 0.1, "file": "none.obj"}}),
     "none.obj can't be read"),
    (change(["shapes"], {"cup": {"from": "mesh", "cell": 0.1, "file": "cup.3ds"}}), ".obj and .stl"),
    (change(["shapes"], {"cup": {"from": "baked"}}), '/shapes/cup: "file" is missing'),
    (change(["shapes"], {"cup": {"from": "baked", "file": "none.pbfshape"}}),
     "/shapes/cup/file: .*none.pbfshape can't be read: No such file"),
    (change(["shapes"], {"cup": {"from": "baked", "file": "bad.json"}}),
     "/shapes/cup/file: .*bad.json: the saved shape does not begin as one")])
def test_bad_files_say_what_is_wrong(changed, words, tmp_path):
    scene = dam_break()
    changed(scene)
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(scene))
    with pytest.raises(pbf.DataError, match=words) as caught:
        pbf.load_scene(path)
    assert "bad.json" in str(caught.value)


def dam_break():
    return json.loads((pathlib.Path(pbf.__file__).parent / "scenes/dam-break-3d.json").read_text())


def with_shape(shape, dimension=3):
    place = [0.5] * dimension
    return {"version": 1, "description": "d", "purpose": "p", "dimension": dimension, "steps": 1,
            "params": {}, "blocks": [{"shape": "ball", "center": [0.9] * dimension, "radius": 0.1}],
            "shapes": {"it": shape},
            "colliders": [{"shape": "shape", "geometry": "it", "position": place, "scale": 2,
                           "path": "screw", "friction": 0.5, "no_slip": 0.25, "inverted": True}]}


TETRAHEDRON = [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]
FACES = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]


@pytest.mark.parametrize("shape, volume", [
    ({"from": "mesh", "vertices": TETRAHEDRON, "faces": FACES, "cell": 0.005}, 0.001 / 6),
    ({"from": "points", "points": TETRAHEDRON, "cell": 0.005}, 0.001 / 6),
    # Flat along z, 0.2 to 0.3 along x: the file has a list along x for each z.
    ({"from": "heights", "heights": [[0.1, 0.2, 0.3]] * 5, "spacing": 0.1, "base": 0, "cell": 0.01},
     0.2 * 0.4 * 0.2)])
def test_shapes_have_the_volume_of_what_they_are_made_from(shape, volume):
    with pbf.load_scene(with_shape(shape)).solver(backend=BACKEND) as fluid:
        solid, = fluid.colliders
        assert solid.geometry.volume == pytest.approx(volume, rel=0.05)
        assert (solid.scale, solid.friction, solid.no_slip) == (2, 0.5, 0.25)
        assert solid.inverted and solid.path == pbf.MotionPath.SCREW


def test_a_grid_is_read_x_first():
    """The distance from the line x + y / 2 = 0.45, whose numbers differ along the two axes."""
    nodes, cell = (12, 8), 0.1
    values = [max((0.1 * i + 0.05 * j - 0.45) / np.hypot(1, 0.5), 0.05 - 0.1 * min(i, j, 11 - i, 7 - j))
              for j in range(nodes[1]) for i in range(nodes[0])]
    shape = {"from": "grid", "nodes": list(nodes), "origin": [0, 0], "values": values, "cell": cell}
    solid, = pbf.load_scene(with_shape(shape, 2))._with_geometries()
    assert solid.geometry.distance((0.2, 0.2)) < 0 < solid.geometry.distance((0.2, 0.55))
    assert solid.geometry.distance((0.25, 0.25)) == pytest.approx(-0.075 / np.hypot(1, 0.5), abs=0.01)


def test_open_meshes_are_refused_by_name():
    shape = {"from": "mesh", "vertices": TETRAHEDRON, "faces": FACES[:3], "cell": 0.005}
    with pytest.raises(pbf.DataError, match="/shapes/it: mesh is open"):
        pbf.load_scene(with_shape(shape)).solver(backend=BACKEND)


def test_meshes_of_files(tmp_path):
    """The cube of side 1, as squares of OBJ and as triangles of both kinds of STL."""
    corners = [(i & 1, i >> 1 & 1, i >> 2) for i in range(8)]
    squares = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    obj = "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "g of squares\n"
    obj += "".join("f " + " ".join(f"{i - 8}/1/2" for i in square) + "\n" for square in squares)
    triangles = [[corners[i] for i in (a, *pair)]
                 for a, b, c, d in squares for pair in ((b, c), (c, d))]
    lines = ["solid cube"] + [f"vertex {x} {y} {z}" for each in triangles for x, y, z in each]
    packed = b"".join(np.array([(0, 0, 0), *each], "<f4").tobytes() + b"\0\0" for each in triangles)
    (tmp_path / "cube.obj").write_text(obj)
    (tmp_path / "text.stl").write_text("\n".join(lines))
    (tmp_path / "binary.STL").write_bytes(b"solid".ljust(80) + (12).to_bytes(4, "little") + packed)
    for name in ("cube.obj", "text.stl", "binary.STL"):
        scene = with_shape({"from": "mesh", "file": name, "cell": 0.05})
        (tmp_path / "scene.json").write_text(json.dumps(scene))
        solid, = pbf.load_scene(tmp_path / "scene.json")._with_geometries()
        assert solid.geometry.volume == pytest.approx(1, rel=0.02)
    (tmp_path / "cube.obj").write_text("v 0 0 0\nf 1 2 3\n")
    scene["shapes"]["it"]["file"] = "cube.obj"
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    with pytest.raises(pbf.DataError, match='cube.obj:2: "2" is none of the 1 vertices'):
        pbf.load_scene(tmp_path / "scene.json")


def test_words_of_meshes_are_whole(tmp_path):
    """The list of tests/bench/objects.cpp."""
    path = tmp_path / "words.obj"
    faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\n"
    for word in ("1,5", "1.5.2", "0x1", "1_0", "nan", "inf", "1e999", "1f", "--1", "+", "\u0661"):
        path.write_text(f"v 0 0 0\nv 1 0 {word}\n{faces}", encoding="utf-8")
        with pytest.raises(pbf.DataError, match=rf'words.obj:2: "{re.escape(word)}" is no number'):
            read_mesh(path)
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    for word in ("4x", "4.5", "1_0", "0x4", "/4", "99999999999999999999"):
        path.write_text(f"{corners}f 2 3 {word}\n")
        with pytest.raises(pbf.DataError, match=f'words.obj:5: "{re.escape(word)}" is none of the 4'):
            read_mesh(path)
    path.write_text(f"\ufeff{corners}v 7 7 7\nf 2 3 4\n{faces}", encoding="utf-8")
    vertices, triangles = read_mesh(path)
    assert len(vertices) == 5 and triangles.tolist() == [[1, 2, 3], [0, 2, 1], [0, 1, 3], [0, 3, 2]]


def test_a_baked_file_is_the_shape_that_was_saved(tmp_path):
    baked = pbf.Geometry.from_mesh(TETRAHEDRON, FACES, cell=0.005)
    baked.save(tmp_path / "it.pbfshape")
    scene = with_shape({"from": "baked", "file": "it.pbfshape"})
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    finer = pbf.load_scene(tmp_path / "scene.json").refined(2)
    solid, = finer._with_geometries()
    assert solid.geometry.save() == baked.save()
    flat = with_shape(scene["shapes"]["it"], 2)
    (tmp_path / "flat.json").write_text(json.dumps(flat))
    with pytest.raises(pbf.DataError, match="holds a shape of dimension 3; the scene has 2"):
        pbf.load_scene(tmp_path / "flat.json")


def test_what_comes_and_goes():
    """0.06 a second for half a second, in particles of 0.05³; the capacity is that of the run."""
    scene = pbf.load_scene("mill-wheel")
    placed = len(scene.particles()[0])
    with scene.solver(backend=BACKEND) as fluid:
        assert fluid.capacity == placed + int(0.06 * 4 / 0.05**3 + 0.5) + 1
        fluid.step(60)
        assert abs(fluid.in_out.emitted - 0.06 * 0.5 / 0.05**3) <= 1
        assert fluid.count == placed + fluid.in_out.emitted - fluid.in_out.drained


def test_phases_are_those_of_the_blocks():
    with pbf.load_scene("oil-on-water").solver(backend=BACKEND) as fluid:
        assert [phase.rest_density for phase in fluid.phases] == [1, 0.7]
        oil = fluid.particle_phases == 1
        assert oil.sum() == 20 * 16 and fluid.positions[oil, 0].max() < 0.5 < fluid.positions[~oil, 0].min()


def test_periodic_axes_are_a_list_of_names():
    with pbf.load_scene("periodic-channel").solver(backend=BACKEND) as fluid:
        assert fluid.periodic == pbf.Periodic.X
        fluid.periodic = "y"
        assert fluid.periodic == pbf.Periodic.Y


def test_finer_fluids_have_finer_shapes():
    scene = pbf.load_scene("mill-wheel")
    assert scene.refined(2).shapes["bed"]["cell"] == 0.0125
    assert scene.refined(0.5).shapes["bed"]["cell"] == 0.025


def test_files_that_are_none(tmp_path):
    (tmp_path / "bad.json").write_text('{"version": 1,\n oops')
    with pytest.raises(pbf.DataError, match="line 2"):
        pbf.load_scene(tmp_path / "bad.json")
    with pytest.raises(pbf.InvalidArgumentError, match='did you mean "dam-break-3d"'):
        pbf.load_scene("dam-brake-3d")
    with pytest.raises(FileNotFoundError):
        pbf.load_scene("nowhere.json")


def test_files_without_end(tmp_path):
    for name, ending in (("endless.json", "16777216"), ("endless.obj", "268435456"),
                         ("endless.stl", "268435456")):
        (tmp_path / name).symlink_to("/dev/zero")
        with pytest.raises(pbf.DataError, match=f"{name} has more than {ending} bytes"):
            if name.endswith(".json"):
                pbf.load_scene(tmp_path / name)
            else:
                read_mesh(tmp_path / name)


def test_sentences_are_one_line():
    scene = {"a\nERROR: b\x1b[2J\ud800": 1}
    with pytest.raises(pbf.DataError) as error:
        pbf.load_scene(scene)
    assert str(error.value).startswith("/a?ERROR: b?[2J?: the key ")
    assert error.value.sentence.isprintable()
    with pytest.raises(pbf.InvalidArgumentError, match='no scene "a.b"'):
        pbf.load_scene("a\nb")


@pytest.mark.parametrize("text, words", [
    ("[" * 100000, "nested far deeper"), ("[" * 100000 + "]" * 100000, "nested far deeper"),
    (b'{"a": "\xc3"}', "byte 7 is not of a text in UTF-8"), ("1" * 5000, "more digits than"),
    ('{"steps": 3, "steps": 4}', 'the key "steps" stands twice'),
    ('{"a": {"b\\u0000": 3, "b\\u0000": 4}}', "stands twice")])
def test_bytes_that_are_no_scene(text, words, tmp_path):
    path = tmp_path / "bad.json"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(pbf.DataError, match=words):
        pbf.load_scene(path)


@pytest.mark.parametrize("path", [["steps"], ["capacity"], ["params", "smoothing_radius"],
                                  ["params", "gravity", 1], ["blocks", 0, "max", 0]])
def test_integers_that_no_float_holds(path):
    scene = dam_break()
    change(path, 10**400)(scene)
    with pytest.raises(pbf.DataError, match="/" + "/".join(map(str, path)) + ": the value is 1000"):
        pbf.load_scene(scene)


def test_a_scene_may_begin_with_a_byte_order_mark(tmp_path):
    path = tmp_path / "marked.json"
    path.write_text(json.dumps(dam_break()), encoding="utf-8-sig")
    assert pbf.load_scene(path).steps == dam_break()["steps"]


def test_blocks_of_more_than_fit_are_refused_before_they_are_filled():
    scene = dam_break()
    scene["blocks"] = [{"shape": "lattice", "first": [0, 0, 0], "counts": [2000, 2000, 2000]}]
    with pytest.raises(pbf.InvalidArgumentError, match="8000000000 particles; at most 1073741823"):
        pbf.load_scene(scene).particles()
