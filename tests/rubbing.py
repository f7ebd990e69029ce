"""What every motion with friction obeys: Coulomb's law at each pose, energy on each step."""

from __future__ import annotations

import itertools

import numpy as np
import pytest


def force(pose):
    return np.array(pose.force_on_object_finger_frame)


def off(pose, expected):
    """Error of the force vector, relative."""
    return float(np.linalg.norm(force(pose) - expected) / np.linalg.norm(expected))


def at(result, parameter, which=0):
    """The pose at a value of the parameter, the first or a later one."""
    return [p for p in result.poses if abs(p.parameter - parameter) < 1e-12][which]


def check_coulomb(pose, mu):
    """The force is the contacts', friction is across the normal, and mu N in slip, less in stick."""
    total = np.zeros(2)
    for contact in pose.contacts:
        n, N, T = np.array(contact.normal), contact.normal_force, contact.tangential_force
        assert np.linalg.norm(n) == pytest.approx(1, abs=1e-10)
        bound = mu(contact)
        if contact.state == "slip":
            assert abs(T) == pytest.approx(bound * N, rel=1e-8)
        else:
            assert contact.state == "stick"
            assert abs(T) <= bound * N * (1 + 1e-8)
        total -= N * n
    if len(pose.contacts) == 1:
        friction = np.array(pose.force_on_object) - total
        assert abs(friction @ n) <= 1e-10 * N * max(bound * N, 1e-12) + 1e-12 * N
        assert np.linalg.norm(friction) == pytest.approx(abs(T), rel=1e-8, abs=1e-12 * N)


def balance(poses):
    """Work less dissipation less stored energy of each step, relative to the step's energies."""
    out = []
    for one, other in itertools.pairwise(poses):
        work, loss, stored = (getattr(other, n) - getattr(one, n) for n in ("work", "dissipation", "energy"))
        assert loss >= 0
        size = max(abs(work), loss, abs(stored))
        if size > 1e-9:
            out.append(abs(work - loss - stored) / size)
    return np.array(out)
