"""What is forbidden: limits on results, each as a dimensionless `g <= 0`.

An upper limit gives `(value - limit)/|limit|`, a lower one its mirror; the
margin against cavitation is counted in pressure drops and that against
lift-off in pressure forces (docs/theory.md section 8). A limit that is not set is
not a constraint; chamber volume must always be positive.
"""

from dataclasses import dataclass
from typing import Any

import jax.numpy as jnp
from jax.tree_util import register_dataclass
from jaxtyping import Array, Float

from camring.metrics.summary import Metrics
from camring.numerics.selection import larger, largest
from camring.physics.system import System

UPPER_LIMITS = {
    "max_pressure": "max_pressure",
    "max_contact_stress": "max_contact_stress",
    "max_pressure_angle": "max_pressure_angle",
    "max_velocity": "max_velocity",
    "max_acceleration": "max_acceleration",
    "max_jerk": "max_jerk",
    "max_case_temperature_rise": "case_temperature_rise",
}
"""Constraint name to the result it bounds from above."""

LOWER_LIMITS = {
    "min_undercut_factor": "min_undercut_factor",
    "min_damping_ratio": "damping_ratio",
    "min_mean_torque": "mean_torque",
    "min_l10_life": "l10_life",
}
"""Constraint name to the result it bounds from below."""

BANDS = {
    "displacement": ("displacement", "displacement"),
    "stroke": ("stroke", "stroke"),
    "lift": ("min_lift", "max_lift"),
}
"""Constraint name to the results its lower and upper end bound."""

OF_ALL_LOBES = "displacement"
"""The band that asks nothing of an operating point at which lobes idle."""


@register_dataclass
@dataclass(frozen=True)
class Constraints:
    """Limits in SI; `None` is no limit. `min_pressure` defaults to the vapour pressure.

    docs/theory.md section 8 has the `g` of each.

    Examples
    --------
    >>> camring.Constraints(max_pressure=420e5, stroke=(0.010, 0.016)).names()
    ('min_pressure', 'chamber_volume', 'max_pressure', 'stroke_low', 'stroke_high')
    """

    min_pressure: float | None = None
    max_pressure: float | None = None
    max_contact_stress: float | None = None
    min_contact_force: float | None = None
    max_pressure_angle: float | None = None
    min_undercut_factor: float | None = None
    max_velocity: float | None = None
    max_acceleration: float | None = None
    max_jerk: float | None = None
    max_case_temperature_rise: float | None = None
    min_damping_ratio: float | None = None
    min_mean_torque: float | None = None
    min_l10_life: float | None = None
    displacement: tuple[float, float] | None = None
    stroke: tuple[float, float] | None = None
    lift: tuple[float, float] | None = None

    def names(self) -> tuple[str, ...]:
        """Constraints in the order in which `violations` reports them."""
        named = ["min_pressure", "chamber_volume"]
        if self.min_contact_force is not None:
            named.append("min_contact_force")
        named += [name for name in UPPER_LIMITS if getattr(self, name) is not None]
        named += [name for name in LOWER_LIMITS if getattr(self, name) is not None]
        for name in BANDS:
            if getattr(self, name) is not None:
                named += [f"{name}_low", f"{name}_high"]
        return tuple(named)

    def results_used(self) -> tuple[str, ...]:
        """The results that decide whether these limits hold."""
        limits = {**UPPER_LIMITS, **LOWER_LIMITS, "min_contact_force": "min_contact_force"}
        used = [result for name, result in limits.items() if getattr(self, name) is not None]
        for name, ends in BANDS.items():
            if getattr(self, name) is not None:
                used += ends
        return tuple(dict.fromkeys(["min_pressure", "min_volume", *used]))


def violations(
    constraints: Constraints, system: System, metrics: tuple[Metrics, ...]
) -> dict[str, Float[Array, ""]]:
    """Each constraint's `g`, the worst over the operating points; `g <= 0` holds."""
    each = [
        at_point(constraints, system, point.pressure_drop, results, bool(point.idle_lobes))
        for point, results in zip(system.operating_points, metrics, strict=True)
    ]
    return {
        name: largest(jnp.stack([found[name] for found in each]), axis=0)
        for name in constraints.names()
    }


def at_point(
    constraints: Constraints,
    system: System,
    drop: Float[Array, ""],
    metrics: Metrics,
    reduced: bool = False,
) -> dict[str, Float[Array, ""]]:
    """Each constraint's `g` at one operating point, of which only the pressure drop counts.

    Where it is negative the machine brakes, and a least mean torque is that of braking.
    Plain arithmetic: results and pressure drop may be numbers or arrays of any one shape.

    Parameters
    ----------
    reduced
        Whether lobes idle; the band of displacement is that of all lobes and holds then.
    """
    motor, size = system.motor, abs(drop)
    vapour, wanted = system.fluid.vapour_pressure, constraints.min_pressure
    least = vapour if wanted is None else jnp.asarray(wanted)
    found = {
        "min_pressure": (least - metrics.min_pressure) / size,
        "chamber_volume": -metrics.min_volume / motor.dead_volume,
    }
    if constraints.min_contact_force is not None:
        short = constraints.min_contact_force - metrics.min_contact_force
        found["min_contact_force"] = short / (motor.piston.area * size)
    for name, result in UPPER_LIMITS.items():
        limit = getattr(constraints, name)
        if limit is not None:
            found[name] = (getattr(metrics, result) - limit) / abs(limit)
    for name, result in LOWER_LIMITS.items():
        limit = getattr(constraints, name)
        if limit is not None:
            value = getattr(metrics, result)
            if result == "mean_torque":
                value = value * drop / size
            found[name] = (limit - value) / _size(limit, 1.0)
    for name, (lowest, highest) in BANDS.items():
        band = getattr(constraints, name)
        if band is not None:
            low, high = band
            found[f"{name}_low"] = (low - getattr(metrics, lowest)) / _size(low, high - low)
            found[f"{name}_high"] = (getattr(metrics, highest) - high) / _size(high, high - low)
            if reduced and name == OF_ALL_LOBES:
                for end in ("low", "high"):
                    found[f"{name}_{end}"] = -jnp.ones_like(found[f"{name}_{end}"])
    return found


def _size(limit: Any, otherwise: Any) -> Any:
    """What a limit is compared with: itself, unless it is zero; of numbers as of arrays."""
    return abs(limit) + (limit == 0) * otherwise


def penalty(found: dict[str, Float[Array, "*batch"]], factor: float) -> Float[Array, "*batch"]:
    """`lambda * sum max(0, g)^2`."""
    return factor * jnp.sum(larger(jnp.stack(list(found.values())), 0) ** 2, axis=0)
