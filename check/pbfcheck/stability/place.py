"""Where the domain lies and how long it is."""
import numpy as np

from .everywhere import centre, fastest
from .figure import at_least, at_most, exactly
from .files import frames
from .shared import energy_gain
from .time_step import GAIN


def _before_chaos(origin, nudged):
    """Frames until last bits at the start have moved the centre by a tenth of what a place may."""
    kept = []
    for a, b in zip(frames(origin), frames(nudged)):
        if np.linalg.norm(centre(a) - centre(b)) > 1e-3 * origin.rest_spacing:
            break
        kept.append(a)
    return kept


def _off(kept, dump, shift, d):
    return max(np.linalg.norm(centre(a) + shift - centre(b)) for a, b in zip(kept, frames(dump))) / d


def far_origin(files):
    origin = files.trial("origin")
    kept, d, shift = _before_chaos(origin, files.trial("nudged")), origin.rest_spacing, files.fact("far")
    figures = [at_most(f"at {shift:g}: centre of mass off, in spacings", _off(kept, files.trial("far"), shift, d), 0.01),
               at_least("seconds until chaos", kept[-1].time, 0.2)]
    note = ""
    for by, call in zip((4096, 1000000), files.fact("calls")):
        if call["status"] == "PBF_OK":
            off = _off(kept, files.trial(f"far-{by}"), by, d)
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
