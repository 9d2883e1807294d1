#!/usr/bin/env python3
"""Puts the pages of the site into one folder: stage.py --reference COMMANDS.md -o FOLDER

The pages are the project's own Markdown files, where they lie, so that their links work on the site
as in the repository. A source file that a page links to becomes a page that shows it. The references
of the commands and of the library's headers are added.
"""

import argparse
import os
import pathlib
import re
import shutil

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "docs/**/*.md", "planner/**/README.md",
         "coordinator/**/README.md", "scenarios/**/README.md", "tests/**/README.md",
         "tools/**/README.md")
PICTURES = ("docs/**/*.png", "docs/**/*.svg")
STYLE = ("docs/site.css",)
LANGUAGES = {".cpp": "cpp", ".hpp": "cpp", ".py": "python", ".sh": "sh", ".yaml": "yaml"}
LINK = re.compile(r"(?<=\]\()([^)#:\s]+)")


def found(patterns):
    return sorted({path for pattern in patterns for path in ROOT.glob(pattern)
                   if "build" not in path.relative_to(ROOT).parts[0]})


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def source_page(source):
    language = LANGUAGES.get(source.suffix, "text")
    text = source.read_text(encoding="utf-8")
    return f"# {source.relative_to(ROOT)}\n\n~~~~{language}\n{text}~~~~\n"


def stage_page(page, text, folder):
    """Writes the page of this name; what it links to that is neither page nor picture becomes a page."""
    def link(match):
        target = ROOT / os.path.normpath((ROOT / page).parent / match[1])
        if target.suffix in (".md", ".png", ".svg") or not target.is_file():
            return match[1]
        write(folder / f"{target.relative_to(ROOT)}.md", source_page(target))
        return match[1] + ".md"

    write(folder / page, LINK.sub(link, text))


def api_page(header):
    """Doxygen's page of a header; it doubles each underscore in the name of a file."""
    name = pathlib.PurePath(header).name.replace("_", "__").replace(".", "_8")
    return f"api/{name}.html"


def library_page():
    """The public headers, as cmake/PublicHeaders.cmake names, groups and describes them."""
    page = ["# The library", "",
            "`find_package(mvtp)` gives `mvtp::planner` and `mvtp::coordinator`; two programs that use them are in",
            "[examples](../examples/README.md). [All classes](api/annotated.html) and",
            "[all functions](api/namespacemembers_func.html), made by Doxygen from the headers, say what they take, give and throw.", ""]
    for line in (ROOT / "cmake/PublicHeaders.cmake").read_text(encoding="utf-8").splitlines():
        if heading := re.fullmatch(r"  # (.*)", line):
            page += ["", f"## {heading[1].capitalize()}", "", "| include | what it has |", "|---|---|"]
        elif entry := re.fullmatch(r"  (\S+\.hpp)\s+(\S+)\s*#?(.*)", line):
            page.append(f"| [`<mvtp/{entry[1]}>`]({api_page(entry[2])}) | {entry[3].strip()} |")
    return "\n".join(page) + "\n"


def stage(reference, folder):
    shutil.rmtree(folder, ignore_errors=True)
    for page in found(PAGES):
        stage_page(page.relative_to(ROOT), page.read_text(encoding="utf-8"), folder)
    stage_page("docs/reference/commands.md", reference.read_text(encoding="utf-8"), folder)
    stage_page("docs/reference/library.md", library_page(), folder)
    for asset in found(PICTURES + STYLE):
        target = folder / asset.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(asset, target)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--reference", required=True, type=pathlib.Path)
    parser.add_argument("-o", "--output-dir", required=True, type=pathlib.Path)
    options = parser.parse_args()
    stage(options.reference, options.output_dir)


if __name__ == "__main__":
    main()
