"""Files that the reader accepts, to the ends of what it accepts: read to finite numbers."""

import time
from collections import Counter

import accepted_motors
import jax
import numpy as np
import pytest

from camring.files.errors import InputError
from camring.files.motor import laws, parse_motor_file
from camring.files.motor.document import LARGEST_FILE, read_text
from camring.files.motor.writer import whole_text

COUNT = 800
SLOWEST = 5.0  # s, of one file, on a busy machine


def read(seed, **drawn):
    """The file of a seed and the seconds that it took; the refusal where it is refused."""
    text = whole_text(accepted_motors.accepted(seed, **drawn))
    began = time.process_time()
    try:
        file = parse_motor_file(text)
    except InputError as error:
        return error, time.process_time() - began
    return file, time.process_time() - began


@pytest.fixture(scope="module")
def files():
    return [read(seed) for seed in range(COUNT)]


def test_nearly_all_are_accepted_and_the_others_get_a_sentence(files):
    refused = Counter(str(each) for each, _ in files if isinstance(each, InputError))
    assert sum(refused.values()) < 0.1 * COUNT, refused.most_common(5)
    for sentence in refused:
        assert sentence.isprintable()
        assert len(sentence) < 600


def test_every_number_of_an_accepted_file_is_finite(files):
    for file, _ in files:
        if isinstance(file, InputError):
            continue
        motor = file.system.motor
        for leaf in jax.tree.leaves(file.system):
            unused = leaf is motor.given_reference_radius
            assert unused or np.all(np.isfinite(np.asarray(leaf)))


def test_no_file_takes_long(files):
    assert max(seconds for _, seconds in files) < SLOWEST


def test_all_laws_and_all_counts_are_among_them(files):
    read_ones = [file for file, _ in files if not isinstance(file, InputError)]
    for place, slot in enumerate(laws.SLOTS):
        assert {file.choices.laws[place] for file in read_ones} == set(accepted_motors.ours(slot))
    for name in ("pistons", "lobes"):
        assert {getattr(file.system.motor, name) for file in read_ones} == set(range(1, 61))
    moduli = [float(file.system.fluid.bulk_modulus) for file in read_ones]
    assert (min(moduli), max(moduli)) == (1e5, laws.STIFFEST)
    speeds = [float(p.shaft_speed) for file in read_ones for p in file.system.operating_points]
    assert accepted_motors.spread([abs(each) for each in speeds]) == pytest.approx(8.0)


def test_a_file_of_100_megabytes_is_refused_at_its_size(tmp_path):
    large = tmp_path / "motor.toml"
    with large.open("wb") as file:
        file.truncate(100_000_000)
    with pytest.raises(InputError, match="100,000,000 bytes"):
        read_text(large)
    assert LARGEST_FILE < 1_000_000


def test_500_pistons_on_60_lobes_are_refused_and_what_the_reader_takes_is_read_quickly():
    document = accepted_motors.accepted(1)
    document["motor"]["pistons"] = 500
    with pytest.raises(InputError, match=r"500 but must lie between 1 and 200"):
        parse_motor_file(whole_text(document))
