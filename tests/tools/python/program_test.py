"""The commands that run SUMO in a process of their own, as functions."""

import os
import signal
import threading

import pytest

import mvtp


@pytest.fixture(autouse=True)
def a_fresh_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_coordinate_runs_a_scenario_and_tells_its_progress(crossroads, tmp_path):
    told = []
    run = mvtp.coordinate(crossroads, output_dir=tmp_path / "out", end=20, no_view=True, seed=3,
                          progress=lambda share, note: told.append((share, note)))  # fmt: skip
    assert run.summary["status"] == "end reached" and run.summary["seed"] == 3
    assert not run.succeeded  # at that time not everybody has arrived
    assert (run.folder / "summary.json").exists() and not (run.folder / "view.html").exists()
    assert [share for share, _ in told] == sorted({share for share, _ in told})
    assert len(told) >= 9 and "vehicles" in told[-1][1]


def test_notes_are_told(scenarios):
    run = mvtp.coordinate(scenarios / "crossroads" / "crossroads-people.sumocfg", end=1)
    assert any(note.startswith("people on foot") for note in run.notes)


def test_compare_runs_several_controls(crossroads):
    comparison = mvtp.compare(crossroads, controllers=["sumo", "fcfs"], seeds=[1, 2], end=10, jobs=2)
    assert {run["seed"] for run in comparison.runs} == {"1", "2"}
    assert {run["control"] for run in comparison.runs} == {"sumo", "fcfs"}
    assert len(comparison.runs) == 4
    assert "fcfs" in comparison.table and comparison.figures
    assert (comparison.folder / "compare.csv").exists()


@pytest.mark.parametrize("function", [mvtp.coordinate, mvtp.compare])
def test_bad_input_gets_the_line_of_the_command(function, command, crossroads):
    name = function.__name__
    for words, options in (
        (("-c", "missing.sumocfg"), {"configuration": "missing.sumocfg"}),
        (("-c", crossroads, "--tries=-1"), {"configuration": crossroads, "tries": -1}),
    ):
        printed = command(name, *words)
        with pytest.raises(mvtp.InputError) as caught:
            function(**options)
        assert printed.stderr == f"mvtp: {caught.value}\n"


def test_bad_input_costs_nobody_his_results(crossroads, tmp_path):
    def refuse(line, **options):
        with pytest.raises(mvtp.InputError, match=line):
            mvtp.coordinate(crossroads, **options)

    mvtp.coordinate(crossroads, output_dir="out", end=1, no_view=True)
    before = (tmp_path / "out" / "summary.json").read_bytes()
    refuse("did you mean --controller", output_dir="out", contoller="fcfs")
    assert (tmp_path / "out" / "summary.json").read_bytes() == before
    refuse("--output-dir: is empty; give a folder", output_dir="")
    refuse("cannot make this folder", output_dir=tmp_path / "out" / "summary.json")


def test_a_run_that_fails_passes_off_no_other_results(crossroads, tmp_path, monkeypatch):
    mvtp.coordinate(crossroads, output_dir="out", end=1, no_view=True)
    monkeypatch.setattr("mvtp._program._program", lambda: "/bin/false")
    with pytest.raises(mvtp.RunError, match="ended without a word") as caught:
        mvtp.coordinate(crossroads, output_dir="out")
    assert caught.value.run is None


def test_a_crash_is_an_exception_with_what_was_simulated_before(crossroads):
    def kill(share, note):
        if share >= 0.7:  # after the first checkpoint
            [sumo] = [pid for pid in children_of(os.getpid()) if "mvtp-sumo" in name_of(pid)]
            os.kill(sumo, signal.SIGSEGV)

    with pytest.raises(mvtp.RunError, match="^coordinate: the simulation crashed") as caught:
        mvtp.coordinate(crossroads, end=100, no_view=True, progress=kill)
    assert caught.value.run.summary["status"] == "failed"
    assert caught.value.run.summary["vehicles"] > 0


def test_ctrl_c_is_passed_on_and_the_results_so_far_are_kept(crossroads):
    def press(share, note):
        if share >= 0.2:
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(mvtp.Interrupted) as caught:
        mvtp.coordinate(crossroads, end=100, no_view=True, progress=press)
    run = caught.value.result
    assert run.summary["status"] == "interrupted" and run.summary["vehicles"] > 0
    assert (run.folder / "vehicles.csv").exists()
    assert threading.active_count() == 1 and not children_of(os.getpid())


def test_a_callback_that_fails_ends_the_run(crossroads):
    class Enough(Exception):
        pass

    def progress(share, note):
        raise Enough

    with pytest.raises(Enough):
        mvtp.coordinate(crossroads, end=200, no_view=True, progress=progress)
    assert not children_of(os.getpid())


def name_of(pid):
    with open(f"/proc/{pid}/comm", encoding="utf-8") as file:
        return file.read()


def children_of(pid):
    """All processes below this one."""
    with open(f"/proc/{pid}/task/{pid}/children", encoding="utf-8") as file:
        own = [int(child) for child in file.read().split()]
    return own + [grandchild for child in own for grandchild in children_of(child)]
