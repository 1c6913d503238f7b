# SPDX-License-Identifier: BSD-3-Clause
"""Robots against formulas of NumPy and SciPy."""
import pickle

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import vernier

ROWS = np.array([[0, -np.pi / 2, 0.29, 0], [0.27, 0, 0, -np.pi / 2], [0.07, -np.pi / 2, 0, 0],
                 [0, np.pi / 2, 0.302, 0], [0, -np.pi / 2, 0, 0], [0, 0, 0.072, np.pi]])


def chain(rows, q, prismatic=(), modified=False):
    """The product of the rows' matrices, as textbooks have it."""
    pose = np.eye(4)
    for i, (a, alpha, d, theta) in enumerate(rows):
        if i in prismatic:
            d = d + q[i]
        else:
            theta = theta + q[i]
        z, x = np.eye(4), np.eye(4)
        z[:3, :3] = Rotation.from_euler("z", theta).as_matrix()
        z[2, 3] = d
        x[:3, :3] = Rotation.from_euler("x", alpha).as_matrix()
        x[0, 3] = a
        pose = pose @ (x @ z if modified else z @ x)
    return pose


def test_poses_are_products_of_rows(robot, joints):
    expected = np.array([chain(ROWS, q) for q in joints])
    np.testing.assert_allclose(robot.fk(joints), expected, atol=1e-14)
    assert np.array_equal(robot.positions(joints), robot.fk(joints)[:, :3, 3])


def test_many_rows_have_the_bits_of_one(robot, joints):
    many = np.tile(joints, (20, 1))  # on several threads
    poses, jacobians = robot.fk(many), robot.jacobian(many)
    for i in (0, 1, 77, 3999):
        assert np.array_equal(poses[i], robot.fk(many[i]))
        assert np.array_equal(jacobians[i], robot.jacobian(many[i]))


def test_jacobians_are_derivatives(robot, joints):
    h = 1e-6
    for q in joints[:20]:
        jacobian = robot.jacobian(q)
        assert jacobian.shape == (6, 6)
        turn = robot.fk(q)[:3, :3]
        for j in range(6):
            step = h * np.eye(6)[j]
            ahead, behind = robot.fk(q + step), robot.fk(q - step)
            np.testing.assert_allclose(jacobian[:3, j], (ahead - behind)[:3, 3] / (2 * h), atol=1e-8)
            spin = Rotation.from_matrix(ahead[:3, :3] @ behind[:3, :3].T).as_rotvec() / (2 * h)
            np.testing.assert_allclose(jacobian[3:, j], spin, atol=1e-8)
        assert turn.shape == (3, 3)


def test_rows_of_a_user(joints):
    mine = vernier.Robot.from_rows("mine", ROWS)
    np.testing.assert_allclose(mine.fk(joints), [chain(ROWS, q) for q in joints], atol=1e-14)
    assert np.isinf(mine.limits).all()
    scara = ROWS[:4].copy()
    limits = [[-1, 1], [-2, 2], [0, 0.3], [-3, 3]]
    types = ["revolute", "revolute", "prismatic", "revolute"]
    q = np.array([[0.3, -1.2, 0.1, 2.0]])
    for modified in (False, True):
        arm = vernier.Robot.from_rows("scara", scara, limits=limits, modified=modified, joint_types=types)
        np.testing.assert_allclose(arm.fk(q)[0], chain(scara, q[0], prismatic=(2,), modified=modified), atol=1e-14)
        assert arm.joint_types == types
        np.testing.assert_array_equal(arm.limits, limits)


def test_frames_of_a_user():
    base, tool = np.eye(4), np.eye(4)
    base[:3, :3] = Rotation.from_rotvec([0.1, 0.2, 0.3]).as_matrix()
    base[:3, 3] = 1, 2, 3
    tool[:3, 3] = 0, 0, 0.1
    arm = vernier.Robot.from_rows("mounted", ROWS, base=base, tool=tool)
    q = np.linspace(-1, 1, 6)
    np.testing.assert_allclose(arm.fk(q), base @ chain(ROWS, q) @ tool, atol=1e-12)


def test_inverse_kinematics_reaches(robot, joints):
    targets = robot.fk(joints)
    found = robot.ik(targets, joints + 0.02)
    assert found.converged.mean() > 0.95  # the others are beside limits or singularities
    np.testing.assert_allclose(robot.fk(found.joints[found.converged]), targets[found.converged], atol=1e-8)
    one = robot.ik(targets[0], joints[0])
    assert one.converged is True and one.status == "converged"
    np.testing.assert_allclose(one.joints, joints[0], atol=1e-7)
    far = robot.fk(joints[0])
    far[:3, 3] = 10, 0, 0
    assert robot.ik(far, joints[0]).converged is False


def test_branches_reach(robot):
    q = np.array([0.3, 0.4, -0.2, 0.5, 0.7, 0.6])
    target = robot.fk(q)
    branches = robot.branches(target)
    assert len(branches) >= 2
    np.testing.assert_allclose(robot.fk(branches.joints), np.broadcast_to(target, (len(branches), 4, 4)), atol=1e-9)
    turns = (branches.joints - q) / (2 * np.pi)
    assert np.abs(turns - np.round(turns)).max(axis=1).min() < 1e-9  # one of them is where we began
    with pytest.raises(ValueError, match="4 joints"):
        vernier.Robot.from_rows("short", ROWS[:4]).branches(np.eye(4))


@pytest.mark.parametrize("name", vernier.Robot.catalogue())
def test_catalogue(name):
    arm = vernier.Robot.load(name)
    assert arm.name == name and f"'{name}'" in repr(arm) and str(arm.joints) in repr(arm)
    assert arm.fk(np.zeros(arm.joints)).shape == (4, 4)


@pytest.mark.parametrize("file", ["six_axis", "seven_axis", "rail", "scara", "fanuc", "palletiser", "positioner"])
def test_files_and_pickles(source, file):
    arm = vernier.Robot.load(source / f"examples/robots/{file}.json")
    again = pickle.loads(pickle.dumps(arm))
    q = np.random.default_rng(1).uniform(-0.3, 0.3, (50, arm.joints))
    assert np.array_equal(again.fk(q), arm.fk(q))
    assert np.array_equal(again.limits, arm.limits) and again.joint_types == arm.joint_types
    assert repr(again) == repr(arm)


def test_controller_joints(source):
    """A FANUC's chain follows -J2 - J3: turning J2 alone keeps the forearm's direction."""
    arm = vernier.Robot.load(source / "examples/robots/fanuc.json")
    at, turned = arm.fk(np.zeros(6)), arm.fk([0, 0.2, 0, 0, 0, 0])
    np.testing.assert_allclose(at[:3, :3], turned[:3, :3], atol=1e-12)
    assert np.linalg.norm(at[:3, 3] - turned[:3, 3]) > 0.05


def test_refusals(robot, tmp_path):
    with pytest.raises(ValueError, match="no robot is called 'nobody'; there are abb_irb120"):
        vernier.Robot.load("nobody")
    bad = tmp_path / "bad.json"
    bad.write_text('{"name": "bad",\n "convention": 7}')
    with pytest.raises(vernier.DataError) as error:
        vernier.Robot.load(bad)
    assert error.value.file == str(bad) and isinstance(error.value, ValueError)
    with pytest.raises(ValueError, match=r"q: an array of shape \(n, 6\) or \(6,\) is expected, not \(2, 5\)"):
        robot.fk(np.zeros((2, 5)))
    with pytest.raises(ValueError, match="q: row 1 has the value nan"):
        robot.fk([[0] * 6, [0, 0, np.nan, 0, 0, 0]])
    with pytest.raises(ValueError, match="real numbers"):
        robot.fk(["a"] * 6)
    with pytest.raises(ValueError, match="real numbers"):
        robot.fk(np.zeros(6, complex))
    with pytest.raises(ValueError, match="T: poses are arrays"):
        robot.ik(np.eye(3), np.zeros(6))
    with pytest.raises(ValueError, match="T: row 0 is no pose"):
        robot.ik(2 * np.eye(4), np.zeros(6))
