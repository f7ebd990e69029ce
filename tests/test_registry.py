import sys
import textwrap
from dataclasses import dataclass

import pytest

from gripper.fingers import Finger, Jaw
from gripper.loads import Load
from gripper.objects import ImplicitSurface, Object
from gripper.registry import GROUPS, OWN, PluginError, check, fault, installed, load, scene_name, unreadable
from gripper.registry import record_of as record_of_class
from gripper_plugins.jaws import Triangle

BASES = {"gripper.objects": Object, "gripper.fingers": Finger, "gripper.jaws": Jaw, "gripper.loads": Load}

GOOD_JAW = """
from dataclasses import dataclass
from gripper.fields import Positive
from gripper.fingers import Jaw

@dataclass(frozen=True, kw_only=True)
class Peg(Jaw):
    size: Positive

    def polygon(self, thickness):
        return ((0, 0), (self.size, 0), (0, self.size))

@dataclass(frozen=True, kw_only=True)
class NoPolygon(Jaw):
    size: Positive

@dataclass(frozen=True, kw_only=True)
class Clash(Peg):
    shape: Positive

class NoDataclass(Peg):
    pass

@dataclass(frozen=True, kw_only=True)
class TakesNothing(Jaw):
    def polygon(self):
        return ()

@dataclass(frozen=True, kw_only=True)
class NoMethod(Jaw):
    polygon: tuple[float, ...] = ()

@dataclass(frozen=True, kw_only=True)
class Misspelt(Peg):
    other: "Postive" = 1

@dataclass(frozen=True)
class Stranger:
    size: float

constant = 3
"""


@pytest.fixture
def distribution(tmp_path, monkeypatch):
    """Install a distribution: a folder on sys.path with a module and its metadata."""

    def make(name, entries, module="", source=GOOD_JAW):
        folder = tmp_path / name
        metadata = folder / f"{name.replace('-', '_')}-2.5.dist-info"
        metadata.mkdir(parents=True)
        (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 2.5\n")
        (metadata / "entry_points.txt").write_text(textwrap.dedent(entries))
        if module:
            (folder / f"{module}.py").write_text(source)
            monkeypatch.delitem(sys.modules, module, raising=False)
        monkeypatch.syspath_prepend(str(folder))

    before = set(sys.modules)
    yield make
    for module in set(sys.modules) - before:
        if module.startswith("foreign_"):
            del sys.modules[module]


def record_of(group, name):
    return next(record for record in installed(group) if record.name == name)


@pytest.mark.parametrize("group", GROUPS)
def test_every_plugin_of_this_project_is_listed_and_loads(group):
    records = [record for record in installed(group) if record.distribution == "gripper"]
    assert records
    for record in records:
        assert check(record) is None, record
        assert issubclass(load(group, record.name), BASES[group])


def test_an_unknown_name_lists_the_known_ones_and_the_nearest():
    with pytest.raises(LookupError, match=r"unknown object 'elipse'; known: circle, .*did you mean 'ellipse'\?"):
        load("gripper.objects", "elipse")


def test_an_unknown_group_lists_the_known_ones():
    with pytest.raises(LookupError, match=r"unknown group 'gripper.object'; known: gripper.objects"):
        load("gripper.object", "circle")


def test_another_distribution_offers_a_plugin_by_its_entry_point_alone(distribution):
    distribution("foreign-jaws", "[gripper.jaws]\npeg = foreign_good:Peg\n", "foreign_good")
    assert load("gripper.jaws", "peg")(size=1).polygon(0.1)
    record = record_of("gripper.jaws", "peg")
    assert (record.distribution, record.version, record.target) == ("foreign-jaws", "2.5", "foreign_good:Peg")
    assert check(record) is None


def test_listing_imports_nothing(distribution):
    distribution("foreign-lazy", "[gripper.jaws]\nlazy = foreign_lazy:Peg\n", "foreign_lazy", "raise RuntimeError")
    assert record_of("gripper.jaws", "lazy")
    assert "foreign_lazy" not in sys.modules


BROKEN = {
    "foreign_missing:Peg": "No module named 'foreign_missing'",
    "foreign_broken:Peg": "its import fails with ZeroDivisionError",
    "foreign_exits:Peg": "its import fails with SystemExit",
    "foreign_evades:Peg": "its import fails with Own: away",
    "foreign_babbles:Peg": "its import fails with Own: its message cannot be read, ZeroDivisionError",
    "foreign_escapes:Peg": "its import fails with RuntimeError: long long",
    "foreign_mixed:Peggy": "its import fails with AttributeError",
    "foreign_mixed": "it must be a class; got module",
    "foreign_mixed:constant": "it must be a class; got int",
    "foreign_mixed:Stranger": "it must be a subclass of gripper.fingers.Jaw; got Stranger",
    "foreign_mixed:NoDataclass": "it must be a frozen dataclass; got NoDataclass",
    "foreign_mixed:TakesNothing": "its polygon must take thickness; got nothing",
    "foreign_mixed:NoMethod": "its polygon must be a method; got a tuple",
    "foreign_mixed:Misspelt": "its fields must have types that can be looked up; got NameError: name 'Postive'",
    "foreign_mixed:NoPolygon": "it must write polygon",
    "foreign_mixed:Clash": "its fields must have other names than the scene file's own keys; got shape",
    "not a target!": "its import fails with",
}
SOURCES = {
    "foreign_broken": "1 / 0",
    "foreign_exits": "import sys\nsys.exit(3)",
    "foreign_evades": "class Own(BaseException):\n    pass\nraise Own('away')",
    "foreign_babbles": "class Own(Exception):\n    def __str__(self):\n        return 1 / 0\nraise Own",
    "foreign_escapes": "raise RuntimeError('\\n\\n'.join('long' for _ in range(9999)))",
}


@pytest.mark.parametrize("target", BROKEN)
def test_a_broken_plugin_says_why_and_whose_it_is_and_takes_no_other_down(distribution, target):
    module = target.split(":")[0] if target.startswith(("foreign_b", "foreign_e", "foreign_mixed")) else ""
    distribution("foreign-broken", f"[gripper.jaws]\nbad = {target}\n", module, SOURCES.get(module, GOOD_JAW))
    with pytest.raises(PluginError) as refusal:
        load("gripper.jaws", "bad")
    assert BROKEN[target] in str(refusal.value)
    assert "jaw 'bad' of foreign-broken 2.5" in str(refusal.value)
    assert BROKEN[target] in (check(record_of("gripper.jaws", "bad")) or "")
    assert load("gripper.jaws", "triangle")


def test_a_name_that_two_distributions_offer_is_refused_with_both(distribution):
    distribution("foreign-one", "[gripper.jaws]\npeg = foreign_one:Peg\n", "foreign_one")
    distribution("foreign-two", "[gripper.jaws]\npeg = foreign_two:Peg\n", "foreign_two")
    with pytest.raises(PluginError, match=r"foreign-one 2.5 .* and foreign-two 2.5 .*: write 'foreign-one:peg' or"):
        load("gripper.jaws", "peg")
    offers = [record for record in installed("gripper.jaws") if record.name == "peg"]
    assert [record.distribution for record in offers] == ["foreign-one", "foreign-two"]
    assert [scene_name(record) for record in offers] == ["foreign-one:peg", "foreign-two:peg"]
    for record in offers:
        assert check(record) is None
        assert load("gripper.jaws", scene_name(record)).__module__ == record.target.split(":")[0]


def test_a_stranger_s_plugin_with_a_name_of_this_project_s_is_called_with_its_distribution(distribution):
    distribution("foreign-jaws", "[gripper.jaws]\ntriangle = foreign_good:Peg\n", "foreign_good")
    assert load("gripper.jaws", "triangle") is Triangle
    assert load("gripper.jaws", "foreign-jaws:triangle").__name__ == "Peg"
    own, other = sorted(
        (r for r in installed("gripper.jaws") if r.name == "triangle"), key=lambda r: r.distribution != OWN
    )
    assert (check(own), check(other)) == (None, None)
    assert (scene_name(own), scene_name(other)) == ("triangle", "foreign-jaws:triangle")
    assert record_of_class(Triangle) == own


def test_a_class_that_another_module_repeats_is_known_by_its_entry_point(distribution):
    distribution("foreign-jaws", "[gripper.jaws]\npeg = foreign_good:Peg\n", "foreign_good")
    peg = load("gripper.jaws", "peg")
    peg.__module__ = "foreign_good.inner"  # as where a package's __init__ imports it
    assert record_of_class(peg).name == "peg"


def test_a_name_of_a_stranger_for_this_project_s_class_does_not_rename_it(distribution):
    distribution("foreign-jaws", "[gripper.jaws]\naaa = gripper_plugins.jaws.triangle:Triangle\n")
    assert record_of_class(Triangle).name == "triangle"


@pytest.mark.parametrize("entries", ["[gripper.jaws]\nno equals sign\n", "peg = a:b\n[gripper.jaws\nx\n"])
def test_a_distribution_whose_entry_points_cannot_be_read_is_named_and_takes_no_other_down(distribution, entries):
    distribution("foreign-garbled", entries)
    assert load("gripper.jaws", "triangle")
    assert all(check(record) is None for record in installed("gripper.jaws"))
    named = [line for line in unreadable() if line.startswith("foreign-garbled 2.5: its entry points cannot be read (")]
    assert len(named) == 1 or "no equals" not in entries


def test_a_surface_that_is_not_quadratic_must_say_where_it_is_before_it_is_made():
    class Quartic(ImplicitSurface):
        def g(self, x, y):
            return x**4 + y**2 / self.radius - self.radius

    class Bounded(Quartic):
        def half_size(self):
            return 1.0

    class Numbers(Quartic):
        def g(self, x, y):
            return float(self.radius) * x**4  # nothing can be told without its numbers

    fields = {"__annotations__": {"radius": "float"}}
    made = [dataclass(frozen=True, kw_only=True)(type(c.__name__, (c,), fields)) for c in (Quartic, Bounded, Numbers)]
    said = [fault("gripper.objects", cls) for cls in made]
    assert said == ["it must write half_size, because its g is not quadratic", None, None]
