"""Thousands of spoilt files: a motor of finite numbers or one sentence, nothing else."""

import copy
import tomllib

import jax
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from motor_files import SOUND, planar, ring

from camring.files.errors import InputError
from camring.files.motor import MotorFile, parse_motor_file
from camring.files.motor.document import decode
from camring.files.motor.writer import whole_text

TEXTS = (SOUND, planar(), ring(24).replace("modes = 8", "modes = 2"))
DOCUMENTS = tuple(tomllib.loads(text) for text in TEXTS)

QUANTITIES = [
    "30 mm", "-1 mm", "0 mm", "1e308 km", "1e-320 mm", "250 bar", "28 deg", "361 deg", "100 rpm",
    "5 cm^3", "2e-13 m^3/(s*Pa)", "10 %", "-200 %", "1 Hz", "20 degC", "3 furlong", "3 psi", "nan",
    "inf bar", "", " ", "mm", "1,5 mm", "1 m^(2)", "1 m^-", "1 m/", "(((", "1 m**99", "1 kg/m3",
    "minimum", "mean", "ring", "planar", "radial", "lobes", "constant", "aerated", "linear", "💥",
]  # fmt: skip
NUMBERS = [0, -1, 1, 2, 3, 8, 1e-3, 0.05, 0.4, 1e5, 1e300, -1e300, 1e-300, float("nan"), 10**30]
KEYS = [
    "motor", "cam", "bore", "boar", "lobes", "control_radii", "control_points", "symmetry",
    "reference_radius", "representation", "degree", "speed", "relative", "bounds", "together_with",
    "law", "shape", "orifice", "weight", "modes", "mirror", "keep_displacement", "min_pressure",
    "motor.bore", "motor.pistons", "fluid.density", "", "a b", "é",
]  # fmt: skip

scalars = st.one_of(
    st.sampled_from(QUANTITIES),
    st.sampled_from([*NUMBERS, float("inf")]),
    st.booleans(),
    st.integers(-(2**70), 2**70),
    st.floats(),
    st.text(max_size=8),
    st.builds("{} {}".format, st.floats(-1e4, 1e4), st.sampled_from(["mm", "bar", "deg", "rpm"])),
)
values = st.recursive(
    scalars,
    lambda inner: st.one_of(
        st.lists(inner, max_size=5),
        st.dictionaries(st.sampled_from(KEYS), inner, max_size=3),
    ),
    max_leaves=6,
)


def places(here):
    """Every (container, key) in a document, inner ones included."""
    for key in here if isinstance(here, dict) else range(len(here)):
        yield here, key
        if isinstance(here[key], dict | list):
            yield from places(here[key])


@st.composite
def mutated_documents(draw):
    """A sound document with up to three places scaled, changed, removed, renamed or added to."""
    document = copy.deepcopy(draw(st.sampled_from(DOCUMENTS)))
    for _ in range(draw(st.integers(1, 3))):
        found = list(places(document))
        here, key = found[draw(st.integers(0, len(found) - 1))]
        _mutate(draw, here, key)
    return document


def _mutate(draw, here, key):
    kind = draw(st.sampled_from(["scale"] * 12 + ["change", "change", "remove", "rename", "add"]))
    value = here[key]
    if kind == "scale":
        here[key] = _scaled(draw, value)
    elif kind == "remove":
        del here[key]
    elif kind == "rename" and isinstance(here, dict):
        here[draw(st.sampled_from(KEYS))] = here.pop(key)
    elif kind == "add" and isinstance(value, dict):
        value[draw(st.sampled_from(KEYS))] = draw(values)
    else:
        here[key] = draw(values)


def _scaled(draw, value):
    """A number of the same kind, not far away; a list with one item more or less."""
    factor = draw(st.sampled_from([-1.0, 0.0, 0.5, 0.9, 0.99, 1.01, 1.1, 2.0, 5.0, 1e6, 1e-6]))
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + draw(st.integers(-3, 3))
    if isinstance(value, float):
        return value * factor
    if isinstance(value, str):
        number, _, unit = value.partition(" ")
        try:
            return f"{float(number) * factor!r} {unit}"
        except ValueError:
            return draw(st.sampled_from(QUANTITIES))
    if isinstance(value, list) and value:
        return draw(st.sampled_from([value[:-1], value[1:], [*value, value[0]], value[::-1]]))
    return value


def is_sound_or_refused(text):
    try:
        file = parse_motor_file(text)
    except InputError as error:
        sentence = str(error)
        assert sentence.isprintable()
        assert len(sentence) < 600
        assert sentence.endswith(".")
        assert "; " in sentence
        return None
    require_finite(file)
    return file


def require_finite(file: MotorFile):
    motor = file.system.motor
    for leaf in jax.tree.leaves(file.system):
        unused = leaf is motor.given_reference_radius and motor.reference != "given"
        assert unused or np.all(np.isfinite(np.asarray(leaf)))
    if file.design_space is not None:
        point = file.design_space.locate(file.system)
        assert np.all((point >= 0) & (point <= 1))


@settings(max_examples=300)
@given(document=mutated_documents())
def test_a_spoilt_document_is_a_motor_or_a_sentence(document):
    is_sound_or_refused(whole_text(document))


@pytest.mark.long
@settings(max_examples=3000)
@given(document=mutated_documents())
def test_many_spoilt_documents_are_motors_or_sentences(document):
    is_sound_or_refused(whole_text(document))


def spoil_and_read(data):
    content = bytearray(data.draw(st.sampled_from(TEXTS)).encode())
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(content) - 1))
        length = data.draw(st.sampled_from([0, 1, 1, 2, 40, 1000]))
        content[start : start + length] = data.draw(
            st.one_of(st.binary(max_size=3), st.sampled_from([b'"', b"\n", b"]", b"=", b"-", b"e"]))
        )
    try:
        text = decode(bytes(content), "motor.toml")
    except InputError:
        return
    is_sound_or_refused(text)


@settings(max_examples=200)
@given(data=st.data())
def test_a_spoilt_text_is_a_motor_or_a_sentence(data):
    spoil_and_read(data)


@pytest.mark.long
@settings(max_examples=1500)
@given(data=st.data())
def test_many_spoilt_texts_are_motors_or_sentences(data):
    spoil_and_read(data)


@settings(max_examples=300)
@given(document=st.dictionaries(st.sampled_from([*KEYS, *DOCUMENTS[0]]), values, max_size=5))
def test_any_document_is_a_motor_or_a_sentence(document):
    is_sound_or_refused(whole_text(document))


@settings(max_examples=300)
@given(text=st.text(max_size=200))
def test_any_text_is_a_motor_or_a_sentence(text):
    is_sound_or_refused(text)
