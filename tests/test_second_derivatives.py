"""Where smooth peaks lie, and the margin against locking: against differences on the same segments."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import sympy

import gripper as gr
from gripper.assemble import setting
from gripper.contact.kinematics import Kinematics
from gripper.motion.branch import Along, Branch
from gripper.motion.locking import nearness
from gripper.parameters import numbers, replaced
from gripper.sensitivity.jet import jet
from gripper.sensitivity.locking_rates import nearness_rates
from gripper.sensitivity.peaks import Summit
from gripper.sensitivity.seeds import Seeds
from gripper.statics.newton import settle
from gripper_plugins.objects import Circle
from tests.scenes import TAPERED, Q, micro_assembly, rotating_finger

ROUGH, SLIPPERY = gr.Friction(coefficient=0.3), gr.Friction(coefficient=0.2)
QUANTITIES = {
    "insertion_force": "motion_force",
    "retention_force": "motion_force",
    "strain": "max_strain",
    "force_on_object": "force",
}
SMOOTH = {
    "I": (micro_assembly(*np.linspace(0.086, 0.054, 13)), {"retention_force", "strain", "force_on_object"}),
    "I, slipping": (
        micro_assembly(*np.linspace(0.086, 0.054, 7), 0.06, 0.07, friction=ROUGH),
        {"retention_force", "strain"},
    ),
    "II": (rotating_finger(*np.linspace(-0.1016, 0.06, 9)), {"retention_force", "strain", "force_on_object"}),
    "II, slipping": (
        rotating_finger(*np.linspace(-0.1016, 0.06, 9), friction=SLIPPERY),
        {"insertion_force", "strain", "force_on_object"},
    ),
}


def branch_of(scene, extreme):
    """The branch of a scene through a known equilibrium, on its segments cut anew until they end at the contacts."""
    fixed = dataclasses.replace(setting(scene), tolerance=1e-8)  # to round-off
    state, place = extreme.kept.exact.state, extreme.parameter
    grips = [site.grip and dataclasses.replace(site.grip, law=fixed.friction) for site in state.sites]
    sites = tuple(dataclasses.replace(site, grip=grip) for site, grip in zip(state.sites, grips, strict=True))
    kinematics = Kinematics(scene, fixed.sections.length)
    obstacle = fixed.obstacle(kinematics.frame(place))
    start = settle(fixed, obstacle, dataclasses.replace(state, sites=sites), state.beam.order)
    return fixed, Branch(fixed, kinematics, Along(place, start), state.beam.order)


def summit(scene, extreme, name):
    """Where a number of a motion is stationary: secants on its exact slope."""
    fixed, branch = branch_of(scene, extreme)
    seeds = Seeds(scene, fixed, [])
    at, further = extreme.parameter, extreme.parameter + 1e-6
    slope = Summit(seeds, QUANTITIES[name])._read(branch.at(at))[-1]
    for _ in range(5):
        ahead = Summit(seeds, QUANTITIES[name])._read(branch.at(further))[-1]
        at, further, slope = further, further - ahead * (further - at) / (ahead - slope), ahead
        if abs(further - at) < 1e-12:
            break
    return further


@pytest.mark.parametrize("motion", SMOOTH)
def test_where_a_smooth_peak_lies_moves_as_differences_of_exact_slopes_say(motion):
    """By every number: q_p = -f_qp / f_qq, both from differences of f_p and f_q along the motion, of fourth order."""
    scene, names = SMOOTH[motion]
    result = gr.trace(scene)
    found = result.sensitivities()
    keys, step = list(found), 2e-4 * np.ptp(scene.motion.values)
    for name in names:
        extreme = getattr(result.extremes, name)
        fixed, branch = branch_of(scene, extreme)
        place, seeds = summit(scene, extreme, name), Seeds(scene, fixed, keys)
        read = [Summit(seeds, QUANTITIES[name])._read(branch.at(place + n * step)) for n in (-2, -1, 1, 2)]
        slopes = np.einsum("n,np->p", [1, -8, 8, -1], read)
        exact = [found[key].summary[f"{name}_at"] for key in keys]
        differences = -slopes[:-1] / slopes[-1]
        scales = np.array([abs(place) / (abs(numbers(scene)[key]) or 0.1) for key in keys])
        np.testing.assert_array_less(np.abs(exact - differences), 1e-5 * np.abs(differences) + 1e-6 * scales, name)


@pytest.mark.parametrize("motion", ["I", "II"])
def test_it_moves_as_the_place_itself_does(motion):
    scene, names = SMOOTH[motion]
    result, key = gr.trace(scene), "object.pose.y"
    found, value = result.sensitivity(key), numbers(scene)[key]
    step = 1e-3 * value
    for name in names:
        extreme = getattr(result.extremes, name)
        places = [summit(replaced(scene, {key: value + n * step}), extreme, name) for n in (-2, -1, 1, 2)]
        differences = np.dot([1, -8, 8, -1], places) / (12 * step)
        assert found.summary[f"{name}_at"] == pytest.approx(differences, rel=1e-5), name


LOCKING = {
    "I, on the lead face": micro_assembly(*np.linspace(0.086, 0.066, 7), friction=ROUGH),
    "I, where the hook's corner begins to slip back": micro_assembly(
        *np.linspace(0.086, 0.054, 7), 0.06, 0.07, theory="stretch", friction=ROUGH
    ),
}


@pytest.mark.parametrize("motion", LOCKING)
def test_the_locking_margin_has_the_derivatives_of_the_limiting_coefficient(motion):
    scene = LOCKING[motion]
    result = gr.trace(scene)
    extreme, found = result.extremes.locking, result.sensitivities()
    exact = nearness_rates(Seeds(scene, extreme.kept.setting, list(found)), extreme.kept.exact, extreme.value)
    for i, key in enumerate(found):
        value = numbers(scene)[key]
        step, near = 1e-3 * (abs(value) or 0.01), []
        for n in (-2, -1, 1, 2):
            fixed, branch = branch_of(replaced(scene, {key: value + n * step}), extreme)
            at = branch.at(extreme.parameter)
            near.append(min((nearness(fixed, at, way) for way in (1, -1)), key=lambda each: abs(each - extreme.value)))
        differences = np.dot([1, -8, 8, -1], near) / (12 * step)
        assert exact[i] == pytest.approx(differences, rel=1e-5, abs=1e-6 / (abs(value) or 0.01)), key


def test_the_least_margin_moves_with_the_place_where_slip_begins():
    scene, key = LOCKING["I, where the hook's corner begins to slip back"], "object.radius"
    found, value = gr.trace(scene).sensitivity(key).summary, numbers(scene)[key]
    step = 1e-3 * value
    there, back = (gr.trace(replaced(scene, {key: value + h})).summary() for h in (step, -step))
    for name in ("locking_margin", "locking_margin_at"):
        assert found[name] == pytest.approx((getattr(there, name) - getattr(back, name)) / (2 * step), rel=1e-4), name


def test_frames_have_their_rates_of_any_order_also_where_poses_bend():
    pose = {"x": 0.02 + Q**2, "y": sympy.sin(3 * Q), "angle": 0.3 - 2 * Q**3}
    body = Circle(radius=0.01).at(x=Q, y=0.05 * sympy.exp(Q), angle=Q**2)
    kinematics = Kinematics(gr.Scene(finger=TAPERED.at(**pose), object=body, motion=gr.Motion("q", (0.0, 1.0))), 0.2)
    for exact, read in (
        (kinematics.acceleration, lambda q: (kinematics.frame(q).velocity, kinematics.frame(q).spin)),
        (kinematics.jerk, kinematics.acceleration),
    ):
        ahead, behind = (np.array(read(0.4 + h)) for h in (1e-5, -1e-5))
        np.testing.assert_allclose(exact(0.4), (ahead - behind) / 2e-5, rtol=1e-7)


def test_arrays_that_carry_a_rate_obey_the_rules_of_derivatives():
    x = jet(np.array([0.3 + 0.4j, -1.2 + 0.5j]), np.array([1.0, 2.0 - 1.0j]))
    for function in (np.exp, np.conjugate, np.abs, lambda y: y**3, lambda y: (y / (2 + y)).real, np.sum, np.diff):
        exact, (ahead, behind) = function(x).rate, (function(x.value + h * x.rate) for h in (1e-6, -1e-6))
        np.testing.assert_allclose(exact, (ahead - behind) / 2e-6, rtol=1e-8)
    with pytest.raises(TypeError):
        np.cos(x)  # unknown to it: refused instead of dropped
