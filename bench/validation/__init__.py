"""The validation command: runs of pbf-bench, judged by pbf-check, on one page.

It only starts the one, calls the other and draws what it said: a case is a scene file, arguments of
pbf-check and the names of its figures (cases.py).
"""
import os
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

sys.path.insert(0, os.path.join(ROOT, "check"))  # the checker is not installed
