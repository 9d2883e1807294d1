"""What the site of the docs adds to MkDocs."""

import re


def github_slug(text, separator):
    """The anchor that GitHub gives a heading, so that a link works there and on the site."""
    return re.sub(r"[^\w\- ]", "", text.strip().lower()).replace(" ", separator)


def _pages(nav):
    for entry in nav:
        target = next(iter(entry.values())) if isinstance(entry, dict) else entry
        if isinstance(target, list):
            yield from _pages(target)
        else:
            yield target


def on_config(config):
    config["mdx_configs"]["toc"] = {"slugify": github_slug, "permalink": True, "toc_depth": 3}
    return config


def on_files(files, config):
    """Pages directly in docs/ that the navigation does not name come last under "How to"."""
    named = set(_pages(config["nav"]))
    how_to = next(entry["How to"] for entry in config["nav"] if "How to" in entry)
    how_to += sorted(file.src_uri for file in files.documentation_pages()
                     if re.fullmatch(r"docs/[^/]*\.md", file.src_uri) and file.src_uri not in named)
    return files
