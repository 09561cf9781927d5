"""The bill of materials names what is installed, as it is installed, and no address."""

import json
from importlib.metadata import distribution, version

import pytest

from benchmarks.bill_of_materials import bill


@pytest.fixture(scope="module")
def found():
    pytest.importorskip("packaging")
    return bill(["plot"])


def test_every_package_that_camring_needs_is_there_in_its_version(found):
    parts = {each["name"]: each for each in found["components"]}
    for name in ("jax", "jaxlib", "numpy", "scipy", "llvmlite", "matplotlib"):
        assert parts[name]["version"] == version(name)
    assert found["metadata"]["component"]["version"] == distribution("camring").version
    assert {"pytest", "sphinx"}.isdisjoint(parts)


def test_what_is_needed_is_part_of_the_bill(found):
    names = {each["name"] for each in found["components"]} | {"camring"}
    needs = {each["ref"]: each["dependsOn"] for each in found["dependencies"]}
    assert names == set(needs)
    assert names >= {other for each in needs.values() for other in each}
    assert "jax" in needs["camring"]


def test_nearly_every_package_states_its_licence(found):
    silent = [each["name"] for each in found["components"] if "licenses" not in each]
    assert len(silent) <= 3, silent


def test_the_same_environment_gives_the_same_bill_without_addresses(found):
    text = json.dumps(found)
    assert json.dumps(bill(["plot"])) == text
    assert "://" not in text
