# SPDX-License-Identifier: BSD-3-Clause
"""Calibrations: the figures of the program, models that keep their bits, and what interrupts and refuses."""
import ctypes
import json
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import vernier


def test_it_is_the_calibration_of_the_program(programs, source, result, tmp_path, model, joints):
    programs("calibrate", "--robot", "abb_irb120", "--data", source / "examples/data/measured.csv", "--test-every", 5,
             "--save", tmp_path / "model.json", "--json", tmp_path / "results.json", "--out", tmp_path, "--date",
             "2026-01-01")
    saved = vernier.load(tmp_path / "model.json")
    assert np.array_equal(saved.fk(joints), model.fk(joints))
    assert np.array_equal(saved.correct(joints).command, model.correct(joints).command)
    theirs = json.loads((tmp_path / "results.json").read_text())
    assert theirs["chosen"] == result.chosen
    assert list(theirs["stages"]) == list(result.stages)
    for key, errors in result.stages.items():
        assert errors.mean() * 1e3 == pytest.approx(theirs["stages"][key]["mean_mm"], rel=1e-12)
        assert errors.max() * 1e3 == pytest.approx(theirs["stages"][key]["max_mm"], rel=1e-12)


def test_results(result, tmp_path):
    assert result.train_poses + result.test_poses == 300 and "Position error of all" in result.verdict
    assert result.stages["frames"].mean() > 10 * result.stages[result.chosen].mean()
    assert len(result.stages["frames"]) == result.test_poses
    assert set(result.rotation_stages) == set(result.stages)
    result.report.save(tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert page == result.report.html and page.lower().startswith("<!doctype html>")
    assert "srcdoc" in result._repr_html_()
    assert result.report.as_dict()["robot"] == "abb_irb120"
    for shown in (result, result.report, result.model):
        assert repr(shown).startswith("<vernier.") and "\n" not in repr(shown)


def test_stages_are_distances_of_the_model(robot, measured, result, model):
    """The deployed stage by NumPy: the model's poses, each approached from the row before, and every fifth row."""
    assert result.chosen == "approach"
    predicted = model.fk(measured.joints, np.vstack([np.full(6, np.nan), measured.joints[:-1]]))
    errors = np.linalg.norm(predicted[:, :3, 3] - measured.positions, axis=1)
    assert errors.mean() < 1.2 * result.stages["approach"].mean()
    held_out = errors[::5]
    mean = result.stages["approach"].mean()
    assert np.isin(np.round(result.stages["approach"], 12), np.round(errors, 12)).mean() > 0.95
    assert held_out.mean() == pytest.approx(mean, rel=0.5)


def test_data_in_arrays_are_data_of_the_file(robot, measured, result):
    again = vernier.Measurements(measured.joints, measured.positions, orientations=measured.orientations)
    fitted = vernier.calibrate(robot, again, test=5, date="2026-01-01")
    for key, errors in result.stages.items():
        np.testing.assert_allclose(fitted.stages[key], errors, rtol=1e-9)


def test_held_out_measurements_and_shares(robot, measured):
    rows = np.arange(len(measured))
    few = dict(learners=[], progress=None)
    by_hand = vernier.calibrate(robot, measured.rows(rows[rows % 5 != 0]), test=measured.rows(rows[rows % 5 == 0]), **few)
    assert by_hand.test_poses == 60
    share = vernier.calibrate(robot, measured, test=0.25, seed=3, **few)
    assert 60 <= share.test_poses <= 90
    for wrong in (1, 0.0, 1.5, "five", None):
        with pytest.raises(ValueError, match="test"):
            vernier.calibrate(robot, measured, test=wrong)


def test_corrections_meet_their_targets(model, joints, robot):
    previous = np.roll(joints, 1, axis=0)
    found = model.correct(joints, previous)
    targets = model.nominal_fk(joints)
    met = found.converged & (found.gate > 0)
    assert met.mean() > 0.8
    np.testing.assert_allclose(model.fk(found.command, previous)[met], targets[met], atol=3e-6)
    before = np.linalg.norm((model.fk(joints, previous) - targets)[:, :3, 3], axis=1)
    assert found.predicted_error[met].max() < 2e-6 < before[met].min()
    by_pose = model.correct(targets, previous, seed=joints)
    np.testing.assert_allclose(by_pose.command[met], found.command[met], atol=1e-9)
    one = model.correct(joints[3], previous[3])
    assert np.array_equal(one.command, found.command[3]) and one.gate[0] == found.gate[3]
    unknown = model.correct(joints, np.full_like(joints, np.nan))
    assert np.array_equal(unknown.command, model.correct(joints).command)


def test_jacobians_and_covariances(model, joints):
    q, h = joints[0], 1e-6
    jacobian = model.jacobian(q)
    for j in range(6):
        step = h * np.eye(6)[j]
        slope = (model.fk(q + step) - model.fk(q - step))[:3, 3] / (2 * h)
        np.testing.assert_allclose(jacobian[:3, j], slope, atol=1e-6)
    covariances = model.covariance(joints[:5])
    assert covariances.shape == (5, 6, 6)
    for covariance in covariances:
        np.testing.assert_allclose(covariance, covariance.T, rtol=1e-9, atol=1e-18)
        assert np.linalg.eigvalsh(covariance).min() > 0
    np.testing.assert_allclose(model.covariance(joints[0]), covariances[0], rtol=1e-9)


def test_paths(model):
    q = np.radians([[-30, 20, 10, 0, 60, -30], [30, 20, 10, 0, 60, 30], [30, 40, -20, 0, 70, 30]])
    calls = []
    path = model.correct_path(q, linear=[False, True, True], tolerance=0.02e-3, progress=calls.append)
    assert path.status[0] == "met" and len(path) > 3 and sum(path.inserted) == len(path) - 3
    assert calls and path.after <= 0.02e-3 < path.before
    ends = [i for i, inserted in enumerate(path.inserted) if not inserted]
    assert [path.target[i] for i in ends] == [0, 1, 2]
    np.testing.assert_allclose(model.fk(path.commands[ends])[:, :3, 3], model.nominal_fk(q)[:, :3, 3], atol=3e-4)
    by_pose = model.correct_path(poses=model.nominal_fk(q), start=q[0])
    np.testing.assert_allclose(by_pose.commands, model.correct_path(q, start=q[0]).commands, atol=1e-9)
    with pytest.raises(ValueError, match="linear: 2 values of 3 rows"):
        model.correct_path(q, linear=[True, False])
    with pytest.raises(ValueError, match="linear: True, False, or one of them a row"):
        model.correct_path(q, linear="yes")
    with pytest.raises(ValueError, match="joints, poses or both"):
        model.correct_path()


def used_elsewhere(arguments):
    """In another process: the bits of a model, a robot and measurements that were sent there."""
    model, robot, measured, joints = arguments
    return model.fk(joints, joints[::-1]), model.correct(joints).command, robot.fk(joints), measured.positions


def test_pickles_keep_their_bits(model, robot, measured, joints, tmp_path):
    here = used_elsewhere((model, robot, measured, joints))
    again = used_elsewhere(pickle.loads(pickle.dumps((model, robot, measured, joints))))
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        there = pool.map(used_elsewhere, [(model, robot, measured, joints)])[0]
    model.save(tmp_path / "model.json")
    saved = used_elsewhere((vernier.load(tmp_path / "model.json"), robot, measured, joints))
    for other in (again, there, saved):
        assert all(np.array_equal(a, b) for a, b in zip(here, other))


def test_measurements(source, robot, measured, tmp_path):
    assert len(measured) == 300 and "300 poses of 6 joints" in repr(measured)
    measured.write(tmp_path / "again.csv", robot)
    again = vernier.Measurements.read(tmp_path / "again.csv", robot)
    assert np.array_equal(again.joints, measured.joints)
    np.testing.assert_allclose(again.positions, measured.positions, atol=1e-12)
    text = (tmp_path / "again.csv").read_text().replace("q1_rad", "A1").replace("x_mm", "X")
    (tmp_path / "other.csv").write_text(text)
    with pytest.raises(vernier.DataError, match="no column q1_rad or q1_deg"):
        vernier.Measurements.read(tmp_path / "other.csv", robot)
    other = vernier.Measurements.read(tmp_path / "other.csv", robot, columns={"q1_rad": "A1", "x_mm": "X"})
    assert np.array_equal(other.joints, again.joints) and np.array_equal(other.positions, again.positions)
    flags = np.arange(300) % 5 == 0
    assert np.array_equal(measured.rows(flags).joints, measured.joints[flags])
    assert np.array_equal(measured.rows([7, 3]).joints, measured.joints[[7, 3]])
    both = measured + vernier.Measurements.from_distances(measured.joints, np.ones(300))
    assert len(both) == 600 and len(both.stations) == 1 and "300 distances" in repr(both)
    covariances = np.tile(np.eye(6) * 1e-10, (300, 1, 1))
    stated = vernier.Measurements(measured.joints, measured.positions, orientations=measured.orientations,
                                  covariances=covariances, times=np.arange(300.0), temperatures=np.full(300, 20.0),
                                  payloads=np.ones((300, 4)))
    assert np.array_equal(pickle.loads(pickle.dumps(stated)).joints, measured.joints)
    from scipy.spatial.transform import Rotation
    matrices = Rotation.from_rotvec(measured.orientations).as_matrix()
    by_matrix = vernier.Measurements(measured.joints, measured.positions, orientations=matrices)
    np.testing.assert_allclose(Rotation.from_rotvec(by_matrix.orientations).as_matrix(), matrices, atol=1e-12)


def test_refusals_of_measurements(measured, robot, tmp_path):
    q, p = measured.joints, measured.positions
    for call, words in [(lambda: vernier.Measurements(q, p[:-1]), "300"),
                        (lambda: vernier.Measurements(q, p[:, :2]), r"positions: an array of shape \(n, 3\)"),
                        (lambda: vernier.Measurements(q, np.where(p == p[4], np.nan, p)), "positions: row 4"),
                        (lambda: vernier.Measurements(q, p, times=np.zeros(7)), "times"),
                        (lambda: vernier.Measurements(q, p, covariances=np.zeros((300, 3, 3))), "positive definite"),
                        (lambda: vernier.Measurements(q, p, orientations=np.zeros((300, 3, 3))), "no rotation"),
                        (lambda: vernier.Measurements.from_distances(q, -np.ones(300)), "lengths: row 0"),
                        (lambda: measured.rows([300]), "row 300 of 300"),
                        (lambda: measured.rows([0.5]), "rows: an array of whole numbers is expected"),
                        (lambda: measured.rows([True, False]), "rows: 2 values of 300 rows")]:
        with pytest.raises(ValueError, match=words):
            call()
    with pytest.raises(ValueError, match="measurements of 5 joints"):
        vernier.calibrate(robot, vernier.Measurements(q[:, :5], p))
    bad = tmp_path / "bad.csv"
    bad.write_text("q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad,x_mm,y_mm,z_mm\n1,2,3,4,5,6,7,8,9\n1,2,3,4,5,6,7,8,x\n")
    with pytest.raises(vernier.DataError) as error:
        vernier.Measurements.read(bad, robot)
    assert error.value.file == str(bad) and error.value.line == 3


def test_failures_have_reasons(measured):
    with pytest.raises(vernier.CalibrationFailure, match="ur10"):
        vernier.calibrate(vernier.Robot.load("ur10"), measured)


def test_progress_is_called_and_may_end_it(robot, measured):
    calls = []
    began = time.monotonic()
    vernier.calibrate(robot, measured, progress=lambda progress: calls.append((time.monotonic(), progress)))
    gaps = np.diff([began] + [when for when, _ in calls])
    assert gaps.max() < 0.5  # 0.1 s, on a machine that does other work as well
    assert calls[-1][1].generation > 0 and "generation" in repr(calls[-1][1])

    class Enough(Exception):
        pass

    def stop(progress):
        raise Enough("no more")

    before = threading.active_count()
    with pytest.raises(Enough, match="no more"):
        vernier.calibrate(robot, measured, progress=stop)
    assert threading.active_count() == before


def test_observers_end_plans_paths_and_simulations(robot, model, joints):
    """An exception of the observer arrives long before the work would be done, and no thread is left."""
    class Enough(Exception):
        pass

    def stop(progress):
        raise Enough

    many = np.tile(joints, (500, 1))
    before = threading.active_count()
    for work in (lambda: vernier.plan(robot, 1000, candidates=20000, progress=stop),
                 lambda: model.correct_path(many, progress=stop), lambda: vernier.simulate(robot, many, progress=stop)):
        began = time.monotonic()
        with pytest.raises(Enough):
            work()
        assert time.monotonic() - began < 1.5  # 0.1 s to the first call, on a machine that does other work as well
    assert threading.active_count() == before


def test_progress_of_plans_and_paths(robot, model, joints):
    calls = []
    path = model.correct_path(joints, progress=calls.append)
    assert len(path) == len(joints) and calls[-1].generation == len(joints) - 1
    vernier.plan(robot, 20, candidates=200, progress=calls.append)
    assert calls[-1].generation == 20


def test_control_c(source):
    """Ctrl-C ends a calibration, in a process of its own."""
    program = ("import sys, vernier\n"
               f"robot = vernier.Robot.load('abb_irb120')\n"
               f"data = vernier.Measurements.read({str(source / 'examples/data/measured.csv')!r}, robot)\n"
               "try:\n"
               "    while True:\n"
               "        print('begins', flush=True)\n"
               "        vernier.calibrate(robot, data)\n"
               "except KeyboardInterrupt:\n"
               "    print('interrupted')\n")
    run = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    assert run.stdout.readline() == "begins\n"
    time.sleep(0.5)
    os.kill(run.pid, signal.SIGINT)
    out, _ = run.communicate(timeout=30)
    assert out.endswith("interrupted\n") and run.returncode == 0


def test_the_interpreter_runs_beside_it(robot, measured):
    counted = 0
    done = threading.Event()

    def work():
        vernier.calibrate(robot, measured, learners=[])
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.wait(0.001):
        counted += 1
    thread.join()
    assert counted > 20


def test_two_stations(robot, measured):
    """The same arm seen from two places: two base frames, one geometry."""
    rows = np.arange(300)
    moved = vernier.Measurements(measured.joints, measured.positions + [1.0, 2.0, 3.0],
                                 orientations=measured.orientations)
    both = measured.rows(rows[::2]) + moved.rows(rows[1::2])
    fitted = vernier.calibrate(robot, both, learners=[])
    assert fitted.stages[fitted.chosen].mean() < 0.1e-3


@pytest.fixture(scope="module")
def reflectors(robot):
    """Three reflectors, each measured at every pose."""
    lower, upper = robot.limits.T
    poses = np.random.default_rng(5).uniform(0.8 * lower, 0.8 * upper, (60, 6))
    return vernier.simulate(robot, poses, seed=4, points=3)


def test_several_reflectors_are_those_of_the_program(programs, robot, reflectors, tmp_path):
    reflectors.write(tmp_path / "three.csv", robot)
    programs("calibrate", "--robot", "abb_irb120", "--data", tmp_path / "three.csv", "--test-every", 5, "--save",
             tmp_path / "model.json", "--json", tmp_path / "results.json", "--out", tmp_path)
    theirs = json.loads((tmp_path / "results.json").read_text())
    read = vernier.Measurements.read(tmp_path / "three.csv", robot)
    assert read.points == reflectors.points and "3 reflectors" in repr(read)
    result = vernier.calibrate(robot, read, test=5)
    assert {key: errors.mean() * 1e3 for key, errors in result.stages.items()} == \
        pytest.approx({key: stage["mean_mm"] for key, stage in theirs["stages"].items()}, rel=1e-12)
    q = reflectors.joints[:30]
    for k, (name, one) in enumerate(result.reflectors.items()):
        saved = vernier.load(tmp_path / ("model.json" if k == 0 else f"model.{k + 1}.json"))
        assert name == theirs["reflectors"][k]["measured"] and repr(one).startswith("<vernier.Reflector: at ")
        assert np.array_equal(saved.correct(q).command, one.model.correct(q).command)
        np.testing.assert_allclose(one.position * 1e3, theirs["reflectors"][k]["offset_mm"], atol=1e-9)
    assert len(result.reflectors) == 3
    assert np.array_equal(result.model.fk(q), next(iter(result.reflectors.values())).model.fk(q))


def test_reflectors_of_arrays(robot, reflectors):
    by_hand = vernier.Measurements(reflectors.joints, reflectors.positions, points=[int(p) for p in reflectors.points])
    assert by_hand.points == reflectors.points == ["1", "2", "3"] * 60
    again = pickle.loads(pickle.dumps(by_hand))
    held_out = np.arange(180) % 15 < 3  # every fifth pose
    few = dict(learners=[])
    result = vernier.calibrate(robot, again.rows(np.flatnonzero(~held_out)), test=by_hand.rows(np.flatnonzero(held_out)),
                               **few)
    assert (result.train_poses, result.test_poses) == (144, 36)
    assert list(result.reflectors) == [f"station 1, point {k}" for k in "123"]
    assert result.stages[result.chosen].mean() < 0.1e-3
    for call, words in [(lambda: vernier.Measurements(reflectors.joints, reflectors.positions, points=["a"]), "1 names of 180"),
                        (lambda: vernier.Measurements(reflectors.joints, reflectors.positions, points="a" * 180),
                         "a name or a number a row"),
                        (lambda: vernier.Measurements(reflectors.joints, reflectors.positions, points=[0.5] * 180),
                         "row 0 is neither"),
                        (lambda: vernier.Measurements(reflectors.joints, reflectors.positions, points=["a"] * 179 + ["b"]),
                         "'b' is measured at 1 pose"),
                        (lambda: vernier.Measurements(reflectors.joints, reflectors.positions, points=reflectors.points,
                                                      orientations=reflectors.positions), "no orientations")]:
        with pytest.raises(ValueError, match=words):
            call()


def test_verify(programs, source, model, robot):
    fresh = vernier.Measurements.read(source / "examples/data/fresh.csv", robot)
    check = vernier.verify(model, fresh)
    assert isinstance(check.valid, bool) and check.verdict in repr(check) and len(check.errors) == len(fresh)
    assert set(check.joints) == set(range(6))


def test_export_c(model, joints, tmp_path):
    """The C file predicts what the model predicts."""
    source = vernier.export_c(model, tmp_path / "arm.h")
    assert (tmp_path / "arm.h").read_text() == source
    subprocess.run(["cc", "-O1", "-shared", "-fPIC", "-DARM_API=", "-x", "c", tmp_path / "arm.h", "-o",
                    tmp_path / "arm.so", "-lm"], check=True)
    library = ctypes.CDLL(str(tmp_path / "arm.so"))
    numbers = ctypes.POINTER(ctypes.c_double)
    library.arm_pose.argtypes = [numbers, numbers, numbers]
    library.arm_pose.restype = None
    for q, previous in zip(joints[:50], joints[1:51]):
        pose = np.empty(12)
        library.arm_pose(*(np.ascontiguousarray(array).ctypes.data_as(numbers) for array in (q, previous)),
                         pose.ctypes.data_as(numbers))
        np.testing.assert_allclose(pose.reshape(3, 4), model.fk(q, previous)[:3], atol=1e-12)
    with pytest.raises(ValueError, match="identifier"):
        vernier.export_c(model, name="no name")


def test_plan_and_simulate(robot):
    plan = vernier.plan(robot, 30, candidates=300, seed=2)
    assert plan.joints.shape == (30, 6) and len(plan) == 30 and plan.relative_error[-1] == pytest.approx(1)
    assert (np.diff(plan.information) > 0).all()
    lower, upper = robot.limits.T
    assert (plan.joints >= lower).all() and (plan.joints <= upper).all()
    assert np.array_equal(vernier.plan(robot, 30, candidates=300, seed=2).joints, plan.joints)
    best = vernier.plan(robot, 10, poses=plan.joints)
    assert np.array_equal(best.joints, plan.joints[best.chosen])
    data = vernier.simulate(robot, plan.path, seed=4)
    assert len(data) == len(plan.visits)
    assert np.array_equal(vernier.simulate(robot, plan.path, seed=4).positions, data.positions)
    quiet = vernier.simulate(robot, plan.path, seed=4, position_noise=0, orientation_noise=0)
    noise = data.positions - quiet.positions
    assert 0.015e-3 < noise.std() < 0.06e-3
    with pytest.raises(ValueError, match="link_radius -1"):
        vernier.plan(robot, 10, link_radius=-1)
    with pytest.raises(ValueError, match="box"):
        vernier.plan(robot, 10, box=[0, 1, 2])
