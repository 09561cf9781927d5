"""What `import camring` gives to notebooks: its documented examples, and how things print."""

import doctest
import inspect
import pickle
from pathlib import Path
from types import SimpleNamespace

import equinox as eqx
import jax
import numpy as np
import pytest
from reference_files import DATA, reference_results

import camring

GUIDE = Path(__file__).parents[2] / "docs" / "guide" / "python.md"
VARIABLES = """
[design_space]
"motor.valve_plate.shift" = ["-1 deg", "1 deg"]
"motor.dead_volume" = ["4 cm^3", "6 cm^3"]
"""


@pytest.fixture(scope="module", autouse=True)
def folder(tmp_path_factory):
    """Where `motor.toml` of the examples lies."""
    place = tmp_path_factory.mktemp("python")
    text = (DATA / "mid.toml").read_text(encoding="utf-8") + VARIABLES
    (place / "motor.toml").write_text(text, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        yield place


@pytest.fixture(scope="module")
def metrics():
    return camring.summarise(camring.simulate("motor.toml"))[0]


PUBLIC = [name for name in camring.__all__ if not name.startswith("__")]
MODULES = ("optuna", "plots")
# Made by, or named in, something that has an example.
SHOWN_ELSEWHERE = {"Fit", "FunctionMinimum", "Gradients", "Port", "Study", "optuna"}
GLOBALS = {"camring": camring}


@pytest.mark.parametrize("name", ["camring", *sorted(set(PUBLIC) - SHOWN_ELSEWHERE)])
def test_examples_in_docstrings_say_what_comes_out(name):
    noun = camring if name == "camring" else getattr(camring, name)
    [found] = doctest.DocTestFinder(recurse=False).find(
        noun, name, module=False, globs=dict(GLOBALS)
    )
    assert found.examples, f"{name} has no example"
    said = []
    ran = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(found, out=said.append)
    assert not ran.failed, "".join(said)


@pytest.mark.parametrize("name", sorted(set(PUBLIC) - set(MODULES)))
def test_public_functions_say_what_they_take_and_when_they_refuse(name):
    said = getattr(camring, name).__doc__
    assert said
    assert not said.startswith(f"{name}("), "a dataclass's own words are none"
    if inspect.isfunction(getattr(camring, name)):
        assert "Parameters\n" in said


def test_examples_of_the_guide_say_what_comes_out():
    found = doctest.testfile(str(GUIDE), module_relative=False, optionflags=doctest.ELLIPSIS)
    assert found.attempted > 10
    assert found.failed == 0


def test_a_motor_file_and_its_name_and_its_system_are_the_same_motor(metrics):
    file = camring.read_motor_file("motor.toml")
    for given in (file, file.system, Path("motor.toml")):
        found = camring.simulate(given)
        assert isinstance(found, tuple)
        assert camring.summarise(found)[0].mean_torque == metrics.mean_torque


TOUCHING = pytest.param(
    [0.5, 0.5],
    id="windows touch each other and a knot",
    marks=pytest.mark.xfail(reason="known failure, docs/notes/verification.md"),
)


@pytest.mark.parametrize("point", [[0.6, 0.5], TOUCHING])
def test_gradients_are_central_differences(point):
    file = camring.read_motor_file("motor.toml")
    found = camring.gradients(file, point, results=["mean_torque"])
    at, step = found.point, 2e-3

    def torque(point):
        return camring.summarise(camring.simulate(file.design_space.apply(file.system, point)))[0]

    for k, slope in enumerate(found.results[0]["mean_torque"]):
        along = step * np.eye(2)[k]
        rise = torque(at + along).mean_torque - torque(at - along).mean_torque
        assert slope == pytest.approx(float(rise) / (2 * step), rel=1e-3)


def test_results_as_a_dictionary_are_plain_numbers_and_what_the_machine_works_as(metrics):
    found = metrics.to_dict()
    assert found.pop("operating_mode") == "motor"
    assert {type(value) for value in found.values()} == {float}
    for name, value in reference_results("mid")[0].items():
        assert found[name] == pytest.approx(value, rel=1e-5, abs=1e-12)
    many = jax.tree.map(lambda value: np.stack([value, value]), metrics).to_dict()
    assert many["stroke"].shape == (2,)
    assert many["operating_mode"].tolist() == ["motor", "motor"]


def test_results_print_their_numbers_with_units(metrics):
    lines = dict(line.split(maxsplit=1) for line in repr(metrics).splitlines()[1:])
    assert lines.keys() == vars(metrics).keys()
    assert float(lines["max_pressure"].removesuffix(" Pa")) == pytest.approx(249.09e5, rel=1e-5)
    assert lines["damping_ratio"].replace(".", "").isdigit()
    page = metrics._repr_html_()
    assert page.count("<tr>") == len(lines)
    assert ">m3/s</td>" in page


def test_results_of_many_motors_print_their_range_and_traced_ones_that_they_are(metrics):
    many = jax.tree.map(lambda value: np.stack([value, 2 * value]), metrics)
    assert f"{float(metrics.stroke):.6g} to {2 * float(metrics.stroke):.6g} (shape (2,)) m" in repr(
        many
    )
    seen = []
    jax.jit(lambda each: seen.append(repr(each)) or each.stroke)(metrics)
    assert "(traced, shape ())" in seen[0]
    assert "stroke" in repr(eqx.tree_at(lambda each: each.stroke, metrics, None))


def test_motor_and_system_print_numbers_not_kinds_of_arrays():
    system = camring.read_motor_file("motor.toml").system
    for noun in (system, system.motor, system.fluid, system.operating_points[0]):
        assert "f64[" not in repr(noun)
    said = repr(system)
    assert "bore: 0.036 m\n" in said
    assert "control_radii: 0.18 to 0.195 (shape (12,)) m" in said
    assert "bulk_modulus: 1.4e+09 Pa" in said
    assert pickle.loads(pickle.dumps(system)).motor.lobes == 6


REFUSED = {
    "without its oil": lambda motor, oil, point: camring.simulate(motor),
    "call camring.simulate\\(motor_file\\)": lambda motor, oil, point: camring.simulate(
        "motor.toml", oil, point
    ),
    "is int, which is no motor": lambda motor, oil, point: camring.simulate(3),
    "no such file|cannot be read|does not exist": lambda *_: camring.simulate("nowhere.toml"),
    "you probably meant mean_torque": lambda *_: camring.gradients(
        "motor.toml", results=["mean_torqe"]
    ),
    "give 2 numbers from 0 to 1": lambda *_: camring.gradients("motor.toml", [0.5]),
}


@pytest.mark.parametrize("said", REFUSED)
def test_what_cannot_be_simulated_is_one_sentence(said):
    system = camring.read_motor_file("motor.toml").system
    with pytest.raises(camring.InputError, match=said):
        REFUSED[said](system.motor, system.fluid, system.operating_points[0])


def test_a_batch_prints_as_a_batch():
    verdict = SimpleNamespace(code=np.zeros(3, int))
    shown = camring.Cycle.__repr__(SimpleNamespace(verdict=verdict))
    assert shown == "Cycle (of a batch or traced, (3,))"
