import contextlib
import csv
import json
import resource
from pathlib import Path

import numpy as np
import pytest

from gripper.describe import describe as resolved
from gripper.output import FILES, NotWrittenError, as_json, prepared, write, write_files
from gripper.result import Model, PoseResult, Result, Shape
from gripper.scenefile import read

GALLERY = Path(__file__).parent.parent / "gallery"
SCENE = read(GALLERY / "micro_assembly.toml")
FAILED = PoseResult.failed(0.086, "the solver found no equilibrium")


def free():
    x = np.linspace(0, 0.057, 5)
    axis, lower, upper = (np.stack([x, 0 * x + y], axis=1) for y in (0, -0.0016, 0.0016))
    shape = Shape(axis=axis, lower=lower, upper=upper, strain=0 * x)
    numbers = dict.fromkeys(("moment_on_object", "motion_force", "clamp_moment", "energy", "tip_rotation"), 0.0)
    vectors = {"force_on_object": (0.0, 0.0), "force_on_object_finger_frame": (0.0, 0.0), "tip": (0.057, 0.0)}
    known = numbers | vectors | {"max_strain": 0.0, "min_gap": 0.001}
    return PoseResult(parameter=0.086, status="free", shape=shape, **known)


def result(*poses):
    return Result(scene=SCENE, model=Model(theory="bending"), poses=poses)


@pytest.mark.parametrize("poses", [(FAILED,), (free(),), (free(), FAILED)])
def test_every_run_leaves_three_complete_files_and_no_other(tmp_path, poses):
    with prepared(tmp_path / "a" / "b"):
        paths = write(tmp_path / "a" / "b", result(*poses))
    assert [path.name for path in paths] == list(FILES)
    assert sorted((tmp_path / "a" / "b").iterdir()) == sorted(paths)
    written = json.loads(paths[0].read_text())
    assert written["scene"] == resolved(SCENE)
    assert [pose["status"] for pose in written["poses"]] == [pose.status for pose in poses]
    assert len(list(csv.reader(paths[1].read_text().splitlines()))) == 1 + len(poses)
    assert paths[2].read_bytes().startswith(b"\x89PNG")


def test_a_second_run_replaces_the_files_of_the_first(tmp_path):
    write(tmp_path, result(FAILED))
    write(tmp_path, result(free()))
    assert json.loads((tmp_path / "result.json").read_text())["poses"][0]["status"] == "free"


@contextlib.contextmanager
def room_for(size):
    """Let no file grow beyond this many bytes."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_a_disk_that_holds_nothing_leaves_the_earlier_files_as_they_were(tmp_path):
    write(tmp_path, result(free()))
    before = contents(tmp_path)
    with room_for(100), pytest.raises(NotWrittenError, match=r"result\.json, curve\.csv, snapshots\.png not written"):
        write(tmp_path, result(free(), free()))
    assert contents(tmp_path) == before


def test_a_disk_without_room_for_the_picture_keeps_the_numbers_and_no_stale_picture(tmp_path):
    write(tmp_path, result(free()))
    both = result(free(), free())
    with (
        room_for(10_000),
        pytest.raises(NotWrittenError, match=r"result\.json, curve\.csv written, snapshots\.png not"),
    ):
        write(tmp_path, both)
    assert contents(tmp_path) == {"result.json": as_json(both.to_dict()), "curve.csv": both.curve_csv().encode()}


@pytest.mark.parametrize("reason", [KeyboardInterrupt, MemoryError])
def test_what_is_complete_is_kept_when_making_the_rest_ends_early(tmp_path, reason):
    def picture():
        raise reason

    with pytest.raises(reason):
        write_files(tmp_path, {"numbers": b"1", "picture": picture})
    assert contents(tmp_path) == {"numbers": b"1"}


def test_ten_thousand_poses_are_written(tmp_path):
    many = result(*[free()] * 5_000, *[FAILED] * 5_000)
    write(tmp_path, many)
    assert len(json.loads((tmp_path / "result.json").read_text())["poses"]) == 10_000
    assert len((tmp_path / "curve.csv").read_text().splitlines()) == 10_001


@pytest.mark.parametrize("reason", [KeyboardInterrupt, OSError])
def test_a_run_that_ends_early_leaves_no_empty_folder(tmp_path, reason):
    with pytest.raises(reason), prepared(tmp_path / "a" / "b"):
        raise reason
    assert list(tmp_path.iterdir()) == []
