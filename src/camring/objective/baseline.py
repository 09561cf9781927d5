"""`J_approx`: the objective by the linear model, for a surrogate to lean on.

Nominal pressure is the ideal commutation wave, supply pressure while the
chamber faces the supply port and return pressure while it faces the return
port; the linear chamber adds the throttling drop that motion causes. No
pressure equation is solved, so thousands of designs cost milliseconds
(docs/theory.md section 7).
"""

from math import pi

import jax.numpy as jnp
from jaxtyping import Array, Complex, Float

from camring.geometry.angles import signed_distance
from camring.geometry.extremes import extreme_radius
from camring.geometry.valve_plate import ValvePlate
from camring.metrics.displacement import driving
from camring.numerics.quantity import Q
from camring.numerics.selection import bounded, larger
from camring.objective.objective import Goal
from camring.objective.terms import TERM_NAMES, weighted_sum
from camring.physics.cycle import reference_radius
from camring.physics.force import radial_force
from camring.physics.linearised import linear_chamber
from camring.physics.operating_point import OperatingPoint
from camring.physics.rotation import turned
from camring.physics.system import System
from camring.physics.torque import torque_by_virtual_work

SAMPLES_PER_PITCH = 360
NARROWEST_SWITCH = 1 / 200
"""Switching takes at least this share of a lobe pitch, or a uniform grid would not see it."""


def commutation_wave(
    plate: ValvePlate, angle: Q[Float[Array, " angle"], "rad"]
) -> Float[Array, " angle"]:
    """One on the supply side, zero on the return side, linear from edge to edge between."""

    def beyond(port: Array, width: Array) -> Float[Array, " angle"]:
        return jnp.abs(signed_distance(angle, port + plate.shift, plate.pitch)) - width / 2

    from_supply = beyond(plate.supply.centre, plate.supply.width)
    from_return = beyond(plate.return_.centre, plate.return_.width)
    gap = larger(jnp.abs(from_supply + from_return), NARROWEST_SWITCH * plate.pitch)
    return bounded(0.5 + (from_return - from_supply) / (2 * gap), 0, 1)


def approximate(system: System, goal: Goal) -> Float[Array, ""]:
    """`J_approx` of a motor: the weighted mean of `J_phys` by the linear model."""
    each = [_terms(system, point, goal) for point in system.operating_points]
    terms = {name: jnp.stack([found[name] for found in each]) for name in TERM_NAMES}
    weights = jnp.stack([point.weight for point in system.operating_points])
    return jnp.sum(weights * weighted_sum(terms, goal.weights)) / jnp.sum(weights)


def _terms(system: System, point: OperatingPoint, goal: Goal) -> dict[str, Float[Array, ""]]:
    motor, fluid = turned(system.motor, point), system.fluid
    speed, drop, area = point.shaft_speed, point.pressure_drop, motor.piston.area
    count = SAMPLES_PER_PITCH * (motor.lobes // motor.cam.repeats)
    angle = motor.cam.period * jnp.arange(count) / count
    radius = motor.cam.pitch_radius(angle)
    lift = radius.value - reference_radius(motor)
    stroke = extreme_radius(motor.cam, 1) - extreme_radius(motor.cam, -1)
    travelled = jnp.abs(radius.first) * driving(motor.valve_plate, angle)
    displacement = motor.pistons * area * 2 * pi * jnp.mean(travelled) / 2
    ideal_torque = drop * displacement / (2 * pi)
    ideal_flow = displacement * speed / (2 * pi)

    orders = motor.cam.repeats * jnp.arange(count // 2 + 1)
    chamber = linear_chamber(
        motor,
        fluid,
        point,
        motor.dead_volume + area * jnp.mean(lift),
        2 * ideal_flow / motor.pistons,
    )
    ripple = chamber.transfer(orders * speed) * jnp.fft.rfft(lift)
    plate = motor.valve_plate
    side = commutation_wave(plate, angle) * (1 - plate.idle_share(plate.supply, angle))
    pressure = point.return_pressure + drop * side + jnp.fft.irfft(ripple, count)
    damping = motor.viscous_damping(fluid)
    lowest = extreme_radius(motor.cam, -1)
    force = radial_force(
        motor.piston, pressure, point.case_pressure, radius, speed, damping, lowest
    )
    torque = torque_by_virtual_work(force, radius)

    def power(wave: Float[Array, " angle"], kept: Array) -> tuple[Array, Array]:
        amplitude: Complex[Array, " order"] = jnp.fft.rfft(wave) / count
        heard = (orders > 0) & (orders <= goal.harmonics) & kept
        return amplitude[0].real, jnp.sum(jnp.where(heard, jnp.abs(amplitude) ** 2, 0))

    mean_torque, torque_power = power(motor.pistons * torque, orders % motor.pistons == 0)
    mean_gauge, pressure_power = power(pressure - point.return_pressure, orders >= 0)
    leaked = motor.leakage_flow(fluid, pressure, point.case_pressure)
    supplied = ideal_flow + motor.pistons * jnp.mean(side * leaked)
    share = mean_torque * speed / (drop * supplied)
    values = (
        torque_power / mean_torque**2,
        pressure_power / mean_gauge**2,
        1 - jnp.where(drop < 0, 1 / share, share),
        pressure_power / drop**2,
        torque_power / ideal_torque**2,
        jnp.mean(radius.third**2) / (stroke * motor.lobes**3) ** 2,
    )
    return dict(zip(TERM_NAMES, values, strict=True))
