import json
import os
import re
import signal
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path

import pytest
from typer.testing import CliRunner

from gripper.cli import app
from gripper.describe import describe as resolved
from gripper.output import FILES
from gripper.registry import GROUPS, installed
from gripper.scenefile import read
from tests.scenes import PIN, STRIP

GALLERY = Path(__file__).parent.parent / "gallery"
GOOD = (GALLERY / "rotating_finger.toml").read_text()

BAD = {
    "empty": "",
    "no TOML": "a = ",
    "unknown key": GOOD.replace("semi_axes", "semi_axis"),
    "unknown plugin": GOOD.replace('"ellipse"', '"elipse"'),
    "out of range": GOOD.replace("length = 0.1778", "length = -1"),
    "code": GOOD.replace("length = 0.1778", "length = \"__import__('os').system('touch executed')\""),
    "a tower of powers": GOOD.replace("length = 0.1778", 'length = "9**9**9**9"'),
    "too many poses": GOOD.replace("poses = 49", "poses = 1000000000"),
    "a width below 0": GOOD.replace("width = 0.025", 'width = "0.01 - s"'),
    "a pose that is not real": GOOD.replace('x = "x_e"', 'x = "log(x_e)"'),
    "friction": GOOD + "\n[friction]\ncoefficient = -0.2\n",
}


def gripper(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def scene_file(folder, text):
    path = folder / "scene.toml"
    path.write_text(text)
    return path


@pytest.mark.parametrize("case", BAD)
def test_a_bad_scene_ends_with_status_2_one_line_and_nothing_written(tmp_path, monkeypatch, case):
    monkeypatch.chdir(tmp_path)
    path = scene_file(tmp_path, BAD[case])
    outcome = gripper("run", path, "-o", tmp_path / "out")
    assert outcome.exit_code == 2
    assert outcome.stdout == ""
    assert outcome.stderr.startswith(f"{path}: ")
    assert len(outcome.stderr.splitlines()) == 1
    assert list(tmp_path.iterdir()) == [path]


def test_a_missing_scene_ends_with_status_2_and_its_name(tmp_path):
    outcome = gripper("run", tmp_path / "none.toml", "-o", tmp_path / "out")
    assert (outcome.exit_code, outcome.stdout) == (2, "")
    assert outcome.stderr.startswith(f"{tmp_path / 'none.toml'}: must be a file that can be read")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("blocked", ["out", "out/below", "out/result.json"])
def test_a_folder_that_cannot_be_written_is_refused_before_solving(tmp_path, blocked):
    folder = tmp_path / "out"
    if blocked == "out/result.json":
        (tmp_path / blocked).mkdir(parents=True)
    else:
        folder.write_text("a file in the way")
        folder = tmp_path / blocked
    outcome = gripper("run", scene_file(tmp_path, GOOD), "-o", folder)
    assert (outcome.exit_code, outcome.stdout) == (2, "")
    assert outcome.stderr.startswith(f"{folder}: must be a folder that can be written; got ")
    assert len(outcome.stderr.splitlines()) == 1


def test_plugins_lists_every_installed_one_in_a_line_with_its_state():
    outcome = gripper("plugins")
    assert outcome.exit_code == 0
    lines = outcome.stdout.splitlines()[1:]
    records = [record for group in GROUPS for record in installed(group)]
    assert len(lines) == len(records)
    for line, record in zip(lines, records, strict=True):
        source = f"{record.distribution} {record.version}"
        assert re.split("  +", line.strip()) == [record.kind, record.name, source, record.target, "ok"]


def test_the_version_is_the_installed_one():
    assert gripper("--version").stdout == f"gripper {version('gripper')}\n"


def test_help_shows_the_names_of_tables_in_their_brackets():
    assert "[limits]" in gripper("optimize", "--help").stdout


def test_help_names_the_exit_statuses_and_where_it_writes():
    text = " ".join(re.sub(r"[^\w\s,./-]", " ", gripper("run", "--help").stdout).split())
    assert "130 when interrupted" in text
    assert "out/ and the scene" in text


def test_the_module_is_the_same_command():
    run = subprocess.run([sys.executable, "-m", "gripper", "--version"], capture_output=True, text=True, check=True)
    assert run.stdout == f"gripper {version('gripper')}\n"


def test_the_command_line_starts_without_what_only_a_command_needs():
    code = "import sys, gripper.cli; print({'matplotlib', 'pydantic', 'shapely'} & set(sys.modules))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == "set()\n"


def short(text, poses):
    return text.replace("poses = 49", f"poses = {poses}")


def test_a_run_writes_its_files_prints_the_result_and_stays_quiet_in_a_pipe(tmp_path):
    path = scene_file(tmp_path, short(GOOD, 3))
    outcome = gripper("run", path, "-o", tmp_path / "new" / "out")
    assert (outcome.exit_code, outcome.stderr) == (0, "")
    paths = [tmp_path / "new" / "out" / name for name in FILES]
    assert outcome.stdout.splitlines()[-3:] == [str(path) for path in paths]
    assert outcome.stdout.startswith("Tapered rubber finger")
    written = json.loads(paths[0].read_text())
    assert [pose["parameter"] for pose in written["poses"]] == pytest.approx([-0.1016, 0.0508, 0.2032])
    assert written["scene"] == resolved(read(path))


def test_a_scene_without_motion_is_one_pose_and_goes_to_out_by_its_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = GOOD[: GOOD.index("[motion]")].replace('"102 deg - 236.22 deg * x_e"', '"90 deg"').replace('"x_e"', "0.0508")
    outcome = gripper("run", scene_file(tmp_path, text))
    assert (outcome.exit_code, outcome.stderr) == (0, "")
    assert sorted(path.name for path in (tmp_path / "out" / "scene").iterdir()) == sorted(FILES)


CHEAP = f"""{STRIP}{PIN}[object.pose]
x = "86 mm + q"
y = "-40 mm"
[motion]
parameter = "q"
from = 0
to = "1 mm"
poses = 10_000
"""


def interrupted(scene, folder, when):
    """Run a scene, and interrupt it as Ctrl-C does, once ``when()`` returns."""
    command = [sys.executable, "-m", "gripper", "run", scene, "-o", folder]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
        when()
        run.send_signal(signal.SIGINT)
        stdout, stderr = run.communicate(timeout=60)
    assert run.returncode == 130
    assert len(stderr.splitlines()) == 1
    return stdout, stderr


def test_an_interrupted_run_keeps_the_poses_that_are_done(tmp_path):
    folder = tmp_path / "out"

    def well_under_way():
        give_up = time.monotonic() + 60
        while not folder.exists() and time.monotonic() < give_up:
            time.sleep(0.02)
        time.sleep(1)

    stdout, stderr = interrupted(scene_file(tmp_path, CHEAP), folder, well_under_way)
    message = re.match(r"interrupted: (\d+) of 10000 poses are done; the others are written as failed", stderr)
    done = int(message[1])
    assert done > 0
    assert stdout.splitlines()[-3:] == [str(folder / name) for name in FILES]
    poses = json.loads((folder / "result.json").read_text())["poses"]
    assert [pose["reason"] for pose in poses] == [None] * done + ["interrupted"] * (10_000 - done)
    assert len((folder / "curve.csv").read_text().splitlines()) == 1 + len(poses)


def test_a_run_that_is_interrupted_while_it_reads_the_scene_leaves_nothing(tmp_path):
    scene, folder = tmp_path / "scene.toml", tmp_path / "out"
    os.mkfifo(scene)
    writers = []
    # a pipe opens for writing when the other side has opened it for reading
    stdout, stderr = interrupted(scene, folder, lambda: writers.append(scene.open("wb")))
    writers[0].close()
    assert (stdout, stderr) == ("", f"interrupted: {folder} does not hold the whole run\n")
    assert not folder.exists()
