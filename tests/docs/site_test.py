#!/usr/bin/env python3
"""Builds the site of the docs and follows its links: site_test.py ROOT COMMANDS.md WORK_FOLDER

Every link and picture must lead to a file, and every anchor to a heading, on the site and, where a
page of the project has the link, in the repository too. Every page of docs/ must be in the
navigation. The drawings must be what drawings.py draws. The README must fit a screen, and so must
those of the planner's rooms.
"""

import html.parser
import os
import pathlib
import re
import shutil
import subprocess
import sys
import urllib.parse


class Anchors(html.parser.HTMLParser):
    """The targets of a page, and where it leads."""

    def __init__(self, page):
        super().__init__()
        self.ids, self.links = set(), []
        self.feed(page.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        self.ids.update(attributes[key] for key in ("id", "name") if attributes.get(key))
        self.links += [attributes[key] for key in ("href", "src") if attributes.get(key)]


def broken_links_of_site(site):
    pages = {page: Anchors(page) for page in site.rglob("*.html") if page.name != "404.html"}
    for page, anchors in pages.items():
        for link in set(anchors.links):
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            path = urllib.parse.unquote(parts.path)
            target = pathlib.Path(os.path.normpath(page.parent / path)) if path else page
            target = target / "index.html" if target.is_dir() else target
            where = page.relative_to(site)
            if not target.is_file():
                yield f"{where}: {link}: no such file"
            elif parts.fragment == "nested-classes":  # Doxygen's, also where all of them are private
                continue
            elif parts.fragment and target in pages and \
                    urllib.parse.unquote(parts.fragment) not in pages[target].ids:
                yield f"{where}: {link}: no such heading"


def broken_links_of_repository(root):
    for page in root.rglob("*.md"):
        if page.relative_to(root).parts[0] in ("build", "out"):
            continue
        text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.S | re.M)
        for link in re.findall(r"\]\(([^)\s]+)\)", text):
            path = link.split("#")[0]
            if path and "://" not in path and not (page.parent / path).is_file():
                yield f"{page.relative_to(root)}: {link}: no such file in the repository"


def missing_in_the_navigation(root, site):
    links = {urllib.parse.unquote(link) for link in Anchors(site / "index.html").links}
    for page in (root / "docs").rglob("*.md"):
        path = page.relative_to(root)
        built = path.parent / "index.html" if page.name == "README.md" else path.with_suffix(".html")
        if str(built) not in links:
            yield f"{path}: is not in the navigation of the site"


def blocks_that_are_none(root):
    """MkDocs takes no block of code that is indented, and no test runs its commands."""
    for page in root.rglob("*.md"):
        if page.relative_to(root).parts[0] in ("build", "out"):
            continue
        for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
            if re.match(r"\s+```", line):
                yield f"{page.relative_to(root)}:{number}: begin the block in the first column"


def longer_than_a_screen(root):
    text = (root / "README.md").read_text(encoding="utf-8")
    if len(text.splitlines()) > 30 or len(text) > 2400:
        yield "README.md: is longer than a screen (30 lines, 2400 signs); move something to docs/"
    for room in sorted(root.glob("planner/*/README.md")):
        if len(room.read_text(encoding="utf-8").splitlines()) > 45:
            yield f"{room.relative_to(root)}: is longer than a screen (45 lines); move something to docs/"


def stale_drawings(root, work):
    subprocess.run([root / "tools/docs/drawings.py", "-o", work / "drawings"], check=True)
    for drawn in (work / "drawings").iterdir():
        if drawn.read_bytes() != (root / "docs/drawings" / drawn.name).read_bytes():
            yield f"docs/drawings/{drawn.name}: run tools/docs/drawings.py -o docs/drawings"


def main():
    root, reference, work = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
    shutil.rmtree(work, ignore_errors=True)
    subprocess.run([root / "tools/docs.sh", reference, work], check=True)
    faults = [*broken_links_of_site(work / "site"), *broken_links_of_repository(root),
              *missing_in_the_navigation(root, work / "site"), *blocks_that_are_none(root),
              *stale_drawings(root, work), *longer_than_a_screen(root)]
    print("\n".join(sorted(faults)))
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
