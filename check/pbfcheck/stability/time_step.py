"""Time steps too large, too small and changing."""
import numpy as np

from ..spray import is_spray
from ..surface import height_map
from .figure import at_most
from .files import first, frames, last
from .shared import energy_gain, volume

GAIN = 1e-4  # of the energy: what float32's rounding may add


def coarse(files):
    dump = files.trial("dam")
    return [at_most("energy gained", energy_gain(dump), GAIN)]


def tiny_step(files):
    drop, still = files.trial("drop"), files.trial("still")
    start, end = first(drop), last(drop)
    size = np.max(drop.manifest.walls.upper - drop.manifest.walls.lower)
    way = start.velocities * end.time
    off = np.linalg.norm(end.positions - start.positions - way, axis=1).max() / size
    momentum = (np.linalg.norm(end.velocities.mean(axis=0) - start.velocities.mean(axis=0))
                / np.linalg.norm(start.velocities.mean(axis=0)))
    kinetic = np.square(end.velocities).sum() / np.square(start.velocities).sum() - 1
    moved = np.linalg.norm(last(still).positions - first(still).positions, axis=1).max() / size
    fall = np.linalg.norm(still.manifest.gravity) * last(still).time**2
    return [at_most("flying drop: place, over the box", off, 1e-6),
            at_most("flying drop: momentum", momentum, 1e-6),
            at_most("flying drop: energy", abs(kinetic), 1e-6),
            at_most("water at rest: moved, over the box", moved, 1e-6 + fall / size)]


def _profile(dump, frame, cells=16):
    """Mean height of the surface over strips of the box's length."""
    d, m = dump.rest_spacing, dump.manifest
    surfaces = m.walls.surfaces(frame.time)
    x = frame.positions[~is_spray(frame.positions, d)]
    surface = height_map(x, d, surfaces, 1, 1)
    strip = np.floor((surface.columns[:, 0] - surfaces[0][0]) / (surfaces[1][0] - surfaces[0][0]) * cells)
    strip = np.clip(strip.astype(int), 0, cells - 1)
    weight = np.bincount(strip, surface.weights, cells)
    return np.bincount(strip, surface.weights * surface.heights, cells) / weight


def alternating_step(files):
    constant, alternating = files.trial("constant"), files.trial("alternating")
    a, b = frames(constant)[1:], frames(alternating)[1:]
    depth = volume(constant, first(constant)) / np.prod(np.delete(
        constant.manifest.walls.upper - constant.manifest.walls.lower, 1))
    worst = max(np.sqrt(np.mean((_profile(constant, f) - _profile(alternating, g)) ** 2)) for f, g in zip(a, b))
    apart = max(abs(f.time - g.time) for f, g in zip(a, b))
    return [at_most("surface off by, RMS over the depth", worst / depth, 0.02),
            at_most("times of the frames apart", apart, 1e-9),
            at_most("energy gained", max(energy_gain(constant), energy_gain(alternating)), GAIN)]
