"""Command line."""
import argparse
import concurrent.futures
import json
import os
import shutil
import sys
import tempfile

from . import ROOT, page, physics
from .cases import CASES
from .fault import RunFault, UsageFault
from .results import bounds_of, case_json
from .runs import run

EXIT_OK, EXIT_FAILED, EXIT_USAGE = 0, 1, 2
MOST_RESOLUTIONS = 5
NAMES = [case.name for case in CASES] + list(physics.CASES)


def build_parser():
    parser = argparse.ArgumentParser(
        prog="validate", description="Runs the validation cases, and writes validation.html and "
        "validation.json. Those of cases.py run at several resolutions (a factor of 2 apart), and "
        "pbf-check judges them; those of physics.py pbf-bench runs at their scenes' own, and measures. "
        "The library's defaults throughout.",
        epilog="exit codes: 0 everything ran and was judged (bars that are missed are figures); 1 a "
               "run failed, or with --quick a bound does not hold; 2 wrong usage")
    parser.add_argument("--case", action="append", choices=NAMES, metavar="NAME",
                        help="only this one; again and again. " + ", ".join(NAMES))
    parser.add_argument("--backend", default="serial")
    parser.add_argument("--precision", choices=("f32", "f64"), help="in place of each case's own")
    parser.add_argument("--resolutions", type=int, default=3, metavar="N", help="1 … 5 (3)")
    parser.add_argument("--finer", type=float, default=1.0, metavar="F",
                        help="resolution of the coarsest run, in that of the scene (1)")
    parser.add_argument("--out", default=os.path.join(ROOT, "out"), metavar="DIR")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                        help="a parameter for every run, for experiments; as pbf-bench takes it")
    parser.add_argument("--program", metavar="FILE", help="pbf-bench (build/release/bin/pbf-bench, else "
                        "the one of the search path)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="runs at once")
    parser.add_argument("--threads", type=int, default=0, help="of each run (0: the backend's choice)")
    parser.add_argument("--quick", action="store_true",
                        help="the coarsest resolution only, judged by bounds known to hold")
    parser.add_argument("--keep", metavar="DIR", help="keep the dumps here")
    return parser


def _check(options):
    if not 1 <= options.resolutions <= MOST_RESOLUTIONS:
        raise UsageFault(f"--resolutions is {options.resolutions}; it must be 1 … {MOST_RESOLUTIONS}")
    if options.jobs < 1:
        raise UsageFault(f"--jobs is {options.jobs}; it must be at least 1")
    if not 0.01 <= options.finer <= 100:
        raise UsageFault(f"--finer is {options.finer:g}; it must be 0.01 … 100")
    built = os.path.join(ROOT, "build", "release", "bin", "pbf-bench")
    program = options.program or (built if os.path.exists(built) else shutil.which("pbf-bench"))
    if not program or not os.path.exists(program):
        raise UsageFault(f"--program is {program or 'not given'}; build pbf-bench, or name its file")
    options.program = program
    try:
        os.makedirs(options.out, exist_ok=True)
    except OSError as error:
        raise UsageFault(f"--out {options.out} can't be made ({error.strerror})") from error


def _run_all(cases, names, levels, options, work):
    """{case: runs from coarse to fine}, [what pbf-bench has measured]. The finest start first: they take
    longest."""
    runs, measured = {case.name: {} for case in cases}, {}
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        jobs = {}

        def submit(function, what, level):
            name = what if level is None else what.name
            folder = os.path.join(work, name if level is None else f"{name}-{level:g}")
            os.makedirs(folder, exist_ok=True)
            arguments = (what, options, folder) if level is None else (what, level, options, folder)
            jobs[pool.submit(function, *arguments)] = (name, level, folder)

        for name in names:
            submit(physics.measure, name, None)
        for level in reversed(levels):
            for case in cases:
                submit(run, case, level)
        try:
            for count, job in enumerate(concurrent.futures.as_completed(jobs), 1):
                name, level, folder = jobs[job]
                done = job.result()
                if level is None:
                    measured[name], particles, seconds = done, done["particles"], done["seconds"]
                else:
                    runs[name][level], particles, seconds = done, done.particles, done.seconds
                if not options.keep:
                    shutil.rmtree(folder)
                print(f"{count:3} of {len(jobs)}  {name}: {particles} particles, {seconds:.1f} s", flush=True)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return ({name: [by_level[level] for level in levels] for name, by_level in runs.items()},
            [measured[name] for name in names])


def _report(cases, runs, measured, options):
    results = [case_json(case, runs[case.name]) for case in cases]
    build = runs[cases[0].name][0].dump.get("build_id", "") if cases else measured[0]["build"]
    about = {"backend": options.backend, "settings": options.set, "build": build}
    with open(os.path.join(options.out, "validation.json"), "w", encoding="utf-8") as file:
        json.dump({"tool": "validate", "format": 1, **about, "cases": results, "physics": measured}, file,
                  indent=1)
    html = os.path.join(options.out, "validation.html")
    with open(html, "w", encoding="utf-8") as file:
        file.write(page.render(cases, runs, results, measured, about))
    print(page.text_table(results, measured))
    print(f"The page is {html}")


def _bounds_hold(cases, runs, measured):
    good = True
    for sentence in (text for result in measured for text in physics.bounds_missed(result)):
        good = False
        print(f"validate: {sentence}", file=sys.stderr)
    for case in cases:
        for bound in bounds_of(runs[case.name][0]):
            if not bound["holds"]:
                good = False
                print(f"validate: {case.name}: {bound['figure']} is {bound['value']}; it must be "
                      f"{bound['sense']} {bound['limit']:g}", file=sys.stderr)
    return good


def main(arguments):
    options = build_parser().parse_args(arguments)
    try:
        _check(options)
        cases = [case for case in CASES if not options.case or case.name in options.case]
        levels = [options.finer * 2.0**k for k in range(1 if options.quick else options.resolutions)]
        with tempfile.TemporaryDirectory(prefix="pbf-validate-") as scratch:
            names = [name for name in physics.CASES if not options.case or name in options.case]
            runs, measured = _run_all(cases, names, levels, options, options.keep or scratch)
            _report(cases, runs, measured, options)
        return EXIT_OK if not options.quick or _bounds_hold(cases, runs, measured) else EXIT_FAILED
    except UsageFault as fault:
        print(f"validate: {fault}", file=sys.stderr)
        return EXIT_USAGE
    except RunFault as fault:
        print(f"validate: {fault}", file=sys.stderr)
        return EXIT_FAILED
