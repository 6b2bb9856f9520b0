"""The page: one table of everything, then a section a case. No file beside it is needed."""
import base64
import html
import io
import os
import string

import matplotlib.pyplot as plt

from .runs import scene_of

TEMPLATE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "page.html")


def number(value):
    if value is None:
        return "–"
    text = f"{value:.3g}" if value == 0 or abs(value) >= 1e-3 else f"{value:.1e}"
    return text.replace(".0e", "e").replace("e-0", "e-").replace("-", "−")


def verdict(row):
    if row["bar"] is None:
        return ""
    if row["holds"] is None:
        return "not judged"
    return "holds" if row["holds"] else "missed"


def order(row):
    if row["order"] is None:
        return ""
    return f"{row['order']:.2f}" + ("" if row["monotone"] else " *")


def figure_texts(figure):
    """What is measured, what it must be, how far off it is, and the bar, as texts."""
    error = "" if figure["error"] is None else number(figure["error"])
    if error and figure["unit"]:
        error += " " + figure["unit"]
    return (number(figure["is"]), "" if figure["must"] is None else number(figure["must"]), error,
            "" if figure["bar"] is None else number(figure["bar"]))


def text_table(results, measured):
    lines = []
    for result in results:
        lines.append(result["title"])
        for row in result["rows"]:
            values = "".join(f"{number(v):>11}" for v in row["values"])
            bar = f"  bar {number(row['bar'])}: {verdict(row)}" if row["bar"] is not None else ""
            slope = f"  order {order(row)}" if row["order"] is not None else ""
            lines.append(f"    {row['figure']:52}{values}{bar}{slope}")
    for result in measured:
        lines.append(result["title"])
        for figure in result["figures"]:
            value, must, error, bar = figure_texts(figure)
            words = f"  must be {must}, off by {error}, bar {bar}: {verdict(figure)}" if bar else ""
            lines.append(f"    {figure['figure']:70}{value:>11}{words}")
    return "\n".join(lines)


def _cells(*texts):
    return "".join(f"<td>{html.escape(text)}</td>" for text in texts)


def _table(results):
    lines = []
    for result in results:
        for k, row in enumerate(result["rows"]):
            head = ""
            if k == 0:
                head = (f'<th rowspan="{len(result["rows"])}"><a href="#{result["case"]}">'
                        f'{html.escape(result["title"])}</a></th>')
            bar = "" if row["bar"] is None else number(row["bar"])
            state = verdict(row)
            reason = f' title="{html.escape(row["reason"])}"' if "reason" in row else ""
            lines.append(f'<tr>{head}{_cells(row["figure"])}'
                         + "".join(f'<td class="n">{number(v)}</td>' for v in row["values"])
                         + f'<td class="n">{bar}</td><td class="{state.replace(" ", "-")}"{reason}>{state}</td>'
                         + f'<td class="n">{order(row)}</td></tr>')
    return "\n".join(lines)


def _measured_table(measured):
    lines = []
    for result in measured:
        for k, figure in enumerate(result["figures"]):
            head = ""
            if k == 0:
                head = (f'<th id="{result["case"]}" rowspan="{len(result["figures"])}">'
                        f'{html.escape(result["title"])}</th>')
            state = verdict(figure)
            lines.append(f'<tr>{head}{_cells(figure["figure"])}'
                         + "".join(f'<td class="n">{html.escape(text)}</td>' for text in figure_texts(figure))
                         + f'<td class="{state.replace(" ", "-")}">{state}</td></tr>')
    return "\n".join(lines)


def _image(figure):
    """Curves as vectors, clouds of particles as pixels."""
    out = io.BytesIO()
    figure.savefig(out, format="svg", dpi=140)
    plt.close(figure)
    text = base64.b64encode(out.getvalue()).decode()
    return f'<img alt="" src="data:image/svg+xml;base64,{text}">'


def _section(case, runs):
    scene = scene_of(case)
    sizes = "; ".join(f"{run.particles:,} particles {run.dump['spacing']:.4g} apart, time step "
                      f"{run.dump['time_step']:.3g}, {run.seconds:.1f} s" for run in runs)
    judged = [entry for part in ("validations", "errors")
              for entry in runs[-1].reports["main"][part].values()]
    parts = [f'<h2 id="{case.name}">{html.escape(case.title)}</h2>',
             f"<p>{html.escape(scene['description'])}. {html.escape(scene['purpose'])}</p>"]
    parts += [_image(figure) for figure in case.draw(runs)]
    parts.append(f"<p class='small'>{case.precision}, {scene['dimension']}D: {html.escape(sizes)}.</p>")
    parts += [f"<p class='small'>{html.escape(entry['title'])}: {html.escape(entry['definition'])}"
              + (f" <b>Not judged: {html.escape(entry['reason'])}.</b>" if "reason" in entry else "")
              + "</p>" for entry in judged]
    return "\n".join(parts)


def render(cases, runs, results, measured, about):
    rows = [row for result in results for row in result["rows"]]
    rows += [figure for result in measured for figure in result["figures"]]
    judged = [row for row in rows if row["bar"] is not None]
    held = sum(row["holds"] is True for row in judged)
    columns = max((len(result["runs"]) for result in results), default=1)
    names = ("coarse", "medium", "fine", "finer", "finest")[:columns] if columns > 1 else ("coarse",)
    settings = "the library's defaults" if not about["settings"] else "set: " + ", ".join(about["settings"])
    with open(TEMPLATE, encoding="utf-8") as file:
        template = string.Template(file.read())
    return template.substitute(
        held=held, judged=len(judged), backend=html.escape(about["backend"]),
        build=html.escape(about["build"]), settings=html.escape(settings),
        columns="".join(f"<th>{name}</th>" for name in names), rows=_table(results),
        measured=_measured_table(measured),
        sections="\n".join(_section(case, runs[case.name]) for case in cases))
