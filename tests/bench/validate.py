"""The validation command's quick form: every case at its coarsest, within the bounds known to hold; then
a fluid that misses them, and wrong command lines. Arguments: pbf-bench, the backend, a folder to work in. 77, skipped, without NumPy,
SciPy or matplotlib."""

import json
import os
import pathlib
import subprocess
import sys

try:
    import matplotlib  # noqa: F401  (only whether they are there)
    import numpy  # noqa: F401
    import scipy  # noqa: F401
except ImportError as missing:
    print(f"SKIPPED: {missing}")
    sys.exit(77)

program, backend, work = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
validate = pathlib.Path(__file__).resolve().parents[2] / "bench" / "validate"


def run(*arguments):
    command = [sys.executable, str(validate), "--out", str(work), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    print(done.stdout + done.stderr)
    return done


def fails(code, sentence, *arguments):
    done = run(*arguments)
    assert done.returncode == code, (arguments, done.returncode)
    assert sentence in done.stderr, (sentence, done.stderr)


# Those that take a second or two each; the others where all is asked for, as ./run test long does.
SHORT = {"cases": ["colliding-drops", "free-fall", "hydrostatic-column"],
         "physics": ["couette", "current-tank", "layers-sort", "lock-exchange", "poiseuille", "rayleigh-taylor",
                     "reservoir-level", "taylor-green", "volume-flow"]}
COUNTS = {"cases": 9, "physics": 21}
is_long = os.environ.get("PBF_TEST_LONG", "0") not in ("", "0")


def every_case_within_its_bounds():
    chosen = [] if is_long else [word for names in SHORT.values() for name in names for word in ("--case", name)]
    done = run("--quick", "--program", program, "--backend", backend, *chosen)
    assert done.returncode == 0, done.returncode
    results = json.loads((work / "validation.json").read_text())
    page = (work / "validation.html").read_text()
    for kind, count in COUNTS.items():
        names = [case["case"] for case in results[kind]]
        assert len(names) == count if is_long else sorted(names) == SHORT[kind], names
        for name in names:
            assert f'id="{name}"' in page, name
    # Two pictures a case, but one of free fall; nothing that a browser would have to fetch.
    pictures = page.count("data:image/svg+xml;base64,")
    assert pictures == 2 * len(results["cases"]) - 1, pictures
    assert "src=\"http" not in page and "<link" not in page and "<script" not in page


def a_broken_fluid_is_told():
    fails(1, "dam-break: dam-break.height.max is", "--quick", "--program", program, "--backend", backend,
          "--case", "dam-break", "--set", "over_relaxation=0.001")
    fails(1, "poiseuille: steady, velocity over the closed form is off by", "--quick", "--program", program, "--backend",
          backend, "--case", "poiseuille", "--set", "wall_no_slip=0")


def wrong_usage_is_told():
    fails(2, "--resolutions is 9; it must be 1", "--program", program, "--resolutions", "9")
    fails(2, "--program is /nowhere", "--program", "/nowhere")
    fails(2, "invalid choice: 'dam-brake'", "--program", program, "--case", "dam-brake")
    fails(1, "there is no parameter \"gravitty\"", "--quick", "--program", program, "--backend", backend,
          "--case", "couette", "--set", "gravitty=1")
    fails(1, "there is no parameter \"gravitty\"", "--quick", "--program", program, "--backend", backend,
          "--case", "free-fall", "--set", "gravitty=1")


every_case_within_its_bounds()
a_broken_fluid_is_told()
wrong_usage_is_told()
