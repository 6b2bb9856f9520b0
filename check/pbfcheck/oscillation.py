"""A damped cosine fitted to a signal."""
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from .fault import NotApplicable


@dataclass(frozen=True)
class Oscillation:
    period: float
    decay_time: float  # of the amplitude, by e; infinite without damping
    amplitude: float  # at the first sample
    offset: float
    residual: float  # RMS of what the fit leaves, over the amplitude


def _basis(time, omega, decay):
    shrink = np.exp(-decay * time)
    return np.stack([shrink * np.cos(omega * time), shrink * np.sin(omega * time),
                     np.ones_like(time)], axis=1)


def _residual(time, signal, omega, decay):
    basis = _basis(time, omega, decay)
    weights = np.linalg.lstsq(basis, signal, rcond=None)[0]
    return basis @ weights - signal, weights


def fit_oscillation(time, signal):
    """Frequency by a scan, refined with the damping by least squares; the rest is linear."""
    if len(time) < 8:
        raise NotApplicable(f"{len(time)} frames are too few for a period; 8 would do")
    time = np.asarray(time, float) - time[0]
    signal = np.asarray(signal, float)
    if np.ptp(signal) <= 1e-12 * max(1.0, np.abs(signal).max()):
        raise NotApplicable("the signal does not oscillate")
    span = time[-1]
    step = span / (len(time) - 1)
    omegas = np.arange(np.pi / span, np.pi / step, 0.1 * np.pi / span)
    sizes = [np.square(_residual(time, signal, w, 0.0)[0]).sum() for w in omegas]
    start = omegas[int(np.argmin(sizes))]
    best = least_squares(lambda p: _residual(time, signal, p[0], p[1])[0], [start, 0.0],
                         x_scale=[start, 1 / span])
    omega, decay = abs(best.x[0]), best.x[1]
    if omega * span < 2 * np.pi * 0.75:
        raise NotApplicable(f"the run lasts {omega * span / (2 * np.pi):.2f} periods; one would do")
    left, weights = _residual(time, signal, omega, decay)
    amplitude = float(np.hypot(weights[0], weights[1]))
    return Oscillation(float(2 * np.pi / omega), float(1 / decay) if decay > 0 else float("inf"),
                       amplitude, float(weights[2]), float(np.sqrt(np.mean(left**2)) / amplitude))
