"""Two fluids of different densities in one solver."""
import numpy as np

from .figure import at_least, at_most
from .files import first, frames, last
from .shared import noise


def _masses(files, label, count):
    fact = next(f for f in files.fact("fluids") if f["trial"] == label)
    masses = np.full(count, float(fact["densities"][0]))
    masses[fact["second"]:] = fact["densities"][1]
    return masses


def _momentum(frame, masses):
    return (masses[:, None] * frame.velocities).sum(axis=0)


def _energy(frame, masses):
    return 0.5 * (masses[:, None] * frame.velocities**2).sum()


def mass_ratio(files):
    figures = []
    for label, dump in files.trials():
        start = first(dump)
        masses = _masses(files, label, len(start.positions))
        size = (masses * np.linalg.norm(start.velocities, axis=1)).sum()
        drift = max(np.linalg.norm(_momentum(f, masses) - _momentum(start, masses)) for f in frames(dump)) / size
        gain = max(_energy(f, masses) for f in frames(dump)) / _energy(start, masses) - 1
        end, light = last(dump), masses == masses.min()
        slowed = 1 - abs(end.velocities[~light, 0].mean() / start.velocities[~light, 0].mean())
        figures += [at_most(f"{label}: momentum, relative drift", drift, 1e-5),
                    at_most(f"{label}: energy gained", gain, 0.01),
                    # It can lose no more than what stops the light one and throws it ahead at 3 times its speed.
                    at_most(f"{label}: speed that the heavy drop loses", slowed, 4 * masses.min() / masses.max())]
    return figures


def _wrong_side(frame, masses):
    """Share of particles that are on the other fluid's side of a flat interface between both."""
    heavy = masses == masses.max()
    order = np.argsort(frame.positions[:, 1], kind="stable")
    lower = np.zeros(len(masses), dtype=bool)
    lower[order[:int(heavy.sum())]] = True
    return float(np.mean(lower != heavy))


def _parted(frame, masses):
    """How much higher the lighter one is in the mean; 1: as two layers are, -1: as they are upside down."""
    heavy, y = masses == masses.max(), frame.positions[:, 1]
    order = np.sort(y)
    count = int(heavy.sum())
    return float((y[~heavy].mean() - y[heavy].mean()) / (order[count:].mean() - order[:count].mean()))


def density_ratio(files):
    figures = []
    for label, dump in files.trials():
        end = last(dump)
        masses = _masses(files, label, len(end.positions))
        figures += [at_most(f"{label}: particles on the other's side", _wrong_side(end, masses), 0.02),
                    at_most(f"{label}: noise at the end, over sqrt(g d)", noise(dump, end), 0.2)]
    return figures


def heavy_above(files):
    figures = []
    for label, dump in files.trials():
        start, end = first(dump), last(dump)
        masses = _masses(files, label, len(end.positions))
        figures += [at_most(f"{label}: parted at the start", _parted(start, masses), -0.99),
                    at_least(f"{label}: … at the end", _parted(end, masses), 0.95)]
    return figures
