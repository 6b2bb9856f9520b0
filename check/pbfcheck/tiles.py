"""Splitting space so that grids stay small: particles far apart do not span one big grid."""
import numpy as np

MOST_CELLS = 30_000_000


def _allowed(count):
    """Cells that a tile may have for this many particles: no big grid for a few."""
    return min(MOST_CELLS, 500_000 + 2_000 * count)


def _cells(low, high, pad, cell):
    return float(np.prod(np.ceil((high - low + 2 * pad) / cell)))


def particle_tiles(points, wanted, pad, cell):
    """Splits the wanted indices into sets whose padded bounding box is small, where it can be."""
    stack = [wanted] if len(wanted) else []
    while stack:
        index = stack.pop()
        low, high = points[index].min(axis=0), points[index].max(axis=0)
        if _cells(low, high, pad, cell) <= _allowed(len(index)) or np.all(high - low <= 2 * pad):
            yield index
            continue
        axis = int(np.argmax(high - low))
        left = points[index, axis] < (low[axis] + high[axis]) / 2
        stack += [index[left], index[~left]]


def cell_tiles(points, origin, cell, reach, axes):
    """Disjoint boxes of cells [first, last) that hold every cell within `reach` cells of a point.

    Only `axes` are split. Yields (first, last, indices of the points within reach of the box).
    """
    if not len(points):
        return
    home = np.floor((points - origin) / cell).astype(np.int64)
    stack = [(home.min(axis=0) - reach, home.max(axis=0) + reach + 1, np.arange(len(points)))]
    while stack:
        first, last, index = stack.pop()
        near = np.all((home[index] >= first - reach) & (home[index] < last + reach), axis=1)
        index = index[near]
        if not len(index):
            continue
        size = last - first
        axis = max(axes, key=lambda a: size[a])
        if np.prod(size.astype(float)) <= _allowed(len(index)) or size[axis] <= 4 * reach:
            yield first, last, index
            continue
        middle = (first[axis] + last[axis]) // 2
        left_last, right_first = last.copy(), first.copy()
        left_last[axis] = right_first[axis] = middle
        stack += [(first, left_last, index), (right_first, last, index)]
