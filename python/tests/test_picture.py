"""Pictures: what is where in them, read back by another program's decoder where there is one."""
import io
import struct
import zlib

import numpy as np
import pytest

import pbf


def decode(data):
    """The pixels of a PNG that has no filters."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, body, size = 8, b"", None
    while at < len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        chunk = data[at + 8:at + 8 + length]
        assert struct.unpack_from(">I", data, at + 8 + length)[0] == zlib.crc32(kind + chunk)
        size = struct.unpack_from(">II", chunk) if kind == b"IHDR" else size
        body += chunk if kind == b"IDAT" else b""
        at += 12 + length
    rows = np.frombuffer(zlib.decompress(body), np.uint8).reshape(size[1], -1)
    assert (rows[:, 0] == 0).all()
    return rows[:, 1:].reshape(size[1], size[0], 3)


def blue(image):
    """Where water is: more blue than red."""
    return image[..., 2].astype(int) - image[..., 0] > 40


def test_png(dam, tmp_path):
    dam.save_picture(tmp_path / "dam.png", (160, 120))
    image = decode((tmp_path / "dam.png").read_bytes())
    assert (image == dam.render((160, 120))).all()
    shown = decode(dam._repr_png_())
    assert shown.shape == (480, 640, 3)
    pillow = pytest.importorskip("PIL.Image")
    assert (np.asarray(pillow.open(tmp_path / "dam.png")) == image).all()


def test_water_is_where_it_is(make):
    """In 2D pixels are coordinates: the lower left quarter of the box is full, the rest empty."""
    fluid = make(pbf.fill_box((0, 0), (0.5, 0.5), 0.05))
    water = blue(fluid.render((200, 200)))
    assert water[110:180, 20:90].mean() > 0.9  # discs leave gaps
    assert not water[:95].any() and not water[:, 110:].any()


def test_nearer_is_before(make):
    """One ball behind another: the colour of the near one is seen. With x to the right and y up, +z
    comes out of the picture."""
    for values, dark in (([0, 1], True), ([1, 0], False)):
        fluid = make([[0.5, 0.5, 0.9], [0.5, 0.5, 0.1]])
        image = fluid.render((101, 101), colour=values, limits=(0, 1), azimuth=0, elevation=0,
                             radius=0.2)
        assert bool(image[50, 50, 0] < 100) is dark


def test_colliders_are_seen(make):
    fluid = make()
    empty = fluid.render((120, 90))
    for collider in (pbf.Sphere((0.5, 0.5, 0.5), radius=0.3), pbf.Capsule(
            (0.5, 0.5, 0.5), radius=0.1, half_length=0.3),
            pbf.Box((0.5, 0.5, 0.5), half_extents=(0.3, 0.2, 0.1), orientation=(0, 0, 0.6, 0.8))):
        fluid.colliders = collider
        changed = (fluid.render((120, 90)) != empty).any(axis=2)
        assert changed[45, 60] and 0.01 < changed.mean() < 0.5
    assert (fluid.render((120, 90), colliders=False) == empty).all()


def test_solids_of_any_form_are_drawn_as_what_they_are(make):
    """A ball and a box as distances on a grid look as a Sphere and a Box do, turned and scaled."""
    fluid = make()
    cell, n = 0.05, 33
    x, y, z = np.meshgrid(*[cell * (np.arange(n) - n // 2)] * 3, indexing="ij")
    turn = (0.0, 0.0, np.sin(0.2), np.cos(0.2))
    ball = pbf.Geometry.from_grid(np.sqrt(x**2 + y**2 + z**2) - 0.6, (-cell * (n // 2),) * 3, cell)
    corners = np.array(np.meshgrid(*[(-0.3, 0.3)] * 3)).reshape(3, -1).T
    brick = pbf.Geometry.from_points(corners, cell=0.02)
    pairs = ((pbf.Solid((0.5, 0.5, 0.5), geometry=ball, scale=0.5), pbf.Sphere((0.5, 0.5, 0.5), radius=0.3)),
             (pbf.Solid((0.4, 0.5, 0.5), geometry=brick, orientation=turn),
              pbf.Box((0.4, 0.5, 0.5), half_extents=(0.3, 0.3, 0.3), orientation=turn)))
    empty = fluid.render((120, 90)).astype(int)
    for solid, same in pairs:
        fluid.colliders = same
        right = fluid.render((120, 90)).astype(int)
        fluid.colliders = solid
        image = fluid.render((120, 90)).astype(int)
        drawn, covered = (np.abs(each - empty).max(axis=2) > 20 for each in (image, right))
        assert covered.sum() > 500
        assert (drawn != covered).sum() < 0.06 * covered.sum()  # half a pixel along the outline
        assert np.abs(image - right)[drawn & covered].mean() < 6


def test_flat_solids_are_drawn_by_their_inside(make):
    fluid = make(dimension=2)
    square = np.array([(-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2)])
    fluid.colliders = pbf.Box((0.5, 0.5), half_extents=(0.2, 0.2))
    right = fluid.render((120, 90)).astype(int)
    fluid.colliders = pbf.Solid((0.5, 0.5), geometry=pbf.Geometry.from_points(square, cell=0.01))
    image = fluid.render((120, 90)).astype(int)
    assert (np.abs(image - right).max(axis=2) > 20).mean() < 0.02


@pytest.mark.parametrize("options, words", [
    ({"size": (0, 5)}, "size"), ({"colour": "taste"}, '"speed"'), ({"colour": [1, 2]}, "1000")])
def test_refusals(dam, options, words):
    with pytest.raises(pbf.InvalidArgumentError, match=words):
        dam.render(**options)


def test_colours(dam):
    dam.step(5)
    images = [dam.render((80, 60), colour=colour) for colour in
              ("speed", "height", "density", "pressure", np.arange(1000))]
    for i, one in enumerate(images):
        for other in images[:i]:
            assert (one != other).any()


@pytest.mark.parametrize("name", ["a.png", "a.gif"])
def test_movies(dam, tmp_path, name):
    pillow = pytest.importorskip("PIL.Image")
    with pbf.Movie(tmp_path / name, fps=20, size=(64, 48)) as movie:
        for _ in dam.frames(3, steps=5):
            movie.add(dam)
    opened = pillow.open(io.BytesIO((tmp_path / name).read_bytes()))
    assert opened.n_frames == 3 and opened.size == (64, 48)
    with pytest.raises(pbf.InvalidArgumentError, match="gif"):
        pbf.Movie("a.avi")


@pytest.mark.parametrize("name", ["a.png", "a.gif"])
def test_an_old_movie_stays_where_a_new_one_finds_no_room(dam, tmp_path, name):
    pytest.importorskip("PIL.Image")
    resource = pytest.importorskip("resource")
    (tmp_path / name).write_bytes(b"kept")
    movie = pbf.Movie(tmp_path / name, fps=20, size=(64, 48))
    movie.add(dam)
    movie.add(dam)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (300, limits[1]))  # as on a full disk
    try:
        with pytest.raises(OSError):
            movie.close()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert [left.name for left in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).read_bytes() == b"kept"
