# SPDX-License-Identifier: BSD-3-Clause
"""Measurements: what they hold and refuse, and calibrations of parts of them, of two stations and of several reflectors."""
import json
import pickle

import numpy as np
import pytest

import vernier


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


def test_held_out_measurements_and_shares(robot, measured):
    some = measured.rows(np.arange(0, 300, 3))
    rows = np.arange(len(some))
    few = dict(learners=[], progress=None)
    by_hand = vernier.calibrate(robot, some.rows(rows[rows % 5 != 0]), test=some.rows(rows[rows % 5 == 0]), **few)
    assert by_hand.test_poses == 20
    share = vernier.calibrate(robot, some, test=0.25, seed=3, **few)
    assert 20 <= share.test_poses <= 30
    for wrong in (1, 0.0, 1.5, "five", None):
        with pytest.raises(ValueError, match="test"):
            vernier.calibrate(robot, measured, test=wrong)


def test_two_stations(robot, measured):
    """The same arm seen from two places: two base frames, one geometry."""
    measured = measured.rows(np.arange(0, 300, 2))
    rows = np.arange(len(measured))
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
