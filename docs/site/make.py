#!/usr/bin/env python3
"""Makes a site of the pages and of the reference, which any static host serves: the target `site` calls it.

    make.py --mkdocs PROGRAM --reference FOLDER --out FOLDER

The pages are the Markdown files as they stand; links to sources lead to pages of the sources, so that none leaves the site.
"""
import argparse
import html
import os
import pathlib
import re
import shutil
import subprocess
import sys

root = pathlib.Path(__file__).resolve().parent.parent.parent
fence = re.compile(r"^\s*(```|~~~)")
link = re.compile(r"(\]\(|(?:href|src|srcset)=\")([^)\"\s#]*)((?:#[^)\"\s]*)?)")


def pages():
    """Every page, by its path in the repository."""
    found = [root / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md")]
    found += [page for page in sorted(root.glob("docs/**/*.md")) if page.parent.name not in ("reference", "study")]
    found += [root / "examples/README.md"]
    return [page.relative_to(root) for page in found if page.exists()]


def order():
    """The names of the pages in the order of the tables of docs/README.md, which links to all."""
    text = (root / "docs/README.md").read_text(encoding="utf-8")
    return [name for name in dict.fromkeys(re.findall(r"^\|\s*\[[^]]*\]\(([\w/.]+\.md)\)", text, re.M))]


def stage(page, known, folder, sources):
    """Writes a page for MkDocs: links to sources changed, a blank line before lists, as Python's Markdown needs it."""
    lines, inside = [], False
    for text in (root / page).read_text(encoding="utf-8").splitlines():
        if fence.match(text):
            inside = not inside
        elif not inside:
            def replaced(found):
                begin, target, anchor = found.groups()
                if not target or re.match(r"[a-z]+:", target):
                    return found[0]
                path = pathlib.Path(os.path.normpath(page.parent / target))
                if path in known:
                    # MkDocs changes the links of Markdown, and leaves HTML as it is.
                    page_name = re.sub(r"README\.md$", "index.md", target)
                    return found[0] if begin == "](" else begin + re.sub(r"\.md$", ".html", page_name) + anchor
                if path.suffix in (".svg", ".png", ".gif"):
                    return found[0]
                sources.add(path)
                return begin + os.path.relpath(f"source/{path}.html", page.parent)
            text = link.sub(replaced, text)
            before = lines[-1] if lines else ""
            item = re.match(r"([-*]|\d+\.) ", text)
            if item and before.strip() and not re.match(r"\s|([-*]|\d+\.) ", before):
                lines.append("")
        lines.append(text)
    (folder / page).parent.mkdir(parents=True, exist_ok=True)
    (folder / page).write_text("\n".join(lines) + "\n", encoding="utf-8")


def source_page(path, sources):
    """A file, or what is in a folder, as a page."""
    up = "../" * len(path.parts)
    if (root / path).is_dir():
        entries = sorted(p for p in (root / path).iterdir() if not p.name.startswith((".", "__")))
        sources.update(p.relative_to(root) for p in entries)
        body = "<ul>" + "".join(
            f'<li><a href="{path.name}/{p.name}.html">{html.escape(p.name)}{"/" * p.is_dir()}</a></li>' for p in entries) + "</ul>"
    else:
        try:
            body = f"<pre>{html.escape((root / path).read_text(encoding='utf-8'))}</pre>"
        except UnicodeDecodeError:
            body = f"<p>{(root / path).stat().st_size} bytes that are no text.</p>"
    return f"""<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>{path}</title><style>:root{{color-scheme:light dark}}body{{font-family:sans-serif;margin:1rem}}pre{{overflow-x:auto}}</style>
<p><a href="{up}index.html">tactnet</a> / {path}</p>{body}</html>
"""


def settings(folder, out, known, version):
    """MkDocs' settings: the theme follows the reader's light or dark setting, as the pictures do."""
    titles = {page: re.search(r"^# (.*)", (root / page).read_text(encoding="utf-8"), re.M)[1].replace("`", "") for page in known}
    first = [pathlib.Path(os.path.normpath(f"docs/{name}")) for name in order()]
    listed = [page for page in dict.fromkeys(first) if page in known]
    listed += [page for page in known if page not in listed and str(page) not in ("README.md", "docs/README.md")]
    nav = ""
    for page in listed:
        if pathlib.Path(f"{page.parent}.md") in listed: # docs/verify/numerics/… stand below docs/verify/numerics.md
            continue
        parts = [other for other in listed if other.parent == page.with_suffix("")]
        nav += f"  - {titles[page]!r}: {page}\n" if not parts else f"  - {titles[page]!r}:\n" + "".join(
            f"      - {titles[part]!r}: {part}\n" for part in [page, *parts])
    return f"""site_name: tactnet {version}
docs_dir: {folder}
site_dir: {out}
use_directory_urls: false
theme:
  name: material
  font: false
  features: [navigation.instant, navigation.top, search.highlight, toc.follow]
  palette:
    - {{media: "(prefers-color-scheme: light)", scheme: default, primary: teal}}
    - {{media: "(prefers-color-scheme: dark)", scheme: slate, primary: teal}}
extra_css: [site.css]
plugins: [search]
markdown_extensions:
  - admonition
  - attr_list
  - md_in_html
  - tables
  - pymdownx.superfences
  - pymdownx.highlight
  - toc:
      permalink: true
      slugify: !!python/object/apply:pymdownx.slugs.slugify {{kwds: {{case: lower}}}}
nav:
  - tactnet: README.md
  - Contents: docs/README.md
{nav}  - Reference: reference/index.html
"""


def mended(text, folder):
    """A page of the reference whose title leads back to the pages. Doxygen 1.9 links to concepts in a namespace detail, which
    have no page, and to headings of nested classes that are not shown: these links go."""
    def kept(found):
        link, words = found.groups()
        if link.startswith("#"):
            return found[0] if f'name="{link[1:]}"' in text or f'id="{link[1:]}"' in text else words
        return found[0] if (folder / link).exists() else words
    text = re.sub(r'<a [^>]*href="(concept\w+\.html|#nested-classes)"[^>]*>([^<]*)</a>', kept, text)
    return re.sub(r'(<div id="projectname">)([^<]*)', r'\1<a href="../index.html">\2</a>', text)


style = """/* Wide tables scroll by themselves; the page never does. */
.md-typeset table:not([class]) { display: block; overflow-x: auto; }
.md-typeset img { height: auto; }
/* Lines of code have up to 120 columns. */
.md-grid { max-width: 80rem; }
/* Links on the dark background as in the reference: the theme's teal has too little contrast there. */
[data-md-color-scheme="slate"] { --md-typeset-a-color: #5cc4b8; }
"""


def main():
    words = argparse.ArgumentParser(description=__doc__)
    for name in ("mkdocs", "reference", "out", "version"):
        words.add_argument(f"--{name}", required=True)
    given = words.parse_args()
    out, known, sources = pathlib.Path(given.out).resolve(), pages(), set()
    folder = out.parent / "site_pages"
    if out.exists() and not (out / "search").is_dir(): # it is removed before it is made again
        sys.exit(f"docs/site/make.py: expected no folder or a site at {out}, found something else")
    for old in (folder, out):
        shutil.rmtree(old, ignore_errors=True)
    for page in known:
        stage(page, known, folder, sources)
    shutil.copytree(root / "docs/pictures", folder / "docs/pictures", ignore=shutil.ignore_patterns("source"))
    (folder / "site.css").write_text(style)
    file = out.parent / "mkdocs.yml"
    file.write_text(settings(folder, out, known, given.version), encoding="utf-8")
    done = subprocess.run([given.mkdocs, "build", "--quiet", "--config-file", str(file)], capture_output=True, text=True)
    problems = [line for line in done.stderr.splitlines() if "reference/index.html" not in line and "-  " not in line]
    if done.returncode != 0 or any("WARNING" in line or "ERROR" in line for line in problems):
        sys.exit("docs/site/make.py: MkDocs says:\n" + done.stderr)
    shutil.copytree(given.reference, out / "reference")
    for file in (out / "reference").glob("*.html"):
        file.write_text(mended(file.read_text(encoding="utf-8"), file.parent), encoding="utf-8")
    written = set()
    while sources - written: # a folder leads to further files
        path = (sources - written).pop()
        written.add(path)
        if (root / path).exists(): # or the test of links says that it is not
            file = out / "source" / f"{path}.html"
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(source_page(path, sources), encoding="utf-8")


if __name__ == "__main__":
    main()
