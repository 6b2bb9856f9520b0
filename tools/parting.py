#!/usr/bin/env python3
"""Where two runs part: the first stage that left other bits, and the first particle there.

    tools/parting.py FIRST SECOND

are traces of the same scene by two builds, instruction sets or machines, which a build with -DPBF_TRACE_STAGES=ON
writes: `PBF_TRACE_FILE=one.trace PBF_TRACE_FIRST=12 PBF_TRACE_LAST=14 my-program`, with one thread. Steps are those
of the process, from 1 on. Exits with 0 where the runs are the same, with 1 where they part.
"""
import array
import collections
import struct
import sys

HEAD = struct.Struct("<8s3Q24s24s")
Record = collections.namedtuple("Record", "step stage run array bits ids values")


def text_of(name):
    return name.rstrip(b"\0").decode()


def read(file, path, size):
    data = file.read(size)
    if len(data) != size:
        sys.exit(f"parting: {path} ends within a record")
    return data


def records_of(path):
    """Each record of a trace, with how often its stage has run in its step."""
    runs, step_now = collections.Counter(), None
    with open(path, "rb") as file:
        while head := file.read(HEAD.size):
            if len(head) < HEAD.size:
                sys.exit(f"parting: {path} ends within a record")
            mark, step, bits, count, stage, name = HEAD.unpack(head)
            if mark != b"stage   " or bits not in (32, 64):
                sys.exit(f"parting: {path} is not a trace of stages")
            if step != step_now:
                runs, step_now = collections.Counter(), step
            key = (text_of(stage), text_of(name))
            runs[key] += 1
            ids = array.array("I", read(file, path, 4 * count))
            yield Record(step, key[0], runs[key], key[1], bits, ids, read(file, path, bits // 8 * count))


def place_of(record):
    times = f", run {record.run} of it in the step" if record.run > 1 else ""
    return f"step {record.step}, stage {record.stage}{times}: {record.array}"


def values_by_id(record):
    letter, size = {32: ("f", 4), 64: ("d", 8)}[record.bits]
    numbers = array.array(letter, record.values)
    return {i: (record.values[size * k:size * (k + 1)], numbers[k]) for k, i in enumerate(record.ids)}


def difference(first, second):
    """A sentence on two records of one place; None where they are the same."""
    if first.ids == second.ids and first.values == second.values:
        return None
    if first.bits != second.bits:
        return f"one run is in float{first.bits}, the other in float{second.bits}"
    one, other = values_by_id(first), values_by_id(second)
    if one.keys() != other.keys():
        return f"{place_of(first)}: particle {min(one.keys() ^ other.keys())} is in one run alone"
    parted = sorted(i for i in one if one[i][0] != other[i][0])
    if not parted:
        return f"{place_of(first)}: the same of each particle, which lie in another order"
    i = parted[0]
    return f"{place_of(first)} of particle {i} is {one[i][1]!r} and {other[i][1]!r}; {len(parted)} of {len(one)} particles differ"


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    count, others = 0, records_of(sys.argv[2])
    for first in records_of(sys.argv[1]):
        second = next(others, None)
        if second is None or first[:4] != second[:4]:
            there = "ends" if second is None else f"is at {place_of(second)}"
            print(f"{place_of(first)}: the second run {there}")
            return 1
        sentence = difference(first, second)
        if sentence:
            print(sentence)
            return 1
        count += 1
    if next(others, None) is not None:
        print("the first run ends before the second")
        return 1
    print(f"{count} arrays are the same")
    return 0


if __name__ == "__main__":
    sys.exit(main())
