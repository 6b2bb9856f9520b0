"""None, one, two."""
import numpy as np

from .everywhere import centre, failed_calls
from .figure import at_most, exactly
from .files import first, frames, last


def no_particles(files):
    count = len(last(files.trial("empty")).positions)
    return [exactly("calls failed", failed_calls(files)), exactly("particles", count),
            exactly("steps not counted", abs(files.fact("steps") - 10))]


def one_falling(files):
    """Errors over the whole fall, so that float32's rounding of the place does not count at the start."""
    dump = files.trial("fall")
    m, start = dump.manifest, first(dump)
    place, speed, fall, fast = 0.0, 0.0, 0.0, 0.0
    for f in frames(dump):
        n = f.step
        moved = m.gravity * m.time_step**2 * n * (n + 1) / 2
        place = max(place, np.linalg.norm(f.positions - start.positions - moved))
        speed = max(speed, np.linalg.norm(f.velocities - n * m.time_step * m.gravity))
        fall, fast = np.linalg.norm(moved), np.linalg.norm(n * m.time_step * m.gravity)
    return [at_most("distance from the scheme's parabola, over the fall", place / fall, 1e-6),
            at_most("error of the speed, over the speed", speed / fast, 1e-6)]


def two_particles(files):
    dump = files.trial("pair")
    start = first(dump)
    v = start.velocities.mean(axis=0)
    apart = max(np.linalg.norm(centre(f) - centre(start) - v * f.time) for f in frames(dump))
    way = np.linalg.norm(start.velocities, axis=1).max() * last(dump).time
    return [at_most("centre of mass off its line, over the way", apart / way, 1e-6)]
