"""The headers that a program may include, but for ranks.h (which a library of its own serves) and pbf.hpp."""
import re

INCLUDE = re.compile(r"^#include <pbf/(\w+\.h)>", re.MULTILINE)


def public_headers(root):
    """Their paths in the order in which they are read: pbf.h, the parts that it includes, and what all.h has beside them."""
    folder = root / "include/pbf"
    included = lambda name: INCLUDE.findall((folder / name).read_text(encoding="utf-8"))
    names = ["pbf.h", *included("pbf.h"), *included("all.h")]
    return [folder / name for name in dict.fromkeys(names)]
