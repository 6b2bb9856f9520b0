"""Deep water, and many iterations."""
import numpy as np

from .figure import at_most
from .files import first, frames, last
from .shared import compression, noise, volume


def law(dump, layers):
    """Compression at the bottom that n iterations leave: N g dt^2 / (4 n d)."""
    m = dump.manifest
    g = np.linalg.norm(m.gravity)
    return layers * g * m.time_step**2 / (4 * m.raw["iterations"] * dump.rest_spacing)


def deep_columns(files):
    figures = []
    for label, dump in files.trials("layers-"):
        layers = int(label.split("-")[1])
        start, end = first(dump), last(dump)
        error = compression(dump, end)
        low = end.positions[:, 1] <= np.quantile(end.positions[:, 1], 0.1)
        shrunk = 1 - volume(dump, end) / volume(dump, start)
        figures += [at_most(f"{layers} layers: compression of the lowest tenth, over the law's",
                            error[low].mean() / law(dump, layers), 1),
                    at_most(f"{layers} layers: volume lost, over the law's mean",
                            shrunk / (law(dump, layers) / 2), 1),
                    at_most(f"{layers} layers: speed at the end over sqrt(g d)", noise(dump, end), 0.1)]
    return figures


def many_iterations(files):
    residuals = []
    for label, dump in files.trials("iterations-"):
        residuals.append((int(label.split("-")[1]), np.sqrt(np.mean(compression(dump, last(dump)) ** 2))))
    rises = [after - before for (_, before), (_, after) in zip(residuals, residuals[1:])]
    note = ", ".join(f"{n}: {r:.3g}" for n, r in residuals)
    scale = max(residuals[0][1], 1e-9)  # one iteration may have left none
    return [at_most("largest rise of the RMS residual over that of one iteration", max(rises) / scale, 1e-4),
            at_most("residual of 1,000 over that of one", residuals[-1][1] / scale, 0.1)], note
