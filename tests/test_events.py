"""Events are located together with their equilibria, and contacts are handed on, as slower ways find them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from gripper import Friction
from gripper.contact.kinematics import Kinematics
from gripper.motion.branch import Along, Branch
from gripper.motion.pinned import Pin
from gripper.motion.releasing import let_go, pressing
from gripper.statics.active import find
from gripper.statics.certificate import survey
from gripper.statics.handed import handed_on, with_deepest
from gripper.statics.newton import settle, straight
from gripper.statics.settling import settle_contacts
from gripper.statics.steps import predicted
from tests.scenes import follow, micro_assembly

LEAD, APEX, BEHIND = 0.068, 0.060, 0.0525
"""Places of the pin (m): on the lead face, under the jaw's corner, on the return face; it is released at 0.05186."""


def along(place: float, mu: float = 0.0):
    """The setting, the path, and the equilibrium of Example I at a place of the pin."""
    scene = micro_assembly(0.086, place, friction=Friction(coefficient=mu) if mu else None)
    *_, last = follow(scene)
    return last.setting, Kinematics(scene, last.length), Along(place, last.equilibrium)


def assert_equilibrium(setting, path, where: float, found, order: int) -> None:
    """Newton's method at that parameter, from there, stays there."""
    there = settle(setting, setting.obstacle(path.frame(where)), found.state, order)
    assert there.state.z == pytest.approx(found.state.z, rel=0, abs=1e-9 * np.linalg.norm(found.state.z) + 1e-12)


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_a_contact_lets_go_where_its_multiplier_is_zero_on_the_branch(mu):
    setting, path, known = along(BEHIND, mu)
    order = known.equilibrium.state.beam.order
    branch, other = Branch(setting, path, known, order), Branch(setting, path, known, order)
    where = let_go(branch, 0, BEHIND, 0.0515)
    assert where == pytest.approx(brentq(lambda q: pressing(other.at(q), 0), BEHIND, 0.0515, xtol=1e-14), abs=1e-11)
    assert abs(pressing(branch.at(where), 0)) < 1e-12
    assert_equilibrium(setting, path, where, branch.at(where), order)


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_a_contact_reaches_the_end_of_its_edge_where_its_place_says_so(mu):
    setting, path, known = along(LEAD, mu)
    order, (site,) = known.equilibrium.state.beam.order, known.equilibrium.state.sites
    end = (
        0.0
        if site.place[0] < setting.outline.pieces[site.piece].length / 2
        else setting.outline.pieces[site.piece].length
    )
    branch, other = Branch(setting, path, known, order), Branch(setting, path, known, order)
    where = branch.pinned(LEAD, Pin(1, end), (LEAD, 0.062))
    short = end + 1e-6 * (site.place[0] - end)
    before = brentq(lambda q: other.at(q).state.sites[0].place[0] - short, LEAD, where, xtol=1e-14)
    assert branch.at(where).state.sites[0].place == (pytest.approx(end, abs=1e-12),)
    assert 0 < (before - where) / (LEAD - where) < 1e-5
    assert_equilibrium(setting, path, where, branch.at(where), order)


STEPS = {
    "off the lead edge, on to its corner": (0.0655, 0.0643),
    "off the corner, on to the return edge": (0.0535, 0.0528),
}


@pytest.mark.parametrize("step", STEPS)
def test_contacts_that_a_step_changes_are_those_that_slsqp_finds(step):
    start, stop = STEPS[step]
    setting, path, known = along(start)
    order, obstacle = known.equilibrium.state.beam.order, setting.obstacle(path.frame(stop))
    guess = predicted(setting, known.equilibrium, stop - start)
    handed = handed_on(setting, obstacle, guess)
    found, other = settle_contacts(setting, obstacle, handed, order), find(setting, obstacle, guess, order).equilibrium
    assert [(site.kind, site.piece) for site in handed.sites] != [(site.kind, site.piece) for site in guess.sites]
    assert [(s.kind, s.piece) for s in found.state.sites] == [(s.kind, s.piece) for s in other.state.sites]
    assert abs(found.force - other.force) <= 1e-8 * abs(other.force)


def test_a_contact_that_would_have_to_pull_lets_go():
    setting, path, known = along(BEHIND)
    obstacle = setting.obstacle(path.frame(0.0515))
    handed = handed_on(setting, obstacle, predicted(setting, known.equilibrium, 0.0515 - BEHIND))
    assert handed.sites == () and handed.multipliers.size == 0


def test_a_place_that_has_sunk_in_is_the_contact_that_slsqp_finds():
    setting, path, known = along(LEAD)
    order, obstacle = known.equilibrium.state.beam.order, setting.obstacle(path.frame(LEAD))
    free = straight(setting, order)
    seen = survey(setting, obstacle, free, brief=True)
    found = with_deepest(setting, obstacle, free, seen, order).equilibrium
    assert found.state.sites[0].place == pytest.approx(known.equilibrium.state.sites[0].place, abs=1e-9)
    assert found.force == pytest.approx(find(setting, obstacle, free, order, seen).equilibrium.force, rel=1e-8)
