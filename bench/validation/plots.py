"""One figure a case: curves of all resolutions against the data or the closed form."""
import os

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)
import numpy as np  # noqa: E402
from matplotlib.ticker import MaxNLocator  # noqa: E402

from . import ROOT  # noqa: E402

plt.rcParams.update({"font.size": 8, "axes.grid": True, "grid.alpha": 0.3, "lines.linewidth": 1.2,
                     "axes.spines.top": False, "axes.spines.right": False, "svg.fonttype": "none",
                     "legend.frameon": False})
COLOURS = ("#9ecae1", "#4292c6", "#084594", "#000000", "#666666")  # coarse to fine
TRUTH = {"color": "#d94801", "zorder": 5}


def _data(name):
    path = os.path.join(ROOT, "check", "validation", name)
    return np.genfromtxt(path, delimiter=",", names=True, comments="#",
                         skip_header=sum(line.startswith("#") for line in open(path, encoding="utf-8")))


def _column(run, key, judgement="main"):
    """A column of the checker's rows of the one thing that was judged."""
    report = run.reports[judgement]
    for part in ("validations", "errors"):
        for entry in report[part].values():
            rows = entry.get("frames", [])
            if rows and key in rows[0]:
                return np.array([np.nan if r.get(key) is None else r[key] for r in rows], float)
    return np.zeros(0)


def _label(run):
    return f"{run.particles:,} particles"


def _curves(axes, runs, x, y, sign=1.0, judgement="main"):
    for colour, run in zip(COLOURS, runs):
        axes.plot(_column(run, x, judgement), sign * _column(run, y, judgement), color=colour,
                  label=_label(run))


def _energy(axes, runs):
    _curves(axes, runs, "time", "relative", judgement="energy")
    axes.axhline(0, **TRUTH, linewidth=0.8)
    axes.set(xlabel="time", title="energy, relative change")


def _figure(columns):
    figure, axes = plt.subplots(1, columns, figsize=(3.6 * columns, 2.8), layout="constrained")
    return figure, axes


def _snapshots(runs):
    """Particles of the finest run, coloured by speed; a slice where there are three dimensions."""
    run = runs[-1]
    d = run.dump["spacing"]
    figure, axes = plt.subplots(1, len(run.pictures), figsize=(10.8, 2.6), layout="constrained")
    top = max(max(speeds.max() for _, _, speeds in run.pictures), 1e-30)
    for ax, (time, x, speeds) in zip(np.atleast_1d(axes), run.pictures):
        if x.shape[1] == 3:
            near = np.abs(x[:, 2] - np.median(x[:, 2])) < d
            x, speeds = x[near], speeds[near]
        dots = ax.scatter(x[:, 0], x[:, 1], c=speeds, s=min(6.0, 6000 / len(x)), vmin=0, vmax=top,
                          cmap="viridis", linewidths=0, rasterized=True)
        ax.set(title=f"time {time:.3g}", aspect="equal")
        ax.xaxis.set_major_locator(MaxNLocator(4, min_n_ticks=2))
    figure.colorbar(dots, ax=axes, label="speed", shrink=0.8)
    return figure


def dam_break(runs):
    figure, (left, middle, right) = _figure(3)
    front = _data("martin_moyce_1952_table2_front_n2_2.csv")
    height = _data("martin_moyce_1952_table6_height_n2_2.csv")
    for colour, run in zip(COLOURS, runs):
        free = _column(run, "met_far_wall") < 1
        left.plot(_column(run, "T")[free], _column(run, "Z")[free], color=colour, label=_label(run))
        middle.plot(_column(run, "tau"), _column(run, "H"), color=colour)
    left.plot(front["T"], front["Z"], "o", markersize=3, label="measured", **TRUTH)
    left.plot(front["T"] - 0.175, front["Z"], "x", markersize=3, label="measured, less the gate's delay",
              **TRUTH)
    middle.plot(height["tau"], height["H"], "o", markersize=3, **TRUTH)
    left.set(xlim=(0, 1.1 * front["T"].max()), ylim=(0.9, 1.2 * front["Z"].max()), xlabel="T = t √(2g/a)",
             title="front / a")
    middle.set(xlim=(0, None), xlabel="τ = t √(g/a)", title="height at the back wall / 2a")
    left.legend()
    _energy(right, runs)
    return [figure, _snapshots(runs)]


def ellipse(runs):
    figure, (left, middle, right) = _figure(3)
    _curves(left, runs, "time", "x_axis")
    _curves(left, runs, "time", "y_axis")
    for key, label in (("x_exact", "exact"), ("y_exact", None)):
        left.plot(_column(runs[-1], "time"), _column(runs[-1], key), "--", label=label, **TRUTH)
    left.set(xlabel="time", title="semi-axes")
    for colour, run in zip(COLOURS, runs):
        area = _column(run, "x_axis") * _column(run, "y_axis")
        middle.plot(_column(run, "time"), area / area[0] - 1, color=colour, label=_label(run))
    middle.axhline(0, **TRUTH, linewidth=0.8)
    middle.set(xlabel="time", title="area, relative change")
    middle.legend()
    _energy(right, runs)
    return [figure, _snapshots(runs)]


def swing(runs):
    """Sloshing and the U-tube: the signal beside the undamped closed form of its first amplitude."""
    figure, (left, right) = _figure(2)
    key = "elevation" if len(_column(runs[0], "elevation")) else "difference"
    _curves(left, runs, "time", key)
    time = np.linspace(0, _column(runs[-1], "time")[-1], 400)
    entry, = runs[-1].reports["main"]["validations"].values()
    exact = entry.get("figures", {}).get("period.exact")
    if exact:
        left.plot(time, _column(runs[-1], key)[0] * np.cos(2 * np.pi * time / exact), "--",
                  label="linear theory", **TRUTH)
    left.set(xlabel="time", title=key)
    left.legend(ncols=2, loc="lower center", bbox_to_anchor=(0.5, -0.45))
    _energy(right, runs)
    return [figure, _snapshots(runs)]


def column(runs):
    figure, (left, middle, right) = _figure(3)
    for colour, run in zip(COLOURS, runs):
        d, start, end = run.dump["spacing"], run.pictures[0][1][:, 1], run.pictures[-1][1][:, 1]
        left.plot((end - start) / d, start, ".", markersize=1.5, color=colour, label=_label(run),
                  rasterized=True)
    left.axvline(0, **TRUTH, linewidth=0.8)
    left.set(xlabel="spacings", title="how far particles have moved up", ylabel="height at first")
    left.legend()
    _curves(middle, runs, "time", "surface.mean_error")
    middle.axhline(0, **TRUTH, linewidth=0.8)
    middle.set(xlabel="time", title="surface, error in spacings")
    _energy(right, runs)
    return [figure, _snapshots(runs)]


def rotating(runs):
    figure, (left, middle, right) = _figure(3)
    for colour, run in zip(COLOURS, runs):
        x = run.pictures[-1][1]
        left.plot(np.hypot(x[:, 0], x[:, 2]), x[:, 1], ".", markersize=1.5, color=colour,
                  label=_label(run), rasterized=True)
    radius = np.linspace(0, 0.5, 50)
    left.plot(radius, 0.3 + 16 * radius**2 / (2 * 9.81), "--", label="Ω²r²/2g", **TRUTH)
    left.set(xlabel="r", title="particles at the end")
    left.legend()
    _curves(middle, runs, "time", "curvature.error")
    middle.axhline(0, **TRUTH, linewidth=0.8)
    middle.set(xlabel="time", title="curvature of the surface, relative error")
    _energy(right, runs)
    return [figure, _snapshots(runs)]


def fall(runs):
    figure, (left, right) = _figure(2)
    for key, axes, title in (("position.max", left, "position off the scheme's parabola, relative"),
                             ("parabola", right, "the scheme's parabola off the exact one, relative")):
        _curves(axes, runs, "time", key)
        axes.set(xlabel="time", title=title, yscale="log")
    left.legend()
    return [figure]


def momentum(runs):
    figure, (left, middle, right) = _figure(3)
    for key, axes in (("linear", left), ("angular", middle)):
        _curves(axes, runs, "time", key)
        axes.axhline(1e-5, **TRUTH, linewidth=0.8)
        axes.set(xlabel="time", title=f"{key} momentum, relative drift", yscale="log")
    left.legend()
    _energy(right, runs)
    return [figure, _snapshots(runs)]
