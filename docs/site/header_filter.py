#!/usr/bin/env python3
"""Doxygen's view of a public header: its plain comments as Doxygen's own.

    header_filter.py FILE

The header is written to be read as it is, without marks of any tool. A comment that begins a line belongs to what follows, one
behind a declaration to what it stands behind, and `/* ---- Title ---- */` begins a group of the reference.
"""
import re
import sys

SECTION = re.compile(r"/\* -{4} (.+?) -+ \*/")
COMMENT = re.compile(r"/\*(.*?)\*/", re.DOTALL)
SPECIAL = re.compile(r"([\\@<>#%&$])")


def slug(title):
    return re.sub(r"\W+", "_", title.lower()).strip("_")


def without_stars(text):
    return "\n".join(re.sub(r"^\s*\* ?", "", line) for line in text.split("\n"))


def marked(words, names):
    """`code` as code, and names of the header's functions and structs as references."""
    words = SPECIAL.sub(r"\\\1", without_stars(words)).strip()
    words = re.sub(r"`([^`]+)`", r"<tt>\1</tt>", words)
    return re.sub(r"\bpbf_\w+\b", lambda name: f'\\ref {name[0]} "{name[0]}"' if name[0] in names else name[0], words)


def converted(text):
    opened = False
    names = set(re.findall(r"^PBF_API [^;(]*?\b(pbf_\w+)\(|^typedef struct (pbf_\w+) \{", text, flags=re.MULTILINE))
    names = {name for pair in names for name in pair if name}
    out, at = [], 0
    for match in COMMENT.finditer(text):
        out.append(text[at:match.start()])
        at = match.end()
        lines = match[0].count("\n")
        section = SECTION.fullmatch(match[0])
        if section:
            title = section[1].split(":")[0]
            out.append(("/** @} */ " if opened else "") + f"/** @defgroup {slug(title)} {title}\n @{{ */")
            opened = True
            continue
        if not opened:  # the head, and what stands before the first group
            out.append("\n" * lines)
            continue
        words = marked(match[1], names)
        before = text[text.rfind("\n", 0, match.start()) + 1:match.start()]
        mark = "/**<" if before.strip() else "/**"
        out.append(f"{mark} {words} */")
    out.append(text[at:])
    # Breathe declares a struct and its typedef of the same name twice.
    ended = re.sub(r"typedef (struct (\w+) \{.*?^\}) \2;", r"\1;", "".join(out), flags=re.MULTILINE | re.DOTALL)
    last = ended.rindex("#ifdef __cplusplus")
    return ended[:last] + "/** @} */\n" + ended[last:]


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    print(converted(open(sys.argv[1], encoding="utf-8").read()))
