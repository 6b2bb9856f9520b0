"""The report: one JSON object, and a table of it for people."""
import json
import math

import numpy as np

from . import FORMAT_VERSION


def plain(value):
    """The value for JSON: numbers that JSON does not know become null."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, dict):
        return {key: plain(v) for key, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def describe(dump, steps):
    m = dump.manifest
    return {**m.raw, "folder": dump.folder, "smoothing_radius": m.smoothing_radius,
            "spacing": m.spacing, "particle_volume": m.particle_volume,
            "rest_spacing": dump.rest_spacing, "rest_spacing_from": dump.rest_source,
            "wall_offset": m.walls.offset, "steps_judged": list(steps)}


def start(dump, steps):
    return {"tool": "pbf-check", "format": FORMAT_VERSION, "dump": describe(dump, steps),
            "errors": {}, "validations": {}, "bounds": []}


def to_json(report):
    return json.dumps(plain(report), indent=1, allow_nan=False) + "\n"


def _number(value):
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _section(key, entry):
    unit = f" [{entry['unit']}]" if entry.get("unit", "1") != "1" else ""
    lines = [f"{key}  {entry['title']}{unit}"]
    if "reason" in entry:
        return lines + [f"    not judged: {entry['reason']}"]
    if entry.get("summary"):
        lines.append(f"    {'':34}{'last':>12}{'mean':>12}{'largest':>12}")
    for name, figure in entry.get("summary", {}).items():
        cells = "".join(f"{_number(figure[k]):>12}" for k in ("last", "mean", "largest"))
        lines.append(f"    {name:34}{cells}")
    for name, value in entry.get("figures", {}).items():
        if isinstance(value, (int, float)) or value is None:
            bar = entry.get("bars", {}).get(name)
            verdict = ""
            if bar is not None:
                verdict = f"   at most {bar:g}: " + ("holds" if entry["verdicts"][name] else "FAILS")
            lines.append(f"    {name:34}{_number(value):>12}{verdict}")
    if entry.get("note"):
        lines.append(f"    note: {entry['note']}")
    return lines


def to_table(report):
    dump = report["dump"]
    steps = dump["steps_judged"]
    lines = [f"{dump['folder']}: {dump['dimension']}D, {len(steps)} frames, steps {steps[0]} … {steps[-1]}, "
             f"rest spacing {dump['rest_spacing']:.6g} (from {dump['rest_spacing_from']})"]
    for part in ("errors", "validations"):
        for key, entry in report[part].items():
            lines += [""] + _section(key, entry)
    if report["bounds"]:
        lines += ["", "bounds"]
    for bound in report["bounds"]:
        verdict = "holds" if bound["holds"] else "FAILS"
        lines.append(f"    {bound['figure']} {bound['sense']} {bound['limit']:g}: "
                     f"{_number(bound['value'])}  {verdict}")
    return "\n".join(lines) + "\n"
