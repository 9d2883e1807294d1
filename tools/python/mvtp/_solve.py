"""Plans for one instance."""

from . import _planner
from ._errors import Interrupted
from ._options import words


def solve(
    instance,
    *,
    algorithm="escot",
    time_limit=60.0,
    seed=0,
    collision="continuous",
    runs=1,
    run_time_limit=None,
    gap=0.01,
    threads=1,
    pbcr="strengthened",
    progress=None,
):
    """Plans for all robots of an Instance; the same bytes as `mvtp solve` for the same options.

    algorithm: one of ALGORITHMS. time_limit: for all runs together [s]. seed: of the random
    choices. collision: "continuous" or "steps", see validate(). runs: tries with the seeds seed,
    seed + 1, ...; the first success counts. run_time_limit: of each [s]. gap: where "escot-star"
    stops, as part of the lower bound. threads: of "escot-star". pbcr: "strengthened" or "paper",
    what PBCR ranks by, alone and in "escot". progress: called some 20 times a second with the share
    of the time limit that is over, in [0, 1], and a note; what it raises ends the search.

    Returns a Plan, solved or not: look at `plan.solved` and `plan.statistics`. The GIL is released.
    Raises InputError for an instance that is blocked from the start or an option out of range, and
    Interrupted on Ctrl-C, with the best plan so far.
    """
    options = {
        "algorithm": algorithm,
        "time_limit": time_limit,
        "seed": seed,
        "collision": collision,
        "runs": runs,
        "run_time_limit": run_time_limit,
        "gap": gap,
        "threads": threads,
        "pbcr": pbcr,
    }
    if not isinstance(instance, _planner.Instance):
        raise TypeError(f"solve: is given {instance!r}; give a mvtp.Instance, as of Instance.load(path)")
    plan, raised = _planner.search(instance, words(options), progress)
    if raised is None:
        return plan
    if isinstance(raised, KeyboardInterrupt):
        raise Interrupted(plan if plan.solved else None) from raised
    raise raised
