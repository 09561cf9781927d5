"""A motor seen in a mirror: what it does is what the motor itself does turning backwards.

Only positive speeds can be simulated, for marching backwards in angle is unstable. The
mirror image of a motor, turned forwards, answers instead: at the opposite angle its
flows are the motor's own and its torque is the motor's with the other sign.
"""

from dataclasses import replace

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Shaped

from camring.geometry.cam import AbstractCam, PlanarCam, RadialCam
from camring.geometry.valve_plate import ValvePlate
from camring.geometry.window import AbstractWindow, TabulatedWindow
from camring.physics.motor import Motor


def has_mirror_image(motor: Motor) -> bool:
    """Whether `mirrored` knows the motor's parts; a relief notch it does not.

    A notch lies at the opening edge, and would have to lie at the closing edge.
    """
    return not motor.valve_plate.notched and isinstance(motor.cam, RadialCam | PlanarCam)


def mirrored(motor: Motor) -> Motor:
    """The motor with cam and valve plate reflected in the line of angle 0.

    For a motor that `has_mirror_image`; with a radial cam a batch may lie along the last axis.
    """
    return eqx.tree_at(
        lambda each: (each.cam, each.valve_plate),
        motor,
        (_mirrored_cam(motor.cam), _mirrored_plate(motor.valve_plate)),
    )


def _mirrored_cam(cam: AbstractCam) -> AbstractCam:
    if isinstance(cam, RadialCam):
        return eqx.tree_at(lambda c: c.control_radii, cam, _backwards(cam.control_radii))
    assert isinstance(cam, PlanarCam)
    points = cam.control_points
    flipped = _backwards(points[:, 0] - 1j * points[:, 1])
    # Behind the first, which stays, they come from the end of the period before.
    flipped = flipped * jnp.where(jnp.arange(len(points)) > 0, jnp.exp(1j * cam.period), 1)
    pairs = jnp.stack([flipped.real, flipped.imag], axis=1)
    return eqx.tree_at(lambda c: c.control_points, cam, pairs)


def _backwards(values: Shaped[Array, " control"]) -> Shaped[Array, " control"]:
    """A periodic sequence the other way round; its first stays."""
    return jnp.roll(values[::-1], 1, axis=0)


def _mirrored_plate(plate: ValvePlate) -> ValvePlate:
    idle = tuple(sorted(-lobe % plate.lobes for lobe in plate.idle_lobes))
    plate = replace(plate, idle_lobes=idle)
    places = (-plate.supply.centre, -plate.return_.centre, -plate.shift)
    return eqx.tree_at(
        lambda each: (each.supply.centre, each.return_.centre, each.shift, each.window),
        plate,
        (*places, _mirrored_window(plate.window)),
    )


def _mirrored_window(window: AbstractWindow) -> AbstractWindow:
    if not isinstance(window, TabulatedWindow):
        return window
    return eqx.tree_at(
        lambda each: (each.position, each.opening_share),
        window,
        (-window.position[::-1], window.opening_share[::-1]),
    )
