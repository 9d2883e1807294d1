"""SUMO in the closed loop, stepped from Python. One simulation after the other in this process."""

import csv
import json
import os
import signal

import numpy as np
import pytest

import mvtp

CLOCK = {"command", "replan_ms", "real_time_factor"}  # figures of the wall clock, and who asked


def without_clock(summary):
    return {key: value for key, value in summary.items() if key not in CLOCK}


def rows(path, leave_out):
    with open(path, newline="", encoding="utf-8") as file:
        table = list(csv.DictReader(file))
    return [{k: v for k, v in row.items() if k not in leave_out} for row in table]


@pytest.fixture(autouse=True)
def a_fresh_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_the_built_in_controller_gives_the_results_of_the_command(crossroads, command, tmp_path):
    command("coordinate", "-c", crossroads, "--end", "60", "--output-dir", "command", "--quiet")
    summary = mvtp.Simulation(crossroads, end=60, output_dir="python").run()
    files = [tmp_path / name / "summary.json" for name in ("command", "python")]
    of_command, of_python = (json.loads(file.read_text()) for file in files)
    assert summary == of_python
    assert without_clock(of_python) == without_clock(of_command)
    assert of_python["completed"] > 0 and of_python["replans"] > 0
    for name, clock in (("vehicles.csv", ()), ("events.csv", ()), ("replans.csv", ("ms",))):
        assert rows(f"command/{name}", clock) == rows(f"python/{name}", clock)
    assert {file.name for file in (tmp_path / "command").iterdir()} == {
        file.name for file in (tmp_path / "python").iterdir()
    }


def test_one_run_after_the_other_gives_the_same(crossroads):
    first, second = (mvtp.Simulation(crossroads, end=15).run() for _ in range(2))
    assert without_clock(first) == without_clock(second)
    assert first["vehicles"] > 0


def test_what_there_is_to_see(crossroads):
    with mvtp.Simulation(crossroads, end=30) as simulation:
        assert simulation.time == 0 and simulation.step_length == 0.1
        assert simulation.vehicles().poses.shape == (0, 3)
        assert simulation.advance(20.0)
        assert simulation.time == pytest.approx(20.0)
        now = simulation.vehicles()
        count = len(now.ids)
        assert count > 4 and now.ids == sorted(now.ids)
        assert now.poses.shape == (count, 3) and now.taken_over.dtype == bool
        assert len(now.types) == len(now.lanes) == len(now.speeds) == len(now.lane_positions) == count
        assert now.taken_over.any() and (now.speeds >= 0).all()
        traffic = simulation.traffic
        lanes = traffic.network.lanes
        i = next(i for i in range(count) if not lanes[now.lanes[i]].internal)
        x, y, yaw = now.poses[i]
        front = np.array([x, y]) + traffic.type(now.types[i]).body.front * np.array(
            [np.cos(yaw), np.sin(yaw)]
        )
        start = lanes[now.lanes[i]].shape[0]
        assert np.linalg.norm(front - start) == pytest.approx(now.lane_positions[i], abs=0.1)
        assert traffic.route(now.ids[0])
        assert [j.id for j in traffic.network.junctions.values() if j.has_conflicts] == ["C"]
        assert simulation.people().poses.shape == (0, 3)
        assert simulation.report()["vehicles"] >= count
    assert simulation.summary["status"] == "interrupted"


class DriveOn(mvtp.Controller):
    """Takes over everybody and lets each drive straight on at its speed."""

    def __init__(self):
        super().__init__()
        self.calls = []

    def decide(self):
        self.calls.append("decide")

    def act(self):
        self.calls.append("act")
        traffic = self.traffic
        now = traffic.vehicles()
        for id, pose, speed in zip(now.ids, now.poses, now.speeds):
            traffic.take_over(id)
            ahead = speed * traffic.step_length * np.array([np.cos(pose[2]), np.sin(pose[2]), 0])
            traffic.place(id, pose + ahead, speed)

    def observe(self):
        self.calls.append("observe")


def test_a_controller_in_python_drives(crossroads):
    controller = DriveOn()
    with pytest.raises(mvtp.InputError, match="no traffic yet"):
        controller.traffic.time
    with mvtp.Simulation(crossroads, controller=controller, end=4) as simulation:
        simulation.advance(3.0)
        before = simulation.vehicles()
        simulation.step()
        after = simulation.vehicles()
    assert controller.calls[:3] == ["decide", "act", "observe"]
    assert before.taken_over.all() and len(before.ids) > 0
    i = after.ids.index(before.ids[0])
    moved = np.linalg.norm(after.poses[i, :2] - before.poses[0, :2])
    assert moved == pytest.approx(0.1 * before.speeds[0], abs=1e-6)
    assert simulation.summary["controller"] == "DriveOn"


def test_without_a_controller_the_caller_drives_between_the_steps(crossroads):
    with mvtp.Simulation(crossroads, controller=None, end=20) as simulation:
        simulation.advance(5.0)
        assert not simulation.vehicles().taken_over.any()
        slow = simulation.vehicles().ids[0]
        simulation.traffic.cap_speed(slow, 2.0)
        simulation.advance(8.0)
        now = simulation.vehicles()
        assert now.speeds[now.ids.index(slow)] == pytest.approx(2.0, abs=0.3)
        simulation.traffic.cap_speed(slow, None)
        simulation.advance(3.0)
        now = simulation.vehicles()
        assert now.speeds[now.ids.index(slow)] > 4.0


def test_lights_are_shown(with_light):
    with mvtp.Simulation(with_light, controller=None, end=40) as simulation:
        traffic = simulation.traffic
        [(signal_id, lights)] = traffic.network.signals.items()
        assert len(traffic.signal_phases(signal_id)[0].lights) == lights
        traffic.show(signal_id, "r" * lights)
        simulation.advance(39.0)
        assert simulation.report()["completed"] == 0
        assert (simulation.vehicles().speeds < 0.1).sum() >= 4


def test_what_a_controller_raises_reaches_the_caller_and_the_report(crossroads):
    class Broken(mvtp.Controller):
        def decide(self):
            if self.traffic.time > 1:
                raise ZeroDivisionError("by\nzero")

    with pytest.raises(ZeroDivisionError):
        with mvtp.Simulation(crossroads, controller=Broken(), output_dir="out") as simulation:
            simulation.run()
    summary = simulation.summary
    assert (summary["status"], summary["message"]) == ("failed", "ZeroDivisionError: by zero")
    with open("out/summary.json", encoding="utf-8") as file:
        assert json.load(file) == summary


def test_ctrl_c_keeps_the_results_so_far(crossroads):
    def press(share, note):
        if share > 0.01:
            os.kill(os.getpid(), signal.SIGINT)

    simulation = mvtp.Simulation(crossroads, end=60, output_dir="out")
    with pytest.raises(mvtp.Interrupted) as caught:
        simulation.run(progress=press)
    assert caught.value.result["status"] == "interrupted"
    with open("out/summary.json", encoding="utf-8") as file:
        assert json.load(file) == caught.value.result
    assert 0 < caught.value.result["simulated_s"] < 60


def test_there_is_one_at_a_time_and_nothing_left_of_it_afterwards(crossroads):
    simulation = mvtp.Simulation(crossroads, end=5)
    with pytest.raises(mvtp.InputError, match="another one is open"):
        mvtp.Simulation(crossroads)
    traffic = simulation.traffic
    simulation.finish()
    for use in (simulation.step, simulation.vehicles, traffic.types, lambda: traffic.time):
        with pytest.raises(mvtp.InputError, match="has ended"):
            use()
    assert simulation.finish() is simulation.summary
    del simulation
    mvtp.Simulation(crossroads, end=1).finish()


def test_sumo_may_run_in_a_process_of_its_own(crossroads):
    def run(**options):
        return without_clock(mvtp.Simulation(crossroads, end=6, **options).run())

    assert run(separate_process=True) == run()


@pytest.mark.parametrize(
    ("options", "line"),
    [
        ({"controller": "aimm"}, r"--controller aimm: is no controller; did you mean aim\? there are escot, "),
        ({"controller": 3}, r"controller: is 3; give a name, a mvtp\.Controller, or None"),
        ({"zone_radius": 5}, r'coordinate: --zone-radius: is "5"; give a number from 20 to 1000'),
        ({"zone_radios": 50}, r"coordinate: --zone-radios was not expected; did you mean --zone-radius\? see"),
        ({"end": 5, "controler": None}, r"controler: is None; leave it out, or give a value"),
        ({"junction": ["C", "X"]}, r"--junction X: the network has no junction with this id"),
        ({"sumo": ["--seed", "3"]}, r"SUMO option --seed: this program sets it itself"),
    ],
)
def test_bad_options_get_the_line_of_the_command(options, line, crossroads):
    with pytest.raises(mvtp.InputError, match=line) as caught:
        mvtp.Simulation(crossroads, **options)
    assert "\n" not in str(caught.value)


def test_who_and_what_is_not_there_is_bad_input(with_light):
    with mvtp.Simulation(with_light, controller=None, end=40) as simulation:
        simulation.advance(10)
        traffic = simulation.traffic
        for use in (
            lambda: traffic.take_over("x"),
            lambda: traffic.hand_back("x"),
            lambda: traffic.place("x", [0, 0, 0], 1),
            lambda: traffic.cap_speed("x", 1),
            lambda: traffic.route("x"),
            lambda: traffic.type("x"),
            lambda: traffic.limit_speed("x", 1),
            lambda: traffic.show("x", "r"),
        ):
            with pytest.raises(mvtp.InputError, match=r"^(vehicle|type|lane|signal) x: is not "):
                use()
        someone = simulation.vehicles().ids[0]
        lane = simulation.vehicles().lanes[0]
        with pytest.raises(mvtp.InputError, match=f"vehicle {someone}: is not taken over; take_over"):
            traffic.place(someone, [0, 0, 0], 1)
        with pytest.raises(mvtp.InputError, match=r"place: pose \(nan, 0, 0\), speed 1: give finite"):
            traffic.place(someone, [float("nan"), 0, 0], 1)
        for speed in (-1, float("nan"), float("inf")):
            for use in (traffic.cap_speed, traffic.limit_speed):
                with pytest.raises(mvtp.InputError, match=r"speed: is .* m/s; give a finite number >= 0"):
                    use(someone if use == traffic.cap_speed else lane, speed)
        for seconds in (0, -5, float("nan"), float("inf")):
            with pytest.raises(mvtp.InputError, match="seconds: is .*; give a finite number > 0"):
                simulation.advance(seconds)
        assert simulation.time == pytest.approx(10.0)


def test_a_missing_scenario_is_bad_input():
    with pytest.raises(mvtp.InputError, match=r"missing\.sumocfg: "):
        mvtp.Simulation("missing.sumocfg")
