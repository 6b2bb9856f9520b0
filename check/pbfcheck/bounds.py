"""Bounds on figures, from the command line: NAME<=NUMBER or NAME>=NUMBER."""
import re

from .fault import UsageFault
from .order import look_up

_BOUND = re.compile(r"^([^<>=]+)(<=|>=)([-+0-9.eE]+)$")


def parse(text):
    match = _BOUND.match(text.replace(" ", ""))
    try:
        return match.group(1), match.group(2), float(match.group(3))
    except (AttributeError, ValueError):
        raise UsageFault(f'--bound is "{text}"; it must be like E1.measure.interior.mean_abs@last<=0.001') from None


def check(report, text):
    """One verdict: an upper bound holds for the absolute value, a lower one for the value itself. A
    figure that is not there fails."""
    name, sense, limit = parse(text)
    try:
        value = look_up(report, name)
    except KeyError:
        value = None
    holds = value is not None and (abs(value) <= limit if sense == "<=" else value >= limit)
    return {"figure": name, "value": value, "sense": sense, "limit": limit, "holds": bool(holds)}
