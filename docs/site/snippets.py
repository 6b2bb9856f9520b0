#!/usr/bin/env python3
"""Code in the documents, as it is in the sources that are compiled and run:

    snippets.py            writes it
    snippets.py --check    fails where a document has other code than its source

In Markdown, before a fenced block:   <!-- code: examples/tutorial/1_dam.c create -->
Around what it names: /* code: create */ … /* end */, in Lua --[[ code: create ]] … --[[ end ]], in Python # code: create … # end
"""
import pathlib
import re
import sys
import textwrap

ROOT = pathlib.Path(__file__).resolve().parents[2]
BEGINS, ENDS = r"(?:/\*|--\[\[|#)", r"(?: \*/| \]\]|)"
BLOCK = re.compile(r"(<!-- code: (\S+) (\w+) -->\n```(?:c|cpp|rust|csharp|lua|js|python)\n)(.*?)(^```$)", re.MULTILINE | re.DOTALL)


def piece(name, label):
    text = (ROOT / name).read_text(encoding="utf-8")
    found = re.findall(rf"^ *{BEGINS} code: {label}{ENDS}\n(.*?)^ *{BEGINS} end{ENDS}$", text, flags=re.MULTILINE | re.DOTALL)
    if len(found) != 1:
        sys.exit(f"{name}: the piece {label} stands there {len(found)} times")
    return textwrap.dedent(found[0])


def main(check):
    wrong, blocks = [], 0
    for page in (ROOT / "README.md", *sorted(ROOT.glob("docs/*.md"))):
        text = page.read_text(encoding="utf-8")
        marks = text.count("<!-- code: ")
        new = BLOCK.sub(lambda block: block[1] + piece(block[2], block[3]) + block[5], text)
        if marks != len(BLOCK.findall(text)):
            sys.exit(f"{page.relative_to(ROOT)}: a mark of code has no block of code behind it")
        blocks += marks
        if new != text and check:
            wrong.append(f"{page.relative_to(ROOT)}: code differs from its source; docs/site/snippets.py writes it")
        elif new != text:
            page.write_text(new, encoding="utf-8")
    print("\n".join(wrong) if wrong else f"{blocks} pieces of code are as their sources have them")
    return 1 if wrong or not blocks else 0


if __name__ == "__main__":
    if sys.argv[1:] not in ([], ["--check"]):
        sys.exit(__doc__)
    sys.exit(main(bool(sys.argv[1:])))
