"""Reduced displacement: lobes that idle, because a valve leads both their windows to the return.

Lobes are distinguished by their windows: lobe `k` has the `k`-th supply and the `k`-th return
window, counted from 0 here. A cam of equal lobes is repeated until it holds one period of
the pattern of idle lobes, so that a motor whose pattern repeats `g` times a revolution keeps
the period `2 pi / g`. docs/theory.md section 14.
"""

from dataclasses import replace
from math import gcd

import jax.numpy as jnp

from camring.geometry.cam import AbstractCam, PlanarCam, RadialCam
from camring.geometry.valve_plate import ValvePlate

__all__ = ["idling", "pattern_repeats"]


def pattern_repeats(idle_lobes: tuple[int, ...], lobes: int) -> int:
    """How often a revolution the pattern of idle lobes repeats; `lobes` when none or all idle."""
    idle = frozenset(idle_lobes)
    orders = (order for order in range(lobes, 0, -1) if lobes % order == 0)
    return next(g for g in orders if {(k + lobes // g) % lobes for k in idle} == idle)


def idling(
    cam: AbstractCam, plate: ValvePlate, idle_lobes: tuple[int, ...]
) -> tuple[AbstractCam, ValvePlate]:
    """Cam and plate with some lobes idle.

    Linear in their numbers; a batch may lie along the last axis of a radial cam.

    Raises
    ------
    ValueError
        For a cam that is neither radial nor planar.
    """
    repeats = gcd(cam.repeats, pattern_repeats(idle_lobes, plate.lobes))
    return _over(cam, repeats), replace(plate, idle_lobes=tuple(sorted(idle_lobes)))


def _over(cam: AbstractCam, repeats: int) -> AbstractCam:
    """The same curve, its period so long that it repeats only so often."""
    copies = cam.repeats // repeats
    if copies == 1:
        return cam
    if isinstance(cam, RadialCam):
        radii = jnp.concatenate([cam.control_radii] * copies)
        return RadialCam(radii, repeats=repeats, degree=cam.degree)
    if not isinstance(cam, PlanarCam):
        raise ValueError(
            f"Idle lobes need a radial or a planar cam, and {type(cam).__name__} is none; "
            "leave the mode out."
        )
    points = cam.control_points[:, 0] + 1j * cam.control_points[:, 1]
    whole = jnp.concatenate([points * jnp.exp(1j * cam.period * k) for k in range(copies)])
    pairs = jnp.stack([whole.real, whole.imag], axis=1)
    return PlanarCam(pairs, repeats=repeats, degree=cam.degree)
