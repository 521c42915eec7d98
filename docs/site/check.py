#!/usr/bin/env python3
"""Checks that every link of a site leads somewhere: check.py FOLDER. Links to other hosts are not looked at."""
import html.parser
import pathlib
import sys
import urllib.parse


class page(html.parser.HTMLParser):
    """The links of a page, with their lines, and what they may lead to."""

    def __init__(self, text):
        super().__init__()
        self.links, self.anchors = [], {""}
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("id", "name") and value:
                self.anchors.add(value)
            elif name in ("href", "src", "srcset") and value and tag != "base":
                self.links += [(part.split()[0], self.getpos()[0]) for part in value.split(",") if part.strip()] \
                    if name == "srcset" else [(value, self.getpos()[0])]

    handle_startendtag = handle_starttag


def main():
    if len(sys.argv) != 2 or not pathlib.Path(sys.argv[1], "index.html").exists():
        sys.exit("check.py: expected a folder with index.html")
    folder = pathlib.Path(sys.argv[1]).resolve()
    known = {path: page(path.read_text(encoding="utf-8", errors="replace")) for path in folder.rglob("*.html")}
    problems, count, hosts = [], 0, set()
    for path, at in sorted(known.items()):
        if path.name == "404.html": # stands anywhere, so that its links begin at the host's root
            continue
        for link, line in at.links:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                hosts.add(parts.netloc)
                continue
            count += 1
            where = f"{path.relative_to(folder)}:{line}"
            target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
            if target.is_dir():
                target = target / "index.html"
            if folder not in target.parents or not target.exists():
                problems.append(f"{where}: there is no '{link}'")
            elif target in known and urllib.parse.unquote(parts.fragment) not in known[target].anchors:
                problems.append(f"{where}: '{target.relative_to(folder)}' has no '#{parts.fragment}'")
    if problems:
        sys.exit("\n".join(problems) + f"\n{len(problems)} dead links")
    print(f"{len(known)} pages, {count} links within them, all lead somewhere")


if __name__ == "__main__":
    main()
