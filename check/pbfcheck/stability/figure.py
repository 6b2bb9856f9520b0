"""A number and the bound that it must keep."""
import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    name: str
    value: float
    bound: float
    sense: str = "<="  # or ">="

    @property
    def holds(self):
        if self.value is None or not math.isfinite(self.value):
            return False
        return self.value <= self.bound if self.sense == "<=" else self.value >= self.bound

    @property
    def strain(self):
        """How near the bound: above 1 it does not hold."""
        if self.value is None or not math.isfinite(self.value):
            return math.inf
        value, bound = (self.value, self.bound) if self.sense == "<=" else (self.bound, self.value)
        if bound > 0:
            return max(value, 0.0) / bound
        return 0.0 if self.holds else math.inf

    def to_json(self):
        shown = "not finite" if self.value is None or not math.isfinite(self.value) else f"{self.value:.3g}"
        sign = "≤" if self.sense == "<=" else "≥"
        return {"name": self.name, "value": self.value, "bound": self.bound, "sense": self.sense,
                "shown": shown, "bound_shown": f"{sign} {self.bound:.3g}", "holds": self.holds}


def at_most(name, value, bound):
    return Figure(name, None if value is None else float(value), float(bound))


def at_least(name, value, bound):
    return Figure(name, None if value is None else float(value), float(bound), ">=")


def exactly(name, wrong):
    """A count of things that must not be."""
    return Figure(name, float(wrong), 0.0)
