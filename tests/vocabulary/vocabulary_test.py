#!/usr/bin/env python3
"""Holds docs, help texts and code to the field's words: vocabulary_test.py ROOT

Left: words that this project once used for itself; right: what the literature says instead. Where an
old word has to stay, exceptions.txt names file, word and reason. An exception that nothing needs any
more is an error too.
"""

import fnmatch
import pathlib
import re
import sys

WORDS = {
    "way": (r"\bways?\b|_ways?\b|\bways?_", "path; single-agent path"),
    "guide": (r"\bguides?\b|[Gg]uide_?[Pp]aths?|find_guide", "reference path"),
    "bucket": (r"\bbuckets?\b", "macro step"),
    "instant": (r"\binstants\b|\b(?:an|each|every|this|that|one|the) instant\b", "time step"),
    "turns": (r"\btak(?:e|es|ing)[ _]turns\b|\btook turns\b", "revised prioritized planning"),
    "halt": (r"\bpatience\b|\bstall(?:s|ed)?\b|comes? to a halt", "stagnation, stagnation limit"),
    "deadline": (r"deadline for all|\bput(?:ting)? off\b", "makespan bound; relax, tighten it"),
    "price": (r"\bprice[sd]?\b", "soft-collision cost"),
    "sight": (r"\bsight\b|\boutlook\b|whom it can reach", "lookahead horizon, reachable disc"),
    "shot": (r"\bshots?\b", "analytic expansion"),
    "action": (r"\b[Aa]ctions?\b|MacroCar", "motion primitives"),
    "SoftAstar": (r"SoftAstar|soft_astar", "soft-constraint hybrid A*"),
    "in the way": (r"\bevasions?\b|\bin[ _]the[ _]way\b", "push candidate, blocking"),
    "fleet": (r"\b[Ff]leet\b|\bDraft\b|\bAdmission\b|\bTemper\b|\bdraft\b",
              "PlanningProblem, ReplanningSession, RequestPlanner, FirstPlanOptions"),
    "prepare": (r"\bprepare\b|look_around", "update_reference_paths, update_neighbours"),
    "visit": (r"\bvisits?\b", "parking event"),
    "the light": (r"\bthe light\b|\bown light\b", "traffic signal"),
    "own drivers": (r"\bown[ _]drivers?\b|OwnDrivers", "car-following model, human drivers"),
    "ours": (r"\b(?:of|not|with|one of) ours\b|\bof our own\b", "CAV; under control"),
    "strand": (r"\bstrand(?:s|ed)?\b", "stop permanently"),
    "gone": (r"\bgone\b", "departed"),
    "one at a time": (r"one[ -]at[ -]a[ -]time|one_at_a_time|order of arrival", "FCFS"),
    "trajectory types": (r"TimedPath|TimedTrack|SoftPath|MovingObstacle|PathTrajectory|PlannedWay|"
                         r"StepPlan|\bIncumbent\b", "Trajectory, SpeedProfile, Path, JointPlan"),
}
# English that has no other word.
ENGLISH = re.compile(
    r"[Rr]ight of way|right_of_way|[Gg]iv(?:e|es|en|ing) way|\b(?:in )?(?:the same|this|that|either|"
    r"both|which|other|any|each|a|no other|one|two) ways?\b|half[- ]way|\bway round\b|[Hh]alf way|\b[Gg]one on\b|\bon (?:its|his|her|the|their) ways?\b|[Gg]reedy action|by the way|under way|under_way|"
    r"one-way|one_way|std::visit|all the way|no way to\b|\bways? to (?!the\b|its\b|their\b|it\b|them\b)")
CODE = (".cpp", ".hpp", ".py", ".js", ".sh", ".html")
SKIPPED = ("build", "out", ".git", "tests/vocabulary", "networks", "scenarios/toio/random")


def files_of(root):
    for path in sorted(root.rglob("*")):
        name = path.relative_to(root).as_posix()
        if path.suffix in (".md", *CODE) and not name.startswith(SKIPPED):
            yield name, path.read_text(encoding="utf-8")


def split(name, text):
    """Each line as (prose, names). Markdown: without code and link targets; code: comments and
    strings are prose, the rest is names."""
    if name.endswith(".md"):
        hidden = r"^(```|~~~).*?^\1|<!--.*?-->"
        text = re.sub(hidden, lambda m: "\n" * m[0].count("\n"), text, flags=re.S | re.M)
        return [(re.sub(r"`[^`\n]*`|\]\([^)]*\)", "", line), "") for line in text.splitlines()]
    comment = r"//.*|^ *\*.*|/\*.*|<!--.*" if not name.endswith((".py", ".sh")) else r"(?:^|\s)#.*"
    named = r"`[^`]*`|\b\w+\(|--[a-z][\w-]*|\b\w+\.[a-z]{2,4}\b"
    prose = re.compile(rf"{comment}|\"(?:[^\"\\]|\\.)*\"|\"\"\".*")
    lines = [re.sub(r"#include .*", "", line) for line in text.splitlines()]
    return [(re.sub(named, " ", " ".join(prose.findall(line))), prose.sub(" ", line)) for line in lines]


def hits_of(name, text):
    """(word, is it a name of the code, message) of each hit."""
    for number, parts in enumerate(split(name, text), 1):
        for is_name, part in enumerate(parts):
            rest = ENGLISH.sub(" ", part)
            for word, (pattern, say) in WORDS.items():
                for hit in re.finditer(pattern, rest):
                    named = bool(is_name) or re.search(r"[A-Z_]", hit[0][1:]) is not None
                    yield word, named, f"{name}:{number}: \"{hit[0]}\": say {say}"


def read_exceptions(path):
    for line in path.read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            where, reason = line.split(" -- ")
            glob, words = where.split(": ")
            assert reason, line
            for word in words.split(", "):
                assert word in WORDS, f"exceptions.txt: no such word: {word}"
                yield glob.removeprefix("names in "), word, glob.startswith("names in ")


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    exceptions = list(read_exceptions(pathlib.Path(__file__).with_name("exceptions.txt")))
    used, faults = set(), []
    for name, text in files_of(root):
        for word, is_name, message in hits_of(name, text):
            found = {(g, w, n) for g, w, n in exceptions
                     if w == word and (is_name or not n) and fnmatch.fnmatch(name, g)}
            used |= found
            if not found:
                faults.append(message)
    faults += [f"exceptions.txt: nothing needs this: {g}: {w}" for g, w, n in exceptions
               if (g, w, n) not in used]
    print("\n".join(faults) or "only the field's words")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
