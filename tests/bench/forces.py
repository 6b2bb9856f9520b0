"""pbf-forces: arguments that are none, and spacings without a fluid, are refused in words.

    forces.py PBF_FORCES
"""
import subprocess
import sys

WRONG = [
    (["--spacing"], 2, "--spacing has no length"),
    (["--spacing", "nan", "tow"], 2, "no length above 0: nan"),
    (["--spacing", "inf", "tow"], 2, "no length above 0: inf"),
    (["--spacing", "-0.1"], 2, "no length above 0: -0.1"),
    (["--spacing", "0.05abc", "tow"], 2, "no length above 0: 0.05abc"),
    (["--spacing", "", "tow"], 2, "no length above 0: "),
    (["float"], 2, "there is no case float"),
    (["--spacing", "1e-9", "buoyancy"], 1, "a spacing of 1e-09 makes more particles than a solver holds"),
    (["--spacing", "5e-324", "dam-break"], 1, "makes more particles than a solver holds"),
    (["--spacing", "10", "buoyancy"], 1, "a spacing of 10 is too wide for this case"),
    (["--spacing", "1e300", "tow"], 1, "a spacing of 1e+300 is too wide for this case"),
]

failed = False
for arguments, code, words in WRONG:
    done = subprocess.run([sys.argv[1], *arguments], capture_output=True, text=True, timeout=60, check=False)
    if done.returncode != code or words not in done.stderr:
        failed = True
        print(f"{arguments}: exit {done.returncode}, {done.stderr!r}; wanted {code}, {words!r}")
sys.exit(failed)
