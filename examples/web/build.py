#!/usr/bin/env python3
"""examples/web/build.py PACKAGE PAGE: one HTML file with the page, its scripts and the module of PACKAGE (the folder
js/ of a build) in it, and the module with threads, where the package has it. It can be served as it is, or opened from
a disk; threads it has where serve.py serves it."""
import base64
import json
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
IMPORTED = re.compile(r'(from |import\()"\./([\w.]+\.mjs)"')
MODULES = {"pbfModule": "pbf.wasm", "pbfThreads": "pbf-threads.wasm"}
PAGE_SCRIPT = '<script type="module" src="./dam_break.mjs"></script>'


def text(path):
    return path.read_text(encoding="utf-8")


def as_url(script):
    return "data:text/javascript;base64," + base64.b64encode(script.encode()).decode()


def as_bytes(name, path):
    """A script that sets a global variable to a file's bytes."""
    return f'globalThis.{name} = Uint8Array.from(atob("{base64.b64encode(path.read_bytes()).decode()}"), (one) => one.charCodeAt(0));'


def add(path, modules):
    """Adds a script, and those that it imports, to the import map; each is there once. Gives the script."""
    return IMPORTED.sub(lambda found: f'{found[1]}"{named(path.parent / found[2], modules)}"', text(path))


def named(path, modules):
    """The name of a file in the import map: data: addresses have no files beside them."""
    name = "pbf" if path.stem == "pbf" else f"page/{path.stem}"
    if name not in modules:
        modules[name] = None  # the example at its head imports itself
        modules[name] = as_url(add(path, modules))
    return name


def page(package):
    modules = {}
    named(package / "pbf.mjs", modules)
    script = add(HERE / "dam_break.mjs", modules)
    bytes_of_modules = "\n".join(as_bytes(name, package / file) for name, file in MODULES.items() if (package / file).exists())
    html = text(HERE / "index.html")
    if html.count(PAGE_SCRIPT) != 1:
        raise SystemExit("index.html has not the one script")
    return html.replace(PAGE_SCRIPT, f"<script type=\"importmap\">\n{json.dumps({'imports': modules})}\n</script>\n"
                        f"<script>\n{bytes_of_modules}\n</script>\n<script type=\"module\">\n{script}</script>")


def main():
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    written = pathlib.Path(sys.argv[2])
    written.parent.mkdir(parents=True, exist_ok=True)
    written.write_text(page(pathlib.Path(sys.argv[1])), encoding="utf-8")
    print(f"{written}: {written.stat().st_size:,} bytes")


if __name__ == "__main__":
    main()
