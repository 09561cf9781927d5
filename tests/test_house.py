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
from benchmarks import import_graph

ROOT = Path(__file__).parent.parent
SOURCE = ROOT / "src" / "camring"
LONGEST_FILE = 350
LARGEST_FOLDER = 25

NO_MOTOR_FILES = ("numerics", "compiler", "geometry", "physics", "metrics", "objective")
NO_MOTOR_FILES += ("reference", "search", "version.py")
ONLY_AT_THE_EDGE = {"pydantic", "pint", "typer", "click", "rich", "xarray", "h5netcdf", "h5py"}
ONLY_AT_THE_EDGE |= {"ezdxf", "xlsxwriter", "OCP", "optuna"}
ONLY_AT_THE_EDGE |= {"matplotlib"}  # and there only in `plots`, loaded when a figure is asked for
NOBODY = {"torch", "pandas"}

FILES = sorted(SOURCE.rglob("*.py"))


def package(path):
    return path.relative_to(SOURCE).parts[0]


def imported(path):
    """Every module that a file names in an import, at its top or inside a function."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path.name} imports by a relative name"
            yield node.module


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


def misplaced(path):
    """Modules that a file imports and must not; import directions are import-linter's."""
    for name in imported(path):
        top = name.split(".")[0]
        if top in NOBODY or (package(path) in NO_MOTOR_FILES and top in ONLY_AT_THE_EDGE):
            yield name


def losing_slopes(path):
    """Calls whose derivative asks which number equals the result (`numerics/selection.py`)."""
    calls = [
        each.func for each in ast.walk(ast.parse(path.read_text())) if isinstance(each, ast.Call)
    ]
    for call in calls:
        if (
            isinstance(call, ast.Attribute)
            and call.attr
            in (
                "maximum",
                "minimum",
                "clip",
                "max",
                "min",
            )
            and isinstance(call.value, ast.Name)
            and call.value.id == "jnp"
        ):
            yield call.attr


def described(path):
    text = path.read_text()
    return not text.strip() or bool(ast.get_docstring(ast.parse(text)))


def test_what_knows_no_motor_file_loads_nothing_that_reads_or_draws():
    wrong = {str(path): list(misplaced(path)) for path in FILES if path.parent != SOURCE}
    assert not {path: names for path, names in wrong.items() if names}


def test_no_slope_hangs_on_two_numbers_being_equal():
    """A compiler that rounds one of them otherwise takes the slope away."""
    differentiated = {"numerics", "geometry", "physics", "metrics", "objective", "search"}
    there = [path for path in FILES if package(path) in differentiated]
    wrong = {str(path): list(losing_slopes(path)) for path in there if path.name != "selection.py"}
    assert not {path: names for path, names in wrong.items() if names}


def test_files_are_short_enough_to_hold_one_idea():
    lines = {str(path): len(path.read_text().splitlines()) for path in FILES}
    assert not {path: count for path, count in lines.items() if count > LONGEST_FILE}


def test_files_say_what_they_are():
    assert not [str(path) for path in FILES if not described(path)]


def test_a_file_in_the_wrong_package_would_be_found(tmp_path, monkeypatch):
    """Each rule refuses what it is there for."""
    monkeypatch.setitem(globals(), "SOURCE", tmp_path)
    (tmp_path / "physics").mkdir()
    path = tmp_path / "physics" / "law.py"
    path.write_text("import torch\nfrom pint import Unit\nimport jax\n")
    assert list(misplaced(path)) == ["torch", "pint"]
    assert not list(losing_slopes(path))
    path.write_text("x = jnp.maximum(y, 0) + jnp.clip(y, 0) + np.max(y)\n")
    assert list(losing_slopes(path)) == ["maximum", "clip"]
    assert not described(path)


def test_a_folder_is_read_at_a_glance():
    counts = {path: len(list(path.glob("*.py"))) for path in SOURCE.rglob("*") if path.is_dir()}
    assert not {str(path): count for path, count in counts.items() if count > LARGEST_FOLDER}


def test_no_file_imports_itself_by_a_detour():
    """Imports inside functions are imports."""
    assert import_graph.cycles(import_graph.graph_of(SOURCE)) == []


def test_a_detour_would_be_found(tmp_path):
    (tmp_path / "one.py").write_text("from pack import two\n")
    (tmp_path / "two.py").write_text("def late():\n    import pack.three\n")
    (tmp_path / "three.py").write_text("from pack.one import name\n")
    (tmp_path / "apart.py").write_text("import pack.one\n")
    package_folder = tmp_path.rename(tmp_path.with_name("pack"))
    graph = import_graph.graph_of(package_folder)
    assert import_graph.cycles(graph) == [3]
    assert import_graph.levels(graph) == 2


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
