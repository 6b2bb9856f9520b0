"""The same again: bits, threads, order, orientation, rotation."""
import numpy as np
from types import SimpleNamespace

from ..distance import cell_density_distance
from ..fault import NotApplicable
from ..rotating_tank import RotatingTank
from .everywhere import centre, failed_calls
from .figure import at_most, exactly
from .files import first, frames, last
from .shared import energy_gain
from .time_step import GAIN


def different(a, b):
    """Numbers in which two frames differ."""
    if a.positions.shape != b.positions.shape:
        return max(a.positions.size, b.positions.size)
    return int((a.positions != b.positions).sum() + (a.velocities != b.velocities).sum())


def save_and_load(files):
    whole, resumed = last(files.trial("whole")), last(files.trial("resumed"))
    return [exactly("calls failed", failed_calls(files)), exactly("numbers that differ", different(whole, resumed)),
            exactly("steps apart", abs(whole.step - resumed.step))]


def thread_counts(files):
    ends = [last(dump) for _, dump in files.trials("threads-")]
    return [exactly("numbers that differ", max(different(ends[0], end) for end in ends[1:]))]


def permuted(files):
    a, b = files.trial("in-order"), files.trial("permuted")
    order, d = np.array(files.fact("order")), a.rest_spacing
    end, other = last(a), last(b)
    apart = np.linalg.norm(end.positions[order] - other.positions, axis=1)
    return [at_most("positions apart, RMS in spacings", np.sqrt(np.mean(apart**2)) / d, 0.01),
            at_most("share of particles in other cells of 4 spacings",
                    cell_density_distance(end.positions, other.positions, 4 * d), 0.01)]


def turned_and_mirrored(files):
    a, b = files.trial("upright"), files.trial("turned")
    mirror, d = files.fact("mirror"), a.rest_spacing
    centres, energies = 0.0, 0.0
    for f, g in zip(frames(a)[1:], frames(b)[1:]):
        c = centre(g)
        back = np.array([mirror - c[2], c[0], c[1]])
        centres = max(centres, np.linalg.norm(centre(f) - back) / d)
        energies = max(energies, abs(np.square(g.velocities).sum() / np.square(f.velocities).sum() - 1))
    return [at_most("centres of mass apart, in spacings", centres, 0.01),
            at_most("kinetic energies apart, relative", energies, 0.01)]


def turning_tank(files):
    figures = []
    for label, dump in files.trials("omega-"):
        omega = float(label.split("-")[1])
        figures.append(at_most(f"{omega:g} rad/s: energy gained", energy_gain(dump), GAIN))
        if omega <= 10:
            figures.append(_paraboloid(dump, omega, files.fact("half")))
    return figures


def _paraboloid(dump, omega, half):
    """Curvature of the surface. Where 0.2 spacings are more than the share of the rise that is asked for,
    they are allowed: the surface of particles is no better known."""
    radius = half - 2 * dump.rest_spacing
    rise = omega**2 * radius**2 / (2 * np.linalg.norm(dump.manifest.gravity))
    options = SimpleNamespace(omega=omega, center=[0.0, 0.0], radius=radius)
    try:
        figures, _ = RotatingTank().run(dump, [last(dump)], options)
        off = abs(figures["curvature.error"])
    except NotApplicable:
        off = None
    return at_most(f"{omega:g} rad/s: rise of the paraboloid off by", off, max(0.02, 0.2 * dump.rest_spacing / rise))
