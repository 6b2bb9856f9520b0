"""Command line."""
import argparse
import concurrent.futures
import json
import os
import shutil
import sys
import tempfile

from . import ROOT, page
from .cases import CASES
from .fault import RunFault, UsageFault
from .results import bounds_of, case_json
from .runs import run

EXIT_OK, EXIT_FAILED, EXIT_USAGE = 0, 1, 2
MOST_RESOLUTIONS = 5


def build_parser():
    parser = argparse.ArgumentParser(
        prog="validate", description="Runs the validation cases, each at several "
        "resolutions (a factor of 2 apart), has pbf-check judge them, and writes validation.html "
        "and validation.json. The library's defaults throughout.",
        epilog="exit codes: 0 everything ran and was judged (bars that are missed are figures); 1 a "
               "run failed, or with --quick a bound does not hold; 2 wrong usage")
    parser.add_argument("--case", action="append", choices=[case.name for case in CASES], metavar="NAME",
                        help="only this one; again and again. " + ", ".join(c.name for c in CASES))
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


def _run_all(cases, levels, options, work):
    """{case: runs from coarse to fine}. The finest start first: they take longest."""
    runs = {case.name: {} for case in cases}
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        jobs = {}
        for level in reversed(levels):
            for case in cases:
                folder = os.path.join(work, f"{case.name}-{level:g}")
                os.makedirs(folder, exist_ok=True)
                jobs[pool.submit(run, case, level, options, folder)] = (case, level, folder)
        try:
            for count, job in enumerate(concurrent.futures.as_completed(jobs), 1):
                case, level, folder = jobs[job]
                done = job.result()
                runs[case.name][level] = done
                if not options.keep:
                    shutil.rmtree(folder)
                print(f"{count:3} of {len(jobs)}  {case.name}: {done.particles} particles, "
                      f"{done.seconds:.1f} s", flush=True)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return {name: [by_level[level] for level in levels] for name, by_level in runs.items()}


def _report(cases, runs, options):
    results = [case_json(case, runs[case.name]) for case in cases]
    about = {"backend": options.backend, "settings": options.set,
             "build": runs[cases[0].name][0].dump.get("build_id", "")}
    with open(os.path.join(options.out, "validation.json"), "w", encoding="utf-8") as file:
        json.dump({"tool": "validate", "format": 1, **about, "cases": results}, file, indent=1)
    html = os.path.join(options.out, "validation.html")
    with open(html, "w", encoding="utf-8") as file:
        file.write(page.render(cases, runs, results, about))
    print(page.text_table(results))
    print(f"The page is {html}")


def _bounds_hold(cases, runs):
    good = True
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
            runs = _run_all(cases, levels, options, options.keep or scratch)
            _report(cases, runs, options)
        return EXIT_OK if not options.quick or _bounds_hold(cases, runs) else EXIT_FAILED
    except UsageFault as fault:
        print(f"validate: {fault}", file=sys.stderr)
        return EXIT_USAGE
    except RunFault as fault:
        print(f"validate: {fault}", file=sys.stderr)
        return EXIT_FAILED
