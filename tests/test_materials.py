"""The table of plastics."""

import pytest

import gripper as gr
from gripper import scenefile
from gripper.materials import PLASTICS, friction_range
from tests.scenes import EXACT

SCENE = """
{material}
[finger]
profile = "uniform"
length = 0.057
thickness = 0.0032
width = 0.0095
[object]
surface = "circle"
radius = 0.0089
[object.pose]
x = 0.04
y = -0.012
"""


@pytest.mark.parametrize("name", PLASTICS)
def test_every_plastic_is_a_material_that_permits_less_when_bent_again_and_again_and_has_its_sources(name):
    material, row = gr.material(name), PLASTICS[name]
    assert 1e9 < material.youngs_modulus < 4e9
    assert 0.3 < material.poisson_ratio < 0.45
    assert 0 < material.permissible_repeatedly <= 0.6 * material.yield_strain + 1e-12
    assert len(row.sources) == 3 and all(len(source) > 20 for source in row.sources)
    low, high = friction_range(name)
    assert 0 < low < high < 1 and friction_range(name, name) == pytest.approx(
        (row.on_itself * low, row.on_itself * high)
    )


def test_the_handbooks_polycarbonate_hook_has_its_friction_and_its_strain():
    hook = EXACT[next(key for key in EXACT if key.startswith("snap-fit handbook"))]
    assert friction_range("PC", "PC")[0] <= 0.6 <= friction_range("PC", "PC")[1]  # its mu, of PC on PC
    assert hook["root strain"] <= gr.material("PC").permissible_repeatedly  # half of what is permitted once


def test_a_scene_names_its_material_and_changes_what_it_wants():
    named = scenefile.loads(SCENE.format(material='material = "POM"'))
    assert named.finger.body.material == gr.material("POM")
    changed = scenefile.loads(SCENE.format(material='[material]\nname = "POM"\nplane = "strain"\nyield_strain = 0.05'))
    assert changed.finger.body.material.bending_modulus == pytest.approx(3.1e9 / (1 - 0.35**2))
    assert changed.finger.body.material.yield_strain == 0.05
    assert scenefile.loads(scenefile.dumps(named)).finger.body.material.G == gr.material("POM").G


def test_a_scene_names_a_pair_for_its_friction():
    text = SCENE.format(material='material = "POM"') + '[friction]\npair = ["POM", "steel"]\nsense = "tipward"\n'
    assert scenefile.loads(text).friction.coefficient == pytest.approx(0.275)


def test_an_unknown_plastic_lists_the_known_ones():
    with pytest.raises(LookupError, match=r"unknown material 'pom'; known: POM, PA66, PA66 conditioned, PC, ABS"):
        gr.material("pom")
    with pytest.raises(scenefile.SceneFileError, match=r"material: must be one of POM, PA66, .*; got 'wood'"):
        scenefile.loads(SCENE.format(material='material = "wood"'))
    with pytest.raises(LookupError, match=r"unknown partner 'glass' of 'PC'; known: steel, PC"):
        friction_range("PC", "glass")
