#!/usr/bin/env python3
"""barriers.py PLUGIN, or a .cubin: whether threads of a warp may go on without each other in its machine code.

Where threads part, a convergence barrier (B0 to B15, one set for each warp) holds those that are
through until the others are. Around a call of a function that has use for the same one, ptxas holds
it in a register, and puts it back after the call. That is wrong where the function has several ends
and ptxas lets a part of the threads leave at an earlier one: these put the barrier back, and wait at
it, while the others still set it to what they need within. So those that wait are let go, alone, and
what a warp has once, as uniform registers, they change for the others (CUDA 13.0, sm_90). A function
that ends in something which all threads do, as a store, has one end.

Names every call of a function that some threads leave early, and that has, in itself or what it
calls, a use for the barrier that is put back after it. Exit code 1: there are some; 77: cuobjdump or
nvdisasm is not there.
"""
import collections
import glob
import os
import re
import shutil
import subprocess
import sys
import tempfile


def find_tool(name):
    found = shutil.which(name) or shutil.which(name, path="/usr/local/cuda/bin")
    if not found:
        print(f"barriers.py: skipped: no {name}")
        sys.exit(77)
    return found


class Kernel:
    """One kernel's functions, each of which is there once more for every kernel that calls it."""

    def __init__(self):
        self.barriers = collections.defaultdict(set)
        self.calls = collections.defaultdict(set)
        self.left_early = set()
        self.put_back = []  # (caller, function, barrier)

    def barriers_of(self, function, seen=()):
        found = set(self.barriers[function])
        for called in self.calls[function] - set(seen):
            found |= self.barriers_of(called, (*seen, function))
        return found

    def faults(self):
        return [(caller, function, barrier) for caller, function, barrier in self.put_back
                if function in self.left_early and barrier in self.barriers_of(function)]


def read(lines):
    kernels, kernel, function, called = {}, None, None, None
    for line in lines:
        if start := re.match(r"\.text\.(\S+):$", line):
            kernel = kernels.setdefault(start[1], Kernel())
            function, called = start[1], None
        elif start := re.match(r"(\$\S+):$", line):
            function, called = start[1], None
        elif kernel is None:
            continue
        elif "CALL" in line:
            target = re.search(r"`\((\S+?)\)", line)
            called = target[1] if target else None
            if called:
                kernel.calls[function].add(called)
        elif operation := re.search(r"\b(BSSY|BSYNC|BREAK|BMOV)\S*\s+([^;]*);", line):
            kernel.barriers[function] |= set(re.findall(r"\bB\d+\b", operation[2]))
            back = re.match(r"(B\d+), R\d+", operation[2])
            if operation[1] == "BMOV" and back and called:
                kernel.put_back.append((function, called, back[1]))
        elif re.search(r"@!?U?P\d+ RET", line):
            kernel.left_early.add(function)
        elif re.search(r"\bBRA\b", line):
            called = None
    return kernels


def disassembled(plugin):
    nvdisasm = find_tool("nvdisasm")
    plugin = os.path.abspath(plugin)
    with tempfile.TemporaryDirectory() as folder:
        if plugin.endswith(".cubin"):
            shutil.copy(plugin, folder)
        else:
            subprocess.run([find_tool("cuobjdump"), "--extract-elf", "all", plugin], cwd=folder,
                           check=True, stdout=subprocess.DEVNULL)
        for cubin in sorted(glob.glob(os.path.join(folder, "*.cubin"))):
            text = subprocess.run([nvdisasm, "-c", cubin], check=True, capture_output=True, text=True).stdout
            yield os.path.basename(cubin), text.split("\n")


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: barriers.py PLUGIN")
    kernels = put_back = faults = 0
    for cubin, lines in disassembled(sys.argv[1]):
        for name, kernel in read(lines).items():
            kernels += 1
            put_back += len(kernel.put_back)
            for caller, function, barrier in sorted(set(kernel.faults())):
                faults += 1
                print(f"{cubin}: {name}: {barrier} is put back in {caller.split('$')[-1]} after "
                      f"{function.split('$')[-1]}, which some threads leave early")
    print(f"{kernels} kernels, {put_back} barriers put back after a call, {faults} of them too early")
    if not kernels:
        sys.exit("barriers.py: no machine code in " + sys.argv[1])
    sys.exit(1 if faults else 0)


main()
