"""The numbers of a motion: peaks located between its poses, work, margins."""

import dataclasses
import json

import numpy as np
import pytest

import gripper as gr
from gallery import optimal_hook
from gripper.parameters import replaced
from gripper.result import PoseResult
from gripper.results.summary import QUANTITIES
from gripper_plugins.fingers.tapered import Tapered
from gripper_plugins.objects.circle import Circle
from tests.scenes import Q, micro_assembly, rotating_finger, unit_finger


def way(first, last, poses, back=False):
    return gr.Motion.between("q", first, last, poses, back=back).values


def hook(poses, mu=0.0, back=False, **options):
    friction = gr.Friction(coefficient=mu, **options) if mu else None
    return micro_assembly(*way(0.086, 0.050, poses, back), friction=friction)


CASES = {
    "hook": hook,
    "hook, rough, there and back": lambda poses: hook(poses, 0.2, back=True),
    "hook, published": lambda poses: hook(poses, 0.2, model="published", sense="tipward"),
    "rubber": lambda poses: rotating_finger(*way(-0.1016, 0.2032, poses)),
}


@pytest.fixture(scope="module", params=CASES)
def both(request):
    """A motion in few poses, and in many."""
    return tuple(gr.trace(CASES[request.param](poses)) for poses in (8, 33))


def test_no_number_depends_on_how_many_poses_there_are(both):
    few, many = (result.summary() for result in both)
    for name in QUANTITIES:
        one, other = getattr(few, name), getattr(many, name)
        tight = 2e-4 if name in ("work_in", "work_out", "dissipation") else 1e-5
        assert one == other or one == pytest.approx(other, rel=tight, abs=1e-9), name


def test_a_peak_where_contacts_change_within_a_step_is_found_though_both_ends_lie_far_below():
    """The hook of gallery/optimal_hook.py needs most where its lead face ends, and nearly as much in the last pose."""
    found = [0.0052101662, 0.0616943861, 0.0698131701, 1.5358897418]
    scene = replaced(optimal_hook.scene, dict(zip(optimal_hook.FREE, found, strict=True)))
    coarse = gr.trace(scene)
    change = next(event for event in coarse.events if event.detail == "jaw to corner of jaw")
    motion = gr.Motion("x_o", (0.1, 0.08, change.parameter + 1e-8, change.parameter - 1e-8))
    beside = [-pose.motion_force for pose in gr.trace(dataclasses.replace(scene, motion=motion)).poses[2:]]
    assert coarse.summary().insertion_force == pytest.approx(max(beside), rel=1e-5)
    assert coarse.summary().insertion_force_at == pytest.approx(change.parameter, abs=1e-8)
    assert max(-pose.motion_force for pose in coarse.poses) < 0.98 * max(beside)


def test_no_pose_exceeds_a_peak(both):
    result = both[1]
    summary, poses = result.summary(), result.poses
    assert max(np.hypot(*pose.force_on_object) for pose in poses) <= summary.force_on_object * (1 + 1e-6)
    assert max(pose.max_strain for pose in poses) <= summary.strain * (1 + 1e-6)
    heading = np.sign(poses[1].parameter - poses[0].parameter)
    there = max(heading * pose.motion_force for pose in poses[:33])
    assert 0.9 * summary.insertion_force <= there <= summary.insertion_force * (1 + 1e-6)


@pytest.mark.parametrize(("name", "short"), [("insertion_force", 3e-4), ("force_on_object", 3e-4), ("strain", 3e-4)])
def test_the_pose_at_a_peak_has_it_and_its_neighbours_have_less(name, short):
    summary = gr.trace(hook(8)).summary()
    place = summary.place(name)
    beside = gr.trace(micro_assembly(0.086, 0.07, place + short, place, place - short)).poses[-3:]
    of = {"insertion_force": lambda p: -p.motion_force, "strain": lambda p: p.max_strain}
    left, top, right = (of.get(name, lambda p: np.hypot(*p.force_on_object))(pose) for pose in beside)
    assert top == pytest.approx(getattr(summary, name), rel=1e-6)
    assert max(left, right) < top


def test_without_friction_the_work_put_in_is_the_largest_energy_and_all_of_it_comes_back():
    few = gr.trace(hook(8)).summary()
    most = max(pose.energy for pose in gr.trace(hook(65)).poses)
    assert most <= few.work_in <= 1.002 * most
    assert few.work_out == pytest.approx(few.work_in, rel=1e-9)
    assert few.dissipation == pytest.approx(0, abs=1e-12)


def test_without_friction_the_way_back_of_a_motion_is_known_from_the_way_there():
    there, back = gr.trace(hook(8)).summary(), gr.trace(hook(8, back=True)).summary()
    assert there.retention_force == pytest.approx(back.retention_force, rel=1e-7)
    assert there.retention_force_at == pytest.approx(back.retention_force_at, abs=1e-5)


def test_a_snap_loses_the_energy_that_the_finger_had():
    snapping = Circle(radius=0.2).at(x=0.95, y=Q)  # the tip's corner slides up its side until a fold at 0.645569
    values = (-0.25, 0.2, 0.645, 0.7)
    scene = gr.Scene(finger=unit_finger(), object=snapping, motion=gr.Motion("q", values), theory="shear")
    result = gr.trace(scene)
    summary = result.summary()
    assert [event.kind for event in result.events][-1] == "snap"
    assert summary.dissipation == pytest.approx(result.poses[2].energy, rel=2e-3)
    assert summary.work_in == pytest.approx(summary.work_out + summary.dissipation, rel=1e-9)
    assert summary.retention_force is None


def test_the_largest_strain_of_a_clamped_uniform_finger_is_at_the_clamp():
    result = gr.trace(hook(8))
    assert result.summary().strain_s == pytest.approx(0, abs=1e-9)
    assert (
        gr.solve(gr.Scene(finger=unit_finger(), object=Circle(radius=0.25).at(x=0.7, y=-0.2))).summary().strain_s == 0
    )


def test_the_largest_strain_of_a_tapered_cantilever_is_where_calculus_puts_it():
    # M = F (a - s), w = w0 (1 - t s): M / w^2 is largest at s = 2 a - 1 / t, for small deflections
    material = gr.Material(youngs_modulus=12 / 0.06**3, poisson_ratio=0.3)
    finger = Tapered(length=1.0, base_thickness=0.06, tip_thickness=0.006, width=1.0, material=material)
    needle = Circle(radius=1e-3).at(x=0.8, y=-0.0084)
    result = gr.solve(gr.Scene(finger=finger, object=needle, theory="bending"))
    a = result.contacts[0].s
    s = 2 * a - 1 / 0.9
    moment, w = result.clamp_moment * (a - s) / a, 0.06 * (1 - 0.9 * s)
    assert result.summary().strain == pytest.approx(6 * moment / (material.youngs_modulus * w**2), rel=1e-3)
    assert result.summary().strain_s == pytest.approx(s, abs=0.01)


def test_margins_are_shares_of_what_the_material_permits():
    scene = hook(8)
    strong = dataclasses.replace(scene.finger.material, yield_strain=0.01)
    finger = dataclasses.replace(scene.finger, material=strong)
    summary = gr.trace(dataclasses.replace(scene, finger=finger)).summary()
    assert summary.strain_margin == pytest.approx(1 - summary.strain / 0.01)
    assert summary.repeated_strain_margin == pytest.approx(1 - summary.strain / 0.006)
    assert summary.repeated_strain_margin < 0 < summary.strain_margin


def test_the_locking_margin_falls_with_friction_and_is_negative_where_it_locks():
    margins = [gr.trace(hook(5, mu)).summary().locking_margin for mu in (0.1, 0.6)]
    assert 1 > margins[0] > margins[1] > 0
    locked = gr.trace(hook(5, 1.0, back=True)).summary()
    assert locked.locked > 0
    assert locked.locking_margin <= 0
    assert locked.insertion_force > 0
    assert locked.retention_force is None


def test_of_a_motion_that_touches_nothing_the_least_distance_is_located():
    passing = Circle(radius=0.1).at(x=0.5 + Q, y=-0.5 - Q**2)
    scene = gr.Scene(finger=unit_finger(), object=passing, motion=gr.Motion("q", (-0.31, -0.1, 0.22)))
    summary = gr.trace(scene).summary()
    assert summary.clearance == pytest.approx(0.5 - 0.1 - 0.03, abs=1e-7)
    assert summary.clearance_at == pytest.approx(0, abs=1e-4)
    assert (summary.strain, summary.force_on_object, summary.insertion_force) == (0, 0, 0)


def test_one_pose_has_its_own_numbers():
    result = gr.solve(gr.Scene(finger=unit_finger(), object=Circle(radius=0.25).at(x=0.7, y=-0.2)))
    summary = result.summary()
    assert (summary.strain, summary.clearance) == (result.max_strain, 0)
    assert summary.force_on_object == pytest.approx(np.hypot(*result.force_on_object))
    assert (summary.insertion_force, summary.strain_at, summary.parameter) == (None, None, None)


def test_failed_poses_are_told():
    result = gr.trace(hook(8))
    failed = dataclasses.replace(result, poses=(*result.poses[:-1], PoseResult.failed(0.05, "no equilibrium")))
    assert "1 of 8 poses failed" in str(failed.summary())
    assert (failed.summary().failed, failed.summary().poses) == (1, 8)


def test_where_every_pose_failed_no_number_is_known():
    on_the_clamp = Circle(radius=0.01).at(x=Q, y=0.0)
    motion = gr.Motion("q", (0.0, 1e-3))
    summary = gr.trace(gr.Scene(finger=unit_finger(), object=on_the_clamp, motion=motion)).summary()
    assert (summary.failed, summary.poses) == (2, 2)
    assert all(getattr(summary, name) is None for name in QUANTITIES if name != "locking_margin")


def test_the_summary_is_in_the_results_file_and_on_one_screen():
    result = gr.trace(hook(8, 0.2, back=True))
    summary = result.summary()
    written = json.loads(json.dumps(result.to_dict(), allow_nan=False))["summary"]
    assert written == dataclasses.asdict(summary)
    lines = str(summary).splitlines()
    assert len(lines) <= 24 and max(map(len, lines)) <= 100
    for name in ("insertion force", "retention force", "locking margin", "strain"):
        assert sum(line.startswith(f"{name}  ") for line in lines) == 1
