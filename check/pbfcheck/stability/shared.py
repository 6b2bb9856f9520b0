"""Figures that several cases share."""
import numpy as np
from types import SimpleNamespace

from ..density import densities
from ..energy import Energy
from ..momentum import AngularMomentum, LinearMomentum
from ..noise import Noise
from ..spray import is_spray
from ..volume import splat_volume
from .files import frames


def volume(dump, frame):
    """Volume of the fluid, spray included."""
    spray = is_spray(frame.positions, dump.rest_spacing)
    surfaces = dump.manifest.walls.surfaces(frame.time)
    bulk = splat_volume(frame.positions[~spray], dump.rest_spacing, surfaces) if not spray.all() else 0.0
    return bulk + int(spray.sum()) * dump.rest_volume


def compression(dump, frame):
    """max(rho/rho0 - 1, 0) of each particle by the solver's own kernel, walls mirroring the fluid."""
    m = dump.manifest
    rho = densities(frame.positions, m.kernel, m.smoothing_radius, m.particle_volume,
                    m.walls.surfaces(frame.time), dump.rest_spacing)
    return np.maximum(rho - 1, 0)


def energy_gain(dump):
    """Largest energy over that of the first frame, less 1."""
    measure = Energy(dump, SimpleNamespace())
    return max(measure.add(frame)["relative"] for frame in frames(dump))


def momentum_drifts(dump):
    drifts = []
    for kind in (LinearMomentum, AngularMomentum):
        measure = kind(dump, SimpleNamespace())
        rows = [measure.add(frame) for frame in frames(dump)]
        measure.finish(rows)
        drifts.append(max(row["relative"] for row in rows))
    return drifts


def noise(dump, frame):
    """RMS speed over sqrt(g d)."""
    return Noise(dump, SimpleNamespace()).add(frame)["rms"]
