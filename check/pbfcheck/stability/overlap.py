"""Particles closer than the fluid ever puts them."""
import numpy as np
from scipy.spatial import cKDTree

from ..density import densities
from .everywhere import centre, failed_calls, fastest
from .figure import at_least, at_most, exactly
from .files import first, frames, last
from .shared import noise, volume

CAP = 1.0  # h a step: the largest speed that the density solve may give a particle


def two_coincident(files):
    dump = files.trial("pair")
    end = last(dump)
    apart = np.linalg.norm(end.positions[0] - end.positions[1]) / dump.rest_spacing
    total = max(np.linalg.norm(f.velocities.sum(axis=0)) for f in frames(dump))
    speed = max(max(np.linalg.norm(f.velocities, axis=1).sum() for f in frames(dump)), 1e-300)
    return [at_least("distance after a second, in spacings", apart, 0.1),
            at_most("momentum over the sum of its parts", total / speed, 1e-5)]


def thousand_coincident(files):
    dump = files.trial("clump")
    m, d = dump.manifest, dump.rest_spacing
    speed = max(fastest(f) for f in frames(dump)) * m.time_step / m.smoothing_radius
    start = centre(first(dump))
    drift = max(np.linalg.norm(centre(f) - start) for f in frames(dump)) / d
    nearest = cKDTree(last(dump).positions).query(last(dump).positions, 2)[0][:, 1].mean() / d
    return [at_most("fastest, in h a step", speed, CAP),
            at_most("centre of mass moved, in spacings", drift, 1e-3),
            at_least("mean distance to the nearest at the end, in spacings", nearest, 0.25)]


def one_cell(files):
    note = (f'{files.fact("seconds"):.3g} s, {files.fact("peak_bytes") / 2**20:.4g} MiB at most, '
            f'plan {files.fact("plan_bytes") / 2**20:.4g} MiB')
    return [exactly("calls failed other than for want of memory", failed_calls(files, ("PBF_ERROR_OUT_OF_MEMORY",))),
            at_most("peak memory, GiB", files.fact("peak_bytes") / 2**30, 16)], note


def neighbor_overflow(files):
    dump = files.trial("crowd")
    m, start = dump.manifest, first(dump)
    crash = exactly("calls failed", failed_calls(files))
    tree = cKDTree(start.positions)
    counts = tree.query_ball_point(start.positions, m.smoothing_radius, return_length=True) - 1
    rho = densities(start.positions, m.kernel, m.smoothing_radius, m.particle_volume,
                    m.walls.surfaces(0.0), dump.rest_spacing, "none")
    told = dump.scalars("densities", start.step, len(rho))
    return [crash, at_most("neighbours counted wrong", abs(int(counts.max()) - files.fact("neighbors_max")), 0),
            at_most("density error, relative", np.abs(told / rho - 1).max(), 1e-4)]


def dense_start(files):
    dump = files.trial("dense")
    end = last(dump)
    rest = volume(dump, end) / (len(end.positions) * dump.rest_volume)
    return [at_most("speed at the end over sqrt(g d)", noise(dump, end), 0.1),
            at_most("volume over rest, off by", abs(rest - 1), 0.03),
            at_most("fastest ever, in h a step",
                    max(fastest(f) for f in frames(dump)) * dump.manifest.time_step
                    / dump.manifest.smoothing_radius, CAP)]
