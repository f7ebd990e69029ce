"""A motion: one branch whatever the steps, the same curve back, located events, snaps and what has no answer."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
import sympy

import gripper as gr
from gripper.motion.events import Change
from gripper.parameters import replaced
from gripper.statics.equilibrium import NoEquilibriumError, reckoned
from gripper.trace import Interrupted
from gripper_plugins.fingers.tapered import Tapered
from gripper_plugins.jaws.triangle import Triangle
from gripper_plugins.objects.circle import Circle
from gripper_plugins.objects.conic import Conic
from gripper_plugins.objects.ellipse import Ellipse
from gripper_plugins.objects.polygon import Polygon
from tests.scenes import FALLING, Q, deepest_cut, follow, micro_assembly, rotating_finger, unit_finger

ROUND = Circle(radius=0.2)


def passing(*values: float, height: float = -0.1, **options: object) -> gr.Scene:
    """A circle that passes from the tip towards the clamp, or back, below the finger's axis."""
    finger = unit_finger(**options)
    return gr.Scene(finger=finger, object=ROUND.at(x=Q, y=height), motion=gr.Motion("q", values), theory="shear")


def rising(*values: float, x: float = 0.6, **options: object) -> gr.Scene:
    """A circle that rises from below."""
    finger = unit_finger()
    options = {"theory": "shear", **options}
    return gr.Scene(finger=finger, object=ROUND.at(x=x, y=Q), motion=gr.Motion("q", values), **options)


MOTIONS = {
    "micro assembly": lambda n: micro_assembly(*np.linspace(0.086, 0.050, n)),
    "rotating finger, rising": lambda n: rotating_finger(*np.linspace(-0.1016, 0.0508, n)),
    "rotating finger, falling": lambda n: rotating_finger(*np.linspace(*FALLING, n)),
    "rising circle": lambda n: rising(*np.linspace(-0.3, 0.1, n)),
    "passing circle": lambda n: passing(*np.linspace(1.3, 0.5, n)),
}
named = pytest.mark.parametrize("name", MOTIONS)


def traced(scene: gr.Scene) -> tuple[gr.PoseResult, ...]:
    result = gr.trace(scene)
    assert not result.failed, (result.failed[0].parameter, result.failed[0].reason)
    return result.poses


def assert_same(one: gr.PoseResult, other: gr.PoseResult, tolerance: float) -> None:
    assert one.status == other.status
    size = max(float(np.linalg.norm(other.force_on_object)), 1e-300)
    assert one.force_on_object == pytest.approx(other.force_on_object, rel=0, abs=tolerance * size)
    assert one.energy == pytest.approx(other.energy, rel=tolerance, abs=1e-300)
    assert [c.on for c in one.contacts] == [c.on for c in other.contacts]
    for here, there in zip(one.contacts, other.contacts, strict=True):
        assert here.s == pytest.approx(there.s, rel=10 * tolerance)


@named
def test_the_branch_does_not_depend_on_the_number_of_poses(name: str) -> None:
    fine = traced(MOTIONS[name](49))
    for count in (5, 17):
        coarse = traced(MOTIONS[name](count))
        for pose, same in zip(coarse, fine[:: 48 // (count - 1)], strict=True):
            assert pose.parameter == pytest.approx(same.parameter)
            assert_same(pose, same, 1e-7)


@named
def test_a_single_step_reaches_the_end_of_the_motion(name: str) -> None:
    values = MOTIONS[name](3).motion.values
    one, other = (traced(replace(MOTIONS[name](3), motion=gr.Motion("q", some)))[-1] for some in (values, values[::2]))
    assert_same(one, other, 1e-7)


@named
def test_without_a_snap_the_way_back_is_the_way_out(name: str) -> None:
    """Frictionless: insertion and extraction give the same curve."""
    scene = MOTIONS[name](17)
    values = scene.motion.values
    result = gr.trace(replace(scene, motion=gr.Motion("q", (*values, *values[-2::-1]))))
    assert not result.failed
    assert "snap" not in [event.kind for event in result.events]
    for out, back in zip(result.poses[:16], result.poses[:16:-1], strict=True):
        assert out.parameter == back.parameter
        assert_same(back, out, 1e-7)


@named
def test_events_on_the_way_back_are_those_of_the_way_out_reversed(name: str) -> None:
    scene = MOTIONS[name](9)
    values = scene.motion.values
    result = gr.trace(replace(scene, motion=gr.Motion("q", (*values, *values[-2::-1]))))
    half = len(result.events) // 2
    assert len(result.events) == 2 * half
    opposite = {"touch": "release", "release": "touch", "change": "change"}
    for out, back in zip(result.events[:half], result.events[: half - 1 : -1], strict=True):
        assert back.kind == opposite[out.kind]
        assert back.parameter == pytest.approx(out.parameter, abs=1e-7)


@named
def test_where_events_lie_does_not_depend_on_the_steps(name: str) -> None:
    coarse, fine = (gr.trace(MOTIONS[name](count)).events for count in (5, 33))
    assert [event.kind for event in coarse] == [event.kind for event in fine]
    for one, other in zip(coarse, fine, strict=True):
        assert one.parameter == pytest.approx(other.parameter, abs=1e-8)
        assert one.detail == other.detail


def sweep(finger: gr.Finger, body: gr.Object, x: tuple, y: tuple, angle: tuple, theory: str) -> gr.Scene:
    """An object that moves and turns evenly while q goes from 0 to 1."""
    place = {name: start + rate * Q for name, (start, rate) in {"x": x, "y": y, "angle": angle}.items()}
    return gr.Scene(finger=finger, object=body.at(**place), motion=gr.Motion("q", (0.0, 1.0)), theory=theory)


THICK = Tapered(length=1.0, width=0.1, base_thickness=0.1154, tip_thickness=0.1443, material=unit_finger().material)
THIN = replace(THICK, base_thickness=0.0434, tip_thickness=0.0476)
HOOK = Triangle(length=0.239, lead_angle=0.4386, return_angle=1.6)
OVAL = Conic(coefficients=(1.2155, 1.2155, -0.4698, 0.0, 0.0, -0.02424249))
WIDE = Conic(coefficients=(0.6395, 1.082, -0.7992, 0.0, 0.0, -0.24820324))
SWEEPS = {
    "a pin past the tip": sweep(
        unit_finger(0.104), Circle(radius=0.0505), (1.1356, -0.7353), (-0.1233, 0.1333), (0.0, 0.0), "bending"
    ),
    "an oval past the tip": sweep(THICK, OVAL, (1.1788, -0.3879), (-0.2526, 0.1693), (-1.9908, 0.029), "shear"),
    "a wide oval off the tip": sweep(THIN, WIDE, (1.3992, 0.0603), (-0.5632, 0.1747), (2.2859, -0.35), "bending"),
    "from the face to the hook": sweep(
        unit_finger(0.0721, jaw=HOOK), Circle(radius=0.2718), (0.4223, 0.468), (-0.3334, 0.1797), (0.0, 0.0), "shear"
    ),
}


@pytest.mark.parametrize("name", SWEEPS)
def test_events_of_a_sweep_do_not_depend_on_the_steps(name: str) -> None:
    events = []
    for count in (2, 5, 17):
        values = tuple(np.linspace(0, 1, count).tolist())
        result = gr.trace(replace(SWEEPS[name], motion=gr.Motion("q", values)))
        assert not result.failed, result.failed[0].reason
        events.append([(event.kind, event.detail, round(event.parameter, 6)) for event in result.events])
    assert events[0] == events[1] == events[2]


@pytest.mark.parametrize("theory", ["bending", "shear"])
def test_one_pose_is_the_end_of_the_motion_that_approaches_it(theory: str) -> None:
    end = 0.07
    pose = traced(rising(-0.4, end, theory=theory))[-1]
    alone = gr.solve(gr.Scene(finger=unit_finger(), object=ROUND.at(x=0.6, y=end), theory=theory)).poses[0]
    assert_same(alone, pose, 1e-8)
    assert alone.motion_force is None and pose.motion_force > 0


def test_a_motion_that_starts_in_contact_is_approached_first() -> None:
    started, followed = traced(rising(0.05))[-1], traced(rising(-0.4, 0.05))[-1]
    assert_same(started, followed, 1e-8)


def test_poses_are_answered_in_the_order_given_also_back_and_forth() -> None:
    values = (-0.3, -0.1, -0.15, -0.1, -0.3, 0.0, -0.1)
    poses = traced(rising(*values))
    assert [pose.parameter for pose in poses] == list(values)
    for i in (3, 6):
        assert_same(poses[i], poses[1], 1e-7)
    assert poses[4].status == "free"


def test_progress_is_told_after_every_pose() -> None:
    told: list[tuple[int, int]] = []
    gr.trace(rising(-0.3, -0.2, -0.1), progress=lambda done, total: told.append((done, total)))
    assert told == [(1, 3), (2, 3), (3, 3)]


def test_touch_and_release_lie_where_the_straight_finger_just_touches() -> None:
    result = gr.trace(rising(-0.3, 0.0, -0.3))
    assert [event.kind for event in result.events] == ["touch", "release"]
    for event in result.events:
        assert event.parameter == pytest.approx(-0.2 - 0.03, abs=1e-9)


def test_a_circle_that_comes_from_beyond_the_tip_passes_from_the_corner_to_the_face() -> None:
    result = gr.trace(passing(1.3, 0.5))
    assert [event.kind for event in result.events] == ["touch", "change"]
    touch = 1 + math.sqrt(0.2**2 - (0.1 - 0.03) ** 2)
    assert result.events[0].parameter == pytest.approx(touch, abs=1e-9)
    assert [contact.on for contact in result.poses[-1].contacts] == ["lower"]


# ---- Where the equilibrium ends.


@cache
def slipping(*values: float) -> gr.Result:
    """A circle rises at the tip until the tip's corner has slid up its side to a fold of the branch."""
    return gr.trace(rising(*values, x=0.95))


COARSE, FINE = (-0.4, 1.2), tuple(np.linspace(-0.4, 1.2, 41).tolist())


CLOSE = (-0.4, *np.linspace(0.6, 0.645, 10).tolist(), 0.66)
FOLD = (0.645, 0.6465)  # traced with fine steps: the last equilibria, their stability falling from 0.16 to 0


def test_a_finger_whose_tip_the_object_leaves_snaps_free() -> None:
    result = slipping(*FINE)
    assert not result.failed, (result.failed[0].parameter, result.failed[0].reason)
    assert [event.kind for event in result.events] == ["touch", "change", "snap"]
    first, last = result.events[0].parameter, result.events[-1].parameter
    assert FOLD[0] < last < FOLD[1]
    for pose in result.poses:
        assert pose.status == ("contact" if first < pose.parameter < last else "free")
    assert result.poses[-1].energy == 0


def test_where_it_snaps_does_not_depend_on_the_steps() -> None:
    events = [slipping(*values).events[-1] for values in (COARSE, FINE, CLOSE)]
    assert {event.kind for event in events} == {"snap"}
    assert [event.parameter for event in events] == pytest.approx([events[0].parameter] * 3, abs=1e-5)


def test_just_before_a_snap_the_equilibrium_is_about_to_lose_its_stability() -> None:
    stabilities = [pose.checks.stability for pose in slipping(*CLOSE).poses[1:-1]]
    assert stabilities == sorted(stabilities, reverse=True)
    assert 0 < stabilities[-1] < 0.3


def test_no_energy_is_won_in_a_snap() -> None:
    before, after = slipping(*CLOSE).poses[-2:]
    assert before.status == "contact"
    assert after.status != "failed", after.reason
    assert after.energy < before.energy


def test_a_pose_without_an_equilibrium_fails_with_a_reason_and_the_poses_before_it_stand() -> None:
    """The object comes to lie on the clamp."""
    body = Circle(radius=0.1).at(x=0.3 - Q, y=-0.1 + 0.1 * Q)
    scene = gr.Scene(finger=unit_finger(), object=body, motion=gr.Motion("q", (-0.5, 0.0, 0.3)))
    result = gr.trace(scene)
    statuses = [pose.status for pose in result.poses]
    assert statuses[-1] == "failed" and "failed" not in statuses[:2]
    (failed,) = result.failed
    assert failed.reason and failed.parameter == 0.3
    for name in ("force_on_object", "motion_force", "energy", "tip", "min_gap", "max_strain", "shape"):
        assert getattr(failed, name) is None
    assert failed.checks == gr.result.Checks() and failed.contacts == ()


def test_an_object_that_encloses_the_clamp_fails_at_every_pose_and_says_why() -> None:
    trough = Polygon(vertices=((-1.0, -50.0), (0.3, -50.0), (0.3, 50.0), (-1.0, 50.0)))
    scene = gr.Scene(finger=unit_finger(), object=trough.at(x=Q), motion=gr.Motion("q", (0.0, 0.1)))
    result = gr.trace(scene)
    assert len(result.failed) == 2
    for pose in result.failed:
        assert "retreat" in pose.reason and "approach" in pose.reason


def test_a_motion_may_begin_where_no_pose_has_an_answer() -> None:
    """The first pose encloses the clamp; from the first free pose on the motion is followed."""
    trough = Polygon(vertices=((-1.0, -50.0), (0.3, -50.0), (0.3, 50.0), (-1.0, 50.0)))
    scene = gr.Scene(finger=unit_finger(), object=trough.at(x=-Q), motion=gr.Motion("q", (0.0, 0.5)))
    statuses = [pose.status for pose in gr.trace(scene).poses]
    assert statuses == ["failed", "free"]


def test_a_finger_met_exactly_head_on_has_no_answer_and_is_told_why() -> None:
    body = Ellipse(semi_axes=(0.3, 0.3)).at(x=1.6 - Q, y=0.0)
    scene = gr.Scene(finger=unit_finger(0.04), object=body, motion=gr.Motion("q", (0.2, 0.325)))
    free, met = gr.trace(scene).poses
    assert free.status == "free"
    assert met.status == "failed" and met.force_on_object is None
    assert "head-on" in met.reason or "strut" in met.reason


@pytest.mark.parametrize("name", ["rising circle", "passing circle"])
def test_no_pose_has_finger_and_object_in_each_other(name: str) -> None:
    scene = MOTIONS[name](17)
    for solved in follow(scene):
        assert deepest_cut(scene, solved) <= 1e-6


def test_a_scene_without_motion_is_not_traced() -> None:
    with pytest.raises(ValueError, match=r"scene must have a motion \(gripper.solve takes one pose\); got None"):
        gr.trace(gr.Scene(finger=unit_finger(), object=ROUND.at(x=0.6, y=-0.5)))


def test_a_pose_that_is_not_finite_is_refused_before_anything_is_solved() -> None:
    q = sympy.Symbol("q")
    scene = gr.Scene(finger=unit_finger(), object=ROUND.at(x=0.6, y=-1 / q), motion=gr.Motion("q", (1.0, 0.5, 0.0)))
    with pytest.raises(ValueError, match="poses must be finite at every pose"):
        gr.trace(scene)


def test_an_interrupted_motion_holds_the_poses_that_were_done() -> None:
    def third(done: int, total: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    scene = passing(0.9, 0.8, 0.7, 0.6, 0.5)
    whole = gr.trace(scene)
    with pytest.raises(Interrupted, match="3 of 5 poses are done") as interruption:
        gr.trace(scene, progress=third)
    result = interruption.value.result
    assert [pose.parameter for pose in result.poses] == [pose.parameter for pose in whole.poses]
    assert [pose.force_on_object for pose in result.poses[:3]] == [pose.force_on_object for pose in whole.poses[:3]]
    assert {(pose.status, pose.reason) for pose in result.poses[3:]} == {("failed", "interrupted")}


@pytest.mark.parametrize("theory", ["bending", "shear"])
def test_the_rotating_finger_met_from_the_far_left_is_a_strut_that_snaps_to_a_side_that_statics_do_not_decide(
    theory: str,
) -> None:
    for count in (13, 31):
        scene = rotating_finger(*np.linspace(-0.21, -0.15, count).tolist(), theory=theory)
        result = gr.trace(scene)
        assert not result.failed
        touch, change, snap = result.events
        assert (touch.kind, change.kind, snap.kind) == ("touch", "change", "snap")
        assert touch.parameter == pytest.approx(-0.188, abs=1e-3)  # where the ellipse meets the straight finger
        assert change.detail == "corner of tip to tip"
        assert "undecided" in snap.detail
        assert snap.parameter == pytest.approx(-0.18636, abs=2e-5)  # however long the steps


@dataclass(frozen=True, kw_only=True)
class Brittle(Circle):
    """A circle whose g cannot be reckoned within half its radius."""

    def evaluate(self, points: np.ndarray, order: int = 2) -> tuple[np.ndarray, ...]:
        if np.min(np.hypot(*points.T)) < self.radius / 2:
            raise ZeroDivisionError("division by zero")
        return super().evaluate(points, order)


def test_arithmetic_that_breaks_down_fails_its_pose_with_a_reason() -> None:
    pose = gr.solve(
        gr.Scene(finger=unit_finger(), object=Brittle(radius=0.2).at(x=0.6, y=-0.05), theory="shear")
    ).poses[0]
    assert pose.status == "failed"
    assert pose.reason == "the arithmetic breaks down: division by zero"


def test_a_matrix_that_cannot_be_factorised_is_a_refusal() -> None:
    with pytest.raises(NoEquilibriumError, match="the arithmetic breaks down: Singular matrix"), reckoned():
        np.linalg.inv(np.zeros((2, 2)))


@pytest.mark.parametrize("theory", ["bending", "shear"])
def test_a_strut_s_undecided_side_is_told_however_long_the_steps(theory: str) -> None:
    """Example II from further left: the end face is met head-on, and beyond the snap the finger leans to one side."""
    long, short = (
        gr.trace(replace(rotating_finger(*values), theory=theory)).events
        for values in ((-0.21, -0.16), (-0.21, -0.19, -0.187, -0.185, -0.16))
    )
    assert [event.kind for event in long] == [event.kind for event in short] == ["touch", "change", "snap"]
    assert "undecided" in long[-1].detail
    for one, other in zip(long, short, strict=True):
        assert one.parameter == pytest.approx(other.parameter, abs=1e-5)


@pytest.mark.parametrize(("event", "place"), [(0.5, 0.5), (1.1, 1.0), (-0.3, 0.0)])
def test_an_event_of_a_step_is_on_the_step(event: float, place: float) -> None:
    """A contact that is kept a hair beyond its edge left it before the step: no leg of the motion turns for that."""
    assert Change(event, "release", "").within(1.0, 0.0) == place
    assert -Change(-event, "release", "").within(-1.0, 0.0) == place


def test_a_contact_that_takes_over_within_one_step_is_located_as_by_steps_that_part_the_two():
    """The thicker hook of Example I: its face meets the pin 2.3 micrometres of the way before the jaw leaves it."""
    coarse = replaced(micro_assembly(0.086, 0.0525, 0.0512), {"finger.thickness": 0.0033})
    fine = replace(coarse, motion=gr.Motion("q", (0.086, 0.0525, 0.051878, 0.0512)))
    one, parted = gr.trace(coarse), gr.trace(fine)
    assert [(event.kind, event.detail) for event in one.events[-2:]] == [("touch", "lower"), ("release", "jaw")]
    assert [event.parameter for event in one.events] == pytest.approx([event.parameter for event in parted.events])
    assert len(parted.poses[2].contacts) == 2
    assert one.poses[-1].force_on_object == pytest.approx(parted.poses[-1].force_on_object, rel=1e-9)
    assert one.poses[-1].iterations < 15  # 27 when steps were halved until they parted the two
