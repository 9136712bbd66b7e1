#!/usr/bin/env python3
"""Renders the documents of this folder as pages of the daemon, below /docs.

usage: server/doc/guide/render.py [--contract] FOLDER

FOLDER/docs/NAME/index.html is made from NAME.md. The style and the drawings are copied. A line
{{NAME}} of a document is replaced by a table from the sources (tables.py). README.md becomes /docs
itself, unless --contract says that the contract's page is there.
"""
import html
import pathlib
import re
import shutil
import sys

sys.dont_write_bytecode = True
try:
    import markdown
except ImportError:  # another python3 comes before Debian's in PATH
    sys.path.append("/usr/lib/python3/dist-packages")
    import markdown

import tables  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
PAGES = ["tutorial", "how-to", "reference", "explanation", "operating", "comparison", "python"]
EXTENSIONS = ["tables", "fenced_code", "toc", "sane_lists"]

# Colours of the drawings, light and dark. Text, lines and areas keep their order of contrast.
DARK = {
    "#ffffff": "#1a2023", "#f8fafc": "#20282c", "#eef2f7": "#263035", "#e2e8f0": "#2f3b41",
    "#dbeafe": "#17335c", "#bfdbfe": "#1d4480", "#94a3b8": "#7a8a9c", "#64748b": "#9fb0c3",
    "#1f2937": "#e4e8ea", "#1d4ed8": "#7fb0ff", "#c2410c": "#ff9a66", "#15803d": "#63cf8c",
    "#7e22ce": "#d09cff",
}


def source_name(target):
    """Returns the path, from the repository's root, of a file that a document links to."""
    return (HERE / target).resolve().relative_to(HERE.parents[2]).as_posix()


def page_address(target):
    """Returns the address on the daemon of a linked document, or None if the link leads to another
    file of the source."""
    name, _, anchor = target.partition("#")
    if name == "README.md":
        return "/docs"
    if name.removesuffix(".md") in PAGES:
        return f"/docs/{name.removesuffix('.md')}" + (f"#{anchor}" if anchor else "")
    return None


def link(match):
    """Turns links to documents into links to their pages. Replaces links to files of the source by
    the paths of these files, because the daemon does not serve them."""
    target, text = match.group(1), match.group(2)
    if re.match(r"[a-z]+:|/|#", target):
        return match.group()
    address = page_address(target)
    if address:
        return f'<a href="{address}">{text}</a>'
    return f"{text} (<code>{source_name(target)}</code> in the source)"


def image(match):
    text, name = match.group(1), pathlib.Path(match.group(2)).name
    dark = f'<source media="(prefers-color-scheme: dark)" srcset="/docs/drawings/dark-{name}">'
    return f'<picture>{dark}<img alt="{text}" src="/docs/drawings/{name}"></picture>'


def body_of(path):
    """Returns a document as HTML, and its table of contents."""
    text = re.sub(r"^\{\{(\w+)\}\}$", lambda name: tables.TABLES[name.group(1)](), path.read_text(encoding="utf-8"), flags=re.M)
    renderer = markdown.Markdown(extensions=EXTENSIONS, extension_configs={"toc": {"toc_depth": "2-3"}})
    body = renderer.convert(text)
    body = re.sub(r'<a href="([^"]+)">(.*?)</a>', link, body, flags=re.S)
    body = re.sub(r'<img alt="([^"]*)" src="(drawings/[^"]+)" ?/?>', image, body)
    body = body.replace("<pre>", '<pre tabindex="0">').replace("<table>", '<div class="wide" tabindex="0"><table>')
    return body.replace("</table>", "</table></div>"), renderer.toc


def navigation(current):
    entries = [("contract", "/docs")] + [(name, f"/docs/{name}") for name in PAGES]
    mark = ' aria-current="page"'
    return "\n".join(f'<a href="{address}"{mark if name == current else ""}>{name.capitalize()}</a>' for name, address in entries)


def write_page(place, path):
    body, contents = body_of(path)
    title = re.search(r"^# (.*)$", path.read_text(encoding="utf-8"), re.M).group(1)
    page = (HERE / "page.html").read_text(encoding="utf-8")
    values = {"title": html.escape(title), "navigation": navigation(path.stem), "contents": contents, "body": body}
    place.mkdir(parents=True, exist_ok=True)
    text = re.sub(r"\{\{(\w+)\}\}", lambda name: values[name.group(1)], page)
    (place / "index.html").write_text(text, encoding="utf-8")


def write_drawings(place):
    place.mkdir(parents=True, exist_ok=True)
    for path in sorted((HERE / "drawings").glob("*.svg")):
        shutil.copyfile(path, place / path.name)
        text = re.sub("|".join(DARK), lambda colour: DARK[colour.group()], path.read_text(encoding="utf-8"))
        (place / f"dark-{path.name}").write_text(text, encoding="utf-8")


def main(arguments):
    has_contract = arguments[:1] == ["--contract"]
    if len(arguments) != 1 + has_contract:
        sys.exit(__doc__.strip())
    docs = pathlib.Path(arguments[-1]) / "docs"
    shutil.rmtree(docs, ignore_errors=True)
    for name in PAGES:
        write_page(docs / name, HERE / f"{name}.md")
    if not has_contract:
        write_page(docs, HERE / "README.md")
    write_drawings(docs / "drawings")
    shutil.copyfile(HERE.parents[2] / "clients" / "web" / "icon.svg", docs / "icon.svg")
    shutil.copyfile(HERE / "page.css", docs / "page.css")


if __name__ == "__main__":
    main(sys.argv[1:])
