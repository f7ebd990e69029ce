"""Tolerance bands, linear and sampled, and the command that writes them."""

import csv
import dataclasses
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from typer.testing import CliRunner

import gripper as gr
from gripper import scenefile
from gripper.bands import Band, linear_bands, sampled_bands, samples
from gripper.cli import app
from gripper.parameters import number, replaced
from gripper.results.summary import QUANTITIES
from gripper_plugins.objects.circle import Circle
from tests.scenes import micro_assembly, unit_finger

BANDS = {"finger.thickness": 2e-5, "object.pose.y": 3e-5, "finger.jaw.lead_angle": 2e-3}
HOOK = dataclasses.replace(micro_assembly(0.086, 0.07, 0.06, 0.05), tolerances=gr.Tolerances(BANDS))
POSE = gr.Scene(
    finger=unit_finger(),
    object=Circle(radius=0.25).at(x=0.7, y=-0.2),
    tolerances=gr.Tolerances({"object.pose.y": 1e-4, "object.pose.x": 1e-3}),
)


@pytest.fixture(scope="module")
def bands():
    return {band.quantity: band for band in linear_bands(gr.trace(HOOK))}


@pytest.mark.parametrize("key", BANDS)
def test_a_linear_band_is_what_half_as_large_a_step_changes_twice(bands, key):
    ends = [number(HOOK, key) + sign * BANDS[key] / 2 for sign in (1, -1)]
    upper, lower = (gr.trace(replaced(HOOK, {key: end})).summary() for end in ends)
    for quantity in ("insertion_force", "retention_force", "strain", "force_on_object"):
        band = bands[quantity]
        change = band.changes[band.keys.index(key)]
        difference = getattr(upper, quantity) - getattr(lower, quantity)
        assert change == pytest.approx(difference, rel=2e-3, abs=1e-6 * band.value)


def test_the_worst_is_the_sum_and_the_likely_the_root_of_squares():
    band = Band(quantity="strain", value=0.01, keys=("a", "b"), changes=(3e-4, -4e-4))
    assert (band.worst, band.likely) == pytest.approx((7e-4, 5e-4))


def test_samples_lie_evenly_within_their_bands_and_repeat():
    drawn = samples(HOOK, 64)
    for key, half in BANDS.items():
        off = (np.array([numbers[key] for numbers in drawn]) - number(HOOK, key)) / half
        assert np.abs(off).max() <= 1
        assert np.histogram(off, 8, (-1, 1))[0].tolist() == [8] * 8
    assert drawn == samples(HOOK, 64) != samples(HOOK, 64, seed=1)


def test_sampled_bands_lie_within_the_linear_ones_where_all_is_nearly_linear():
    linear = {band.quantity: band for band in linear_bands(gr.solve(POSE))}
    with ThreadPoolExecutor(1) as executor:
        drawn, reasons = sampled_bands(POSE, 16, executor=executor)
    assert reasons == () and {band.quantity for band in drawn} == set(linear) == {"strain", "force_on_object"}
    for band in drawn:
        about = linear[band.quantity]
        assert band.samples == 16 and band.least <= band.low <= band.high <= band.largest
        assert about.value - 1.05 * about.worst <= band.least < about.value < band.largest
        assert band.largest <= about.value + 1.05 * about.worst
        assert band.largest - band.least > about.likely


def test_variants_without_an_answer_are_reasons():
    scene = dataclasses.replace(POSE, tolerances=gr.Tolerances({"finger.thickness": 0.07}))
    with ThreadPoolExecutor(1) as executor:
        drawn, reasons = sampled_bands(scene, 8, executor=executor)
    assert reasons and all(reason.startswith("thickness must be a positive number") for reason in reasons)
    assert drawn[0].samples + len(reasons) == 8


@pytest.mark.parametrize("count", [0, 1, 12, -4])
def test_samples_are_a_power_of_two(count):
    with pytest.raises(ValueError, match="count must be a power of 2"):
        samples(POSE, count)


def test_a_scene_without_tolerances_has_no_bands():
    bare = dataclasses.replace(POSE, tolerances=None)
    with pytest.raises(ValueError, match=r"tolerances must be given, .*; got none"):
        linear_bands(gr.solve(bare))


def test_a_tornado_has_its_largest_bar_on_top_and_both_ends_of_each_band():
    figure = Band(quantity="strain", value=0.01, keys=("a", "b", "c"), changes=(3e-4, -4e-4, 1e-4)).plot()
    axes = figure.axes[0]
    assert [label.get_text() for label in axes.get_yticklabels()] == ["c", "a", "b"]
    ends = [bar.get_x() + bar.get_width() for bar in axes.patches]
    assert ends == pytest.approx([0.0101, 0.0103, 0.0096, 0.0099, 0.0097, 0.0104])


def test_the_command_writes_a_table_and_a_tornado_for_each_number(tmp_path):
    path, folder = tmp_path / "scene.toml", tmp_path / "out"
    path.write_text(scenefile.dumps(POSE))
    outcome = CliRunner().invoke(app, ["tolerance", str(path), "-o", str(folder), "--samples", "4"])
    assert (outcome.exit_code, outcome.stderr) == (0, "")
    table = list(csv.DictReader((folder / "tolerance.csv").read_text().splitlines()))
    assert [row["quantity"] for row in table] == ["strain", "force_on_object"]
    assert all(row["quantity"] in QUANTITIES and float(row["worst"]) >= float(row["likely"]) > 0 for row in table)
    assert all(float(row["least"]) < float(row["largest"]) for row in table)
    assert outcome.stdout.splitlines()[-3:] == [
        str(folder / name) for name in ("tolerance.csv", "tornado_strain.png", "tornado_force_on_object.png")
    ]


def test_a_scene_without_a_tolerance_table_is_bad_input(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(scenefile.dumps(dataclasses.replace(POSE, tolerances=None)))
    outcome = CliRunner().invoke(app, ["tolerance", str(path), "-o", str(tmp_path / "out")])
    assert (outcome.exit_code, outcome.stdout) == (2, "")
    assert outcome.stderr == f"{path}: tolerance: must be given, as [tolerance] with half widths by key\n"


def test_a_scene_without_derivatives_has_sampled_bands_alone_and_says_why(tmp_path):
    path, folder = tmp_path / "scene.toml", tmp_path / "out"
    published = gr.Friction(coefficient=0.2, model="published", sense="tipward")
    path.write_text(scenefile.dumps(dataclasses.replace(POSE, friction=published)))
    outcome = CliRunner().invoke(app, ["tolerance", str(path), "-o", str(folder)])
    assert (outcome.exit_code, outcome.stdout) == (2, "")
    refused = "model of friction must be 'coulomb', to be differentiated"
    assert refused in outcome.stderr and "--samples 256" in outcome.stderr
    outcome = CliRunner().invoke(app, ["tolerance", str(path), "-o", str(folder), "--samples", "4"])
    assert outcome.exit_code == 0 and outcome.stderr.startswith(f"no linear bands: {refused}")
    table = list(csv.DictReader((folder / "tolerance.csv").read_text().splitlines()))
    assert [row["quantity"] for row in table] == ["strain", "force_on_object"]
    assert all(float(row["least"]) < float(row["value"]) < float(row["largest"]) for row in table)
    assert all(row["worst"] == "" for row in table)
