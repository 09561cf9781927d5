"""A program is given the numbers of a goal: another limit or weight needs no other program."""

from dataclasses import replace
from pathlib import Path

import jax
import pytest
from motors import STRUCTURES, sound_case

import camring
from camring.files.motor import parse_motor_file
from camring.metrics.summary import Metrics
from camring.objective.constraints import Constraints, at_point
from camring.programs.leaves import split, whole_form
from camring.programs.motor_program import bare

EXAMPLE = Path(__file__).parents[2] / "examples" / "wheel_motor.toml"
LIMITS = Constraints(
    min_pressure=1e5,
    max_pressure=4e7,
    min_mean_torque=0.0,
    min_l10_life=3e6,
    displacement=(3e-4, 4e-4),
    lift=(0.0, 0.01),
)


def seen_by_a_program(goal: camring.Goal):
    leaves, structure = jax.tree.flatten(bare((goal,), {}))
    return structure, split(leaves, whole_form)[1]


def test_files_with_other_limits_and_weights_share_their_programs():
    text = EXAMPLE.read_text()
    other = text.replace('"1.9 GPa"', '"2.1 GPa"').replace('"30 deg"', '"31 deg"')
    given, changed = (parse_motor_file(each, EXAMPLE).goal for each in (text, other))
    assert changed.constraints.max_contact_stress == 2.1e9
    assert given != changed
    assert seen_by_a_program(given) == seen_by_a_program(changed)
    weights = replace(given, weights=camring.Weights(torque_ripple=3.0))
    assert seen_by_a_program(given) == seen_by_a_program(weights)


@pytest.mark.parametrize("change", [{"max_jerk": 1e9}, {"min_l10_life": None}])
def test_a_limit_more_or_less_is_another_program(change):
    goal = camring.Goal(constraints=LIMITS)
    other = camring.Goal(constraints=replace(LIMITS, **change))
    assert seen_by_a_program(goal) != seen_by_a_program(other)


def test_limits_as_data_say_what_limits_in_the_program_say():
    """Those that are zero too, where a margin is compared with something else."""
    case = sound_case(0, STRUCTURES[0])
    system = camring.System(case.motor, case.fluid, (case.point,))
    results = Metrics(**dict.fromkeys(Metrics.__dataclass_fields__, 1e-3))

    def said(limits):
        return at_point(limits, system, case.point.pressure_drop, results)

    data = jax.jit(said)(camring.Goal(constraints=LIMITS).as_data().constraints)
    assert {name: float(g) for name, g in data.items()} == pytest.approx(
        {name: float(g) for name, g in said(LIMITS).items()}, rel=1e-14
    )
