"""Sweeps: every variant once, whatever is killed on the way."""

import dataclasses
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import pytest
from typer.testing import CliRunner

import gripper as gr
from gripper import scenefile
from gripper.cli import app
from gripper.parameters import replaced
from gripper.sweep import Plan, spread
from gripper_plugins.fingers.uniform import Uniform
from gripper_plugins.objects.circle import Circle
from tests.scenes import micro_assembly, unit_finger

POSE = gr.Scene(finger=unit_finger(), object=Circle(radius=0.25).at(x=0.7, y=-0.2))
OVER = {"object.radius": (0.2, 0.25, 0.22), "finger.thickness": (0.06, -0.05)}


@dataclass(frozen=True, kw_only=True)
class Deadly(Uniform):
    """A finger whose plugin ends its process at one thickness."""

    def w(self, s):
        if self.thickness == 0.05:
            os._exit(9)
        return super().w(s)


DEADLY = dataclasses.replace(POSE, finger=Deadly(**vars(unit_finger())))


def test_every_variant_is_a_row_with_the_summary_of_its_scene_or_its_reason():
    table = gr.sweep(POSE, OVER)
    assert [row.values for row in table.rows] == list(Plan(OVER).variants())
    for row in table.rows:
        if row.values[1] < 0:
            assert row.reason == "thickness must be a positive number, in m; got -0.05"
            continue
        alone = gr.solve(replaced(POSE, dict(zip(OVER, row.values, strict=True)))).summary()
        assert (row.reason, row.summary) == (None, alone)
    assert [row.variant for row in table.failed] == [1, 3, 5]


def test_a_motion_is_swept_like_a_pose_and_any_executor_serves():
    scene, over = micro_assembly(0.086, 0.07, 0.06), {"friction.coefficient": (0.0, 0.2)}
    with ThreadPoolExecutor(1) as executor:
        table = gr.sweep(scene, over, executor=executor)
    assert [row.summary for row in table.rows] == [
        gr.trace(replaced(scene, {"friction.coefficient": mu})).summary() for mu in (0.0, 0.2)
    ]


def test_a_pose_without_an_answer_is_a_reason():
    on_the_clamp = dataclasses.replace(POSE, object=Circle(radius=0.01).at(x=0.0, y=0.0))
    (row,) = gr.sweep(on_the_clamp, {"finger.length": (1.0,)}).rows
    assert row.summary is None and row.reason.startswith("1 of 1 poses failed: the object lies on the clamp")


def test_a_variant_whose_process_ends_is_a_row_and_the_others_are_not_harmed():
    table = gr.sweep(DEADLY, {"finger.thickness": (0.06, 0.05, 0.055)})
    assert [row.summary is None for row in table.rows] == [False, True, False]
    assert table.rows[1].reason.startswith("its process ended, 3 times: ")


def test_a_kept_table_gives_the_rows_back_to_the_last_bit_and_nothing_is_reckoned_again(tmp_path):
    calls = []
    first = gr.sweep(POSE, OVER, tmp_path / "new" / "sweep")
    again = gr.sweep(POSE, OVER, tmp_path / "new" / "sweep", progress=lambda done, total: calls.append(done))
    assert (again, calls) == (first, [])


@pytest.mark.parametrize("cut", [1, 9, 60])
def test_a_torn_row_and_a_damaged_one_are_reckoned_again(tmp_path, cut):
    first = gr.sweep(POSE, OVER, tmp_path)
    path, calls = tmp_path / "sweep.csv", []
    whole = path.read_text()
    lines = whole.splitlines(keepends=True)
    lines[1] = lines[1].replace("0.2,", "0.21,", 1)
    path.write_text("".join(lines)[:-cut])
    again = gr.sweep(POSE, OVER, tmp_path, progress=lambda done, total: calls.append((done, total)))
    assert (again, calls) == (first, [(5, 6), (6, 6)])
    assert path.read_text() == whole


def test_a_folder_of_another_sweep_is_refused(tmp_path):
    gr.sweep(POSE, {"object.radius": (0.2,)}, tmp_path)
    with pytest.raises(ValueError, match="folder must be new, or hold this very sweep") as refusal:
        gr.sweep(POSE, {"object.radius": (0.2, 0.3)}, tmp_path)
    assert str(refusal.value).endswith("where over object.radius is [0.2], now [0.2, 0.3]")
    wider = dataclasses.replace(POSE, finger=dataclasses.replace(POSE.finger, width=0.2))
    with pytest.raises(ValueError, match=r"where finger\.width is .*, now 0\.2$"):
        gr.sweep(wider, {"object.radius": (0.2,)}, tmp_path)


def test_what_no_row_depends_on_does_not_part_a_sweep(tmp_path, monkeypatch):
    first = gr.sweep(POSE, {"object.radius": (0.2,)}, tmp_path / "sweep")
    calls = []
    named = dataclasses.replace(POSE, title="another", limits=gr.Limits({"max_strain": 0.1}))
    swept = replaced(named, {"object.radius": 0.3})  # each row has its own
    distribution = tmp_path / "stranger-1.0.dist-info"
    distribution.mkdir()
    (distribution / "METADATA").write_text("Metadata-Version: 2.1\nName: stranger\nVersion: 1.0\n")
    (distribution / "entry_points.txt").write_text("[gripper.objects]\naaa = gripper_plugins.objects.circle:Circle\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    again = gr.sweep(swept, {"object.radius": (0.2,)}, tmp_path / "sweep", progress=lambda *done: calls.append(done))
    assert (again, calls) == (first, [])


def test_a_sweep_of_another_class_or_version_or_none_is_refused_by_it(tmp_path):
    gr.sweep(POSE, {"object.radius": (0.2,)}, tmp_path)
    path = tmp_path / "sweep.json"
    whole = path.read_text()
    for one, other, said in (
        ('"gripper": "', '"gripper": "0.0.', r"where gripper is .*, now"),
        ("circle:Circle", "circle:Round", r"where classes is .*, now"),
        ("{", "[", "where what was swept cannot be read"),
    ):
        path.write_text(whole.replace(one, other))
        with pytest.raises(ValueError, match=said):
            gr.sweep(POSE, {"object.radius": (0.2,)}, tmp_path)


def test_axes_are_in_the_units_that_were_written_or_mm_and_deg():
    written = Plan([spread("object.radius=20cm:25cm:2"), spread("object.pose.angle=0,0.1")])
    axes = gr.sweep(POSE, written).plot("strain").axes[0]
    assert axes.get_xlabel() == "object.radius (cm)"
    assert list(axes.lines[0].get_xdata()) == [20, 25]
    assert [line.get_label() for line in axes.lines] == ["object.pose.angle = 0 deg", "object.pose.angle = 5.72958 deg"]
    plain = gr.sweep(POSE, {"object.radius": (0.2, 0.25)}).plot("strain").axes[0]
    assert (plain.get_xlabel(), list(plain.lines[0].get_xdata())) == ("object.radius (mm)", [200, 250])


def test_a_sweep_that_is_killed_goes_on_where_it_was(tmp_path):
    scene, folder = tmp_path / "scene.toml", tmp_path / "out"
    scene.write_text(scenefile.dumps(POSE))
    over = {"object.pose.y": np.linspace(-0.2, -0.19, 90)}
    command = [sys.executable, "-m", "gripper", "sweep", scene, "--over", "object.pose.y=-0.2:-0.19:90", "-o", folder]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        give_up = time.monotonic() + 60
        while rows(folder) < 5 and time.monotonic() < give_up:
            time.sleep(0.02)
        process.send_signal(signal.SIGKILL)
    kept, calls = rows(folder), []
    assert 5 <= kept < 90
    table = gr.sweep(scenefile.read(scene), over, folder, progress=lambda done, total: calls.append(done))
    assert kept - 1 <= calls[0] - 1 <= kept and calls[-1] == 90
    assert rows(folder) == 90 == len({row.variant for row in table.rows})
    assert table.failed == ()


def rows(folder):
    path = folder / "sweep.csv"
    return path.read_bytes().count(b"\n") - 1 if path.exists() else 0


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("finger.length=10mm:25mm:4", (0.01, 0.015, 0.02, 0.025)),
        ("finger.length=10 mm:25 mm:2", (0.01, 0.025)),
        ("friction.coefficient=0,0.2,1e-1", (0, 0.2, 0.1)),
        ("finger.pose.angle=-20deg:20deg:2", (-np.pi / 9, np.pi / 9)),
    ],
)
def test_values_on_the_command_line_are_spread_or_listed_with_units(text, values):
    key, found, unit = spread(text)
    assert key == text.split("=")[0]
    assert found == pytest.approx(values)
    assert unit == {"finger.length": "mm", "finger.pose.angle": "deg"}.get(key, "")


@pytest.mark.parametrize("text", ["finger.length", "a=1:2", "a=1:2:1", "a=1:2:x", "a=1 mile", "a=", "=1,2", "a=1,,2"])
def test_other_values_on_the_command_line_are_errors(text):
    with pytest.raises(ValueError, match="must"):
        spread(text)


@pytest.mark.parametrize("values", [None, (), (1.0, 1.0), (np.nan,)])
def test_a_plan_varies_something(values):
    with pytest.raises(ValueError, match="must"):
        Plan({} if values is None else {"finger.length": values})


def test_figures_show_the_numbers_and_mark_what_has_none():
    curve = gr.sweep(POSE, {"object.radius": (0.25, 0.2, -1.0)})
    line, missing = curve.plot("strain").axes[0].lines
    assert list(line.get_xdata()) == [-1000, 200, 250]
    assert list(line.get_ydata())[1:] == [curve.rows[1].summary.strain, curve.rows[0].summary.strain]
    assert list(missing.get_xdata()) == [-1000]
    table = gr.sweep(POSE, OVER)
    thick, thin, missing = table.plot("force_on_object").axes[0].lines
    assert list(thick.get_ydata()) == [table.rows[i].summary.force_on_object for i in (0, 4, 2)]
    assert np.isnan(thin.get_ydata()).all() and list(missing.get_xdata()) == list(thin.get_xdata())
    assert thick.get_label() == "finger.thickness = 60 mm"
    wide = gr.sweep(POSE, {"finger.length": (1.0,), "object.radius": (0.25, 0.2, -1.0, 0.3, 0.35)})
    axes = wide.plot("strain").axes[0]
    cells = axes.collections[0].get_array()
    assert list(cells.mask[:, 0]) == [True] + [False] * 4
    assert cells[1, 0] == wide.rows[1].summary.strain
    assert [text.get_text() for text in axes.get_yticklabels()] == ["-1000", "200", "250", "300", "350"]
    three = gr.sweep(POSE, {"object.radius": (0.25,), "finger.length": (1.0,), "object.pose.x": (0.7,)})
    with pytest.raises(ValueError, match="one key or two"):
        three.plot("strain")


def test_the_command_writes_table_and_figures_and_tells_what_failed(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(scenefile.dumps(POSE))
    outcome = CliRunner().invoke(
        app, ["sweep", str(scene), "--over", "finger.thickness=60mm,-1mm", "-o", str(tmp_path / "out")]
    )
    assert (outcome.exit_code, outcome.stderr) == (1, "")
    lines = outcome.stdout.splitlines()
    assert lines[0] == "1 of 2 variants have an answer"
    assert lines[1] == "  finger.thickness = -1 mm: thickness must be a positive number, in m; got -0.001"
    assert lines[2].startswith("strain 0.0") and lines[2].endswith(", largest at finger.thickness = 60 mm")
    assert lines[3].startswith("force on object ")
    assert lines[4:] == [str(tmp_path / "out" / name) for name in ("sweep.csv", "strain.png", "force_on_object.png")]
    assert all((tmp_path / "out" / line.rsplit("/", 1)[1]).stat().st_size > 0 for line in lines[4:])


@pytest.mark.parametrize(
    ("option", "said"),
    [
        (["--over", "finger.thicknes=1:2:2"], "unknown number 'finger.thicknes'; known: "),
        (["--over", "finger.thickness=1"], ""),
        (["--over", "finger.thickness=1:2:2", "--plot", "force"], "unknown quantity 'force'; known: "),
        (
            ["--over", "finger.thickness=1N:2N:3"],
            "values of finger.thickness must be a length, in m; got",
        ),
        (["--over", "finger.thickness"], "over must be key=start:stop:n or key=a,b,c"),
    ],
)
def test_bad_input_is_one_message_and_status_2(tmp_path, option, said):
    scene = tmp_path / "scene.toml"
    scene.write_text(scenefile.dumps(POSE) if said else "nonsense")
    outcome = CliRunner().invoke(app, ["sweep", str(scene), *option, "-o", str(tmp_path / "out")])
    assert (outcome.exit_code, outcome.stdout) == (2, "")
    assert outcome.stderr.startswith(said) and len(outcome.stderr.splitlines()) == 1
