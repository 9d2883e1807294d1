"""Instances, plans and the referee, from Python."""

import copy
import os
import pickle
import re
import signal
import threading
import time

import numpy as np
import pytest

import mvtp


def without_times(path):
    """A plan file but for what the clock says."""
    return re.sub(r"(runtime|first_solution): [^,}\n]+", r"\1: -", path.read_text())


def swap(**options):
    """Two robots on an open map change places."""
    starts = [[10, 20, 0], [30, 20, np.pi]]
    goals = [[30, 20, 0], [10, 20, np.pi]]
    return mvtp.Instance(starts, goals, size=(40, 40), **options)


def test_the_version_is_that_of_the_program(command):
    assert command("--version").stdout.startswith(f"mvtp {mvtp.__version__}\n")


@pytest.mark.parametrize("algorithm", mvtp.ALGORITHMS)
def test_solve_gives_the_same_bytes_as_the_command(algorithm, scenarios, command, tmp_path):
    instance = scenarios / "circle" / "circle4.yaml"
    gap = {"gap": 0.5}  # escot-star ends by itself
    done = command("solve", "-i", instance, "-o", tmp_path / "command.yaml", "-a", algorithm,
                   "--seed", "3", "--gap", "0.5")  # fmt: skip
    assert done.returncode == 0, done.stderr
    plan = mvtp.solve(mvtp.Instance.load(instance), algorithm=algorithm, seed=3, **gap)
    assert plan.solved
    plan.save(tmp_path / "python.yaml")
    assert without_times(tmp_path / "python.yaml") == without_times(tmp_path / "command.yaml")


def test_poses_are_views_of_one_block_and_whoever_has_arrived_rests(circle8):
    plan = mvtp.solve(mvtp.Instance.load(circle8))
    steps = plan.statistics["makespan_steps"] + 1
    assert plan.poses.shape == (8, steps, 3) and plan.states.shape == (8, steps, 5)
    assert np.shares_memory(plan.poses, plan.states)
    assert np.shares_memory(plan.poses, plan.poses)
    assert not plan.poses.flags.owndata and not plan.poses.flags.writeable
    for robot in range(len(plan)):
        own = plan.trajectory(robot)
        assert np.shares_memory(own, plan.trajectory(robot))
        np.testing.assert_array_equal(plan.states[robot, : len(own)], own)
        assert (plan.poses[robot, len(own) :] == own[-1, :3]).all()
        assert (plan.states[robot, len(own) :, 3:] == 0).all()
    np.testing.assert_allclose(plan.poses[:, -1], mvtp.Instance.load(circle8).goals, atol=1e-9)


def test_views_outlive_the_plan(circle8):
    plan = mvtp.solve(mvtp.Instance.load(circle8))
    poses, first = plan.poses, plan.poses.copy()
    del plan
    np.testing.assert_array_equal(poses, first)


def test_an_instance_of_values_is_the_one_of_its_file(tmp_path):
    built = mvtp.Instance(
        np.array([[10.0, 20, 0], [30, 20, 3]]),
        [(30, 20, 0), (10, 20, 3)],
        size=(40, 50),
        circles=[(20, 5, 1.5)],
        polygons=[[(1, 1), (4, 1), (4, 3)], np.array([[30.0, 40], [35, 40], [35, 45]])],
        vehicle=["cl-cbs", mvtp.Vehicle(width=1.5)],
        names=["left", "right"],
        dt=0.5,
    )
    built.save(tmp_path / "i.yaml")
    read = mvtp.Instance.load(tmp_path / "i.yaml")
    sent = pickle.loads(pickle.dumps(built))
    for instance in (built, read, sent, copy.deepcopy(read)):
        np.testing.assert_array_equal(instance.starts, [[10, 20, 0], [30, 20, 3]])
        np.testing.assert_array_equal(instance.goals, [[30, 20, 0], [10, 20, 3]])
        np.testing.assert_array_equal(instance.circles, [[20, 5, 1.5]])
        np.testing.assert_array_equal(instance.polygons[0], [[1, 1], [4, 1], [4, 3]])
        assert instance.polygons[1].shape == (3, 2)
        assert instance.names == ["left", "right"]
        assert instance.size == (40, 50) and instance.dt == 0.5 and instance.bounds == "footprint"
        assert instance.vehicles == [mvtp.Vehicle("cl-cbs"), mvtp.Vehicle(width=1.5)]
        assert instance.vehicles[1].length == 3.0
        assert len(instance) == 2
    assert not built.starts.flags.owndata and not built.starts.flags.writeable


def test_plans_come_back_from_their_files_bit_by_bit(tmp_path):
    plan = mvtp.solve(swap())
    plan.save(tmp_path / "plan.yaml")
    for read in (mvtp.Plan.load(tmp_path / "plan.yaml"), pickle.loads(pickle.dumps(plan))):
        np.testing.assert_array_equal(read.states, plan.states)
        assert read.names == plan.names and read.vehicles == plan.vehicles
        assert read.statistics == plan.statistics


def test_pickle_keeps_what_no_file_says():
    wall = [[(9.9, 19.9), (10.1, 19.9), (10.1, 20.1)]]
    allowed = swap(polygons=wall, initial_overlap="allow", bounds="axle")
    sent = pickle.loads(pickle.dumps(allowed))
    assert sent.problems() == [] and sent.bounds == "axle"
    refused = swap(polygons=wall)
    assert pickle.loads(pickle.dumps(refused)).problems() == refused.problems() != []
    vehicles = [mvtp.Vehicle(width=1.25, max_accel=0.1), mvtp.Vehicle("cl-cbs")]
    assert pickle.loads(pickle.dumps(vehicles)) == vehicles


def test_the_referee_judges_values(tmp_path):
    instance = swap()
    plan = mvtp.solve(instance)
    assert mvtp.validate(instance, plan) == []
    assert mvtp.validate(instance, mvtp.Plan(plan.states)) == []
    through = np.linspace(instance.starts, instance.goals, 26, axis=1)
    [violation] = mvtp.validate(instance, mvtp.Plan(through))
    assert violation.agents == ["agent0", "agent1"] and violation.rule == "robot overlap"
    assert 8 < violation.step < 13
    assert "agent0" in violation.message and "\n" not in violation.message
    assert mvtp.validate(instance, mvtp.Plan(through[:, ::25]), collision="steps")


@pytest.mark.parametrize(
    ("make", "line"),
    [
        (lambda: swap(dt=-1), r"instance: dt: is -1"),
        (lambda: swap(circles=[(5, float("nan"))]), r"instance: map\.obstacles\[0\]\[1\]: is .*nan"),
        (lambda: swap(names=["a", "a"]), r'agents\[1\]\.name: "a" is the name of agents\[0\] too'),
        (lambda: swap(vehicle="tank"), r'vehicle.*unknown preset "tank"; choose escot or cl-cbs'),
        (lambda: swap(vehicle=["escot"]), r"vehicle: has 1 entries for 2 agents"),
        (lambda: swap(bounds="wheels"), r'--bounds: is "wheels"; choose axle\|footprint'),
        (lambda: mvtp.Instance([[1, 2]], [[1, 2, 3]], size=(9, 9)), r"starts: has the shape \(1, 2\)"),
        (lambda: mvtp.Instance([], [], size=(9, 9)), r"instance: agents"),
        (lambda: mvtp.Vehicle(widht=2), r"vehicle: .*widht"),
        (lambda: mvtp.Vehicle(width=0), r"vehicle: width: is 0"),
        (lambda: mvtp.Vehicle(max_speed=float("inf")), r"vehicle: max_speed: is .*inf"),
        (lambda: mvtp.Instance(np.array([[1j, 1, 0]]), [[2, 2, 0]], size=(9, 9)), r"starts: is no array of numbers"),
        (lambda: mvtp.Plan([[1, 2, 3]]), r"plan: states: is no array of the shape"),
        (lambda: mvtp.Plan(np.array([[[1j, 2, 3]]])), r"plan: states: is no array of the shape"),
        (lambda: mvtp.Plan(np.zeros((2, 4, 3)), names=["a"]), r"plan: names: has 1 entries"),
        (lambda: mvtp.solve(swap(), time_limit=0), r'solve: --time-limit: is "0"; give a finite'),
        (lambda: mvtp.solve(swap(), algorithm="astar"), r'--algorithm: is "astar"; choose escot'),
        (lambda: mvtp.validate(swap(), mvtp.Plan(np.zeros((2, 4, 3))), collision="x"), r"--collision"),
    ],
)  # fmt: skip
def test_bad_values_get_one_line(make, line):
    with pytest.raises(mvtp.InputError, match=line) as caught:
        make()
    assert "\n" not in str(caught.value) and isinstance(caught.value, ValueError)


@pytest.mark.parametrize(
    "make",
    [
        lambda: mvtp.Instance([[1, 1, 0]], [[2, 2, 0]], size=40),
        lambda: swap(vehicle=3),
        lambda: swap(vehicle=[3, 4]),
        lambda: swap(names=7),
        lambda: mvtp.Vehicle(width=[]),
        lambda: mvtp.solve("circle8.yaml"),
        lambda: mvtp.solve(None),
    ],
)
def test_values_of_another_type_are_type_errors(make):
    with pytest.raises(TypeError):
        make()


def test_solve_says_that_a_path_is_no_instance():
    with pytest.raises(TypeError, match=r"solve: is given 'circle8\.yaml'; give a mvtp\.Instance"):
        mvtp.solve("circle8.yaml")


def test_a_plan_that_is_not_finite_is_judged_and_never_saved(tmp_path):
    for value in (float("nan"), float("inf")):
        states = np.zeros((2, 4, 5))
        states[1, 2, 0] = value
        plan = mvtp.Plan(states)
        assert "not finite" in {violation.rule for violation in mvtp.validate(swap(), plan)}
        with pytest.raises(mvtp.InputError, match="plan: agent1: step 2 is not finite"):
            plan.save(tmp_path / "plan.yaml")
        with pytest.raises(mvtp.InputError, match="plan: agent1: step 2 is not finite"):
            pickle.dumps(plan)
    assert not list(tmp_path.iterdir())


def test_bad_files_get_the_line_that_the_command_prints(command, tmp_path):
    blocked = tmp_path / "blocked.yaml"
    blocked.write_text("agents: [{start: [5, 5, 0], goal: [20, 5, 0]}]\n"
                       "map: {dimensions: [30, 10], obstacles: [[20, 5]]}\n")  # fmt: skip
    broken = tmp_path / "broken.yaml"
    broken.write_text("agents: [{start: [5, 5, north], goal: [20, 5, 0]}]\n")
    for path in (blocked, broken, tmp_path / "missing.yaml"):
        printed = command("solve", "-i", path)
        assert printed.returncode == 2
        with pytest.raises(mvtp.InputError) as caught:
            mvtp.solve(mvtp.Instance.load(path))
        assert f"mvtp: {caught.value}\n" == printed.stderr


def test_problems_are_what_solve_refuses():
    touching = mvtp.Instance([[10, 10, 0], [11, 10, 0]], [[10, 30, 0], [30, 30, 0]], size=(40, 40))
    [problem] = touching.problems()
    with pytest.raises(mvtp.InputError, match=re.escape(problem)):
        mvtp.solve(touching)
    assert swap().problems() == []


def endless(**options):
    """A search with a plan from the first moments on, which it improves until its time limit."""
    return mvtp.solve(swap(), algorithm="escot-star", gap=0, **options)


def test_other_threads_go_on_while_it_solves():
    steps = 0
    ended = threading.Event()

    def count():
        nonlocal steps
        while not ended.is_set():
            steps += 1
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    endless(time_limit=0.5)
    ended.set()
    counter.join()
    assert steps > 10


def test_progress_is_told_and_may_end_the_search():
    shares = []

    class Enough(Exception):
        pass

    def progress(share, note):
        shares.append(share)
        assert note.endswith(" s")
        if len(shares) == 3:
            raise Enough

    with pytest.raises(Enough):
        endless(time_limit=60, progress=progress)
    assert len(shares) == 3 and shares == sorted(shares) and 0 < shares[0] < shares[2] < 1


def test_ctrl_c_ends_the_search_and_keeps_the_best_plan():
    def press(share, note):
        if share > 0.02:
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(mvtp.Interrupted) as caught:
        endless(time_limit=60, progress=press)
    assert isinstance(caught.value, KeyboardInterrupt)
    assert mvtp.validate(swap(), caught.value.result) == []
