#!/usr/bin/env python3
"""examples/web/build.py PACKAGE PAGE: one HTML file with the page, its scripts and the module of PACKAGE (the folder
js/ of a build) in it. It can be served as it is, or opened from a disk."""
import base64
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
PAGE_SCRIPT = '<script type="module" src="./dam_break.mjs"></script>'


def text(path):
    return path.read_text(encoding="utf-8")


def as_url(script):
    return "data:text/javascript;base64," + base64.b64encode(script.encode()).decode()


def with_import(script, name, url):
    if f'"{name}"' not in script:
        raise SystemExit(f"no import of {name}")
    return script.replace(f'"{name}"', f'"{url}"')


def page(package):
    library = with_import(text(package / "pbf.mjs"), "./abi.g.mjs", as_url(text(package / "abi.g.mjs")))
    script = with_import(text(HERE / "dam_break.mjs"), "./picture.mjs", as_url(text(HERE / "picture.mjs")))
    script = with_import(script, "pbf", as_url(library))
    module = base64.b64encode((package / "pbf.wasm").read_bytes()).decode()
    bytes_of_module = (f'const text = atob("{module}");\n'
                       "globalThis.pbfModule = Uint8Array.from(text, (one) => one.charCodeAt(0));")
    html = text(HERE / "index.html")
    if html.count(PAGE_SCRIPT) != 1:
        raise SystemExit("index.html has not the one script")
    return html.replace(PAGE_SCRIPT, f"<script>\n{bytes_of_module}\n</script>\n<script type=\"module\">\n{script}</script>")


def main():
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    written = pathlib.Path(sys.argv[2])
    written.parent.mkdir(parents=True, exist_ok=True)
    written.write_text(page(pathlib.Path(sys.argv[1])), encoding="utf-8")
    print(f"{written}: {written.stat().st_size:,} bytes")


if __name__ == "__main__":
    main()
