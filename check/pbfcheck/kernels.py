"""Smoothing kernels, their sums over the rest lattice and the rest spacing that follows."""
import numpy as np
from scipy.optimize import brentq

# A lattice whose density by the solver's own kernel is within this of 1 counts as its rest state.
REST_TOLERANCE = 0.05


def wendland_c2(r, h, dim):
    q = np.minimum(np.asarray(r, float) / h, 1.0)
    norm = 7 / (np.pi * h**2) if dim == 2 else 21 / (2 * np.pi * h**3)
    rest = (1 - q) ** 2
    return norm * rest * rest * (4 * q + 1)


def poly6(r, h, dim):
    rest = np.maximum(h * h - np.square(np.asarray(r, float)), 0.0)
    norm = 4 / (np.pi * h**8) if dim == 2 else 315 / (64 * np.pi * h**9)
    return norm * rest**3


def cubic_spline(r, h, dim):
    """Monaghan's, which ends at h."""
    q = np.minimum(np.asarray(r, float) / h, 1.0)
    norm = 40 / (7 * np.pi * h**2) if dim == 2 else 8 / (np.pi * h**3)
    return norm * np.where(q <= 0.5, 6 * q * q * (q - 1) + 1, 2 * (1 - q) ** 3)


# By the names in a manifest: the kernel of the density. A gradient kernel plays no part here.
# "cubic_spline" is none of the library's, but other solvers' by default.
KERNELS = {"wendland_c2": wendland_c2, "poly6_spiky": poly6, "cubic_spline": cubic_spline}


def lattice_points(reach, dim):
    """Points of the integer lattice within `reach` of the origin, the origin included."""
    n = int(np.floor(reach))
    axis = np.arange(-n, n + 1, dtype=float)
    points = np.stack(np.meshgrid(*[axis] * dim, indexing="ij"), -1).reshape(-1, dim)
    return points[np.einsum("ij,ij->i", points, points) <= reach * reach]


def lattice_sum(name, h, spacing, dim):
    """Sum of W over a square or cubic lattice, seen from one of its points."""
    distance = spacing * np.linalg.norm(lattice_points(h / spacing, dim), axis=1)
    return float(KERNELS[name](distance, h, dim).sum())


def calibrated_volume(name, h, spacing, dim):
    """The particle volume with which that lattice has density 1."""
    return 1.0 / lattice_sum(name, h, spacing, dim)


def rest_spacing(name, h, spacing, volume, dim):
    """(spacing of the lattice at rest, where it comes from).

    It is the scene's spacing, unless the solver's own constraint contradicts it: a scene may start
    compressed or stretched. Then it is the spacing at which the solver's kernel gives density 1.
    """
    density = volume * lattice_sum(name, h, spacing, dim)
    if abs(density - 1) <= REST_TOLERANCE:
        return spacing, "spacing"
    low, high = h / 6, h * (1 - 1e-9)
    excess = [volume * lattice_sum(name, h, s, dim) - 1 for s in (low, high)]
    if excess[0] <= 0 or excess[1] >= 0:
        return spacing, "spacing"
    solved = brentq(lambda s: volume * lattice_sum(name, h, s, dim) - 1, low, high, xtol=1e-14 * h)
    return float(solved), "smoothing_radius, kernel and particle_volume"
