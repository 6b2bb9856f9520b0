"""Kernel densities from positions, in units of the rest density."""
import numpy as np
from scipy.spatial import cKDTree

from .kernels import KERNELS
from .walls import half_space_share, mirror_images

WALL_MODELS = ("mirror", "integral", "none")


def _self_pairs(tree, points, radius):
    pairs = tree.query_pairs(radius, output_type="ndarray")
    i, j = pairs[:, 0], pairs[:, 1]
    separation = points[i]
    separation -= points[j]
    return i, j, np.sqrt(np.einsum("ij,ij->i", separation, separation))


def kernel_sums(points, kernel, h, ghosts=None):
    """Sum of W over all points and ghosts within h of each point, itself included."""
    count, dim = points.shape
    weight = KERNELS[kernel]
    sums = np.full(count, float(weight(0.0, h, dim)))
    if count == 0:
        return sums
    tree = cKDTree(points)
    i, j, distance = _self_pairs(tree, points, h)
    w = weight(distance, h, dim)
    sums += np.bincount(i, w, count) + np.bincount(j, w, count)
    if ghosts is not None and len(ghosts):
        near = tree.sparse_distance_matrix(cKDTree(ghosts), h, output_type="ndarray")
        sums += np.bincount(near["i"], weight(near["v"], h, dim), count)
    return sums


def densities(points, kernel, h, volume, surfaces, rest_spacing, wall_model="mirror"):
    """rho/rho0 of each point.

    mirror    images of the fluid in the wall: exact for a lattice that fits the box
    integral  the kernel's integral behind the wall at rest density, begun where it is exact for the
              first layer of a lattice
    none      the solver's fluid has no walls in its density
    """
    ghosts = mirror_images(points, surfaces, h) if wall_model == "mirror" else None
    density = volume * kernel_sums(points, kernel, h, ghosts)
    if wall_model == "integral" and len(points):
        share = half_space_share(points, surfaces, kernel, h, rest_spacing)
        density += volume / rest_spacing ** points.shape[1] * share
    return density
