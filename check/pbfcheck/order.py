"""E10: order of convergence, from the reports of several runs."""
import json

import numpy as np

from .fault import DumpFault, UsageFault

TITLE = "order"
DEFINITION = (
    "Slope of log error against log parameter by least squares, slopes between neighbours, and whether "
    "the error falls monotonically as the parameter goes its finer way: down, or up for iterations.")
RISING = ("iterations", "substeps")  # more of it should mean less error


def look_up(report, key):
    """A figure by name: "E1.measure.interior.mean_abs@last" (or @mean, @largest: the default), or
    "sloshing.period.error" of a validation."""
    name, _, which = key.partition("@")
    which = which or "largest"
    section, _, figure = name.partition(".")
    for part in ("errors", "validations"):
        entry = report.get(part, {}).get(section)
        if entry is None:
            continue
        if figure in entry.get("summary", {}) and which in entry["summary"][figure]:
            return entry["summary"][figure][which]
        if figure in entry.get("figures", {}):
            return entry["figures"][figure]
    raise KeyError(key)


def read_report(path):
    try:
        with open(path, encoding="utf-8") as file:
            report = json.load(file)
    except OSError as error:
        raise DumpFault(path, f"cannot be read ({error.strerror})") from error
    except (UnicodeDecodeError, json.JSONDecodeError) as error:
        raise DumpFault(path, f"is not JSON: {error}") from error
    if not isinstance(report, dict) or report.get("tool") != "pbf-check":
        raise DumpFault(path, "is not a report of pbf-check")
    return report


def _positive(path, name, value):
    if isinstance(value, bool) or not isinstance(value, (int, float)) or value == 0:
        raise DumpFault(path, f"has {name} = {value!r}; a slope needs a number other than 0")
    return abs(float(value))


def convergence(parameters, errors, rising):
    """Figures of one series; `rising`: finer means a larger parameter."""
    order = np.argsort(parameters)[:: 1 if rising else -1]  # coarse to fine
    p, e = np.log(np.asarray(parameters)[order]), np.log(np.asarray(errors)[order])
    if len(p) < 2 or np.any(np.diff(p) == 0):
        raise UsageFault("order needs at least two runs with different parameters")
    return {"slope": float(np.polyfit(p, e, 1)[0]),
            "slopes": [float(s) for s in np.diff(e) / np.diff(p)],
            "monotone": bool(np.all(np.diff(e) < 0)),
            "parameters": [float(v) for v in np.exp(p)], "errors": [float(v) for v in np.exp(e)]}


def order_of(paths, key, parameter, values):
    if values and len(values) != len(paths):
        raise UsageFault(f"--values has {len(values)} numbers for {len(paths)} reports")
    parameters, errors = [], []
    for k, path in enumerate(paths):
        report = read_report(path)
        value = values[k] if values else report.get("dump", {}).get(parameter)
        parameters.append(_positive(path, f'"{parameter}"', value))
        try:
            errors.append(_positive(path, key, look_up(report, key)))
        except KeyError:
            raise DumpFault(path, f'has no figure "{key}"') from None
    return {"title": TITLE, "definition": DEFINITION, "unit": "1", "error": key, "by": parameter,
            **convergence(parameters, errors, parameter in RISING)}
