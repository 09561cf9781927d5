"""What is wanted of a motor, as dimensionless terms with weights.

`J_phys = w1 R_tau^2 + w2 R_P^2 + w3 (1 - efficiency) + w4 J_spec + w5 J_jerk`,
docs/theory.md section 8.
"""

from dataclasses import dataclass

import jax.numpy as jnp
from jax.tree_util import register_dataclass
from jaxtyping import Array, Bool, Float

from camring.metrics.summary import Metrics


@register_dataclass
@dataclass(frozen=True)
class Weights:
    """How much each term counts; the defaults of docs/theory.md section 8.

    Examples
    --------
    >>> weights = camring.Weights(torque_ripple=1000.0)
    >>> weights.torque_ripple, weights.efficiency
    (1000.0, 1.0)
    """

    torque_ripple: float = 10.0
    pressure_ripple: float = 0.02
    efficiency: float = 1.0
    spectrum: float = 1.0
    jerk: float = 0.02
    spectral_pressure: float = 0.01
    spectral_torque: float = 1.0
    envelope_ripple: float = 0.0
    """Of the mean squared torque ripple over the envelope; no part of an operating point's sum."""
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


def inefficiency(
    efficiency: Float[Array, "*batch"],
    pumps: Bool[Array, "*batch"],
    brakes: Bool[Array, "*batch"],
) -> Float[Array, "*batch"]:
    """One minus efficiency, and more, without a jump, the less it is what it is meant to be.

    Seen as output over input: 1 for a motor that stands still, 2 for a brake that takes as
    much from its shaft as from its oil, 3 where it takes no more oil, and from there to 4
    for a pump without losses. A pump's good efficiency thus never counts as a motor's. Where
    `brakes`, the operating point's return above its supply, shaft and oil change places: it
    is a pump that is wanted.
    """
    taking = (efficiency < 0) & ~pumps
    other_way = jnp.where(taking, 1 / jnp.where(taking, efficiency, -1.0), efficiency)
    wanted = jnp.where(brakes, other_way, efficiency)
    worse = wanted < -1
    from_shaft = 3 + 1 / jnp.where(worse, wanted, -1)
    taken = jnp.where(worse, from_shaft, 1 - wanted)
    astray = jnp.where(brakes, (efficiency > 0) & ~pumps, pumps)
    return jnp.where(astray, 3 + jnp.abs(efficiency), taken)


def raw_terms(metrics: Metrics) -> dict[str, Float[Array, ""]]:
    """The unweighted terms of one operating point, keyed by `TERM_NAMES`."""
    values = (
        metrics.torque_ripple**2,
        metrics.pressure_ripple**2,
        inefficiency(metrics.efficiency, metrics.input_power < 0, metrics.ideal_torque < 0),
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
