"""What `camring pareto` and `camring sensitivities` say of bad input, and the shares they use."""

import numpy as np
import pytest
from motor_files import SOUND, without_table

from camring.interfaces.config import parse_motor_file
from camring.interfaces.errors import InputError
from camring.interfaces.sensitivities import sensitivities
from camring.interfaces.trade_off import SENSES, _Traded, trade_off, traded_results
from camring.interfaces.trade_off_output import require_place
from camring.objective.slopes import results_used


def test_names_of_results():
    assert traded_results("efficiency, torque_ripple") == ("efficiency", "torque_ripple")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("torque_riple,efficiency", "you probably meant torque_ripple"),
        ("efficiency", "names 1 results; name 2 or 3"),
        ("efficiency,efficiency", "names 1 results"),
        ("zzz,efficiency", "give some of"),
    ],
)
def test_names_that_cannot_be_traded(text, words):
    with pytest.raises(InputError, match=words):
        traded_results(text)


def test_a_file_without_a_design_space(tmp_path):
    text = without_table("[design_space.cam]", without_table("[design_space]", SOUND))
    text = without_table("[search]", text)
    with pytest.raises(InputError, match="design_space"):
        trade_off(parse_motor_file(text), ("torque_ripple", "efficiency"))
    path = tmp_path / "motor.toml"
    path.write_text(text)
    with pytest.raises(InputError, match="design_space"):
        sensitivities(path)


def test_a_folder_that_is_there(tmp_path):
    with pytest.raises(InputError):
        require_place(tmp_path)
    with pytest.raises(InputError, match="does not exist"):
        require_place(tmp_path / "no" / "front")


def test_maxima_count_at_the_worst_point_and_means_by_weight():
    text = SOUND.replace("weight = 0.6", "weight = 0.75").replace("weight = 0.4", "weight = 0.25")
    model = _Traded(parse_motor_file(text), ("max_contact_stress", "efficiency"))
    results = [
        {"max_contact_stress": 2.0, "efficiency": 0.8},
        {"max_contact_stress": 1.0, "efficiency": 0.4},
    ]
    assert model.summed(results) == pytest.approx([2.0, 0.7])


@pytest.mark.parametrize(
    "names", [("torque_ripple", "efficiency"), ("jerk_objective", "efficiency", "torque_ripple")]
)
def test_slopes_of_what_is_traded_are_central_differences(names):
    """With results that the goal uses anyway, so that nothing is compiled for the test."""
    file = parse_motor_file(SOUND)
    assert set(names) <= set(results_used(file.goal)) & set(SENSES)
    model = _Traded(file, names)
    point = model.space.locate(file.system) * 0.9 + 0.02
    direction = np.random.default_rng(2).standard_normal(model.space.dimension)
    step = 1e-3 * direction / np.linalg.norm(direction)
    rise = (model.values(point + step)[0] - model.values(point - step)[0]) / 2
    found = model.slopes(point)[0] @ step
    np.testing.assert_allclose(found, rise, rtol=2e-2, atol=1e-9)
