"""`[envelope]` in a motor file: what it takes, what it refuses, what is said of its check."""

from dataclasses import replace

import numpy as np
import pytest
from motor_files import SOUND, added, without_table

from camring.evaluation.envelope_batch import AtPoints
from camring.evaluation.outcome import EnvelopeNumbers, Outcome
from camring.evaluation.record import Record
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.physics.envelope import Envelope
from camring.studies.envelope_check import EnvelopeCheck
from camring.studies.envelope_grid import usual_envelope
from camring.studies.envelope_words import (
    broken_in_words,
    document_of,
    runs_in_words,
    unasked_in_words,
)
from camring.studies.store import Store
from camring.studies.validation import envelope_checks

TABLE = """
[envelope]
speed = ["30 rpm", "300 rpm"]
supply_pressure = ["70 bar", "350 bar"]
"""


def refused(text):
    with pytest.raises(InputError) as caught:
        parse_motor_file(text)
    return str(caught.value)


def test_it_takes_charge_and_case_from_the_operating_points():
    found = parse_motor_file(SOUND + TABLE).envelope
    assert found.speed == pytest.approx((np.pi, 10 * np.pi))
    assert found.supply_pressure == pytest.approx((7e6, 35e6))
    points = parse_motor_file(SOUND).system.operating_points
    assert found.return_pressure[1] == max(float(each.return_pressure) for each in points)
    assert not found.both_directions


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ('rotation = "bath"', "did you mean 'both'?"),
        ('supply_pressure_ = ["1 bar", "2 bar"]', "you probably meant envelope.supply_pressure"),
        ('return_pressure = ["10 bar", "80 bar"]', "not above the return pressure of 80 bar"),
        ("max_ripple_ratio = 0", "above zero"),
        ('max_efficiency_loss = "-1 %"', "must be zero or more"),
    ],
)
def test_what_it_cannot_take_is_refused_with_the_way_out(line, said):
    assert said in refused(f"{SOUND}{TABLE}{line}\n")


def test_a_temperature_needs_an_oil_that_follows_it():
    temperature = 'temperature = ["20 degC", "80 degC"]\n'
    rest = without_table("[fluid]")
    plain = '[fluid]\ndensity = "870 kg/m^3"\nbulk_modulus = "1.4 GPa"\nvapour_pressure = "3 kPa"\n'
    assert "has no effect without fluid.oil" in refused(f"{rest}\n{plain}{TABLE}{temperature}")
    named = '[fluid]\noil = "ISO VG 46"\ntemperature = "50 degC"\n'
    found = parse_motor_file(f"{rest}\n{named}{TABLE}{temperature}").envelope
    cold, hot = found.fluids
    assert float(cold.density) > 1.03 * float(hot.density)
    assert found.temperatures == pytest.approx((293.15, 353.15))


def test_a_weight_of_the_envelope_needs_one():
    said = refused(added("[objective]", "envelope_ripple = 5"))
    assert "objective.envelope_ripple has no effect without [envelope]" in said


def test_without_one_a_tenth_of_pressure_and_speed_is_looked_at():
    points = parse_motor_file(SOUND).system.operating_points
    found = usual_envelope(parse_motor_file(SOUND).system)
    fastest = max(float(each.shaft_speed) for each in points)
    assert found.speed[0] <= 0.1 * fastest * (1 + 1e-12)
    drop = max(float(each.pressure_drop) for each in points)
    assert found.supply_pressure[0] - found.return_pressure[1] == pytest.approx(0.1 * drop)


def test_without_one_speeds_of_points_with_idle_lobes_are_not_asked_of_all_lobes():
    mode = "\n[motor.modes.half]\nidle_lobes = [1, 3, 5]\n"
    text = SOUND.replace("weight = 0.6", 'weight = 0.6\nmode = "half"') + mode
    half, full = parse_motor_file(text).system.operating_points
    assert float(half.shaft_speed) > float(full.shaft_speed)
    found = usual_envelope(parse_motor_file(text).system)
    assert found.speed[1] == float(full.shaft_speed)
    # Where every point has a mode there are no others to go by.
    all_half = text.replace("weight = 0.4", 'weight = 0.4\nmode = "half"')
    found = usual_envelope(parse_motor_file(all_half).system)
    assert found.speed[1] == float(half.shaft_speed)


class Results:
    """What of a summary the words need."""

    def __init__(self, count):
        self.torque_ripple, self.efficiency = np.full(count, 0.05), np.full(count, 0.9)
        self.min_contact_force, self.vapour_margin = np.full(count, 9.0), np.full(count, 5e5)


def check(asked, best_limits, given=-0.5):
    """A given motor that keeps its limits, and a best one with these at 3 x 2 points."""
    envelope = Envelope((np.pi, 10 * np.pi), (7e6, 35e6), (1e6, 1e6))
    grid = envelope.grid(3, 2)
    names = ("min_contact_force", "min_pressure")
    kept = {name: np.full(6, given) for name in names}
    broken = {name: np.array(best_limits, dtype=float) for name in names[:1]}
    limits = [kept, {**kept, **broken}]
    found = [AtPoints(grid, each, Results(6), np.zeros(6, int)) for each in limits]
    return EnvelopeCheck(envelope, asked, *found, limits, {})


def test_a_sound_motor_is_said_to_run_in_its_whole_range():
    found = check(True, [-0.1] * 6)
    assert runs_in_words(found) == (
        "runs without lift-off or cavitation from 70 to 350 bar, 30 to 300 rpm, at 10 bar charge"
    )
    assert not found.broken().any()
    assert broken_in_words(found) == []


def test_a_motor_that_lifts_off_at_part_load_is_said_to_and_where():
    # At 70 bar it lifts off at all three speeds, most at the highest.
    found = check(False, [0.1, -0.2, 0.2, -0.2, 0.3, -0.2])
    assert found.broken().tolist() == [True, False, True, False, True, False]
    assert found.tightest() == 4
    assert "lifts its rollers or cavitates at 3 of 6 points" in runs_in_words(found)
    assert "at every speed from 350 bar only" in runs_in_words(found)
    said = unasked_in_words(found)
    assert "rollers lift off from 70 bar at 30 to 300 rpm, at 3 of 6 points" in said
    assert "by 0.3 of its scale at 300 rpm, 70 bar" in said
    assert "add [envelope]" in said


def test_what_the_given_motor_breaks_too_is_no_news():
    found = check(False, [0.1] * 6, given=0.2)
    assert unasked_in_words(found) == ""


def test_a_document_of_a_check_is_plain_numbers():
    document = document_of(check(True, [-0.1] * 6))
    assert document["asked"] is True
    assert document["warning"] == ""
    assert document["designs"]["best"]["binding"] == ["min_contact_force"] * 6
    assert all(isinstance(each, float) for each in document["speed"])


def test_a_study_gives_back_every_point_bit_for_bit(tmp_path):
    numbers = EnvelopeNumbers(
        {"min_pressure": [-0.1, 1 / 3]},
        {"efficiency": [0.9, 2 / 3]},
        0.1 + 0.2,
        {"max_pressure": -7e-3},
    )
    store = Store.create(tmp_path, {})
    for trial, envelope in enumerate((numbers, None)):
        outcome = Outcome(1.0, {"min_pressure": 1 / 3}, envelope=envelope)
        store.append(Record(trial, "initial", np.zeros(2), outcome), {})
    first, second = store.records()
    assert first.outcome.envelope == numbers
    assert second.outcome.envelope is None
    store.close()


def test_a_best_design_keeps_its_limits_by_more_between_the_points():
    def record(g):
        numbers = EnvelopeNumbers({"min_pressure": [-1.0, g]}, {})
        return Record(0, "", np.zeros(1), Outcome(1.0, {"min_pressure": g}, envelope=numbers))

    assert record(-3e-3).safe
    assert not record(-1e-3).safe
    assert record(-1e-3).feasible


def test_validated_needs_every_point_and_the_second_solver():
    good = replace(check(True, [-0.1] * 6), second={0: ("min_pressure", -0.2)})
    assert all(each.passed for each in envelope_checks(good))
    broken = {each.name for each in envelope_checks(check(True, [0.1] * 6)) if not each.passed}
    assert broken == {"min_contact_force in the envelope"}
    doubted = replace(good, second={4: ("max_pressure", 0.01)})
    (found,) = [each for each in envelope_checks(doubted) if not each.passed]
    assert "SciPy" in found.name
    assert "300 rpm, 70 bar" in found.name
    unsolved = replace(good, second={}, failure="no orbit closes")
    assert [each.detail for each in envelope_checks(unsolved) if not each.passed] == [
        "no orbit closes"
    ]
