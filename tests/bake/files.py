"""pbf-bake: files of spheres and boxes have their distances; what is no solid is refused.

    files.py PBF_BAKE FOLDER
"""
import math
import pathlib
import os
import re
import resource
import signal
import struct
import subprocess
import sys
import time

BAKE, WORK = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
failures = []


def check(what, holds):
    if not holds:
        failures.append(what)
        print("files.py: not so:", what)


def bake(*words):
    return subprocess.run([str(BAKE), *map(str, words)], capture_output=True, text=True, check=False, cwd=WORK)


# ---- Meshes ----

def sphere(radius, slices=64):
    """A ball of latitudes and longitudes: its vertices are on the sphere, its faces at most
    radius (1 - cos(pi / slices)) inside of it, twice that where quads are cut."""
    rings, vertices, faces = slices // 2, [(0, radius, 0)], []
    for i in range(1, rings):
        for j in range(slices):
            a, b = math.pi * i / rings, 2 * math.pi * j / slices
            vertices.append((radius * math.sin(a) * math.cos(b), radius * math.cos(a), radius * math.sin(a) * math.sin(b)))
    vertices.append((0, -radius, 0))

    def at(i, j):
        return 1 + (i - 1) * slices + j % slices
    for j in range(slices):
        faces.append((0, at(1, j + 1), at(1, j)))
        faces.append((len(vertices) - 1, at(rings - 1, j), at(rings - 1, j + 1)))
        for i in range(1, rings - 1):
            faces += [(at(i, j), at(i, j + 1), at(i + 1, j)), (at(i, j + 1), at(i + 1, j + 1), at(i + 1, j))]
    return vertices, faces


def box(half):
    """From -half to half along each axis."""
    vertices = [tuple((1 if n >> k & 1 else -1) * half[k] for k in range(3)) for n in range(8)]
    quads = ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6))
    return vertices, [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]


def write_obj(name, vertices, faces):
    lines = ["v " + " ".join(map(repr, map(float, v))) for v in vertices]
    lines += ["f " + " ".join(str(i + 1) for i in f) for f in faces]
    (WORK / name).write_text("\n".join(lines) + "\n")


def write_stl(name, vertices, faces):
    rows = [struct.pack("<12fH", 0, 0, 0, *(x for i in f for x in vertices[i]), 0) for f in faces]
    (WORK / name).write_bytes(bytes(80) + struct.pack("<I", len(faces)) + b"".join(rows))


def write_ply(name, vertices, faces):
    head = (f"ply\nformat ascii 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
            f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    body = [" ".join(map(str, v)) for v in vertices] + ["3 " + " ".join(map(str, f)) for f in faces]
    (WORK / name).write_text(head + "\n".join(body) + "\n")


# ---- Files ----

class Shape:
    """By the layout that docs/shapes.md has."""

    def __init__(self, name):
        saved = (WORK / name).read_bytes()
        mark, kind, self.dimension, *rest = struct.unpack_from("<8s2I3II3ddQ", saved)
        self.nodes, self.origin, self.cell, self.hash = rest[:3], rest[4:7], rest[7], rest[8]
        assert mark == b"PBFSHAPE" and kind == 1 and rest[3] == 0
        count = self.nodes[0] * self.nodes[1] * self.nodes[2]
        self.values = struct.unpack_from(f"<{count}f", saved, 72)
        assert len(saved) == 72 + 4 * count

    def places(self):
        """Each node's place and distance."""
        nx, ny, _ = self.nodes
        for n, value in enumerate(self.values):
            yield [self.origin[k] + self.cell * i for k, i in enumerate((n % nx, n // nx % ny, n // nx // ny))], value


def box_distance(p, half):
    beyond = [abs(x) - h for x, h in zip(p, half)]
    return math.hypot(*(max(b, 0) for b in beyond)) if max(beyond) > 0 else max(beyond)


# ---- What is made ----

def balls_have_their_distances():
    radius, cell = 0.5, 0.05
    mesh = sphere(radius)
    off = 2 * radius * (1 - math.cos(math.pi / 64)) + 1e-6  # of faces from the sphere
    for write, name in ((write_obj, "ball.obj"), (write_stl, "ball.stl"), (write_ply, "ball.ply")):
        write(name, *mesh)
        done = bake(name, name + ".pbfshape", "--cell", cell)
        check(f"{name} is baked: {done.stderr}", done.returncode == 0)
        shape = Shape(name + ".pbfshape")
        worst = max(abs(value - (math.hypot(*p) - radius)) for p, value in shape.places())
        check(f"{name}: {worst} off, of {off}", worst <= off and shape.cell == cell and shape.dimension == 3)
        volume = float(re.search(r"volume ([\d.e+-]+)", done.stdout)[1])
        check(f"{name}: volume {volume}", abs(volume / (4 / 3 * math.pi * radius**3) - 1) < 0.01)
    a, b, c = (Shape(f"ball.{e}.pbfshape") for e in ("obj", "stl", "ply"))
    check("formats agree", a.nodes == b.nodes == c.nodes and max(abs(x - y) + abs(x - z) for x, y, z in zip(a.values, b.values, c.values)) < 1e-6)


def boxes_are_placed():
    half = (0.1, 0.2, 0.3)
    vertices, faces = box(half)
    write_obj("box.obj", [(x + 1, y, z) for x, y, z in vertices], faces)
    for options, middle, size in (((), (1, 0, 0), half), (("--scale", 2), (2, 0, 0), (0.2, 0.4, 0.6)),
                                  (("--centre",), (0, 0, 0), half), (("--z-up",), (1, 0, 0), (0.1, 0.3, 0.2)),
                                  (("--hull",), (1, 0, 0), half)):
        done = bake("box.obj", "box.pbfshape", "--spacing", 0.05, *options)
        check(f"box {options}: {done.stderr}", done.returncode == 0)
        shape = Shape("box.pbfshape")
        worst = max(abs(value - box_distance([x - m for x, m in zip(p, middle)], size)) for p, value in shape.places())
        check(f"box {options}: {worst} off", worst < 1e-6 and shape.cell == 0.025)
    bake("box.obj", "box.pbfshape", "--cells", 30)
    check("cells along the longest side", abs(Shape("box.pbfshape").cell - 0.02) < 1e-9)
    shown = bake("--show", "box.pbfshape")
    check(f"a file is shown: {shown.stdout}", shown.returncode == 0 and "z from -0.3 to 0.3" in shown.stdout)


def open_meshes_are_shells():
    vertices, faces = box((0.2, 0.2, 0.2))
    write_obj("open.obj", vertices, faces[2:])
    refused("mesh is open: the edge", "open.obj", "open.pbfshape", "--cell", 0.02)
    check("nothing is written", not (WORK / "open.pbfshape").exists())
    done = bake("open.obj", "open.pbfshape", "--cell", 0.02, "--thickness", 0.04)
    check(f"a shell: {done.stderr}", done.returncode == 0)
    inside = [value for p, value in Shape("open.pbfshape").places() if math.hypot(*p) < 0.1]
    check("a shell has room", min(inside) > 0.05)


def collapsed_triangles_are_left_out():
    vertices, faces = box((0.2, 0.2, 0.2))
    write_obj("twice.obj", [*vertices, vertices[0]], [*faces, (0, 8, 1)])
    done = bake("twice.obj", "twice.pbfshape", "--cell", 0.05)
    check(f"a triangle of two places: {done.stderr}", done.returncode == 0 and "1 triangles with two corners" in done.stdout)


# ---- What is refused ----

def refused(words, *command, code=1):
    done = bake(*command)
    check(f"{command}: {done.returncode}, {done.stderr!r} without {words!r}",
          done.returncode == code and words in done.stderr and done.stderr.startswith("pbf-bake: ") | (code == 2) and done.stderr.count("\n") <= 2)


def what_is_no_solid_is_refused():
    vertices, faces = box((0.2, 0.2, 0.2))
    far = [(1e38, 0, 0), *vertices[1:]]
    write_obj("far.obj", far, faces)
    refused("must be between -1e30 and 1e30", "far.obj", "x.pbfshape", "--cell", 0.01)
    write_obj("nan.obj", [(math.nan, 0, 0), *vertices[1:]], faces)
    refused("vertices[", "nan.obj", "x.pbfshape", "--cell", 0.01)
    write_ply("nan.ply", [(math.inf, 0, 0), *vertices[1:]], faces)
    refused("nan.ply", "nan.ply", "x.pbfshape", "--cell", 0.01)
    write_obj("cross.obj", [(0.9, 0.1, 0), *vertices[1:]], faces)
    refused("crosses itself", "cross.obj", "x.pbfshape", "--cell", 0.01)
    write_obj("ok.obj", vertices, faces)
    refused("larger cells", "ok.obj", "x.pbfshape", "--cell", 1e-7)
    refused("may be thinner than a cell", "ok.obj", "x.pbfshape", "--cell", 3)
    refused("at least 1.5 cells", "ok.obj", "x.pbfshape", "--cell", 0.1, "--thickness", 0.1)
    refused("can't be written", "ok.obj", "no/such/x.pbfshape", "--cell", 0.05)
    refused("does not exist", "none.obj", "x.pbfshape", "--cell", 0.05)
    refused("is a folder", ".", "x.pbfshape", "--cell", 0.05)
    (WORK / "text.obj").write_text("no mesh at all\n")
    refused("text.obj", "text.obj", "x.pbfshape", "--cell", 0.05)
    (WORK / "cut.stl").write_bytes((WORK / "ball.stl").read_bytes()[:1000])
    refused("cut.stl", "cut.stl", "x.pbfshape", "--cell", 0.05)
    refused("cut short", "--show", "text.obj")
    refused("--cell, --spacing or --cells is missing", "ok.obj", "x.pbfshape", code=2)
    refused("a file to write is missing", "ok.obj", code=2)
    refused("-1", "ok.obj", "x.pbfshape", "--cell", -1, code=2)
    check("nothing is written", not (WORK / "x.pbfshape").exists())


def raw_ply(vertices, faces, face_corners, body, form="ascii"):
    return (f"ply\nformat {form} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n"
            f"element face {faces}\nproperty list {face_corners} int vertex_indices\nend_header\n").encode() + body


def damaged_meshes_are_told():
    """Assimp crashes, or finds no end, with some of them."""
    (WORK / "below.ply").write_bytes(raw_ply(3, 1, "uchar", b"0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"))
    refused("has vertex 4294967295; there are 3", "below.ply", "x.pbfshape", "--cell", 0.1)
    (WORK / "none.ply").write_bytes(raw_ply(3, 1, "uchar", b"", "binary_little_endian"))
    refused("none.ply can't be read", "none.ply", "x.pbfshape", "--cell", 0.1)
    (WORK / "most.ply").write_bytes(raw_ply(4294967295, 1, "uchar", b"0 0 0\n"))
    refused("most.ply can't be read", "most.ply", "x.pbfshape", "--cell", 0.1)
    (WORK / "more.ply").write_bytes(raw_ply(8000000000, 1, "uchar", b"0 0 0\n"))
    # AddressSanitizer ends a program that asks for so much, in place of an exception.
    watched = b"__asan_init" in BAKE.read_bytes()
    refused("more.ply can't be read" if watched else "there is no memory", "more.ply", "x.pbfshape", "--cell", 0.1)
    round_ = "".join(f"v {math.cos(i / 3200)} {math.sin(i / 3200)} 0\n" for i in range(20001))
    (WORK / "corners.obj").write_text(round_ + "f " + " ".join(map(str, range(1, 20002))) + "\n")
    refused("has 20001 corners", "corners.obj", "x.pbfshape", "--cell", 0.1)
    (WORK / "crash.off").write_text("OFF\n8 12 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 99\n")
    refused("crash.off can't be read", "crash.off", "x.pbfshape", "--cell", 0.1)
    (WORK / "endless.ply").write_bytes(b"ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\n3 0 0\n0.5 0.5 0.5\n" * 3)

    def little_time():
        resource.setrlimit(resource.RLIMIT_CPU, (3, resource.RLIM_INFINITY))
    done = subprocess.run([str(BAKE), "endless.ply", "x.pbfshape", "--cell", "1"], capture_output=True, text=True, check=False,
                          cwd=WORK, preexec_fn=little_time)
    check(f"no end is told: {done.stderr!r}", done.returncode == 1 and "endless.ply can't be read" in done.stderr)


def far_meshes_are_right_or_refused():
    """A house on a map: corners that the reader's numbers can't tell from others made one of half as much again."""
    def house(side):
        half = (side / 2,) * 3
        vertices, faces = box(half)
        return [[v[0] + 448262.3, v[1] + 520.1, v[2] + 5411932.7] for v in vertices], faces
    write_obj("house.obj", *house(1.3))
    refused("its numbers are read 0.5 apart, and cells are 0.1", "house.obj", "x.pbfshape", "--cell", 0.1)
    refused("are read 0.005 apart", "house.obj", "x.pbfshape", "--cell", 0.001, "--scale", 0.01)
    write_obj("hill.obj", *house(640))
    done = bake("hill.obj", "hill.pbfshape", "--cell", 16)
    volume = float(done.stdout.split("volume")[1].split()[0].rstrip(","))
    check(f"a hill has its volume: {volume}", abs(volume / 640**3 - 1) < 0.02)


def files_of_holes_are_not_read():
    with open(WORK / "holes.obj", "wb") as file:
        file.truncate(1 << 35)
    try:
        ended = subprocess.run([str(BAKE), "holes.obj", "holes.pbfshape", "--cell", "0.1"], capture_output=True, text=True,
                               check=False, cwd=WORK, timeout=30)
        check("its size is told", ended.returncode == 1 and "holes.obj has 34359738368 bytes" in ended.stderr)
    except subprocess.TimeoutExpired:
        check("a file of holes is not read", False)
    (WORK / "holes.obj").unlink()


def children_of(number):
    try:
        return [int(child) for child in pathlib.Path(f"/proc/{number}/task/{number}/children").read_text().split()]
    except OSError:
        return []


def eventually(holds):
    """Within ten seconds."""
    for _ in range(1000):
        if holds():
            return True
        time.sleep(0.01)
    return False


def none_reads_on_for_a_program_that_was_killed():
    if not pathlib.Path("/proc/self/task").exists():
        return
    os.mkfifo(WORK / "pipe.obj")  # that nothing is ever written to
    program = subprocess.Popen([str(BAKE), "pipe.obj", "pipe.pbfshape", "--cell", "0.1"], cwd=WORK)
    begun = eventually(lambda: children_of(program.pid))
    readers = children_of(program.pid)
    program.kill()
    program.wait()
    check("a mesh is read in a process of its own", begun)
    for reader in readers:
        ends = eventually(lambda: not pathlib.Path(f"/proc/{reader}").exists())
        check("it ends with the program", ends)
        if not ends:
            os.kill(reader, signal.SIGKILL)
    (WORK / "pipe.obj").unlink()


def what_is_told_is_one_line():
    """Whatever the names of files, and the words of the command line, are."""
    for words in (("--show", "no\nfile\x1b[2J"), ("cube.obj", "no/fol\nder/\x1b[2J", "--cell", 0.2),
                  ("cube.obj", "x", "--cell", "0\n\x1b[2J"), ("--show", "x", "a\n\x1b[2J", "b")):
        told = bake(*words).stderr
        lines = told.replace("\nRun with --help for more information.\n", "\n")
        check(f"{words}: {told!r}", told and lines.count("\n") == 1 and "\x1b" not in told)


def what_is_no_file_is_told():
    for name, words in (("/dev/zero", "does not begin as one"), ("/dev/null", "cut short"), ("/proc", "Is a directory"),
                        ("/proc/self/pagemap", "/proc/self/pagemap")):
        refused(words, "--show", name)
        check(f"{name} is named", name in bake("--show", name).stderr)
    (WORK / "loop").unlink(missing_ok=True)
    (WORK / "loop").symlink_to("loop")
    refused("loop can't be written", "ok.obj", "loop", "--cell", 0.05)
    check("the link is left", (WORK / "loop").is_symlink())


def bake_with(limit, *words):
    """No file may become larger than that, as on a full disk."""
    def set_limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    return subprocess.run([str(BAKE), *map(str, words)], capture_output=True, text=True, check=False, cwd=WORK, preexec_fn=set_limit)


def what_is_written_is_whole_or_as_before():
    write_obj("cube.obj", *box((1, 1, 1)))
    check("a cube is baked", bake("cube.obj", "kept.pbfshape", "--cell", 0.2).returncode == 0)
    before = (WORK / "kept.pbfshape").read_bytes()
    (WORK / "kept.pbfshape").chmod(0o600)
    ended = bake_with(5000, "cube.obj", "kept.pbfshape", "--cell", 0.1)
    check("a full disk is told", ended.returncode == 1 and "can't be written" in ended.stderr)
    check("the old file is left", (WORK / "kept.pbfshape").read_bytes() == before)
    check("nothing is left beside it", not list(WORK.glob("kept.pbfshape.*")))
    (WORK / "link.pbfshape").symlink_to("kept.pbfshape")
    check("through a link", bake("cube.obj", "link.pbfshape", "--cell", 0.1).returncode == 0)
    check("the link is one", (WORK / "link.pbfshape").is_symlink())
    check("the file is another", (WORK / "kept.pbfshape").read_bytes() != before)
    (WORK / "ahead.pbfshape").symlink_to("later.pbfshape")
    check("through a link to nothing", bake("cube.obj", "ahead.pbfshape", "--cell", 0.2).returncode == 0)
    check("that link is one", (WORK / "ahead.pbfshape").is_symlink())
    check("what it leads to is there", (WORK / "later.pbfshape").is_file())
    script = 'echo other > "$1.$$.0.new"; echo other > "$1.$$.new"; exec "$0" cube.obj "$1" --cell 0.2'
    done = subprocess.run(["sh", "-c", script, str(BAKE), "kept.pbfshape"], cwd=WORK, check=False)
    check("beside a process of this number", done.returncode == 0)
    others = list(WORK.glob("kept.pbfshape.*"))
    check("its files are left", [other.read_text() for other in others] == ["other\n", "other\n"])
    for other in others:
        other.unlink()
    check("its permissions stay", (WORK / "kept.pbfshape").stat().st_mode & 0o777 == 0o600)


def a_mesh_is_not_written_over():
    vertices, faces = box((0.5, 0.5, 0.5))
    write_obj("only.obj", vertices, faces)
    before = (WORK / "only.obj").read_bytes()
    (WORK / "other.obj").unlink(missing_ok=True)
    (WORK / "other.obj").symlink_to("only.obj")
    for name in ("only.obj", "./only.obj", "other.obj"):
        refused("is the mesh itself", "only.obj", name, "--cell", 0.2)
    check("a mesh stays", (WORK / "only.obj").read_bytes() == before)


def readers_may_go_away():
    pipe = WORK / "pipe.pbfshape"
    os.mkfifo(pipe)
    with subprocess.Popen(["head", "-c", "10", str(pipe)], stdout=subprocess.DEVNULL):
        ended = bake("cube.obj", "pipe.pbfshape", "--cell", 0.03)
    check("a reader that goes away is told", ended.returncode == 1 and "can't be written" in ended.stderr)
    check("the pipe is left", pipe.is_fifo())
    with open("/dev/full", "w", encoding="utf-8") as full:
        shown = subprocess.run([str(BAKE), "--show", "kept.pbfshape"], stdout=full, stderr=subprocess.PIPE, check=False, cwd=WORK)
    check("lost output is told", shown.returncode == 1 and b"can't be written" in shown.stderr)


for left in [*WORK.glob("*.pbfshape"), *WORK.glob("pipe.obj")]:
    left.unlink()
balls_have_their_distances()
boxes_are_placed()
open_meshes_are_shells()
collapsed_triangles_are_left_out()
what_is_no_solid_is_refused()
damaged_meshes_are_told()
far_meshes_are_right_or_refused()
files_of_holes_are_not_read()
none_reads_on_for_a_program_that_was_killed()
what_is_no_file_is_told()
what_is_told_is_one_line()
what_is_written_is_whole_or_as_before()
a_mesh_is_not_written_over()
readers_may_go_away()
sys.exit(1 if failures else 0)
