"""What every case must hold: no particle lost, everything finite, all inside the walls."""
import numpy as np

from ..containment import Containment
from ..fault import DumpFault
from .figure import exactly
from .files import frames


def everywhere(files):
    lost, outside = 0, 0
    for _, dump in files.trials():
        containment = Containment(dump, None)
        for frame in frames(dump):
            if frame.velocities is None:
                raise DumpFault(dump.path("velocities", frame.step), "is missing")
            row = containment.add(frame)
            lost += abs(row["lost"])
            outside += row["outside"]
    if not files.labels:
        return []
    return [exactly("particles lost", lost), exactly("particles outside the walls", outside)]


def refusals(files):
    """Calls that must have been refused, by a sentence that names the culprit, with the state untouched."""
    entries = files.facts.get("refusals", [])
    accepted = [e for e in entries if e["status"] == "PBF_OK"]
    mute = [e for e in entries if e["status"] != "PBF_OK" and e["names"] not in e["sentence"]]
    touched = [e for e in entries if not e["unchanged"]]
    worst = next(iter(accepted + mute + touched), None)
    note = "" if worst is None else f'{worst["call"]}, {worst["names"]}: {worst["status"]} "{worst["sentence"]}"'
    return [exactly(f"accepted, of {len(entries)} calls", len(accepted)),
            exactly("refused without naming the culprit", len(mute)),
            exactly("state touched by a refused call", len(touched))], note


def failed_calls(files, but=()):
    """Calls that should have worked, or failed with one of the statuses in `but`."""
    calls = files.facts.get("calls", [])
    return sum(c["status"] != "PBF_OK" and not (c["status"] in but and c["sentence"]) for c in calls)


def centre(frame):
    return frame.positions.mean(axis=0)


def fastest(frame):
    return float(np.linalg.norm(frame.velocities, axis=1).max(initial=0.0))
