"""pytest, if it and what the package needs are installed; else 77, which CTest counts as skipped."""
import importlib.util
import sys

missing = [name for name in ("cffi", "numpy", "pytest") if not importlib.util.find_spec(name)]
if missing:
    print("not installed:", ", ".join(missing))
    sys.exit(77)

import pytest  # noqa: E402

sys.exit(pytest.main(sys.argv[1:]))
