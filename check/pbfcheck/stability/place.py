"""Where the domain lies and how long it is."""
import numpy as np

from .everywhere import centre, fastest
from .figure import at_most, exactly
from .files import frames
from .shared import energy_gain
from .time_step import GAIN


def _off(near, far, shift):
    return max(np.linalg.norm(centre(a) + shift - centre(b)) for a, b in zip(frames(near), frames(far))) / near.rest_spacing


def far_origin(files):
    near, shift = files.trial("origin"), files.fact("far")
    figures = [at_most(f"at {shift:g}: centre of mass off, in spacings", _off(near, files.trial("far"), shift), 0.01)]
    note = ""
    for by, call in zip((4096, 1000000), files.fact("calls")):
        if call["status"] == "PBF_OK":
            off = _off(near, files.trial(f"far-{by}"), by)
            figures.append(at_most(f"at {by:,}: centre of mass off, in spacings", off, 0.01))
        else:
            refused = call["status"] == "PBF_ERROR_INVALID_ARGUMENT" and "float32" in call["sentence"]
            figures.append(exactly(f"at {by:,}: refused without the reason", not refused))
            note = call["sentence"]
    return figures, note


def tank_lengths(files):
    figures = []
    for label, dump in files.trials("length-"):
        drop = dump.manifest.walls.upper[1]
        free = np.sqrt(2 * np.linalg.norm(dump.manifest.gravity) * drop)
        figures += [at_most(f'{label.split("-")[1]} m: energy gained', energy_gain(dump), GAIN),
                    at_most(f'{label.split("-")[1]} m: fastest over that of a fall from the ceiling',
                            max(fastest(f) for f in frames(dump)) / free, 2)]
    return figures
