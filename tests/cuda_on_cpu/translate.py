#!/usr/bin/env python3
"""Makes C++ of the cuda backend's sources, for the device that is emulated on a CPU.

    translate.py FROM TO [LEFT_OUT...]

Copies FROM, a folder of .cu and .h files, to TO. What C++ has no form for is written otherwise:

    a_kernel<A><<<grid, block>>>(...)    emulated::launch("a_kernel", [](auto &...values) {
                                             a_kernel<A>(values...); }, grid, block)(...)
    __shared__ T name[N];                a reference into the memory of the block that runs
    extern __shared__ T name[];          a pointer to its dynamic part

Lines stay where they begin, and the compiler's messages name the files they come from. Files whose
text has not changed are not written.
"""

import pathlib
import re
import sys


def end_of_brackets(text, at):
    """The place after the bracket that closes the one at `at`."""
    pairs = {"(": ")", "[": "]", "{": "}"}
    open_ones = []
    while True:
        if text[at] in pairs:
            open_ones.append(pairs[text[at]])
        elif open_ones and text[at] == open_ones[-1]:
            open_ones.pop()
        at += 1
        if not open_ones:
            return at


def start_of_kernel(text, end):
    """Where the expression begins that names a kernel and ends before `end`."""
    at = end
    while text[at - 1].isspace():
        at -= 1
    if text[at - 1] == ">":
        depth = 0
        while True:
            at -= 1
            if text[at] == ">" and text[at - 1] != "-":
                depth += 1
            elif text[at] == "<":
                depth -= 1
            if depth == 0:
                break
    while re.match(r"[\w:]", text[at - 1]):
        at -= 1
    return at


def template_kernels(texts):
    """The names of kernels that are templates."""
    names = set()
    for text in texts:
        for found in re.finditer(r"__global__ void\s+(?:__launch_bounds__\([^;{]*?\)\s+)?(\w+)\(", text):
            before = re.split(r"[;}]|\*/", text[: found.start()])[-1]
            if "template <" in before:
                names.add(found.group(1))
    return names


def translated_launches(text, templates):
    out, done = [], 0
    for found in re.finditer(r"<<<", text):
        begin = start_of_kernel(text, found.start())
        at = found.end()
        while not text.startswith(">>>", at):
            at = end_of_brackets(text, at) if text[at] in "([{" else at + 1
        kernel, shape = text[begin : found.start()].strip(), text[found.end() : at]
        name = re.match(r"[\w:]+", kernel).group()
        if name in templates:  # whose parameters its arguments may tell
            called = f"[](auto &...values) {{ {kernel}(values...); }}"
        else:
            called = kernel
        out.append(text[done:begin])
        out.append(f'emulated::launch("{name}", {called}, {shape})')
        done = at + 3
    return "".join(out) + text[done:]


def translated_shared(text):
    text = re.sub(
        r"extern __shared__ ([\w ]+?) (\w+)\[\];",
        r"\1 *\2 = static_cast<\1 *>(emulated::dynamic_shared());",
        text,
    )

    def variable(found):
        declared = found.group(1)
        name = re.search(r"(\w+)\s*((\[[^;]*\])?)$", declared).group(1)
        return (
            f"struct shared_{name} {{ {declared}; }}; "
            f"static const int variable_{name} = emulated::new_shared_variable(); "
            f"auto &{name} = emulated::shared_variable<shared_{name}>(variable_{name})->{name};"
        )

    return re.sub(r"__shared__ ([^;]+);", variable, text)


def main():
    source, target, left_out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3:]
    paths = [path for path in sorted(source.rglob("*")) if path.suffix in (".cu", ".h")]
    templates = template_kernels([path.read_text() for path in paths])
    for path in paths:
        name = path.relative_to(source).as_posix()
        if name in left_out:
            continue
        text = translated_shared(translated_launches(path.read_text(), templates))
        text = f'#line 1 "{path}"\n' + text
        to = target / (name + ".cpp" if path.suffix == ".cu" else name)
        if to.exists() and to.read_text() == text:
            continue
        to.parent.mkdir(parents=True, exist_ok=True)
        to.write_text(text)


if __name__ == "__main__":
    main()
