"""Particles in free fall, against the time integration's own parabola."""
import numpy as np

from .fault import DumpFault, NotApplicable
from .validation import Validation


class FreeFall(Validation):
    name = "free-fall"
    title = "free fall"
    definition = (
        "max |x - x_n| over the distance moved and max |v - v_n| over |v_n|, with x_n = x_0 + n dt v_0 "
        "+ g dt^2 n (n + 1)/2 and v_n = v_0 + n dt g: the symplectic scheme's own solution, up to the "
        "first frame in which a particle would have met a wall. Particles must not touch each other. "
        "`parabola`: distance of that solution from g t^2/2, relative: first order in dt.")
    bars = {"position.max": 1e-6, "velocity.max": 1e-6}

    def run(self, dump, frames, options):
        m = dump.manifest
        rows, start = [], None
        for frame in frames:
            if start is None:
                if frame.velocities is None or frame.step != 0:
                    raise DumpFault(dump.path("velocities", 0), "is needed: the fall starts at step 0")
                start = frame
                continue
            n, dt = frame.step, m.time_step
            fallen = n * dt * start.velocities + m.gravity * dt**2 * n * (n + 1) / 2
            expected = start.positions + fallen
            lower, upper = m.walls.bounds(frame.time)
            if np.any(expected < lower) or np.any(expected > upper):
                break
            if frame.positions.shape != expected.shape:
                raise NotApplicable(f"step {n} has {len(frame.positions)} particles, step 0 "
                                    f"{len(expected)}")
            row = {"step": n, "time": frame.time,
                   "position.max": _worst(frame.positions - expected, fallen)}
            if frame.velocities is not None:
                speed = start.velocities + n * dt * m.gravity
                row["velocity.max"] = _worst(frame.velocities - speed, speed)
            continuous = m.gravity * frame.time**2 / 2
            row["parabola"] = float(np.linalg.norm(m.gravity * dt**2 * n * (n + 1) / 2 - continuous)
                                    / max(np.linalg.norm(continuous), 1e-300))
            rows.append(row)
        if not rows:
            raise NotApplicable("no frame between step 0 and the first touch of a wall")
        figures = {key: max(row[key] for row in rows)
                   for key in ("position.max", "velocity.max") if key in rows[0]}
        return {**figures, "parabola": rows[-1]["parabola"], "frames": len(rows)}, rows


def _worst(error, of):
    size = np.linalg.norm(of, axis=1)
    apart = np.linalg.norm(error, axis=1)
    return float(np.max(apart / np.maximum(size, 1e-300)))
