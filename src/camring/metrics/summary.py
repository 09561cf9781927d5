"""The numbers of a data sheet: one record for each operating point."""

from math import pi
from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.contour import pressure_angle, undercut_factor
from camring.geometry.extremes import extreme_radius
from camring.metrics.cavitation import Cavitation, cavitation
from camring.metrics.power_balance import PowerBalance, power_balance
from camring.metrics.spectrum import chamber_spectra, of_all_pistons, quadrature_samples
from camring.metrics.stiffness import oscillator
from camring.metrics.torque_range import torque_range
from camring.numerics.extremum import EXTREMUM_FRACTIONS, maximum, minimum, total_variation
from camring.numerics.quantity import Q
from camring.physics.cycle import Cycle
from camring.physics.piston_state import sample_elements


class Metrics(eqx.Module):
    """Results of model.md section 10, in SI, and their companions."""

    mean_torque: Q[Float[Array, ""], "N.m"]
    torque_ripple: Q[Float[Array, ""], "1"]
    torque_ripple_true_rms: Q[Float[Array, ""], "1"]
    torque_ripple_peak_to_peak: Q[Float[Array, ""], "1"]
    pressure_ripple: Q[Float[Array, ""], "1"]
    pressure_ripple_true_rms: Q[Float[Array, ""], "1"]
    flow_ripple: Q[Float[Array, ""], "1"]
    flow_ripple_true_rms: Q[Float[Array, ""], "1"]
    displacement: Q[Float[Array, ""], "m3"]
    stroke: Q[Float[Array, ""], "m"]
    min_lift: Q[Float[Array, ""], "m"]
    max_lift: Q[Float[Array, ""], "m"]
    ideal_torque: Q[Float[Array, ""], "N.m"]
    supply_flow: Q[Float[Array, ""], "m3/s"]
    efficiency: Q[Float[Array, ""], "1"]
    volumetric_efficiency: Q[Float[Array, ""], "1"]
    hydromechanical_efficiency: Q[Float[Array, ""], "1"]
    input_power: Q[Float[Array, ""], "W"]
    output_power: Q[Float[Array, ""], "W"]
    line_loss: Q[Float[Array, ""], "W"]
    throttling_loss: Q[Float[Array, ""], "W"]
    leakage_loss: Q[Float[Array, ""], "W"]
    friction_loss: Q[Float[Array, ""], "W"]
    compression_loss: Q[Float[Array, ""], "W"]
    power_residual: Q[Float[Array, ""], "1"]
    min_pressure: Q[Float[Array, ""], "Pa"]
    max_pressure: Q[Float[Array, ""], "Pa"]
    supply_pressure_swing: Q[Float[Array, ""], "Pa"]
    pressure_overshoot: Q[Float[Array, ""], "Pa"]
    pressure_undershoot: Q[Float[Array, ""], "Pa"]
    air_release_margin: Q[Float[Array, ""], "Pa"]
    vapour_margin: Q[Float[Array, ""], "Pa"]
    share_below_air_release: Q[Float[Array, ""], "1"]
    share_below_vapour: Q[Float[Array, ""], "1"]
    min_contact_force: Q[Float[Array, ""], "N"]
    max_contact_stress: Q[Float[Array, ""], "Pa"]
    min_undercut_factor: Q[Float[Array, ""], "1"]
    max_pressure_angle: Q[Float[Array, ""], "rad"]
    max_velocity: Q[Float[Array, ""], "m/s"]
    max_acceleration: Q[Float[Array, ""], "m/s2"]
    max_jerk: Q[Float[Array, ""], "m/s3"]
    min_volume: Q[Float[Array, ""], "m3"]
    hydraulic_stiffness: Q[Float[Array, ""], "N/m"]
    natural_frequency: Q[Float[Array, ""], "rad/s"]
    damping_ratio: Q[Float[Array, ""], "1"]
    jerk_objective: Q[Float[Array, ""], "1"]
    spectral_pressure: Q[Float[Array, ""], "1"]
    spectral_torque: Q[Float[Array, ""], "1"]


class Measured(NamedTuple):
    """What integrals, spectra and searches found; every result follows from it.

    Leaves are of one shape: scalars of one motor, or a lane for each of many.
    """

    power: PowerBalance
    mean_torque: Q[Float[Array, "*lane"], "N.m"]
    mean_gauge_pressure: Q[Float[Array, "*lane"], "Pa"]
    """Of the chamber, above the return port's."""
    torque_power: Q[Float[Array, "*lane"], "N2.m2"]
    """Sum of squared amplitudes over positive orders, of all pistons; likewise below."""
    pressure_power: Q[Float[Array, "*lane"], "Pa2"]
    flow_power: Q[Float[Array, "*lane"], "m6/s2"]
    torque_span: Q[Float[Array, "*lane"], "N.m"]
    lowest_radius: Q[Float[Array, "*lane"], "m"]
    highest_radius: Q[Float[Array, "*lane"], "m"]
    rises: Q[Float[Array, "*lane"], "m"]
    """All that a piston rises in one revolution."""
    mean_volume: Q[Float[Array, "*lane"], "m3"]
    lowest_pressure: Q[Float[Array, "*lane"], "Pa"]
    highest_pressure: Q[Float[Array, "*lane"], "Pa"]
    supply_pressure_swing: Q[Float[Array, "*lane"], "Pa"]
    cavitation: Cavitation
    least_force: Q[Float[Array, "*lane"], "N"]
    most_stress: Q[Float[Array, "*lane"], "Pa"]
    least_undercut: Q[Float[Array, "*lane"], "1"]
    most_tilt: Q[Float[Array, "*lane"], "rad"]
    steepest: Q[Float[Array, "*lane"], "m/rad"]
    most_bent: Q[Float[Array, "*lane"], "m/rad2"]
    most_jerky: Q[Float[Array, "*lane"], "m/rad3"]
    mean_square_jerk: Q[Float[Array, "*lane"], "m2/rad6"]


def results(cycle: Cycle, found: Measured) -> Metrics:
    """The numbers of a data sheet from what was measured on a cycle, or on many in lanes."""
    motor, point = cycle.motor, cycle.point
    speed, drop, power = point.shaft_speed, point.pressure_drop, found.power
    stroke = found.highest_radius - found.lowest_radius
    displacement = motor.pistons * found.rises * motor.piston.area
    ideal_torque = drop * displacement / (2 * pi)
    torque_ripple = jnp.sqrt(found.torque_power) / jnp.abs(found.mean_torque)
    pressure_ripple = jnp.sqrt(found.pressure_power) / jnp.abs(found.mean_gauge_pressure)
    flow_ripple = jnp.sqrt(found.flow_power) / jnp.abs(power.supply_flow)
    spring = oscillator(cycle, found.mean_volume)
    lowest_lift = found.lowest_radius - cycle.reference_radius
    return Metrics(
        mean_torque=found.mean_torque,
        torque_ripple=torque_ripple,
        torque_ripple_true_rms=jnp.sqrt(2) * torque_ripple,
        torque_ripple_peak_to_peak=found.torque_span / jnp.abs(found.mean_torque),
        pressure_ripple=pressure_ripple,
        pressure_ripple_true_rms=jnp.sqrt(2) * pressure_ripple,
        flow_ripple=flow_ripple,
        flow_ripple_true_rms=jnp.sqrt(2) * flow_ripple,
        displacement=displacement,
        stroke=stroke,
        min_lift=lowest_lift,
        max_lift=found.highest_radius - cycle.reference_radius,
        ideal_torque=ideal_torque,
        supply_flow=power.supply_flow,
        efficiency=power.output_power / power.input_power,
        volumetric_efficiency=displacement * speed / (2 * pi * power.supply_flow),
        hydromechanical_efficiency=found.mean_torque / ideal_torque,
        input_power=power.input_power,
        output_power=power.output_power,
        line_loss=power.line_loss,
        throttling_loss=power.throttling_loss,
        leakage_loss=power.leakage_loss,
        friction_loss=power.friction_loss,
        compression_loss=power.compression_loss,
        power_residual=power.residual,
        min_pressure=found.lowest_pressure,
        max_pressure=found.highest_pressure,
        supply_pressure_swing=found.supply_pressure_swing,
        pressure_overshoot=jnp.maximum(found.highest_pressure - point.supply_pressure, 0),
        pressure_undershoot=jnp.maximum(point.return_pressure - found.lowest_pressure, 0),
        air_release_margin=found.cavitation.air_release_margin,
        vapour_margin=found.cavitation.vapour_margin,
        share_below_air_release=found.cavitation.share_below_air_release,
        share_below_vapour=found.cavitation.share_below_vapour,
        min_contact_force=found.least_force,
        max_contact_stress=found.most_stress,
        min_undercut_factor=found.least_undercut,
        max_pressure_angle=found.most_tilt,
        max_velocity=jnp.abs(speed) * found.steepest,
        max_acceleration=speed**2 * found.most_bent,
        max_jerk=jnp.abs(speed) ** 3 * found.most_jerky,
        min_volume=motor.dead_volume + motor.piston.area * lowest_lift,
        hydraulic_stiffness=spring.stiffness,
        natural_frequency=spring.natural_frequency,
        damping_ratio=spring.damping_ratio,
        jerk_objective=found.mean_square_jerk / (stroke * motor.lobes**3) ** 2,
        spectral_pressure=found.pressure_power / drop**2,
        spectral_torque=found.torque_power / ideal_torque**2,
    )


def summarise(cycle: Cycle, highest_order: int = 600) -> Metrics:
    """Every result of a cycle; traceable and batched like the cycle itself."""
    motor, point = cycle.motor, cycle.point
    samples = quadrature_samples(cycle)
    piston = samples.piston
    corners = sample_elements(cycle, jnp.asarray(EXTREMUM_FRACTIONS))

    per_amount = 1 / cycle.fluid.content(point.supply_pressure)
    gauge = piston.chamber_pressure - point.return_pressure
    waves = [piston.torque, gauge, piston.supply_flow * per_amount]
    one_torque, pressure, one_flow = chamber_spectra(cycle, samples, waves, highest_order)
    torque, flow = (of_all_pistons(each, motor.pistons) for each in (one_torque, one_flow))
    shaft = torque_range(cycle)

    # Falls undo rises over a period, so half the total travel is the sum of rises.
    quarter = cycle.orbit.mesh.width / (len(EXTREMUM_FRACTIONS) - 1)
    travel = total_variation(corners.radius.value, corners.radius.first, quarter)
    least_pressure = minimum(corners.chamber_pressure)
    swing = (
        jnp.zeros(())  # the set pressure, to the last bit
        if cycle.gallery is None
        else maximum(corners.supply_pressure) - minimum(corners.supply_pressure)
    )
    found = Measured(
        power=power_balance(cycle, samples),
        mean_torque=torque.mean,
        mean_gauge_pressure=pressure.mean,
        torque_power=torque.power(),
        pressure_power=pressure.power(),
        flow_power=flow.power(),
        torque_span=shaft.highest - shaft.lowest,
        lowest_radius=extreme_radius(motor.cam, -1),
        highest_radius=extreme_radius(motor.cam, 1),
        rises=motor.cam.repeats * travel / 2,
        mean_volume=samples.mean(piston.chamber.volume),
        lowest_pressure=least_pressure,
        highest_pressure=maximum(corners.chamber_pressure),
        supply_pressure_swing=swing,
        cavitation=cavitation(cycle, corners.chamber_pressure, least_pressure),
        least_force=minimum(corners.force),
        most_stress=maximum(corners.contact_stress),
        least_undercut=minimum(undercut_factor(corners.radius, motor.roller.radius)),
        most_tilt=maximum(jnp.abs(pressure_angle(corners.radius))),
        steepest=maximum(jnp.abs(corners.radius.first)),
        most_bent=maximum(jnp.abs(corners.radius.second)),
        most_jerky=maximum(jnp.abs(corners.radius.third)),
        mean_square_jerk=samples.mean(piston.radius.third**2),
    )
    return results(cycle, found)
