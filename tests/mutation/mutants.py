"""Mutants of C++ sources: which lines hold logic, and how each may be broken.

Relies on clang-format: operators between two operands have spaces around them, brackets of
templates have none, and a statement that begins a line ends with it or is left alone.
"""

import dataclasses
import pathlib
import random
import re

FLIPPED = {"<": ">=", ">=": "<", ">": "<=", "<=": ">", "==": "!=", "!=": "==",
           "&&": "||", "||": "&&", "+": "-", "-": "+", "+=": "-=", "-=": "+="}
OPERATOR = re.compile(r" (<=|>=|==|!=|<|>|&&|\|\||\+=|-=|\+|-) ")
CONSTANTS = {"0": "1", "1": "0", "0.0": "1.0", "1.0": "0.0", "true": "false", "false": "true"}
CONSTANT = re.compile(r"(?<![\w.'])(0\.0|1\.0|0|1|true|false)(?![\w.'])")
CONDITION = re.compile(r"\b(?:if|while) \(")
STATEMENT = re.compile(
    r"(?:[\w.:>\[\]()*-]+ (?:[-+*/|&]?=) .*|(?:\+\+|--)[\w.>\[\]-]+|[\w.:>\[\]-]+\(.*\)|continue|break"
    r"|if \(.*\) (?:return|continue|break)\b.*);")
# What only declares, or is there for the compiler.
NO_LOGIC = re.compile(r"#|using |namespace |template|friend |typedef|static_assert|assert\(|case |enum "
                      r"|public:|private:|\[\[nodiscard\]\].*;$|(?:static )?(?:inline )?constexpr ")
DEFAULT = re.compile(r"(?:mutable |const )*[\w:<>, ]+[ *&]\w+(?: = [^()]*|\{[^()]*\})?[;,]$")


@dataclasses.dataclass(frozen=True)
class Mutant:
    file: str  # below the root
    line: int
    kind: str
    begin: int  # columns of the line that are replaced
    end: int
    old: str
    new: str


def without_comments(lines):
    """The lines with comments and the insides of strings blanked out, columns kept."""
    inside = False
    for line in lines:
        line = re.sub(r'"(?:\\.|[^"\\])*"', lambda s: '"' + " " * (len(s[0]) - 2) + '"', line)
        if inside:
            end = line.find("*/")
            line, inside = (" " * len(line), True) if end < 0 else (" " * (end + 2) + line[end + 2:], False)
        line = re.sub(r"/\*.*?\*/", lambda s: " " * len(s[0]), line)
        if "/*" in line:
            line, inside = line[:line.index("/*")], True
        yield line.split("//")[0].rstrip()


def closing(code, begin):
    """Where the bracket that opens at `begin` closes; -1: not on this line."""
    depth = 0
    for i in range(begin, len(code)):
        depth += (code[i] == "(") - (code[i] == ")")
        if depth == 0:
            return i
    return -1


def mutations(code, before, least_indent):
    """(kind, begin, end, new) for one line of code; `before` is the code line above it. What is
    indented less than `least_indent` is no statement."""
    for m in OPERATOR.finditer(code):
        kind = ("sum" if m[1][0] in "+-" else "and, or" if m[1] in ("&&", "||") else "comparison")
        yield kind, m.start(1), m.end(1), FLIPPED[m[1]]
    for m in CONSTANT.finditer(code):
        yield "constant", m.start(), m.end(), CONSTANTS[m[1]]
    for m in CONDITION.finditer(code):
        begin = m.end() - 1
        end = closing(code, begin)
        condition = code[begin + 1:end]
        if end > 0 and ";" not in condition and " = " not in condition:
            yield "negation", begin, end + 1, "(!(" + condition + "))"
    first = len(code) - len(code.lstrip())
    if first >= least_indent and STATEMENT.fullmatch(code.strip()) and before.endswith((";", "{", "}", ":")):
        yield "statement", first, len(code), ";"


def mutants_of(root, file):
    """All mutants of a file, in the order of its lines."""
    lines = (root / file).read_text(encoding="utf-8").splitlines()
    before = ""
    for number, code in enumerate(without_comments(lines), 1):
        stripped = code.strip()
        if not stripped:
            continue
        declares = NO_LOGIC.match(stripped) or (file.endswith(".hpp") and DEFAULT.fullmatch(stripped))
        if not declares:
            for kind, begin, end, new in mutations(code, before, 4 if file.endswith(".hpp") else 2):
                yield Mutant(file, number, kind, begin, end, lines[number - 1][begin:end], new)
        before = stripped


def draw(root, folder, count, seed):
    """One mutant on each of `count` lines of logic below a folder, drawn by seed."""
    by_line = {}
    files = sorted(p for p in (root / folder).rglob("*.[ch]pp"))
    for path in files:
        for mutant in mutants_of(root, path.relative_to(root).as_posix()):
            by_line.setdefault((mutant.file, mutant.line), []).append(mutant)
    rng = random.Random(seed)
    lines = rng.sample(sorted(by_line), min(count, len(by_line)))
    return [rng.choice(by_line[line]) for line in lines]


def apply(root, mutant):
    """Writes the mutant into its file. Returns what the file held before."""
    path = pathlib.Path(root) / mutant.file
    text = path.read_text(encoding="utf-8")
    lines = text.split("\n")
    line = lines[mutant.line - 1]
    lines[mutant.line - 1] = line[:mutant.begin] + mutant.new + line[mutant.end:]
    path.write_text("\n".join(lines), encoding="utf-8")
    return text
