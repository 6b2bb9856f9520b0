"""Tables that scripts write into the project's pages, each between two comments."""
import pathlib

ROOT = pathlib.Path(__file__).resolve().parents[2]
END = "<!-- end -->"


def write_table(page, name, text):
    """Puts `text` in place of the table `name` of ROOT/page."""
    page = ROOT / page
    start = f"<!-- table: {name} -->"
    before, rest = page.read_text(encoding="utf-8").split(start)
    after = rest.split(END, 1)[1]
    page.write_text(f"{before}{start}\n{text}\n{END}{after}", encoding="utf-8")
