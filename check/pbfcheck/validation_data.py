"""Published tables, as CSV with # lines that name the source."""
import os

import numpy as np

FOLDER = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "validation")

FRONT = "martin_moyce_1952_table2_front_n2_2.csv"
HEIGHT = "martin_moyce_1952_table6_height_n2_2.csv"
ELLIPTIC_PATCH = "elliptic_patch_monaghan1994_analytic.csv"
OSCILLATING_DROP = "oscillating_drop_monaghan_rafiee2013_analytic.csv"
RITTER = "ritter_1892_analytic.csv"


def table(name):
    """{column: array}"""
    with open(os.path.join(FOLDER, name), encoding="utf-8") as file:
        lines = [line for line in file if line.strip() and not line.startswith("#")]
    columns = lines[0].strip().split(",")
    values = np.array([[float(v) for v in line.split(",")] for line in lines[1:]])
    return {column: values[:, k] for k, column in enumerate(columns)}


def source(name):
    """The file's comment lines."""
    with open(os.path.join(FOLDER, name), encoding="utf-8") as file:
        return " ".join(line[1:].strip() for line in file if line.startswith("#"))
