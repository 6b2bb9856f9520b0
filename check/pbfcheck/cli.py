"""Command line."""
import argparse
import sys

from . import bounds, report
from .density import WALL_MODELS
from .dump import Dump
from .fault import DumpFault, UsageFault
from .judge import ERRORS, VALIDATIONS, errors_of, validation_of
from .order import order_of
from .stability.command import judge_folder
from .streams import LostOutput, show, tell

EXIT_OK = 0
EXIT_BEYOND_BOUND = 1
EXIT_USAGE = 2
EXIT_BAD_DUMP = 3

EXIT_CODES = ("exit codes: 0 judged, every bound holds; 1 a bound or bar does not hold, or a validation "
              "could not be judged; 2 wrong usage, or output that can't be written; 3 a dump or report is missing or "
              "malformed")


def _common(parser):
    parser.add_argument("dump", help="folder of positions_<step>.npy, velocities_<step>.npy, dump.json")
    parser.add_argument("--steps", default="all", help="all, last, ends, a step, or START:END:STRIDE")
    parser.add_argument("--json", metavar="FILE", help="write the report; - for standard output")
    parser.add_argument("--gate-shift", type=float, default=0.0, help="dam break: added to the run's T")
    parser.add_argument("--bound", action="append", default=[], metavar="FIGURE<=NUMBER",
                        help="e.g. E1.measure.interior.mean_abs@last<=0.001 (@mean, @largest: the default)")


def build_parser():
    parser = Parser(prog="pbf-check", description=__doc__, epilog=EXIT_CODES)
    commands = parser.add_subparsers(dest="command", required=True)

    errors = commands.add_parser("errors", help="E1 to E9 of one dump, and whether its particles are all there", epilog=EXIT_CODES)
    _common(errors)
    errors.add_argument("--only", metavar="KEYS", help="comma-separated, of " + ", ".join(ERRORS))
    errors.add_argument("--measure-radius", type=float, default=3.0, metavar="R",
                        help="E1: radius of the measuring kernel in rest spacings (default 3)")
    errors.add_argument("--coverage", type=float, default=0.95,
                        help="E1: filled share of the kernel ball of an interior particle")
    errors.add_argument("--wall-density", choices=WALL_MODELS, default="mirror",
                        help="E1: what stands for the fluid behind a wall")
    errors.add_argument("--reference", metavar="DIR", help="E3: dump of the converged run")
    errors.add_argument("--floor", metavar="DIR", help="E3: the reference started a hair apart")
    errors.add_argument("--cell", type=float, default=4.0, help="E3: cell width in rest spacings")
    errors.add_argument("--agree", type=float, default=0.1,
                        help="E3: RMS distance in spacings below which trajectories agree")

    validate = commands.add_parser("validate", help="one validation run", epilog=EXIT_CODES)
    validate.add_argument("name", choices=sorted(VALIDATIONS))
    _common(validate)
    validate.add_argument("--mode", type=int, default=1, help="sloshing: n")
    validate.add_argument("--length", type=float, help="u-tube: length of the fluid along the tube")
    validate.add_argument("--middle", type=float, help="u-tube: coordinate between the arms")
    validate.add_argument("--omega", type=float, help="rotating-tank: radians a time unit")
    validate.add_argument("--center", type=float, nargs="+", help="rotating-tank: horizontal coordinates")
    validate.add_argument("--radius", type=float, help="rotating-tank: judged up to here")

    order = commands.add_parser("order", help="E10 from the JSON reports of several runs", epilog=EXIT_CODES)
    order.add_argument("reports", nargs="+", help="files written with --json")
    order.add_argument("--error", required=True, help="figure, e.g. E3.rms@last")
    order.add_argument("--by", default="time_step", help="key of the dump: time_step, spacing, iterations, …")
    order.add_argument("--values", type=float, nargs="+", help="the parameter of each report, in place of its dump's")
    order.add_argument("--json", metavar="FILE", help="write the result; - for standard output")

    stability = commands.add_parser("stability", help="verdicts on the cases of pbf-bench stability --dump",
                                    epilog=EXIT_CODES)
    stability.add_argument("folder", help="of <case>/<backend>/facts.json beside their dumps")
    stability.add_argument("--json", metavar="FILE", help="write the verdicts; - for standard output")
    stability.add_argument("--case", type=int, action="append", default=[], metavar="N", help="this one; again for more")
    stability.add_argument("--backend", action="append", default=[], metavar="B", help="this one; again for more")
    stability.add_argument("--silent", action="store_true", help="no table")
    return parser


def _check_numbers(args):
    limits = {"measure_radius": (1.0, 20.0), "coverage": (0.0, 1.0), "cell": (0.1, 1e6),
              "agree": (0.0, 1e6), "gate_shift": (-10.0, 10.0), "mode": (1, 1000)}
    for name, (low, high) in limits.items():
        value = getattr(args, name, low)
        if not low <= value <= high:
            raise UsageFault(f"--{name.replace('_', '-')} is {value:g}; it must be {low:g} … {high:g}")


def _keys(args):
    if not args.only:
        return list(ERRORS)
    keys = args.only.split(",")
    for key in keys:
        if key not in ERRORS:
            raise UsageFault(f'--only has "{key}"; it must be of {", ".join(ERRORS)}')
    return keys


def _write(text, path):
    if path == "-":
        show(text)
        return
    try:
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
    except OSError as error:
        raise UsageFault(f"--json {path} cannot be written ({error.strerror})") from error


def _judge(args):
    for text in args.bound:
        bounds.parse(text)
    dump = Dump(args.dump)
    steps = dump.select(args.steps)
    result = report.start(dump, steps)
    failed = False
    if args.command == "errors":
        result["errors"] = errors_of(dump, steps, _keys(args), args)
    else:
        entry = validation_of(dump, steps, args.name, args)
        result["validations"][args.name] = entry
        failed = "reason" in entry or not all(entry.get("verdicts", {}).values())
    result["bounds"] = [bounds.check(result, text) for text in args.bound]
    if args.json:
        _write(report.to_json(result), args.json)
    if args.json != "-":
        show(report.to_table(result))
    failed = failed or not all(bound["holds"] for bound in result["bounds"])
    return EXIT_BEYOND_BOUND if failed else EXIT_OK


def _order(args):
    result = order_of(args.reports, args.error, args.by, args.values)
    if args.json:
        _write(report.to_json({"tool": "pbf-check", "errors": {"E10": result}}), args.json)
    if args.json != "-":
        for p, e in zip(result["parameters"], result["errors"]):
            show(f"{args.by} {p:.6g}   {args.error} {e:.6g}\n")
        monotone = "falls monotonically" if result["monotone"] else "does NOT fall monotonically"
        show(f"E10  slope {result['slope']:.3f}; the error {monotone}\n")
    return EXIT_OK


def _stability(args):
    text, table, good = judge_folder(args.folder, args.case, args.backend)
    if args.json:
        _write(text, args.json)
    if args.json != "-" and not args.silent:
        show(table)
    return EXIT_OK if good else EXIT_BEYOND_BOUND


COMMANDS = {"order": _order, "stability": _stability}


def _end(code, fault):
    if str(fault):
        tell(f"pbf-check: {fault}\n")
    return code


class Parser(argparse.ArgumentParser):
    """Prints as the program does."""

    def _print_message(self, message, file=None):
        if message:
            (show if file is sys.stdout else tell)(message)


def main(arguments):
    try:
        args = build_parser().parse_args(arguments)
        _check_numbers(args)
        return COMMANDS.get(args.command, _judge)(args)
    except (UsageFault, LostOutput) as fault:
        return _end(EXIT_USAGE, fault)
    except DumpFault as fault:
        return _end(EXIT_BAD_DUMP, fault)
