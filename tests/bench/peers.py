"""What the drivers of other solvers write and read, without the solvers. 77, skipped, without NumPy."""
import json
import pathlib
import sys
import tempfile

try:
    import numpy as np
except ImportError as missing:
    print(f"SKIPPED: {missing}")
    sys.exit(77)

bench = pathlib.Path(__file__).resolve().parents[2] / "bench"
sys.path[:0] = [str(bench / "peers"), str(bench / "tools")]

import hull  # noqa: E402  (they lie in bench/)
import peers_table  # noqa: E402
import replay  # noqa: E402
import setup  # noqa: E402


def the_mesh_is_closed_and_faces_outwards():
    corners = np.array(setup.CORNERS, float)
    volume, edges = 0.0, []
    for a, b, c in setup.TRIANGLES:
        p, q, r = corners[a - 1], corners[b - 1], corners[c - 1]
        volume += np.dot(p - 0.5, np.cross(q - 0.5, r - 0.5)) / 6
        edges += [(a, b), (b, c), (c, a)]
    assert abs(volume - 1) < 1e-12, volume
    assert len(set(edges)) == 36 and all((b, a) in edges for a, b in edges), edges


def particles_keep_their_float32():
    x = np.array([[0.1, 1 / 3, 1e-7]], np.float32)
    line = setup.particle_file(x).splitlines()[-1]
    assert np.array_equal(np.array(line.split()[:3], np.float32), x[0]), line
    assert "NUMBER_OF_PARTICLES: 1" in setup.particle_file(x)


def walls_leave_a_lattice_alone():
    low, high = planes = setup.wall_planes([0, 0, 0], [1, 2, 3], 0.1)
    assert np.allclose(low, 0.05 - 0.125) and np.allclose(high, np.array([1, 2, 3]) - 0.05 + 0.125)
    inner = setup.wall_surfaces(planes, 0.1)
    assert np.allclose(inner[0], -0.025) and np.allclose(inner[1], [1.025, 2.025, 3.025])


def settings_become_parameters():
    plan = json.loads((bench / "peers" / "hull.json").read_text())
    for family in plan["families"] + plan["few"]:
        labels = [hull.label(settings) for settings in hull.products(family["vary"])]
        assert len(set(labels)) == len(labels), labels
    assert hull.configuration({"iterations": 4, "divide_time_step": 2}) == {"minIterations": 4, "maxIterations": 4}
    assert hull.label({"maxError": 0.1, "divide_time_step": 4}) == "tolerance 0.1 %, Δt/4"


def figures_are_over_the_frames_after_the_start():
    report = {"errors": {"E1": {"frames": [{"x": 9.0}, {"x": -1.0}, {"x": 3.0}, {"x": None}]}}}
    assert hull.figure(report, "E1.x@mean") == 2.0
    assert hull.figure(report, "E1.x@largest") == 3.0
    assert hull.figure({"errors": {"E1": {"frames": [{"x": 9.0}]}}}, "E1.x@mean") is None


def trial(folder, label, times, **more):
    path = pathlib.Path(folder) / label
    path.mkdir()
    (path / "dump.json").write_text(json.dumps({
        "spacing": 0, "smoothing_radius": 0.1, "domain_min": [0, 0, 0], "domain_max": [1, 1, 1], "iterations": 4,
        "gravity": [0, -9.81, 0], "time_step": 0.01, "times": times, **more}))
    return replay.Trial(path)


def a_chained_case_is_one_run():
    with tempfile.TemporaryDirectory() as folder:
        first = trial(folder, "settling", {"0": 0, "10": 0.1})
        then = trial(folder, "heavy", {"10": 0.1, "14": 0.14}, gravity=[0, -9810, 0])
        job = replay.job([first, then], 13, "pbf", 4, "out")
    assert replay.runs(13, [first, then]) == [[first, then]] and len(replay.runs(7, [first, then])) == 2
    assert [s["steps"] for s in job["segments"]] == [40, 16] and job["frames"] == [0, 40, 56], job
    assert [s["gravity"][1] for s in job["segments"]] == [-9.81, -9810]
    assert job["segments"][0]["time_steps"] == [0.0025] and job["spacing"] == 0.05


def steps_alternate():
    with tempfile.TemporaryDirectory() as folder:
        alternating = trial(folder, "alternating", {"0": 0, "4": 0.22})
    part = replay.segment(alternating, 10, 2)
    total = sum(part["time_steps"][k % 2] for k in range(part["steps"]))
    assert part["steps"] == 8 and abs(total - 0.22) < 1e-12, part


def piles_are_put_back():
    apart = np.array([[1.01, 1, 1], [0.99, 1, 1.01], [1.05, 1.03, 1.01]])
    assert replay.piled(2, apart).tolist() == [[1, 1, 1], [1, 1, 1], [1.05, 1.02, 1.01]]
    assert replay.piled(7, apart) is apart


def the_table_takes_the_cheapest():
    points = [("a", 1.0, 0.02, ""), ("a", 3.0, 0.005, ""), ("a", 2.0, 0.008, "")]
    assert peers_table.cheapest(points, 0.01)[1] == 2.0
    assert peers_table.cheapest(points, 0.001) is None
    assert [p[1] for p in peers_table.beaten_by(points, [("b", 1.5, 0.006, "")])] == [1.0, 3.0]


for check in (the_mesh_is_closed_and_faces_outwards, particles_keep_their_float32, walls_leave_a_lattice_alone,
              settings_become_parameters, figures_are_over_the_frames_after_the_start, a_chained_case_is_one_run,
              steps_alternate, piles_are_put_back, the_table_takes_the_cheapest):
    check()
    print(f"ok: {check.__name__}")
