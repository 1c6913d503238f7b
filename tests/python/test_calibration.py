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


def test_pickles_of_another_version_are_refused(model, robot, measured):
    for kept in (robot, measured):
        version, *values = kept.__getstate__()
        with pytest.raises(ValueError, match="another version"):
            type(kept).__new__(type(kept)).__setstate__((version + 1, *values))
    (text,) = model.__getstate__()
    schema = json.loads(text)["schema_version"]
    later = text.replace(f'"schema_version": {schema}', '"schema_version": 1000')
    with pytest.raises(vernier.DataError, match="version 1000 is unknown"):
        type(model).__new__(type(model)).__setstate__((later,))


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
        vernier.calibrate(robot, measured.rows(np.arange(0, 300, 3)), learners=[])
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.wait(0.001):
        counted += 1
    thread.join()
    assert counted > 20


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
