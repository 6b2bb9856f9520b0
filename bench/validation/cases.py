"""The cases: what is run, how it is judged, and which figures count."""
from dataclasses import dataclass, field
from typing import Callable, Optional, Tuple

from . import plots


@dataclass(frozen=True)
class Figure:
    """One figure of one report, by pbf-check's name for it."""
    label: str
    key: str
    bar: Optional[float] = None  # largest absolute value that passes
    judgement: str = "main"
    order: bool = True  # whether it should fall as the resolution rises


@dataclass(frozen=True)
class Case:
    name: str  # of the scene, too
    title: str
    judge: Tuple[str, ...]  # arguments of pbf-check, the dump's folder left out
    figures: Tuple[Figure, ...]
    draw: Callable
    frames: int = 80
    precision: str = "f32"
    further: dict = field(default_factory=dict)  # more judgements: name → arguments
    quick: Tuple[str, ...] = ()  # bounds of the coarse run, as pbf-check takes them


ENERGY = Figure("energy at the end, relative", "E6.relative@last", judgement="energy", order=False)

# The corners' part of the length is explained in the scene.
TUBE = ("validate", "u-tube", "--length", "2.0236")
TURNING = ("validate", "rotating-tank", "--omega", "4", "--center", "0", "0", "--radius", "0.4")

CASES = (
    Case("dam-break", "Dam break: Martin & Moyce 1952", ("validate", "dam-break"),
         (Figure("front, RMS", "dam-break.front.rms", 0.05),
          Figure("front, RMS, the gate's published delay of 0.175 added", "dam-break.front.rms",
                 judgement="shifted"),
          Figure("delay that fits best", "dam-break.best_shift", order=False),
          Figure("height, largest error", "dam-break.height.max", 0.05), ENERGY),
         plots.dam_break, further={"shifted": ("validate", "dam-break", "--gate-shift", "0.175")},
         quick=("dam-break.front.rms<=0.15", "dam-break.height.max<=0.05")),
    Case("elliptic-patch", "Stretching elliptic patch: exact", ("validate", "elliptic-patch"),
         (Figure("axes, largest error", "elliptic-patch.axes.max", 0.02),
          Figure("axes, RMS", "elliptic-patch.axes.rms"),
          Figure("area, largest change", "elliptic-patch.area.max"), ENERGY), plots.ellipse,
         quick=("elliptic-patch.axes.max<=0.45",)),
    Case("oscillating-drop", "Oscillating drop: exact", ("validate", "oscillating-drop"),
         (Figure("axes, largest error", "oscillating-drop.axes.max", 0.02),
          Figure("period", "oscillating-drop.period.error", 0.02),
          Figure("amplitude kept over a period", "oscillating-drop.amplitude.kept", order=False),
          Figure("area, largest change", "oscillating-drop.area.max"), ENERGY), plots.ellipse,
         quick=("oscillating-drop.period.error<=0.03", "oscillating-drop.amplitude.kept>=0.8")),
    Case("hydrostatic-column", "Hydrostatic column: 25, 50, 100 layers",
         ("errors", "--only", "E2,E7,E9"),
         (Figure("pressure at the end, largest error", "E7.pressure.max@last", 0.01),
          Figure("surface at the end, in spacings", "E7.surface.mean_error@last"),
          Figure("volume at the end", "E2.relative@last", 0.001),
          Figure("noise at the end, RMS", "E9.rms@last"), ENERGY), plots.column, frames=20),
    Case("sloshing", "Sloshing tank: ω² = g k tanh(k H)", ("validate", "sloshing"),
         (Figure("period", "sloshing.period.error", 0.02),
          Figure("decay time, in periods", "sloshing.decay_periods", order=False), ENERGY), plots.swing,
         quick=("sloshing.period.error<=0.05", "sloshing.decay_time>=2")),
    Case("u-tube", "U-tube: ω² = 2 g/l", TUBE,
         (Figure("period", "u-tube.period.error", 0.02),
          Figure("decay time, in periods", "u-tube.decay_periods", order=False), ENERGY), plots.swing,
         quick=("u-tube.period.error<=0.1", "u-tube.decay_time>=1")),
    Case("rotating-tank", "Rotating tank: Ω²r²/2g", TURNING,
         (Figure("curvature at the end", "rotating-tank.curvature.error", 0.02),
          Figure("shape at the end, RMS over the rise", "rotating-tank.shape.rms", 0.02), ENERGY),
         plots.rotating, frames=8, quick=("rotating-tank.curvature.error<=0.5",)),
    Case("free-fall", "Free fall", ("validate", "free-fall"),
         (Figure("position, largest error", "free-fall.position.max", 1e-6, order=False),
          Figure("velocity, largest error", "free-fall.velocity.max", 1e-6, order=False),
          Figure("the scheme's parabola from the exact one", "free-fall.parabola")), plots.fall,
         frames=12, precision="f64",
         quick=("free-fall.position.max<=1e-6", "free-fall.velocity.max<=1e-6")),
    Case("colliding-drops", "Two drops collide: momentum", ("validate", "colliding-drops"),
         (Figure("linear drift", "colliding-drops.linear.max", 1e-5, order=False),
          Figure("angular drift", "colliding-drops.angular.max", 1e-5), ENERGY), plots.momentum,
         frames=40, quick=("colliding-drops.linear.max<=1e-5", "colliding-drops.angular.max<=3e-3")),
)
