# SPDX-License-Identifier: BSD-3-Clause
"""How arrays are read: in place where they are contiguous, with the same bits otherwise."""
import gc
import resource

import numpy as np
import pytest

import vernier
from vernier import _vernier


def reads(call):
    """Arrays that a call reads in place, and those that it converts."""
    before = _vernier._array_reads()
    call()
    return tuple(now - then for now, then in zip(_vernier._array_reads(), before))


def test_contiguous_arrays_are_read_in_place(robot, joints):
    assert reads(lambda: robot.fk(joints)) == (1, 0)
    assert reads(lambda: robot.fk(joints[3])) == (1, 0)
    assert reads(lambda: robot.fk(joints[10:20])) == (1, 0)
    read_only = joints.copy()
    read_only.flags.writeable = False
    assert reads(lambda: robot.fk(read_only)) == (1, 0)


@pytest.mark.parametrize("other", [lambda q: np.asfortranarray(q), lambda q: np.repeat(q, 2, axis=0)[::2],
                                   lambda q: q.tolist(), lambda q: q.astype(">f8"), lambda q: q[:, ::-1][:, ::-1]])
def test_others_are_converted_to_the_same_bits(robot, joints, other):
    given = other(joints)
    if reads(lambda: robot.fk(given)) == (1, 0):  # NumPy made it contiguous
        assert given.flags.c_contiguous
    else:
        assert reads(lambda: robot.fk(given)) == (0, 1)
    assert np.array_equal(robot.fk(given), robot.fk(joints))


def test_single_precision_and_integers(robot, joints):
    assert np.array_equal(robot.fk(joints.astype(np.float32)), robot.fk(joints.astype(np.float32).astype(float)))
    assert np.array_equal(robot.fk(np.ones(6, int)), robot.fk(np.ones(6)))


def test_results_own_their_memory(robot, joints):
    given = joints.copy()
    poses = robot.fk(given)
    kept = poses.copy()
    given[:] = 0
    del given
    gc.collect()
    assert poses.flags.owndata and poses.flags.writeable and np.array_equal(poses, kept)


def test_masked_arrays_are_refused(robot, joints):
    with pytest.raises(ValueError, match="q: a masked array is not read"):
        robot.fk(np.ma.masked_greater(joints, 1))
    assert np.array_equal(robot.fk(joints.view(np.matrix)), robot.fk(joints))


def test_no_rows(robot):
    assert robot.fk(np.zeros((0, 6))).shape == (0, 4, 4)
    assert robot.jacobian(np.zeros((0, 6))).shape == (0, 6, 6)


def test_memory_stays(robot, joints, measured):
    """10,000 calls, those that are refused among them."""
    model = vernier.calibrate(robot, measured.rows(np.arange(0, 300, 4)), learners=[]).model

    def calls(n):
        for _ in range(n):
            robot.fk(joints)
            robot.fk(joints.T.copy().T)
            model.correct(joints[:2], joints[:2])
            repr(robot)
            try:
                robot.fk(joints[:, :5])
            except ValueError:
                pass

    calls(200)
    gc.collect()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    calls(2000)  # five calls each
    gc.collect()
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 4096  # kB
