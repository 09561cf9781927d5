"""The rules of the house (docs/notes/house.md), kept by a machine."""

import ast
import importlib
import inspect
import pkgutil
import subprocess
from pathlib import Path

import equinox as eqx
import pytest

import camring

ROOT = Path(__file__).parent.parent
SOURCE = ROOT / "src" / "camring"
LONGEST_FILE = 350

LADDER = ("numerics", "geometry", "physics", "metrics", "objective", "interfaces")
MAY_IMPORT = {room: set(LADDER[: place + 1]) for place, room in enumerate(LADDER)}
MAY_IMPORT["search"] = {"search", "numerics"}
MAY_IMPORT["interfaces"].add("search")
ONLY_INTERFACES = {"pydantic", "pint", "typer", "click", "rich", "xarray", "h5netcdf", "h5py"}
ONLY_INTERFACES |= {"ezdxf", "xlsxwriter", "OCP", "optuna"}
ONLY_INTERFACES |= {"matplotlib"}  # and there only in `plots`, loaded when a figure is asked for
NOBODY = {"torch", "pandas"}

FILES = sorted(SOURCE.rglob("*.py"))


def room(path):
    return path.relative_to(SOURCE).parts[0]


def imported(path):
    """Every module that a file names in an import, at its top or inside a function."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path.name} imports by a relative name"
            yield node.module
            if node.module == "camring":
                yield from (f"camring.{a.name}" for a in node.names if a.name in MAY_IMPORT)


def modules():
    for found in pkgutil.walk_packages([str(SOURCE)], "camring."):
        yield importlib.import_module(found.name)


@pytest.fixture(scope="module")
def nouns():
    """Every equinox module of the program."""
    found = set()
    for module in modules():
        for _, kind in inspect.getmembers(module, inspect.isclass):
            if issubclass(kind, eqx.Module) and kind.__module__.startswith("camring."):
                found.add(kind)
    return found


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(SOURCE)))
class TestEveryFile:
    def test_imports_run_one_way(self, path):
        if path.parent == SOURCE:
            return
        for parts in (name.split(".") for name in imported(path)):
            if parts[0] == "camring" and len(parts) > 1:
                assert parts[1] in MAY_IMPORT[room(path)], ".".join(parts)
            assert parts[0] not in NOBODY
            if room(path) != "interfaces":
                assert parts[0] not in ONLY_INTERFACES, ".".join(parts)

    def test_is_short_enough_to_hold_one_idea(self, path):
        assert len(path.read_text().splitlines()) <= LONGEST_FILE

    def test_says_what_it_is(self, path):
        text = path.read_text()
        assert not text.strip() or ast.get_docstring(ast.parse(text))


def test_the_rooms_are_those_of_the_house():
    rooms = {path.name for path in SOURCE.iterdir() if path.is_dir() and path.name[0] != "_"}
    assert rooms == set(MAY_IMPORT)


def test_a_noun_is_abstract_or_final(nouns):
    for noun in nouns:
        for base in noun.__mro__[1:]:
            if base in nouns:
                assert base.__name__.startswith("Abstract"), f"{noun} derives from {base}"


def test_no_method_is_overridden(nouns):
    for noun in nouns:
        for name, value in vars(noun).items():
            if name.startswith("__") and name != "__call__":
                continue
            for base in noun.__mro__[1:]:
                if base in nouns and name in vars(base) and callable(value):
                    abstract = getattr(vars(base)[name], "__isabstractmethod__", False)
                    assert abstract, f"{noun.__name__}.{name} overrides {base.__name__}'s"


def test_the_public_names_can_be_had():
    for name in camring.__all__:
        assert getattr(camring, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'simulte'"):
        _ = camring.simulte


def test_no_file_names_a_machine_or_a_registry():
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    if listed.returncode:
        pytest.skip("not a checkout")
    # Spelt in two halves, so that this file does not hold them.
    forbidden = ["pypi" + ".org", "python" + "hosted", "/work" + "/", "/root" + "/", "/home" + "/"]
    for name in listed.stdout.splitlines():
        path = ROOT / name
        if path.suffix in (".py", ".toml", ".md", ".txt", ".cfg", "") and path.is_file():
            text = path.read_text(errors="replace")
            for word in forbidden:
                assert word not in text, f"{name} holds {word}"
