"""What the writers of all languages ask of a description."""

COMMENT = "Written by tools/bindings.py from bindings/abi.json; do not edit."


def camel(name, without=""):
    """"PBF_KERNEL_WENDLAND_C2" → "KernelWendlandC2"."""
    name = name.removeprefix(without).removeprefix("pbf_").removeprefix("PBF_")
    return "".join(part[:1].upper() + part[1:].lower() for part in name.split("_"))


def is_status(enum):
    return min(enum.values()) < 0


def is_text(kind):
    """const char *, a C string."""
    return kind.get("pointer") == {"scalar": "char"} and kind["const"]
