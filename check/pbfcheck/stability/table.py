"""Which function judges which case, and the verdicts of a whole folder."""
import os

from ..fault import DumpFault, NotApplicable
from . import column, few, fluids, gravity, other, overlap, place, same, sleep, time_step, walls
from .everywhere import everywhere
from .files import CaseFiles

JUDGES = {
    1: overlap.two_coincident, 2: overlap.thousand_coincident, 3: few.no_particles, 4: few.one_falling,
    5: few.two_particles, 6: overlap.one_cell, 7: time_step.coarse, 8: time_step.coarse,
    9: time_step.tiny_step, 10: time_step.alternating_step, 11: column.deep_columns,
    12: column.many_iterations, 13: gravity.heavy, 14: gravity.flipping_gravity, 15: place.far_origin,
    16: walls.fast_at_thin_wall, 17: walls.long_at_thin_wall, 18: walls.piston, 19: walls.overfull_piston,
    20: fluids.mass_ratio, 21: fluids.density_ratio, 22: other.misuse, 23: other.misuse, 24: walls.thin_domain,
    25: walls.leaving, 26: other.misuse, 27: overlap.neighbor_overflow, 28: gravity.sudden_changes,
    29: other.colliding_drops, 30: other.long_runs, 31: sleep.sleep_and_wake, 32: same.save_and_load, 33: same.thread_counts,
    34: same.turning_tank, 35: place.tank_lengths, 36: overlap.dense_start, 37: same.permuted,
    38: same.turned_and_mirrored, 39: fluids.heavy_above}


def _figures(files):
    """(figures, the one nearest to its bound first; a note)"""
    figures = everywhere(files)
    if not all(f.holds for f in figures):  # the others may mean nothing then
        return figures, ""
    judged = JUDGES[files.number](files)
    more, note = judged if isinstance(judged, tuple) else (judged, "")
    return sorted(figures + more, key=lambda f: -f.strain), note


def verdict(folder):
    """One JSON object: verdict, figures with their bounds, and a sentence where there are none."""
    files = CaseFiles(folder)
    facts = files.facts
    result = {"case": files.number, "backend": files.backend, "quick": facts.get("quick", False),
              "seconds": facts.get("seconds", 0.0), "peak_bytes": facts.get("peak_bytes", 0),
              "device": facts.get("device", ""), "build_id": facts.get("build_id", ""),
              "reason": "", "note": "", "figures": [],
              "pictures": [{**p, "file": os.path.join(folder, p["file"])} for p in facts.get("pictures", [])]}
    for outcome, verdict_of in (("unavailable", "unavailable"), ("absent", "absent"), ("failed", "fails")):
        if outcome in facts:
            return {**result, "verdict": verdict_of, "reason": str(facts[outcome])}
    try:
        figures, note = _figures(files)
    except (DumpFault, NotApplicable) as fault:
        return {**result, "verdict": "fails", "reason": str(fault)}
    holds = bool(figures) and all(f.holds for f in figures)
    return {**result, "verdict": "holds" if holds else "fails", "note": note,
            "figures": [f.to_json() for f in figures]}


def _usual_order(backend):
    known = ("reference", "serial", "openmp", "cuda")
    return (known.index(backend) if backend in known else len(known), backend)


def verdicts(root, cases=(), backends=()):
    """Those of the cases on the backends below a folder (none: all), in the order of the cases."""
    if not os.path.isdir(root):
        raise DumpFault(root, "is not a folder")
    folders = []
    for case in sorted(os.listdir(root)):
        if case[:2].isdecimal() and os.path.isdir(os.path.join(root, case)):
            inner = os.path.join(root, case)
            if cases and int(case[:2]) not in cases:
                continue
            folders += [os.path.join(inner, b) for b in sorted(os.listdir(inner), key=_usual_order)
                        if (not backends or b in backends)
                        and os.path.exists(os.path.join(inner, b, "facts.json"))]
    if not folders:
        raise DumpFault(root, "holds no <case>/<backend>/facts.json")
    return [verdict(folder) for folder in folders]
