"""What `camring pareto` and `camring sensitivities` say of bad input, and the shares they use."""

from types import SimpleNamespace

import numpy as np
import pytest
from motor_files import SOUND, without_table

from camring.analyses.sensitivities import sensitivities
from camring.evaluation.assessed import outcome_of
from camring.evaluation.evaluator import applied
from camring.evaluation.strategy import first_points
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.physics.resolution import Resolution
from camring.presentation.pareto import require_place, sentences
from camring.programs.compiled import assess
from camring.studies import pareto
from camring.studies.design_gradients import _InBatch, _OneByOne
from camring.studies.objectives import Traded
from camring.studies.pareto import trade_off, traded_results


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


def test_a_front_that_no_other_solver_confirms_says_why():
    found = SimpleNamespace(
        compromises=[1, 2], evaluations=3, screened=4, search_seconds=1.0, check_seconds=1.0,
        volume=0.5, sample=2, independent=np.inf, dropped=[],
        unconfirmed="no second solver for SealRingLeakage",
    )  # fmt: skip
    assert "Not confirmed by another solver: no second solver for SealRingLeakage." in sentences(
        found
    )
    found.unconfirmed, found.independent = "", 3e-7
    assert "SciPy's stiff solver agrees on 2 of them to 3.0e-07." in sentences(found)


def test_a_front_starts_from_the_given_motor_and_from_theory():
    file = parse_motor_file(SOUND)
    starts = np.array(pareto._starts(Traded(file, ("torque_ripple", "efficiency")), 0))
    first = first_points(file, theory=True)
    assert len(first) > 1
    assert starts[: len(first)] == pytest.approx(first)
    assert starts[0] == pytest.approx(file.design_space.locate(file.system))


@pytest.mark.parametrize(("reached", "said"), [(0.0, []), (1e-9, ["a in its envelope"])])
def test_a_limit_of_the_envelope_that_is_just_reached_is_kept(monkeypatch, reached, said):
    limits = {"a": np.array([-1.0, reached]), "b": np.array([-1.0, -1.0])}
    found = SimpleNamespace(motors=[SimpleNamespace(faults=np.zeros(2))], limits=[limits])
    monkeypatch.setattr(pareto, "check_envelope", lambda given, motor: found)
    file = SimpleNamespace(envelope="any")
    assert pareto._broken(file, file, SimpleNamespace(constraints={"c": reached - 1})) == said


def test_maxima_count_at_the_worst_point_and_means_by_weight():
    text = SOUND.replace("weight = 0.6", "weight = 0.75").replace("weight = 0.4", "weight = 0.25")
    model = Traded(parse_motor_file(text), ("max_contact_stress", "efficiency"))
    results = [
        {"max_contact_stress": 2.0, "efficiency": 0.8},
        {"max_contact_stress": 1.0, "efficiency": 0.4},
    ]
    assert model.summed(results) == pytest.approx([2.0, 0.7])


TRADED = ("efficiency", "jerk_objective", "max_contact_stress")


def near(model, count):
    """Points about the given design."""
    centre = model.space.locate(model.file.system) * 0.9 + 0.02
    return centre + 0.02 * np.random.default_rng(1).standard_normal((count, len(centre)))


def test_slopes_of_what_is_traded_are_central_differences():
    """More points than one call takes, so that the parts of a batch are held apart."""
    model = Traded(parse_motor_file(SOUND), TRADED)
    points = near(model, 10)
    directions = np.random.default_rng(2).standard_normal(points.shape)
    steps = 1e-3 * directions / np.linalg.norm(directions, axis=1, keepdims=True)
    for kind, (plus, minus, slopes) in enumerate(
        zip(
            model.values(points + steps),
            model.values(points - steps),
            model.slopes(points),
            strict=True,
        )
    ):
        found = np.einsum("pkd,pd->pk", slopes, steps)
        scale = np.max(np.abs(found), axis=0)
        agree = np.abs(found - (plus - minus) / 2) < 2e-2 * scale + 1e-9
        assert np.mean(agree) > (0.99 if kind == 0 else 0.9)  # a limit may have a kink on the way


def test_a_batch_says_what_each_design_says_alone():
    """To what docs/notes/batch.md states of final resolution."""
    model = Traded(parse_motor_file(SOUND), TRADED)
    points = near(model, 3)
    losses, limits = model.values(points)
    for point, loss, limit in zip(points, losses, limits, strict=True):
        system = applied(model.space, model.file.system, point)
        alone = outcome_of(assess(system, model.file.goal, Resolution()))
        np.testing.assert_allclose(-model.senses * model.summed(alone.results), loss, rtol=5e-4)
        names = model.file.goal.constraints.names()
        np.testing.assert_allclose([alone.constraints[n] for n in names], limit, atol=1e-3)


def test_designs_without_a_batch_say_the_same_in_the_same_order():
    """Slopes too, so that each limit goes with its own; stresses are coarser in a batch."""
    file = parse_motor_file(SOUND)
    given = file.system, file.goal, file.design_space, TRADED
    points = near(Traded(file, TRADED), 2)
    together, alone = (gradients(*given) for gradients in (_InBatch, _OneByOne))
    for side_by_side, one_by_one in zip(together.values(points), alone.values(points), strict=True):
        np.testing.assert_allclose(side_by_side, one_by_one, rtol=5e-4, atol=1e-3)
    of_both = zip(together.slopes(points)[1:], alone.slopes(points)[1:], strict=True)
    for side_by_side, one_by_one in of_both:
        length, other = (np.linalg.norm(each, axis=-1) for each in (side_by_side, one_by_one))
        steep = other > 1e-6  # what no coordinate changes has a direction of rounding
        cosine = np.sum(side_by_side * one_by_one, axis=-1)[steep] / (length * other)[steep]
        assert np.all(cosine > 0.99)
        assert np.all(length[~steep] < 1e-6)
