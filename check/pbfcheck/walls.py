"""The domain's walls: where they stand, and what of the kernel lies behind them.

`domain_min` and `domain_max` bound the particles' centres. The wall's own matter begins `offset`
behind them, half a spacing by default: a lattice whose first layer touches the bound continues
into the wall without a gap.
"""
from dataclasses import dataclass

import numpy as np

from .kernels import KERNELS, lattice_points


@dataclass(frozen=True)
class Walls:
    lower: np.ndarray
    upper: np.ndarray
    present: np.ndarray  # x min, x max, y min, …; as are the four below
    velocity: np.ndarray
    amplitude: np.ndarray
    frequency: np.ndarray
    phase: np.ndarray
    offset: float

    @property
    def moving(self):
        shaken = (self.amplitude != 0) & (self.frequency != 0)
        return bool(np.any(self.present & ((self.velocity != 0) | shaken)))

    def bounds(self, time):
        """(lower, upper) of the centres at a time; infinite where there is no wall."""
        shift = (self.velocity * time
                 + self.amplitude * np.sin(self.frequency * time + self.phase))
        lower = np.where(self.present[0::2], self.lower + shift[0::2], -np.inf)
        upper = np.where(self.present[1::2], self.upper + shift[1::2], np.inf)
        return lower, upper

    def surfaces(self, time):
        """(lower, upper) planes behind which the wall's matter begins."""
        lower, upper = self.bounds(time)
        return lower - self.offset, upper + self.offset


def distance_to_walls(points, surfaces):
    """Distance of each point to the nearest wall surface; infinite where there is none."""
    lower, upper = surfaces
    return np.minimum(points - lower, upper - points).min(axis=1)


def _axis_images(points, axis, lower, upper, reach):
    """Mirror images in both planes of an axis that lie within `reach` behind them, images of
    images too where the domain is that thin."""
    images = []
    inside = points[(points[:, axis] >= lower) & (points[:, axis] <= upper)]
    for first in (0, 1):
        side, current = first, inside
        while len(current):
            plane = upper if side else lower
            if not np.isfinite(plane):
                break
            current = current.copy()
            current[:, axis] = 2 * plane - current[:, axis]
            depth = current[:, axis] - upper if side else lower - current[:, axis]
            current = current[depth <= reach]
            images.append(current)
            if upper - lower <= 0:
                break
            side = 1 - side
    return images


def mirror_images(points, surfaces, reach):
    """Mirror images of the points in the wall surfaces, those within `reach` of the domain; edges
    and corners included. A lattice that fits the box is continued exactly."""
    lower, upper = surfaces
    everything = points
    for axis in range(points.shape[1]):
        images = _axis_images(everything, axis, lower[axis], upper[axis], reach)
        everything = np.concatenate([everything] + images)
    return everything[len(points):]


def half_space_table(kernel, h, dim, samples=2001):
    """(distances, integral of W beyond a plane at that distance), 0 … h."""
    z = np.linspace(0, h, samples)
    # Integral over the plane at distance z: substitute the in-plane radius by r, which is smooth.
    u = (np.arange(400) + 0.5) / 400
    width = np.sqrt(np.maximum(h * h - z * z, 0))[:, None]
    s = width * u
    values = KERNELS[kernel](np.sqrt(z[:, None] ** 2 + s * s), h, dim)
    measure = 2.0 if dim == 2 else 2 * np.pi * s
    plane = (values * measure * width / 400).sum(axis=1)
    pieces = (plane[1:] + plane[:-1]) / 2 * (z[1] - z[0])
    return z, np.append(np.cumsum(pieces[::-1])[::-1], 0.0)


def _plane_shift(kernel, h, spacing, dim, beyond):
    """How far behind the wall's surface its half-space must begin, so that it lends the first layer of
    a lattice, half a spacing before the surface, just what the lattice behind would."""
    points = spacing * lattice_points(h / spacing, dim)
    behind = points[points[:, -1] < 0]
    lent = KERNELS[kernel](np.linalg.norm(behind, axis=1), h, dim).sum() * spacing**dim
    z, share = beyond
    return float(np.interp(-lent, -share, z)) - spacing / 2


def half_space_share(points, surfaces, kernel, h, spacing):
    """Share of the kernel behind the walls: the integral beyond a plane, calibrated on the lattice; at
    edges 1 - product(1 - I_k)."""
    dim = points.shape[1]
    z, beyond = half_space_table(kernel, h, dim)
    shift = _plane_shift(kernel, h, spacing, dim, (z, beyond))
    free = np.ones(len(points))
    for side in (points - surfaces[0], surfaces[1] - points):
        distance = side + shift
        share = np.interp(np.minimum(np.abs(distance), h), z, beyond)
        free *= (1 - np.where(distance >= 0, share, 1 - share)).prod(axis=1)
    return 1 - free
