"""Spray: particles in groups too small to have an interior."""
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

LINK = 1.5  # spacings: within a lattice's first two shells, below its third


def groups(points, spacing):
    """The number of the connected group of each particle."""
    count = len(points)
    if count == 0:
        return np.zeros(0, int)
    pairs = cKDTree(points).query_pairs(LINK * spacing, output_type="ndarray")
    links = coo_matrix((np.ones(len(pairs), np.int8), (pairs[:, 0], pairs[:, 1])), (count, count))
    return connected_components(links, directed=False)[1]


def is_spray(points, spacing):
    """Particles in groups of fewer than 3^dim, links up to 1.5 spacings."""
    group = groups(points, spacing)
    if not len(group):
        return np.zeros(0, bool)
    return np.bincount(group)[group] < 3 ** points.shape[1]
