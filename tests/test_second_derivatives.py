"""Where smooth peaks lie: against differences of where the exact slope vanishes, on the same segments."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import gripper as gr
from gripper.assemble import setting
from gripper.contact.kinematics import Kinematics
from gripper.motion.branch import Along, Branch
from gripper.parameters import numbers, replaced
from gripper.sensitivity.jet import jet
from gripper.sensitivity.peaks import Summit
from gripper.sensitivity.seeds import Seeds
from gripper.statics.newton import settle
from tests.scenes import micro_assembly, rotating_finger

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


def test_arrays_that_carry_a_rate_obey_the_rules_of_derivatives():
    x = jet(np.array([0.3 + 0.4j, -1.2 + 0.5j]), np.array([1.0, 2.0 - 1.0j]))
    for function in (np.exp, np.conjugate, np.abs, lambda y: y**3, lambda y: (y / (2 + y)).real, np.sum, np.diff):
        exact, (ahead, behind) = function(x).rate, (function(x.value + h * x.rate) for h in (1e-6, -1e-6))
        np.testing.assert_allclose(exact, (ahead - behind) / 2e-6, rtol=1e-8)
    with pytest.raises(TypeError):
        np.cos(x)  # unknown to it: refused instead of dropped
