"""chart.py CHARTS OUT: scatter plots of bench/report/chart.h, with both axes logarithmic, by Matplotlib.

CHARTS is a JSON file: a list of charts with the members of chart.h's structs. OUT gets a list of as many SVG texts, each for a
place in an HTML page; what the mouse shows over a point is its tip.
"""
import io
import json
import sys
import xml.etree.ElementTree as xml

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter  # noqa: E402

COLORS = {"baseline": "#7b8494", "subject": "#1f63d0", "c0": "#d0740f", "c1": "#1a8a5a", "c2": "#9a4fc4", "c3": "#0e8fa6",
          "c4": "#c23b6b", "c5": "#7d7a12"}
STYLE = {"svg.fonttype": "none", "svg.hashsalt": "pbf", "font.family": "sans-serif", "font.size": 9, "axes.grid": True,
         "axes.grid.which": "both", "grid.color": "#e6e9ee", "axes.spines.top": False, "axes.spines.right": False}
PIXEL = 1 / 72


def limits(values):
    return (min(values) / 1.3, max(values) * 1.3) if values else (0.001, 0.1)


def set_up(axis, chart, points):
    """The fronts set the upper end: what is worse than all of them lies on the edge."""
    axis.set(xscale="log", yscale="log", xlabel=chart["x_title"], ylabel=chart["y_title"],
             xlim=limits([point["x"] for point in points]),
             ylim=(limits([point["y"] for point in points if point["y"] > chart["least_y"]])[0],
                   limits([point["y"] for point in points if point["on_front"] and point["y"] > chart["least_y"]])[1]))
    for ticks, text in ((axis.xaxis, "{:.4g}".format), (axis.yaxis, lambda value: f"{100 * value:.4g} %")):
        low, high = ticks.get_view_interval()
        ticks.set_minor_locator(LogLocator(subs=(2, 5)))
        ticks.set_major_formatter(FuncFormatter(lambda value, _, text=text: text(value)))
        ticks.set_minor_formatter(ticks.get_major_formatter() if high < 400 * low else NullFormatter())
    axis.text(0.02, 0.03, "↙ better", transform=axis.transAxes, color="#5d6675")
    if chart["floor"] is not None and chart["floor"] > axis.get_ylim()[0]:
        axis.axhline(chart["floor"], color="#b3261e", linestyle="--", linewidth=1)
        axis.annotate(chart["floor_name"], (1, chart["floor"]), (-4, 4), xycoords=("axes fraction", "data"),
                      textcoords="offset points", ha="right", color="#5d6675")


def scatter(axis, points, name, tips, **style):
    """Points beyond the edge lie on it. `tips` gets what belongs to the group `name`, in its order."""
    low, high = axis.get_ylim()
    axis.scatter([point["x"] for point in points], [min(max(point["y"], low), high) for point in points], gid=name, clip_on=False,
                 **style)
    tips[name] = [point["tip"] for point in points]


def draw(axis, chart):
    tips = {}
    points = [point for series in chart["series"] for point in series["points"]]
    set_up(axis, chart, points)
    for number, series in enumerate(chart["series"]):
        color = COLORS.get(series["class"], "black")
        front = [point for point in series["points"] if point["on_front"]]
        low = axis.get_ylim()[0]
        scatter(axis, [point for point in series["points"] if not point["on_front"]], f"rest{number}", tips, color=color, alpha=0.38,
                s=16, linewidths=0)
        axis.plot([point["x"] for point in front], [max(point["y"], low) for point in front], color=color,
                  linewidth=2.2 if series["class"] in ("subject", "baseline") else 1.5)
        for point in front:
            axis.plot([point["x_low"], point["x_high"]], [max(point["y"], low)] * 2, color=color, alpha=0.6)
        scatter(axis, front, f"front{number}", tips, color=color, s=36, edgecolors="white", linewidths=0.7, zorder=3)
        for point in series["points"]:
            if point["name"]:
                axis.plot(point["x"], max(point["y"], low), "o", markersize=12, markerfacecolor="none", color="#1c2330", zorder=4)
                axis.annotate(point["name"], (point["x"], max(point["y"], low)), (8, 8), textcoords="offset points", weight="bold")
    return tips


def embedded(svg, tips):
    """Without what a file of its own would have: names of namespaces, a size, metadata."""
    root = xml.fromstring(svg)
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
        element.attrib = {key.rpartition("}")[2]: value for key, value in element.attrib.items()}
    root.attrib = {"viewBox": root.get("viewBox"), "role": "img"}
    for child in root.findall("metadata"):
        root.remove(child)
    for group in root.iter("g"):
        for point, tip in zip(group.iter("use"), tips.get(group.get("id"), ())):
            xml.SubElement(point, "title").text = tip
    return xml.tostring(root, encoding="unicode")


def svg_of(chart):
    figure, axis = plt.subplots(figsize=(chart["width"] * PIXEL, chart["height"] * PIXEL), layout="constrained")
    tips = draw(axis, chart)
    out = io.StringIO()
    figure.savefig(out, format="svg", transparent=True)
    plt.close(figure)
    return embedded(out.getvalue(), tips)


if __name__ == "__main__":
    plt.rcParams.update(STYLE)
    with open(sys.argv[1], encoding="utf-8") as given:
        charts = json.load(given)
    with open(sys.argv[2], "w", encoding="utf-8") as made:
        json.dump([svg_of(chart) for chart in charts], made)
