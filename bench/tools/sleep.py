#!/usr/bin/env python3
"""What sleep saves, and what it changes: scenes that come to rest, awake and with sleep.

    bench/tools/sleep.py measure BUILD RESULT.json    runs BUILD's pbf-bench and pbf-check
    bench/tools/sleep.py table RESULT.json            writes the table in docs/notes/sleep.md

A span's time is the processor's for a run to its end less that for a run to its beginning (one step
where that is 0), each the least of RUNS.
"""
import json
import pathlib
import re
import resource
import subprocess
import sys
import tempfile

from pages import ROOT, write_table

SPEED, TIME = 0.07, 0.5  # 0.1 sqrt(|g| spacing) of these scenes, half a second
SCENES = {"still-tank": [(0, 600), (600, 1200), (1200, 1800)], "dam-break-3d": [(0, 1200), (0, 3600)]}
RUNS = 1
NOISE = 0.3  # ms a step: less is lost in the difference of two runs
FIGURES = {"E1": "measure.interior.mean_abs", "E2": "volume", "E9": "rms"}


def run(*command):
    return subprocess.run([str(word) for word in command], check=True, text=True, stdout=subprocess.PIPE).stdout


def bench_run(bench, scene, steps, sleep, dump):
    settings = ["--set", f"sleep_speed={SPEED}", "--set", f"sleep_time={TIME}"] if sleep else []
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    text = run(bench, "run", "--scene", scene, "--backend", "serial", "--threads", 1, "--steps", steps,
               "--steps-per-call", steps, "--dump", dump, *settings)
    particles, device = re.search(r"(\d+) particles", text), re.search(r"serial on (.*?),", text)
    milliseconds = 1e3 * (resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before)
    return milliseconds, int(particles.group(1)), device.group(1)


def errors_of(dump):
    report = pathlib.Path(dump) / "errors.json"
    subprocess.run([sys.executable, ROOT / "check" / "pbf-check", "errors", dump, "--steps", "last", "--only", "E1,E2,E9",
                    "--json", report], check=False, stdout=subprocess.DEVNULL)
    errors = json.loads(report.read_text(encoding="utf-8"))["errors"]
    return {measure: errors[measure]["summary"][figure]["last"] for measure, figure in FIGURES.items()}


def measure(build, result):
    bench, rows, device = build / "bin" / "pbf-bench", [], ""
    for scene, spans in SCENES.items():
        for sleep in (False, True):
            ends = sorted({step for span in spans for step in span if step})
            with tempfile.TemporaryDirectory() as dump:
                at = {0: bench_run(bench, scene, 1, sleep, dump)[0]}
            for end in ends:
                with tempfile.TemporaryDirectory() as dump:
                    times = [bench_run(bench, scene, end, sleep, dump) for _ in range(RUNS)]
                    at[end], particles, device = min(t[0] for t in times), times[0][1], times[0][2]
                    errors = errors_of(dump)
                for first, last in spans:
                    if last == end:
                        rows.append({"scene": scene, "particles": particles, "sleep": sleep, "first": first, "last": last,
                                     "ms_per_step": (at[last] - at[first]) / (last - first), "errors": errors})
                        print(scene, "asleep" if sleep else "awake", first, last, rows[-1]["ms_per_step"], flush=True)
    commit = run("git", "-C", ROOT, "rev-parse", "--short=12", "HEAD").strip()
    result.write_text(json.dumps({"commit": commit, "device": device, "sleep_speed": SPEED, "sleep_time": TIME,
                                  "rows": rows}, indent=1) + "\n", encoding="utf-8")


def pairs_of(result):
    """(awake, asleep) of each span."""
    rows = result["rows"]
    for awake in rows:
        if not awake["sleep"]:
            yield awake, next(r for r in rows if r["sleep"] and all(r[k] == awake[k] for k in ("scene", "first", "last")))


def least(milliseconds, over=None):
    """The time, or how many times `over` it is, where differences of two runs tell."""
    if over is None:
        return f"{milliseconds:.2f}" if milliseconds > NOISE else f"< {NOISE}"
    return f"{milliseconds / over:.1f}" if over > NOISE else f"> {milliseconds / NOISE:.0f}"


def table(result):
    lines = ["| scene | steps | ms a step, awake | with sleep | × | E1 at the end, awake | with sleep | volume asleep over awake | noise (E9) awake | with sleep |",
             "| --- | --- | --: | --: | --: | --: | --: | --: | --: | --: |"]
    for awake, asleep in pairs_of(result):
        a, b = awake["errors"], asleep["errors"]
        lines.append(f"| {awake['scene']} | {awake['first']:,} … {awake['last']:,} | {awake['ms_per_step']:.2f} | "
                     f"{least(asleep['ms_per_step'])} | {least(awake['ms_per_step'], asleep['ms_per_step'])} | "
                     f"{100 * a['E1']:.2f} % | {100 * b['E1']:.2f} % | {100 * (b['E2'] / a['E2'] - 1):+.2f} % | "
                     f"{a['E9']:.3f} | {b['E9']:.3f} |")
    first = result["rows"][0]
    lines += ["", f"serial, 1 thread, {result['device']}, processor time; sleep_speed {result['sleep_speed']}, "
              f"sleep_time {result['sleep_time']}, commit {result['commit']}; still-tank has {first['particles']:,} particles."]
    return "\n".join(lines)


if __name__ == "__main__":
    arguments = sys.argv[1:]
    if len(arguments) == 3 and arguments[0] == "measure":
        measure(pathlib.Path(arguments[1]).resolve(), pathlib.Path(arguments[2]))
    elif len(arguments) == 2 and arguments[0] == "table":
        result = json.loads(pathlib.Path(arguments[1]).read_text(encoding="utf-8"))
        write_table("docs/notes/sleep.md", "sleep", table(result))
    else:
        sys.exit(__doc__)
