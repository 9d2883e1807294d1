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
    """Pages that the navigation does not name come last in the section of their folder."""
    named = set(_pages(config["nav"]))
    for section, folder in (("How to", "docs"), ("Experiments", "docs/experiments")):
        entries = next(entry[section] for entry in config["nav"] if section in entry)
        entries += sorted(file.src_uri for file in files.documentation_pages()
                          if re.fullmatch(rf"{folder}/[^/]*\.md", file.src_uri) and file.src_uri not in named)
    return files
