"""What a goal says of a design, as plain numbers."""

import math

import jax

from camring.evaluation.outcome import Outcome
from camring.numerics.verdict import Verdict
from camring.objective.objective import Assessment


def outcome_of(
    assessment: Assessment, approximation: float = math.nan, design: dict | None = None
) -> Outcome:
    """The assessment as plain numbers; a faulty one has no objective but says why."""
    found: Assessment = jax.device_get(assessment)
    sentences = [Verdict(code).explain() for code in found.faults]
    failure = "; ".join(dict.fromkeys(sentence for sentence in sentences if sentence)) or None
    if failure is None and not math.isfinite(found.objective):
        failure = _without_a_number(found)
    return Outcome(
        objective=math.nan if failure else float(found.objective),
        physical_objective=math.nan if failure else float(found.physical_objective),
        approximation=approximation,
        constraints={name: float(value) for name, value in found.constraints.items()},
        terms=[
            {name: float(values[place]) for name, values in found.terms.items()}
            for place in range(len(found.metrics))
        ],
        results=[
            {name: float(value) for name, value in vars(metrics).items()}
            for metrics in found.metrics
        ],
        design=design or {},
        failure=failure,
    )


def _without_a_number(found: Assessment) -> str:
    least = min(float(metrics.min_undercut_factor) for metrics in found.metrics)
    if least <= 0:
        return (
            f"the rollers undercut the ring (least undercut factor {least:.3g}, it must exceed 0), "
            "and the contact stress has no bound"
        )
    names = [name for name, value in found.constraints.items() if not math.isfinite(value)]
    return f"no finite number for {', '.join(names).replace('_', ' ') or 'the objective'}"
