"""Where the domain lies and how long it is."""
import numpy as np

from .everywhere import centre, fastest
from .figure import at_most, exactly
from .files import first, frames, last
from .shared import energy_gain
from .time_step import GAIN


def far_origin(files):
    near, far = files.trial("origin"), files.trial("far")
    d, shift = near.rest_spacing, files.fact("far")
    off = max(np.linalg.norm(centre(a) + shift - centre(b)) for a, b in zip(frames(near), frames(far))) / d
    figures = [at_most("at 4,096: centre of mass off, in spacings", off, 0.01)]
    call = files.fact("calls")[0]
    refused = call["status"] == "PBF_ERROR_INVALID_ARGUMENT" and "float32" in call["sentence"]
    if call["status"] != "PBF_OK":
        return figures + [exactly("at 1e6: refused without the reason", not refused)], call["sentence"]
    million = files.trial("million")
    off = max(np.linalg.norm(centre(a) + 1e6 - centre(b)) for a, b in zip(frames(near), frames(million))) / d
    return figures + [at_most("at 1e6: centre of mass off, in spacings", off, 0.01)], ""


def tank_lengths(files):
    figures = []
    for label, dump in files.trials("length-"):
        drop = dump.manifest.walls.upper[1]
        free = np.sqrt(2 * np.linalg.norm(dump.manifest.gravity) * drop)
        figures += [at_most(f'{label.split("-")[1]} m: energy gained', energy_gain(dump), GAIN),
                    at_most(f'{label.split("-")[1]} m: fastest over that of a fall from the ceiling',
                            max(fastest(f) for f in frames(dump)) / free, 2)]
    return figures
