"""Figures of a case over its resolutions: values, bars, order of convergence."""
from pbfcheck.order import convergence, look_up


def value_of(run, figure):
    """None where the checker could not judge."""
    try:
        return look_up(run.reports[figure.judgement], figure.key)
    except KeyError:
        return None


def reason_of(run, figure):
    """Why there is no value."""
    report = run.reports[figure.judgement]
    section = figure.key.split(".")[0]
    for part in ("validations", "errors"):
        reason = report[part].get(section, {}).get("reason")
        if reason:
            return reason
    return "the dump does not hold what it needs"


def row_of(figure, runs):
    """One figure over the runs, coarse to fine. The verdict is that of the finest."""
    values = [value_of(run, figure) for run in runs]
    row = {"figure": figure.label, "key": figure.key, "values": values, "bar": figure.bar,
           "holds": None, "order": None, "monotone": None}
    if figure.bar is not None and values[-1] is not None:
        row["holds"] = abs(values[-1]) <= figure.bar
    if None in values:
        row["reason"] = reason_of(runs[values.index(None)], figure)
    elif figure.order and len(values) > 1 and all(values):
        spacings = [run.dump["spacing"] for run in runs]
        found = convergence(spacings, [abs(v) for v in values], rising=False)
        row["order"], row["monotone"] = found["slope"], found["monotone"]
    return row


def bounds_of(run):
    """The quick form's bounds, as pbf-check judged them."""
    return run.reports["main"]["bounds"]


def case_json(case, runs):
    return {"case": case.name, "title": case.title,
            "rows": [row_of(figure, runs) for figure in case.figures],
            "runs": [{"finer": run.finer, "particles": run.particles, "seconds": run.seconds,
                      "dump": run.dump, "reports": run.reports} for run in runs]}
