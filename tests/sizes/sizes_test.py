#!/usr/bin/env python3
"""Holds the code to sizes that a reader can take in: sizes_test.py ROOT

No function above 60 lines, no source above 400, no test above 500; planner and coordinator have at
least 0.6 lines of tests per line of source, blank lines and comments not counted.
"""

import ast
import pathlib
import re
import sys

FLOORS = ("coordinator", "traci_bridge", "planner", "tools")
FUNCTION, SOURCE, TEST, RATIO = 60, 400, 500, 0.6
CODE = (".cpp", ".hpp", ".py")

# Comments, character constants and strings: what is in them is no code.
NO_CODE = re.compile(r"//[^\n]*|/\*.*?\*/|R\"(\w*)\(.*?\)\1\"|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])+'",
                     re.DOTALL)
DIGIT_MARK = re.compile(r"(?<=[0-9a-fA-F])'(?=[0-9a-fA-F])")
# What may stand before the brace of a function; a lambda belongs to the function around it.
FUNCTION_HEAD = re.compile(r"\)(?:\s*(?:const\b|noexcept\b|override\b|final\b|->[\w:<>,*&\s]+|"
                           r":[^:].*|requires\b.*))*\s+$", re.DOTALL)
CONTROL = re.compile(r"^\s*(?:\}?\s*else\b|if\b|for\b|while\b|switch\b|do\b|try\b|catch\b|return\b|"
                     r"INSTANTIATE_TEST|namespace\b|class\b|struct\b|enum\b|union\b|template\s*<[^;{]*>\s*(?:class|"
                     r"struct|concept)\b|case\b|default\b)")


def without_text(code):
    """The code, its strings and comments blank; line numbers stay."""
    code = DIGIT_MARK.sub("", code)
    return NO_CODE.sub(lambda m: re.sub(r"[^\n]", " ", m.group()), code)


def is_function(head):
    """Is this, before a brace, the head of a function?"""
    name = re.sub(r"operator\W+", "", head.partition("(")[0] if "operator(" not in head else "")
    return FUNCTION_HEAD.search(head) and not CONTROL.match(head) and "=" not in name


def functions_of(code):
    """(first line, lines) of each function of C++ that is not within another."""
    code = without_text(code)
    opened, head, function, found = [], 0, None, []
    for place, sign in enumerate(code):
        if sign == "{":
            text = code[head:place]
            # What lists values follows its name without a space, and ends no statement.
            lists = place > 0 and not code[place - 1].isspace()
            if function is None and not lists and is_function(text):
                function = (len(opened), place - len(text.lstrip()))
            opened.append(lists)
        elif sign == "}" and opened:
            if opened.pop():
                continue
            if function is not None and len(opened) == function[0]:
                first = code.count("\n", 0, function[1]) + 1
                found.append((first, code.count("\n", 0, place) + 2 - first))
                function = None
        if sign in "{};" and not (opened and opened[-1]):
            head = place + 1
    return found


def python_functions_of(code):
    return [(node.lineno, node.end_lineno - node.lineno + 1) for node in ast.walk(ast.parse(code))
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))]


def files_of(root, *folders):
    for folder in folders:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in CODE:
                yield path.relative_to(root).as_posix(), path.read_text(encoding="utf-8")


def code_lines(code):
    return sum(bool(line.strip()) for line in without_text(code).splitlines())


def too_long(root):
    for name, code in files_of(root, *FLOORS, "tests"):
        limit = TEST if name.startswith("tests/") else SOURCE
        lines = code.count("\n")
        if lines > limit:
            yield f"{name}: {lines} lines; at most {limit}"
        of = python_functions_of if name.endswith(".py") else functions_of
        for first, lines in of(code):
            if lines > FUNCTION:
                yield f"{name}:{first}: a function of {lines} lines; at most {FUNCTION}"


def too_few_tests(root):
    for floor in ("planner", "coordinator"):
        source = sum(code_lines(code) for _, code in files_of(root, floor))
        tests = sum(code_lines(code) for _, code in files_of(root, f"tests/{floor}"))
        if tests < RATIO * source:
            yield f"{floor}: {tests} lines of tests for {source} of source; at least {RATIO}"


def knows_functions():
    """The counter itself, on what it must and must not take for a function."""
    body = "\n  a();" * 70 + "\n}\n"
    functions = ("void f(int x) {", "A::A(int x)\n    : x_(x), y_{1} {", "bool f() const noexcept {",
                 "template <class T>\nauto f(T t) -> std::vector<T> {", "bool operator==(A a) {")
    others = ("namespace mvtp {", "struct A {", "class A final : public B<int()> {", "enum class E {")
    text = 'void f() {\n  g("{ // }", \'{\', 1\'000);\n}\n'
    return all(functions_of(f + body) == [(1, f.count("\n") + 72)] for f in functions) and \
        all(not functions_of(f + body) for f in others) and \
        functions_of(text + text) == [(1, 3), (4, 3)]


def main():
    if not knows_functions():
        print("sizes_test.py: does not count functions as it should", file=sys.stderr)
        return 1
    root = pathlib.Path(sys.argv[1])
    problems = [*too_long(root), *too_few_tests(root)]
    print(*problems, sep="\n", file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
