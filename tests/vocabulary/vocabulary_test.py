#!/usr/bin/env python3
"""Holds docs, help texts and code to the field's words: vocabulary_test.py ROOT

Left: words that this project once used for itself; right: what the literature says instead. Names are
read as they stand and word by word: AWayOut and own_light as "a way out" and "own light". Where an old
word has to stay, exceptions.txt names file, word and reason. An exception that nothing needs any more
is an error too.
"""

import fnmatch
import pathlib
import re
import sys

WORDS = {
    "way": (r"\bways?\b", "path; single-agent path"),
    "guide": (r"\bguides?\b|[Gg]uide_?[Pp]aths?|find_guide", "reference path"),
    "bucket": (r"\bbuckets?\b", "macro step"),
    "instant": (r"\binstants\b|\b(?:an|each|every|this|that|one|the) instant\b", "time step"),
    "turns": (r"\btak(?:e|es|ing)[ _]turns\b|\btook turns\b", "revised prioritized planning"),
    "halt": (r"\bpatience\b|\bstall(?:s|ed)?\b|\bhalts?\b", "stagnation, stagnation limit; stop"),
    "deadline": (r"deadline for all|\bput(?:ting)? off\b", "makespan bound; relax, tighten it"),
    "price": (r"\bprice[sd]?\b", "soft-collision cost"),
    "sight": (r"\bsights?\b|\boutlook\b|whom it can reach", "lookahead horizon, reachable disc"),
    "shot": (r"\bshots?\b", "analytic expansion"),
    "action": (r"\b[Aa]ctions?\b|MacroCar", "motion primitives"),
    "SoftAstar": (r"SoftAstar|soft_astar", "soft-constraint hybrid A*"),
    "in the way": (r"\bevasions?\b|\bevasive\b|\bin[ _]the[ _]way\b", "push candidate, blocking"),
    "fleet": (r"\b[Ff]leet\b|\bDraft\b|\bAdmission\b|\bTemper\b|\bdraft\b",
              "PlanningProblem, ReplanningSession, RequestPlanner, FirstPlanOptions"),
    "prepare": (r"\bprepare\b(?! [a-z])|look_around", "update_reference_paths, update_neighbours"),
    "visit": (r"\bvisits?\b|\b(?:a|the|its|one|per|whose|whole|fake|vehicle's|car's) stay\b|"
              r"\b(?:all|the|these|of|end|fake) stays\b|\bstays of \d", "parking event"),
    "the light": (r"\bthe light\b|\bown light\b", "traffic signal"),
    "own drivers": (r"\bown[ _]drivers?\b|OwnDrivers", "car-following model, human drivers"),
    "ours": (r"\b(?:of|not|with|one of) ours\b|\bof our own\b", "CAV; under control"),
    "zone": (r"(?<![Cc]ontrol[ -])(?<![Cc]onflict[ -])(?<!dead )\bzones?\b", "control zone"),
    "strand": (r"\bstrand(?:s|ed)?\b", "stop permanently"),
    "gone": (r"\bgone\b", "departed"),
    "one at a time": (r"one[ -]at[ -]a[ -]time|one_at_a_time|order of arrival", "FCFS"),
    "trajectory types": (r"TimedPath|TimedTrack|SoftPath|MovingObstacle|PathTrajectory|PlannedWay|"
                         r"StepPlan|\bIncumbent\b", "Trajectory, SpeedProfile, Path, JointPlan"),
}
ANY = re.compile("|".join(pattern for pattern, _ in WORDS.values()))
# English that has no other word. A way is a path unless it is said to be a manner, or a direction.
ENGLISH = re.compile(
    r"right[ _]of[ _]way|\bgiv(?:e|es|en|ing)[ _]way\b|\b(?:in )?(?:the same|this|that|either|both|which|other|"
    r"any|each|no other|one) ways?\b|\bin a way\b|half[- ]way|\bway round\b|\bgone on\b|\bno way to\b|"
    r"\bon (?:its|his|her|the|their) way\b|greedy action|by the way|\bunder[ _]way\b|\bone[-_ ]way\b|std::visit|"
    r"all the way|\bways to colour\b", re.I)
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
    hidden = r"--[a-z][\w-]*|\b\w+\.[a-z]{2,4}\b"
    named = r"`[^`]*`|@param \w+|\b\w+_\w+\b|\b\w+\("
    prose = re.compile(rf"{comment}|\"(?:[^\"\\]|\\.)*\"|\"\"\".*")
    parts = []
    for line in text.splitlines():
        line = re.sub(r"#include .*", "", line)
        said = re.sub(hidden, " ", " ".join(prose.findall(line)))
        parts.append((re.sub(named, " ", said), " ".join([prose.sub(" ", line), *re.findall(named, said)])))
    return parts


def spell(text):
    """The words within names, as prose has them: "AWayOut" and "own_light" as "a way out" and "own light"."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])|_", " ", text).lower()


def hits_of(name, text):
    """(word, is it a name of the code, message) of each hit."""
    for number, parts in enumerate(split(name, text), 1):
        for is_name, part in enumerate(parts):
            hits = {}
            for form in (part, spell(part)):
                rest = ENGLISH.sub(" ", form)
                if not ANY.search(rest):
                    continue
                for word, (pattern, say) in WORDS.items():
                    for hit in re.finditer(pattern, rest):
                        hits.setdefault(word, (hit[0], say))
            for word, (hit, say) in hits.items():
                named = bool(is_name) or re.search(r"[A-Z_]", hit[1:]) is not None
                yield word, named, f"{name}:{number}: \"{hit}\": say {say}"


def check_itself():
    """What it must see, and what is English, or a name of the field."""
    for seen in ("kSight", "EvasiveWorld", "FindsAWayOut", "is_in_the_way(", "// see outlook()", "/// `OwnDriver`",
                 "// a way among robots at rest", "// two ways meet", "PlansFromALaterBucketOn", "way_ = 1;",
                 "OfAMixedFleet", "SlowActions", "// after its stay is over", "halts[i]", "ByTheLight",
                 "// Zones share no ground"):
        assert list(hits_of("a.cpp", seen)), f"not seen: {seen}"
    for said in ("has_right_of_way(", "// gives way to b", "steps_under_way_", "TheOtherWayRound", "one_way(",
                 "// in a way that nothing explains", "// lanes each way", "prepare_tables(", "Highway", "away",
                 "// the vehicle stays on its lane", "halted_by_stop", '"--stall"', "// a step at a time",
                 "// a control zone", "// Control zones"):
        assert not list(hits_of("a.cpp", said)), f"seen: {said}"


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
    check_itself()
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
