"""Runs one of the checker's test modules from their folder; 77, which CTest shows as skipped, where
NumPy or SciPy is missing."""
import os
import sys
import unittest

try:
    import numpy  # noqa: F401  (only whether it is there)
    import scipy  # noqa: F401
except ImportError as missing:
    print(f"skipped: {missing}; python3-numpy and python3-scipy would do")
    sys.exit(77)

sys.path.insert(0, os.getcwd())
unittest.main(module=sys.argv[1], argv=sys.argv[1:])
