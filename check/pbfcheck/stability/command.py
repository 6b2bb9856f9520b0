"""pbf-check stability: verdicts on the cases that pbf-bench stability has dumped."""
from .. import FORMAT_VERSION, report
from .table import verdicts


def _line(entry):
    head = f'{entry["case"]:3d}  {entry["backend"]:10s} {entry["verdict"]:12s}'
    if entry["reason"] or not entry["figures"]:
        return head + entry["reason"]
    worst = entry["figures"][0]
    return f'{head}{worst["name"]}: {worst["shown"]} {worst["bound_shown"]}'


def judge_folder(folder, cases, backends):
    """(report as JSON text, table as text, whether no case fails)"""
    entries = verdicts(folder, cases, backends)
    text = report.to_json({"tool": "pbf-check", "format": FORMAT_VERSION, "verdicts": entries})
    table = "\n".join(_line(entry) for entry in entries) + "\n"
    return text, table, all(entry["verdict"] != "fails" for entry in entries)
