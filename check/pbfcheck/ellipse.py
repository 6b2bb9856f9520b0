"""A 2D patch of fluid that stays an ellipse: its exact motion, and its axes from particles."""
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp


def exact_axes(times, a, rate, attraction):
    """Semi-axis a (b = 1/a) over times from the first, for u = (-A x, A y) with A = rate at first
    and an acceleration -attraction x: a' = -a A, A' = (A^2 + attraction)(a^4 - 1)/(a^4 + 1)."""
    def slope(_, state):
        a4 = state[0] ** 4
        return [-state[0] * state[1], (state[1] ** 2 + attraction) * (a4 - 1) / (a4 + 1)]

    times = np.asarray(times, float)
    if len(times) == 1 or times[-1] == times[0]:
        return np.full(len(times), a)
    solution = solve_ivp(slope, (times[0], times[-1]), [a, rate], t_eval=times, method="DOP853",
                         rtol=1e-11, atol=1e-13)
    return solution.y[0]


def exact_period(rate, attraction):
    """Of an ellipse that is a circle at first; the axes are equal twice a period."""
    def slope(_, state):
        a4 = state[0] ** 4
        return [-state[0] * state[1], (state[1] ** 2 + attraction) * (a4 - 1) / (a4 + 1)]

    def circle(_, state):
        return state[0] - 1

    circle.direction = -1 if rate > 0 else 1
    limit = 20 * 2 * np.pi / np.sqrt(attraction)
    solution = solve_ivp(slope, (0, limit), [1.0, rate], events=circle, method="DOP853",
                         rtol=1e-11, atol=1e-13)
    events = solution.t_events[0]
    later = events[events > 1e-6 * limit]
    return float(later[0])


@dataclass(frozen=True)
class Axes:
    x: float
    y: float
    tilt: float  # off-diagonal moment over the mean diagonal one
    centre: np.ndarray


def axes_of(points, spacing):
    """Semi-axes of a uniform ellipse with the particles' second moments. Each particle stands for a
    square cell, whose own moment is d²/12."""
    centre = points.mean(axis=0)
    moments = np.cov(points.T, bias=True) + np.eye(2) * spacing**2 / 12
    return Axes(2 * float(np.sqrt(moments[0, 0])), 2 * float(np.sqrt(moments[1, 1])),
                float(moments[0, 1] / (moments[0, 0] + moments[1, 1]) * 2), centre)


def strain_rate(points, velocities):
    """A of the best fit u = (-A x, A y)."""
    arm = (points - points.mean(axis=0)) * np.array([-1.0, 1.0])
    relative = velocities - velocities.mean(axis=0)
    return float((arm * relative).sum() / np.square(arm).sum())
