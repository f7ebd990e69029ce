"""Strains to shape: the energy is exact, the shape is the integral, and closed forms come out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

import gripper as gr
from gripper.beam.axis import Axis
from gripper.beam.sections import sections
from gripper.beam.strains import Beam
from tests.scenes import EXACT, RUBBER, TAPERED, unit_finger

GAUSS, WEIGHTS = np.polynomial.legendre.leggauss(48)
THICK, UNIFORM = sections(TAPERED), sections(unit_finger())
SEGMENTS = [(0.0, 1.0), (0.0, 0.61, 1.0), (0.0, 0.3, 0.37, 0.9, 1.0)]
BEAMS = [
    Beam(profile, breaks, order, theory)
    for profile in (THICK, UNIFORM)
    for breaks in SEGMENTS
    for order, theory in ((0, "shear"), (4, "bending"), (6, "shear"), (5, "stretch"))
]
beams = st.sampled_from(BEAMS)
seeds = st.integers(0, 2**32 - 1)


def random_unknowns(beam: Beam, seed: int, size: float = 1.0) -> np.ndarray:
    z = np.random.default_rng(seed).normal(size=beam.size)
    return size * z / np.linalg.norm(z)


def quadrature(beam: Beam, start: float, stop: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stations, weights and segments that integrate piecewise smooth fields over [start, stop]."""
    marks = np.union1d([start, stop], [b for b in beam.breaks if start < b < stop])
    half = np.diff(marks)[:, None] / 2
    s = (marks[:-1, None] + half * (GAUSS + 1)).ravel()
    return s, (half * WEIGHTS).ravel(), beam.segment_of(s)


def fields(beam: Beam, z: np.ndarray, s: np.ndarray, segment: np.ndarray) -> np.ndarray:
    """Kappa, gamma and eps: those that the theory leaves out are 0."""
    strains = np.zeros((3, s.size))
    strains[: beam.fields] = beam.strains(z, s, segment)
    return strains


def direction(theory: str, psi: np.ndarray, gamma: np.ndarray, eps: np.ndarray) -> np.ndarray:
    """r' as it is defined: x' = cos(psi + gamma), or (1 + eps) cos psi - gamma sin psi with stretch."""
    if theory != "stretch":
        return np.cos(psi + gamma) + 1j * np.sin(psi + gamma)
    x = (1 + eps) * np.cos(psi) - gamma * np.sin(psi)
    return x + 1j * ((1 + eps) * np.sin(psi) + gamma * np.cos(psi))


def values(beam: Beam, z: np.ndarray, s: np.ndarray, *, left: bool = False) -> tuple[np.ndarray, ...]:
    return Axis.of(beam, z).values(s, beam.segment_of(s, left=left))


@given(beam=beams, seed=seeds)
@settings(deadline=None)
def test_the_energy_is_half_the_square_of_the_unknowns(beam: Beam, seed: int) -> None:
    z = random_unknowns(beam, seed)
    s, weights, segment = quadrature(beam, 0, 1)
    stiffness = beam.sections.EI(s), beam.sections.GA(s), beam.sections.EA(s)
    energy = sum(weights @ (k * field**2) for k, field in zip(stiffness, fields(beam, z, s, segment), strict=True)) / 2
    assert z @ z / 2 == pytest.approx(energy, rel=1e-12)


@given(beam=beams, seed=seeds, stop=st.floats(0.01, 1))
@settings(deadline=None)
def test_the_shape_is_the_integral_of_the_strains(beam: Beam, seed: int, stop: float) -> None:
    modes = np.tile(np.arange(beam.modes), beam.segments * beam.fields)
    z = random_unknowns(beam, seed) / 3.0**modes  # fields as smooth as those of a finger
    s, weights, segment = quadrature(beam, 0, stop)
    position, psi, along, kappa = values(beam, z, np.array([stop]))
    assert psi[0] == pytest.approx(weights @ fields(beam, z, s, segment)[0], abs=1e-12)
    turn, *strains = fields(beam, z, np.array([stop]), beam.segment_of(np.array([stop])))
    assert kappa[0] == pytest.approx(turn[0], abs=1e-12)
    assert along == pytest.approx(direction(beam.theory, psi, *strains), abs=1e-12)
    assert abs(position[0] - weights @ values(beam, z, s)[2]) < 1e-9


@given(beam=beams, seed=seeds)
@settings(deadline=None)
def test_rows_are_the_values_linear_maps(beam: Beam, seed: int) -> None:
    z, s = random_unknowns(beam, seed), np.linspace(0, 1, 23)
    axis, segment = Axis.of(beam, z), beam.segment_of(s)
    rows = beam.rows(s, segment)
    position, psi, along, kappa = axis.values(s, segment)
    for map_, value in zip(rows.strains[[0, 2]], (psi, kappa), strict=True):
        assert map_ @ z == pytest.approx(value, abs=1e-12)
    eps = rows.strains[5] @ z if beam.stretches else 0 * s
    assert along == pytest.approx(direction(beam.theory, psi, rows.strains[1] @ z, eps), abs=1e-12)
    assert rows.position @ axis.direction == pytest.approx(position, abs=1e-12)
    assert axis.direction == pytest.approx(axis.values(beam.gauss, beam.segment_of(beam.gauss))[2], abs=1e-12)


@given(beam=beams, seed=seeds)
@settings(deadline=None)
def test_position_and_rotation_do_not_jump_where_segments_meet(beam: Beam, seed: int) -> None:
    z, inner = random_unknowns(beam, seed), np.array(beam.breaks[1:-1])
    before, after = values(beam, z, inner, left=True), values(beam, z, inner)
    assert before[0] == pytest.approx(after[0], abs=1e-13)
    assert before[1] == pytest.approx(after[1], abs=1e-13)


@given(seed=seeds, breaks=st.sampled_from(SEGMENTS), profile=st.sampled_from([THICK, UNIFORM]))
@settings(deadline=None)
def test_order_zero_is_a_chain_of_circular_arcs(seed: int, breaks: tuple[float, ...], profile: object) -> None:
    beam = Beam(profile, breaks, 0, "shear")
    z = random_unknowns(beam, seed)
    kappa, gamma = beam.coefficients(z)[:, :, 0]
    ds = np.diff(breaks)
    psi = np.concatenate([[0.0], np.cumsum(kappa * ds)])
    middle = psi[:-1] + kappa * ds / 2 + gamma
    chords = ds * np.sinc(kappa * ds / (2 * np.pi)) * np.exp(1j * middle)  # numpy's sinc(x) is sin(pi x) / (pi x)
    position, rotation, *_ = values(beam, z, np.array(breaks), left=True)
    assert position == pytest.approx(np.concatenate([[0], np.cumsum(chords)]), abs=1e-12)
    assert rotation == pytest.approx(psi, abs=1e-12)


@given(beam=beams, seed=seeds)
@settings(deadline=None)
def test_coefficients_and_unknowns_are_each_other_s_inverse(beam: Beam, seed: int) -> None:
    z = random_unknowns(beam, seed)
    assert beam.unknowns(beam.coefficients(z)) == pytest.approx(z, abs=1e-12)


@given(beam=beams, seed=seeds)
@settings(deadline=None)
def test_a_beam_of_higher_order_holds_the_very_fields_of_a_lower_one(beam: Beam, seed: int) -> None:
    finer = Beam(beam.sections, beam.breaks, beam.order + 2, beam.theory)
    z, s = random_unknowns(beam, seed), np.linspace(0, 1, 33)
    embedded, segment = finer.embed(beam, z), beam.segment_of(s)
    assert finer.strains(embedded, s, segment) == pytest.approx(beam.strains(z, s, segment), abs=1e-10)
    assert embedded @ embedded == pytest.approx(z @ z, rel=1e-12)


@given(beam=beams, seed=seeds, marks=st.lists(st.floats(0.05, 0.95), max_size=3, unique_by=lambda s: round(s, 1)))
@settings(deadline=None)
def test_fields_that_are_polynomials_all_along_survive_other_segments(
    beam: Beam, seed: int, marks: list[float]
) -> None:
    whole = Beam(beam.sections, (0.0, 1.0), beam.order, beam.theory)
    z, s = random_unknowns(whole, seed), np.linspace(0, 1, 33)
    other = Beam(beam.sections, (0.0, *sorted(marks), 1.0), beam.order, beam.theory)
    expected = whole.strains(z, s, whole.segment_of(s))
    for found, cut in ((beam.project(whole, z), beam), (other.project(beam, beam.project(whole, z)), other)):
        assert cut.strains(found, s, cut.segment_of(s)) == pytest.approx(expected, abs=1e-8)
        assert found @ found == pytest.approx(z @ z, rel=1e-9)


@given(seed=seeds, moves=st.lists(st.floats(-1, 1), min_size=2, max_size=2))
@settings(deadline=None)
def test_segments_that_move_leave_the_shape_of_the_strains_to_second_order(seed: int, moves: list[float]) -> None:
    old = Beam(THICK, (0.0, 0.3, 0.7, 1.0), 5, "shear")
    z, h, way = random_unknowns(old, seed), 1e-5, np.array([0.0, *moves, 0.0])
    new = Beam(THICK, tuple((np.array(old.breaks) + h * way).tolist()), 5, "shear")
    carried = new.unknowns(old.coefficients(z) + old.convection(old.coefficients(z), h * way))
    for segment in range(3):
        s = np.linspace(old.breaks[segment], old.breaks[segment + 1], 9)[1:-1]
        each = np.full(s.size, segment)
        there, here = new.strains(carried, s, each), old.strains(z, s, each)
        assert there == pytest.approx(here, abs=2e-6 * np.abs(old.coefficients(z)).max())  # first order: 1e-3


@given(beam=beams, seed=seeds)
@settings(deadline=None)
def test_no_strain_changes_faster_than_its_bound(beam: Beam, seed: int) -> None:
    z = random_unknowns(beam, seed)
    bounds = beam.slope_bounds(beam.coefficients(z))
    for segment in range(beam.segments):
        s, h = np.linspace(*beam.breaks[segment : segment + 2], 60), 1e-7
        inner, each = s[1:-1], np.full(58, segment)
        change = (beam.strains(z, inner + h, each) - beam.strains(z, inner - h, each)) / (2 * h)
        slopes = (beam.rows(inner, each).strains @ z)[[3, 4, 6] if beam.stretches else [3, 4]][: beam.fields]
        assert slopes == pytest.approx(change, abs=1e-5 * max(1.0, np.abs(change).max()))
        assert np.abs(slopes[0]).max() <= bounds[0, segment] * (1 + 1e-12) + 1e-12
        assert np.abs(slopes[1:]).sum(axis=0).max(initial=0.0) <= bounds[1, segment] * (1 + 1e-12) + 1e-12


@given(beam=beams, seed=seeds, size=st.floats(0.01, 1.0))
@settings(deadline=None)
def test_no_axis_is_faster_or_slower_than_its_bounds(beam: Beam, seed: int, size: float) -> None:
    z, s = random_unknowns(beam, seed, size), np.linspace(0, 1, 201)
    speed, segment = np.abs(values(beam, z, s)[2]), beam.segment_of(s)
    slowest, fastest = beam.speed_bounds(beam.coefficients(z))
    assert (slowest[segment] - 1e-12 <= speed).all() and (speed <= fastest[segment] + 1e-12).all()


def cantilever(finger: gr.Finger, force: float, theory: str, order: int = 14) -> tuple[complex, float, float]:
    """Tip, its rotation and the root's curvature under a dead force across the undeflected tip: min V - P y."""
    profile = sections(finger)
    beam = Beam(profile, (0.0, 0.5, 1.0), order, theory)
    tip, load = beam.rows(np.ones(1), np.array([1])), force / profile.force_scale
    weights = tip.position[0]

    def energy(z: np.ndarray) -> tuple[float, np.ndarray]:
        axis = Axis.of(beam, z)
        return z @ z / 2 - load * weights @ axis.direction.imag, z - load * weights @ axis.turning.imag

    def hessian(z: np.ndarray) -> np.ndarray:
        return np.eye(beam.size) - Axis.of(beam, z).second_derivative(1j * load * weights)

    start = np.zeros(beam.size)
    answer = minimize(energy, start, jac=True, hess=hessian, method="trust-exact", options={"gtol": 1e-11})
    z = answer.x
    for _ in range(3):
        z = z - np.linalg.solve(hessian(z), energy(z)[1])
    position, psi, *_ = values(beam, z, np.ones(1))
    return complex(position[0]), float(psi[0]), float(values(beam, z, np.zeros(1))[3][0])


@pytest.mark.parametrize(
    "row", EXACT["cantilever, dead tip load (Bisshopp & Drucker 1945; digits by elliptic integrals, "
                 "agreeing with Mattiasson 1981)"]["rows"], ids=lambda row: f"P = {row[0]}",
)  # fmt: skip
def test_the_cantilever_under_a_dead_load_is_the_elastica(row: list[float]) -> None:
    load, deflection, shortening, slope, curvature = row
    tip, rotation, root = cantilever(unit_finger(), load, "bending")
    assert (tip.imag, 1 - tip.real, rotation, root) == pytest.approx((deflection, shortening, slope, curvature), 1e-5)


@pytest.mark.parametrize(
    "row", EXACT["cantilever with shear, EI = 10, L = 1, P = 10: Reissner beam with EA = infinity "
                 "(Batista 2016, IJSS 87) and the inextensible model"]["rows"], ids=lambda row: f"GA = {row[0]}",
)  # fmt: skip
def test_the_cantilever_with_shear_is_the_inextensible_model_s(row: list[float]) -> None:
    GA, _, _, shortening, deflection = row
    material = gr.Material(youngs_modulus=120 / 0.1**3, poisson_ratio=0.3)
    G = GA / (material.shear_coefficient * 0.1)
    finger = unit_finger(0.1, material=replace(material, shear_modulus=G))
    assert sections(finger).GA(np.zeros(1)) * sections(finger).force_scale == pytest.approx(GA)
    tip, *_ = cantilever(finger, 10.0, "shear")
    assert (1 - tip.real, tip.imag) == pytest.approx((shortening, deflection), 1e-5)


@pytest.mark.parametrize(
    "row", EXACT["cantilever with shear, EI = 10, L = 1, P = 10: Reissner beam with EA = infinity "
                 "(Batista 2016, IJSS 87) and the inextensible model"]["rows"], ids=lambda row: f"GA = {row[0]}",
)  # fmt: skip
def test_the_cantilever_with_stretch_is_reissner_s_as_its_axial_stiffness_grows(row: list[float]) -> None:
    """Batista's table: the tip of a finger of EA = 12 EI / w^2 lies off it by c / EA, so two of them give the limit."""
    GA, shortening, deflection, *_ = row
    tips = []
    for w in (0.02, 0.01):
        material = gr.Material(youngs_modulus=120 / w**3, poisson_ratio=0.3)
        material = replace(material, shear_modulus=GA / (material.shear_coefficient * w))
        tips.append(cantilever(unit_finger(w, material=material), 10.0, "stretch")[0])
    limit = tips[1] + (tips[1] - tips[0]) / 3  # EA grows by a factor of 4
    assert (1 - limit.real, limit.imag) == pytest.approx((shortening, deflection), abs=1e-6)


@pytest.mark.parametrize("w", [0.05, 0.2])
def test_a_finger_pulled_along_its_axis_is_longer_by_P_over_EA(w: float) -> None:
    """Not bent; the load's place has no part in it: a column of Hooke."""
    profile = sections(unit_finger(w))
    beam = Beam(profile, (0.0, 0.5, 1.0), 3, "stretch")
    pull = 2.0
    weights, z = beam.rows(np.ones(1), np.array([1])).position[0], np.zeros(beam.size)
    for _ in range(3):
        axis = Axis.of(beam, z)
        hessian = np.eye(beam.size) - axis.second_derivative(pull * weights + 0j)
        z = z - np.linalg.solve(hessian, z - pull * weights @ axis.turning.real)
    assert values(beam, z, np.ones(1))[0][0] == pytest.approx(1 + pull * w**2 / 12, abs=1e-12)


def test_whitening_holds_for_profiles_that_no_quadrature_integrates_exactly() -> None:
    wide = replace(TAPERED, width=gr.fingers.S * 0.1 + 0.01, material=RUBBER)
    beam = Beam(sections(wide), (0.0, 0.4, 1.0), 6, "shear")
    z = random_unknowns(beam, 0)
    s, weights, segment = quadrature(beam, 0, 1)
    kappa, gamma, _ = fields(beam, z, s, segment)
    assert z @ z == pytest.approx(weights @ (beam.sections.EI(s) * kappa**2 + beam.sections.GA(s) * gamma**2))
