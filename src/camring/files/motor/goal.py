"""The tables `[objective]` and `[constraints]` as what is wanted of the motor."""

from camring.files.motor.tables import FileTables
from camring.objective.constraints import Constraints
from camring.objective.objective import Goal, Weights

WEIGHTS = (
    "torque_ripple",
    "pressure_ripple",
    "efficiency",
    "spectrum",
    "jerk",
    "spectral_pressure",
    "spectral_torque",
    "envelope_ripple",
    "penalty",
)


def build_goal(tables: FileTables) -> Goal:
    """Weights, constraints and number of harmonics of a file."""
    weights = {name: getattr(tables.objective, name) for name in WEIGHTS}
    return Goal(
        weights=Weights(**weights),
        constraints=Constraints(**tables.constraints.model_dump()),
        harmonics=tables.objective.harmonics,
    )
