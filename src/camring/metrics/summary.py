"""The numbers of a data sheet: one record for each operating point."""

from math import pi

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.contour import pressure_angle, undercut_factor
from camring.geometry.extremes import extreme_radius
from camring.metrics.cavitation import cavitation
from camring.metrics.power_balance import power_balance
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


def summarise(cycle: Cycle, highest_order: int = 600) -> Metrics:
    """Every result of a cycle; traceable and batched like the cycle itself."""
    motor, point = cycle.motor, cycle.point
    pistons, speed, drop = motor.pistons, point.shaft_speed, point.pressure_drop
    samples = quadrature_samples(cycle)
    piston = samples.piston
    corners = sample_elements(cycle, jnp.asarray(EXTREMUM_FRACTIONS))

    per_amount = 1 / cycle.fluid.content(point.supply_pressure)
    gauge = piston.chamber_pressure - point.return_pressure
    waves = [piston.torque, gauge, piston.supply_flow * per_amount]
    one_torque, pressure, one_flow = chamber_spectra(cycle, samples, waves, highest_order)
    torque, flow = of_all_pistons(one_torque, pistons), of_all_pistons(one_flow, pistons)
    torque_extremes = torque_range(cycle)

    power = power_balance(cycle, samples)
    highest, lowest = extreme_radius(motor.cam, 1), extreme_radius(motor.cam, -1)
    stroke = highest - lowest
    # Falls undo rises over a period, so half the total travel is the sum of rises.
    quarter = cycle.orbit.mesh.width / (len(EXTREMUM_FRACTIONS) - 1)
    travel = total_variation(corners.radius.value, corners.radius.first, quarter)
    rises = motor.cam.repeats * travel / 2
    displacement = pistons * rises * motor.piston.area
    ideal_torque = drop * displacement / (2 * pi)
    mean_torque = torque.mean
    spring = oscillator(cycle, samples.mean(piston.chamber.volume))
    least_pressure = minimum(corners.chamber_pressure)
    most_pressure = maximum(corners.chamber_pressure)
    swing = (
        jnp.zeros(())  # the set pressure, to the last bit
        if cycle.gallery is None
        else maximum(corners.supply_pressure) - minimum(corners.supply_pressure)
    )
    starved = cavitation(cycle, corners.chamber_pressure, least_pressure)

    return Metrics(
        mean_torque=mean_torque,
        torque_ripple=torque.ripple(),
        torque_ripple_true_rms=jnp.sqrt(2) * torque.ripple(),
        torque_ripple_peak_to_peak=(torque_extremes.highest - torque_extremes.lowest)
        / jnp.abs(mean_torque),
        pressure_ripple=pressure.ripple(),
        pressure_ripple_true_rms=jnp.sqrt(2) * pressure.ripple(),
        flow_ripple=flow.ripple(),
        flow_ripple_true_rms=jnp.sqrt(2) * flow.ripple(),
        displacement=displacement,
        stroke=stroke,
        min_lift=lowest - cycle.reference_radius,
        max_lift=highest - cycle.reference_radius,
        ideal_torque=ideal_torque,
        supply_flow=power.supply_flow,
        efficiency=power.output_power / power.input_power,
        volumetric_efficiency=displacement * speed / (2 * pi * power.supply_flow),
        hydromechanical_efficiency=mean_torque / ideal_torque,
        input_power=power.input_power,
        output_power=power.output_power,
        line_loss=power.line_loss,
        throttling_loss=power.throttling_loss,
        leakage_loss=power.leakage_loss,
        friction_loss=power.friction_loss,
        compression_loss=power.compression_loss,
        power_residual=power.residual,
        min_pressure=least_pressure,
        max_pressure=most_pressure,
        supply_pressure_swing=swing,
        pressure_overshoot=jnp.maximum(most_pressure - point.supply_pressure, 0),
        pressure_undershoot=jnp.maximum(point.return_pressure - least_pressure, 0),
        air_release_margin=starved.air_release_margin,
        vapour_margin=starved.vapour_margin,
        share_below_air_release=starved.share_below_air_release,
        share_below_vapour=starved.share_below_vapour,
        min_contact_force=minimum(corners.force),
        max_contact_stress=maximum(corners.contact_stress),
        min_undercut_factor=minimum(undercut_factor(corners.radius, motor.roller.radius)),
        max_pressure_angle=maximum(jnp.abs(pressure_angle(corners.radius))),
        max_velocity=jnp.abs(speed) * maximum(jnp.abs(corners.radius.first)),
        max_acceleration=speed**2 * maximum(jnp.abs(corners.radius.second)),
        max_jerk=jnp.abs(speed) ** 3 * maximum(jnp.abs(corners.radius.third)),
        min_volume=motor.dead_volume + motor.piston.area * (lowest - cycle.reference_radius),
        hydraulic_stiffness=spring.stiffness,
        natural_frequency=spring.natural_frequency,
        damping_ratio=spring.damping_ratio,
        jerk_objective=samples.mean(piston.radius.third**2) / (stroke * motor.lobes**3) ** 2,
        spectral_pressure=pressure.power() / drop**2,
        spectral_torque=torque.power() / ideal_torque**2,
    )
