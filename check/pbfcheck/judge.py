"""Runs the errors and validations over a dump's frames."""
from . import stats
from .colliding_drops import CollidingDrops
from .containment import Containment
from .dam_break import DamBreak, DamBreakRun
from .density_error import DensityError
from .distance import ReferenceDistance
from .elliptic import EllipticPatch, OscillatingDrop
from .energy import Energy
from .fault import NotApplicable
from .free_fall import FreeFall
from .hydrostatics import Hydrostatics
from .momentum import AngularMomentum, LinearMomentum
from .noise import Noise
from .ritter import Ritter
from .rotating_tank import RotatingTank
from .swinging import Sloshing, UTube
from .volume_error import VolumeError

ERRORS = {m.key: m for m in (Containment, DensityError, VolumeError, ReferenceDistance, LinearMomentum,
                             AngularMomentum, Energy, Hydrostatics, DamBreak, Noise)}
VALIDATIONS = {v.name: v for v in (EllipticPatch, OscillatingDrop, Sloshing, UTube, RotatingTank,
                                   FreeFall, CollidingDrops, DamBreakRun, Ritter)}


def _head(kind):
    return {"title": kind.title, "definition": kind.definition}


def errors_of(dump, steps, keys, options):
    """{key: entry}. An error that means nothing for this dump gets a reason in place of figures."""
    entries = {key: {**_head(ERRORS[key]), "unit": ERRORS[key].unit} for key in keys}
    running, rows = {}, {key: [] for key in keys}
    for key in keys:
        try:
            running[key] = ERRORS[key](dump, options)
        except NotApplicable as reason:
            entries[key]["reason"] = str(reason)
    for step in steps:
        if not running:
            break
        frame = dump.frame(step)
        for key in list(running):
            try:
                rows[key].append({"step": frame.step, "time": frame.time, **running[key].add(frame)})
            except NotApplicable as reason:
                entries[key]["reason"] = str(reason)
                del running[key]
    for key, measure in running.items():
        try:
            further = measure.finish(rows[key])
        except NotApplicable as reason:
            entries[key]["reason"] = str(reason)
            continue
        bars = further.pop("bars", {})
        note = further.pop("note", None)
        entries[key].update({"figures": further, "summary": stats.summary(rows[key]),
                             "frames": rows[key]})
        if note:
            entries[key]["note"] = note
        add_verdicts(entries[key], bars)
    return entries


def validation_of(dump, steps, name, options):
    kind = VALIDATIONS[name]
    entry = _head(kind)
    try:
        figures, rows = kind().run(dump, (dump.frame(step) for step in steps), options)
    except NotApplicable as reason:
        return {**entry, "reason": str(reason)}
    entry.update({"figures": figures, "frames": rows})
    add_verdicts(entry, kind.bars)
    return entry


def add_verdicts(entry, bars):
    if bars:
        figures = entry["figures"]
        entry["bars"] = bars
        entry["verdicts"] = {name: figures.get(name) is not None and abs(figures[name]) <= limit
                             for name, limit in bars.items()}
