"""Whether an XML file keeps to a schema that is written down as a table of types.

A table has one entry for each type that mvtp writes, and no more: whatever is not in it is a fault, also if the
published schema knows it. So a new element needs a new line, which its author has looked up. An entry is a Type, or
the words that an enumeration allows.

The content of a type reads as in a DTD: "a, b?, c*, d+" in this order, "a | b" one of them; "a & b": each once, in any
order. "a:type" where the type is not called as the element is (capitals aside).
"""

import re
from typing import NamedTuple

DECIMAL = r"(\d+(\.\d*)?|\.\d+)"
SIMPLE = {
    "string": r"[\s\S]*",
    "boolean": r"true|false|1|0",
    "decimal": rf"[+-]?{DECIMAL}",
    "positiveDecimal": rf"\+?(?=[0.]*[1-9]){DECIMAL}",
    "double": rf"[+-]?{DECIMAL}([eE][+-]?\d+)?|-?INF|NaN",
    "integer": r"[+-]?\d+",
    "nonNegativeInteger": r"\+?\d+",
    "positiveInteger": r"\+?0*[1-9]\d*",
    "zero": r"[+-]?0+",
    "date": r"\d{4}-(0[1-9]|1[0-2])-(0[1-9]|[12]\d|3[01])",
    "dateTime": r"\d{4}-(0[1-9]|1[0-2])-(0[1-9]|[12]\d|3[01])T([01]\d|2[0-3]):[0-5]\d:[0-5]\d(\.\d+)?",
}


class Type(NamedTuple):
    """Of an element: its content, and {attribute: type}. Attributes that may be missing end with "?"."""
    content: str = ""
    attributes: dict = {}


def particles(content):
    """[(name, type, how often)] of a content model, in its order."""
    return [(name, kind or name[0].upper() + name[1:], often)
            for name, kind, often in re.findall(r"(\w+)(?::(\w+))?([?*+]?)", content)]


def children_fit(tags, content):
    if "&" in content:
        often = {name: times for name, _, times in particles(content)}
        return len(tags) == len(set(tags)) and {name for name in often if often[name] != "?"} <= set(tags) <= set(often)
    model = re.sub(r"(\w+)(:\w+)?", r"(\1;)", content)
    return re.fullmatch(re.sub("[, ]", "", model), "".join(tag + ";" for tag in tags)) is not None


class Checker:
    def __init__(self, types):
        self.types = types
        self.faults = []

    def check(self, element, kind, where):
        """Adds to the faults what breaks the type in the element and all below it."""
        found = self.types.get(kind)
        if isinstance(found, Type):
            self.check_attributes(element, found.attributes, where)
            self.check_content(element, found.content, where)
        elif len(element) or element.attrib:
            self.faults.append(f"{where}: holds more than text")
        else:
            self.check_value(element.text or "", kind, where)

    def check_value(self, text, kind, where):
        words = self.types.get(kind)
        fits = text in words.split() if words else re.fullmatch(SIMPLE[kind], text)
        if not fits:
            self.faults.append(f'{where}: is "{text}", not {words or kind}')

    def check_attributes(self, element, allowed, where):
        kinds = {name.rstrip("?"): kind for name, kind in allowed.items()}
        for name, value in element.attrib.items():
            if name in kinds:
                self.check_value(value, kinds[name], f"{where}/@{name}")
            else:
                self.faults.append(f"{where}/@{name}: is not in the table")
        for name in set(allowed) - set(element.attrib):
            if not name.endswith("?"):
                self.faults.append(f"{where}/@{name}: is missing")

    def check_content(self, element, content, where):
        if any(text and text.strip() for text in (element.text, *(child.tail for child in element))):
            self.faults.append(f"{where}: has text in it")
        tags = [child.tag for child in element]
        if not children_fit(tags, content):
            self.faults.append(f'{where}: has "{" ".join(tags):.200}", not "{content}"')
        kinds = {name: kind for name, kind, _ in particles(content)}
        for child in element:
            if child.tag in kinds:
                self.check(child, kinds[child.tag], f"{where}/{child.tag}")


def faults_of(root, types, name):
    """All that is wrong with a document whose root element, and its type, have this name."""
    if root.tag != name:
        return [f"the root is {root.tag}, not {name}"]
    checker = Checker(types)
    checker.check(root, name, name)
    return checker.faults
