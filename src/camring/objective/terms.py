"""What is wanted of a motor, as dimensionless terms with weights.

`J_phys = w1 R_tau^2 + w2 R_P^2 + w3 (1 - efficiency) + w4 J_spec + w5 J_jerk`,
model.md section 8.
"""

from dataclasses import dataclass

import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.metrics.summary import Metrics


@dataclass(frozen=True)
class Weights:
    """How much each term counts; the defaults of model.md section 8."""

    torque_ripple: float = 10.0
    pressure_ripple: float = 0.02
    efficiency: float = 1.0
    spectrum: float = 1.0
    jerk: float = 0.02
    spectral_pressure: float = 0.01
    spectral_torque: float = 1.0
    penalty: float = 100.0


TERM_NAMES = (
    "torque_ripple_squared",
    "pressure_ripple_squared",
    "inefficiency",
    "spectral_pressure",
    "spectral_torque",
    "jerk",
)
"""The raw terms a study stores, so that weights can change without simulating again."""


TERM_RESULTS = (
    "torque_ripple",
    "pressure_ripple",
    "efficiency",
    "spectral_pressure",
    "spectral_torque",
    "jerk_objective",
)
"""The results that the terms are made of."""


def raw_terms(metrics: Metrics) -> dict[str, Float[Array, ""]]:
    """The unweighted terms of one operating point, keyed by `TERM_NAMES`."""
    values = (
        metrics.torque_ripple**2,
        metrics.pressure_ripple**2,
        # A motor that takes shaft power and gives oil is a pump: the worse the more it gives.
        1 - metrics.efficiency * jnp.where(metrics.input_power < 0, -1.0, 1.0),
        metrics.spectral_pressure,
        metrics.spectral_torque,
        metrics.jerk_objective,
    )
    return dict(zip(TERM_NAMES, values, strict=True))


def term_weights(weights: Weights) -> dict[str, float]:
    """The factor of each raw term in `J_phys`."""
    factors = (
        weights.torque_ripple,
        weights.pressure_ripple,
        weights.efficiency,
        weights.spectrum * weights.spectral_pressure,
        weights.spectrum * weights.spectral_torque,
        weights.jerk,
    )
    return dict(zip(TERM_NAMES, factors, strict=True))


def weighted_sum(
    terms: dict[str, Float[Array, "*batch"]], weights: Weights
) -> Float[Array, "*batch"]:
    """`J_phys` from raw terms."""
    weighted = [factor * terms[name] for name, factor in term_weights(weights).items()]
    return jnp.sum(jnp.stack(weighted), axis=0)
