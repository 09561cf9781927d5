"""The numbers of a data sheet: one record for each operating point."""

from html import escape
from math import pi
from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.geometry.contour import pressure_angle, undercut_factor
from camring.geometry.extremes import extreme_radius
from camring.metrics.cavitation import Cavitation, cavitation
from camring.metrics.displacement import rises_between_knots
from camring.metrics.efficiency import efficiencies, working_as
from camring.metrics.power_balance import PowerBalance, power_balance
from camring.metrics.rating_life import Endured, endured, rating_life
from camring.metrics.spectrum import chamber_spectra, of_all_pistons
from camring.metrics.stiffness import oscillator
from camring.metrics.torque_range import torque_range
from camring.numerics.extremum import EXTREMUM_FRACTIONS, maximum, minimum, total_variation
from camring.numerics.quantity import Q
from camring.numerics.readable import written_fields
from camring.numerics.selection import larger
from camring.physics.cycle import Cycle
from camring.physics.piston_state import quadrature_samples, sample_elements


class Metrics(eqx.Module):
    """Results of docs/theory.md section 10, in SI, and their companions.

    Examples
    --------
    >>> [found] = camring.summarise(camring.simulate("motor.toml"))
    >>> f"{float(found.supply_flow) * 6e4:.1f} L/min", found.operating_mode
    ('71.3 L/min', 'motor')
    """

    mean_torque: Q[Float[Array, ""], "N.m"]
    torque_ripple: Q[Float[Array, ""], "1"]
    torque_ripple_true_rms: Q[Float[Array, ""], "1"]
    torque_ripple_peak_to_peak: Q[Float[Array, ""], "1"]
    pressure_ripple: Q[Float[Array, ""], "1"]
    pressure_ripple_true_rms: Q[Float[Array, ""], "1"]
    flow_ripple: Q[Float[Array, ""], "1"]
    flow_ripple_true_rms: Q[Float[Array, ""], "1"]
    return_flow_ripple: Q[Float[Array, ""], "1"]
    return_flow_ripple_true_rms: Q[Float[Array, ""], "1"]
    displacement: Q[Float[Array, ""], "m3"]
    stroke: Q[Float[Array, ""], "m"]
    min_lift: Q[Float[Array, ""], "m"]
    max_lift: Q[Float[Array, ""], "m"]
    ideal_torque: Q[Float[Array, ""], "N.m"]
    supply_flow: Q[Float[Array, ""], "m3/s"]
    return_flow: Q[Float[Array, ""], "m3/s"]
    """Out of the return port, as a volume at its pressure: what a pump delivers."""
    case_drain: Q[Float[Array, ""], "m3/s"]
    """Mean leakage into the case, as a flow meter there would show it."""
    efficiency: Q[Float[Array, ""], "1"]
    """What a test bench reads; a pump's where `operating_mode` says. See `metrics.efficiency`."""
    volumetric_efficiency: Q[Float[Array, ""], "1"]
    hydromechanical_efficiency: Q[Float[Array, ""], "1"]
    energy_efficiency: Q[Float[Array, ""], "1"]
    """Of the exact power balance; `efficiency` itself where flow counts by volume."""
    port_efficiency: Q[Float[Array, ""], "1"]
    """By the power between the ports, which counts what a pump delivers."""
    input_power: Q[Float[Array, ""], "W"]
    output_power: Q[Float[Array, ""], "W"]
    line_loss: Q[Float[Array, ""], "W"]
    return_line_loss: Q[Float[Array, ""], "W"]
    throttling_loss: Q[Float[Array, ""], "W"]
    leakage_loss: Q[Float[Array, ""], "W"]
    friction_loss: Q[Float[Array, ""], "W"]
    compression_loss: Q[Float[Array, ""], "W"]
    port_power: Q[Float[Array, ""], "W"]
    """The input, less what drained oil takes with it below the return's pressure."""
    full_leakage_loss: Q[Float[Array, ""], "W"]
    """From where the oil leaks to where it arrives, never negative; see
    `metrics.power_balance`."""
    power_residual: Q[Float[Array, ""], "1"]
    case_heat: Q[Float[Array, ""], "W"]
    """What of friction and leakage stays in the motor and warms its case."""
    surface_heat: Q[Float[Array, ""], "W"]
    """What of it the surface gives to the surroundings; the drain takes the rest."""
    case_temperature_rise: Q[Float[Array, ""], "K"]
    """Of case and films above the oil that comes in; zero without a heat balance."""
    min_pressure: Q[Float[Array, ""], "Pa"]
    max_pressure: Q[Float[Array, ""], "Pa"]
    supply_pressure_swing: Q[Float[Array, ""], "Pa"]
    return_pressure_swing: Q[Float[Array, ""], "Pa"]
    pressure_overshoot: Q[Float[Array, ""], "Pa"]
    pressure_undershoot: Q[Float[Array, ""], "Pa"]
    air_release_margin: Q[Float[Array, ""], "Pa"]
    vapour_margin: Q[Float[Array, ""], "Pa"]
    share_below_air_release: Q[Float[Array, ""], "1"]
    share_below_vapour: Q[Float[Array, ""], "1"]
    min_contact_force: Q[Float[Array, ""], "N"]
    max_contact_stress: Q[Float[Array, ""], "Pa"]
    l10_life: Q[Float[Array, ""], "s"]
    """Rating life of ring and rollers, ISO 281; see `metrics.rating_life`."""
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

    @property
    def operating_mode(self) -> str | np.ndarray:
        """Whether it works as `motor`, `pump` or `brake`; an array of words for a batch."""
        found = working_as(self.input_power, self.output_power)
        return found if found.ndim else str(found)

    def to_dict(self) -> dict[str, float | str | np.ndarray]:
        """Plain numbers by name, SI, and `operating_mode`; arrays where it holds many motors."""
        numbers = {name: np.asarray(value) for name, value in vars(self).items()}
        plain = {name: each if each.ndim else float(each) for name, each in numbers.items()}
        return {**plain, "operating_mode": self.operating_mode}

    def __repr__(self) -> str:
        rows = list(written_fields(self))
        widest = max(len(name) for name, _, _ in rows)
        return "\n".join(
            [
                "Metrics",
                *(f"  {name:{widest}}  {text} {unit}".rstrip() for name, text, unit in rows),
            ]
        )

    def _repr_html_(self) -> str:
        """A table for notebooks."""
        rows = "".join(
            f"<tr><th style='text-align:left'>{name}</th>"
            f"<td style='text-align:right'>{escape(text)}</td>"
            f"<td style='text-align:left'>{escape(unit)}</td></tr>"
            for name, text, unit in written_fields(self)
        )
        return f"<table>{rows}</table>"


class Measured(NamedTuple):
    """What integrals, spectra and searches found; every result follows from it.

    Leaves are of one shape: scalars of one motor, or a batch of many.
    """

    power: PowerBalance
    mean_torque: Q[Float[Array, "*batch"], "N.m"]
    mean_gauge_pressure: Q[Float[Array, "*batch"], "Pa"]
    """Of the chamber, above the return port's."""
    torque_power: Q[Float[Array, "*batch"], "N2.m2"]
    """Sum of squared amplitudes over positive orders, of all pistons; likewise below."""
    pressure_power: Q[Float[Array, "*batch"], "Pa2"]
    flow_power: Q[Float[Array, "*batch"], "m6/s2"]
    return_flow_power: Q[Float[Array, "*batch"], "m6/s2"]
    torque_span: Q[Float[Array, "*batch"], "N.m"]
    lowest_radius: Q[Float[Array, "*batch"], "m"]
    highest_radius: Q[Float[Array, "*batch"], "m"]
    rises: Q[Float[Array, "*batch"], "m"]
    """All that a piston rises in one revolution, idle lobes left out."""
    mean_volume: Q[Float[Array, "*batch"], "m3"]
    lowest_pressure: Q[Float[Array, "*batch"], "Pa"]
    highest_pressure: Q[Float[Array, "*batch"], "Pa"]
    supply_pressure_swing: Q[Float[Array, "*batch"], "Pa"]
    return_pressure_swing: Q[Float[Array, "*batch"], "Pa"]
    cavitation: Cavitation
    least_force: Q[Float[Array, "*batch"], "N"]
    most_stress: Q[Float[Array, "*batch"], "Pa"]
    least_undercut: Q[Float[Array, "*batch"], "1"]
    most_tilt: Q[Float[Array, "*batch"], "rad"]
    steepest: Q[Float[Array, "*batch"], "m/rad"]
    most_bent: Q[Float[Array, "*batch"], "m/rad2"]
    most_jerky: Q[Float[Array, "*batch"], "m/rad3"]
    mean_square_jerk: Q[Float[Array, "*batch"], "m2/rad6"]
    endured: Endured


def results(cycle: Cycle, found: Measured) -> Metrics:
    """The numbers of a data sheet from what was measured on a cycle, or on many in a batch."""
    motor, point = cycle.motor, cycle.point
    speed, drop, power = point.shaft_speed, point.pressure_drop, found.power
    stroke = found.highest_radius - found.lowest_radius
    displacement = motor.pistons * found.rises * motor.piston.area
    ideal_torque = drop * displacement / (2 * pi)
    torque_ripple = jnp.sqrt(found.torque_power) / jnp.abs(found.mean_torque)
    pressure_ripple = jnp.sqrt(found.pressure_power) / jnp.abs(found.mean_gauge_pressure)
    flow_ripple = jnp.sqrt(found.flow_power) / jnp.abs(power.supply_flow)
    return_ripple = jnp.sqrt(found.return_flow_power) / jnp.abs(power.return_flow)
    share = efficiencies(power, found.mean_torque, drop, displacement, speed)
    spring = oscillator(cycle, found.mean_volume)
    lowest_lift = found.lowest_radius - cycle.reference_radius
    rise, cooled = _warmth(cycle)
    return Metrics(
        mean_torque=found.mean_torque,
        torque_ripple=torque_ripple,
        torque_ripple_true_rms=jnp.sqrt(2) * torque_ripple,
        torque_ripple_peak_to_peak=found.torque_span / jnp.abs(found.mean_torque),
        pressure_ripple=pressure_ripple,
        pressure_ripple_true_rms=jnp.sqrt(2) * pressure_ripple,
        flow_ripple=flow_ripple,
        flow_ripple_true_rms=jnp.sqrt(2) * flow_ripple,
        return_flow_ripple=return_ripple,
        return_flow_ripple_true_rms=jnp.sqrt(2) * return_ripple,
        displacement=displacement,
        stroke=stroke,
        min_lift=lowest_lift,
        max_lift=found.highest_radius - cycle.reference_radius,
        ideal_torque=ideal_torque,
        supply_flow=power.supply_flow,
        return_flow=power.return_flow,
        case_drain=power.case_drain,
        efficiency=share.total,
        volumetric_efficiency=share.volumetric,
        hydromechanical_efficiency=share.hydromechanical,
        energy_efficiency=share.energy,
        port_efficiency=share.ports,
        input_power=power.input_power,
        output_power=power.output_power,
        line_loss=power.line_loss,
        return_line_loss=power.return_line_loss,
        throttling_loss=power.throttling_loss,
        leakage_loss=power.leakage_loss,
        friction_loss=power.friction_loss,
        compression_loss=power.compression_loss,
        port_power=power.port_power,
        full_leakage_loss=power.full_leakage_loss,
        power_residual=power.residual,
        case_heat=power.case_heat,
        surface_heat=cooled + jnp.zeros_like(power.case_heat),
        case_temperature_rise=rise + jnp.zeros_like(power.case_heat),
        min_pressure=found.lowest_pressure,
        max_pressure=found.highest_pressure,
        supply_pressure_swing=found.supply_pressure_swing,
        return_pressure_swing=found.return_pressure_swing,
        pressure_overshoot=larger(found.highest_pressure - point.higher_pressure, 0),
        pressure_undershoot=larger(point.lower_pressure - found.lowest_pressure, 0),
        air_release_margin=found.cavitation.air_release_margin,
        vapour_margin=found.cavitation.vapour_margin,
        share_below_air_release=found.cavitation.share_below_air_release,
        share_below_vapour=found.cavitation.share_below_vapour,
        min_contact_force=found.least_force,
        max_contact_stress=found.most_stress,
        l10_life=rating_life(motor, speed, found.endured),
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


def _warmth(cycle: Cycle) -> tuple[Q[Float[Array, "*batch"], "K"], Q[Float[Array, "*batch"], "W"]]:
    """How much warmer the case is than the oil that comes in, and what its surface gives off."""
    thermal, line = cycle.motor.thermal, cycle.fluid.line
    if thermal is None or line is None:
        return jnp.zeros(()), jnp.zeros(())
    above = line.temperature + thermal.rise - thermal.ambient_temperature
    return thermal.rise, thermal.heat_transfer * above


def _swing(pressure: Float[Array, "corner element"] | None) -> Q[Float[Array, ""], "Pa"]:
    """Of a manifold; without one the set pressure stands at the windows to the last bit."""
    return jnp.zeros(()) if pressure is None else maximum(pressure) - minimum(pressure)


def summarise(cycle: Cycle, highest_order: int = 600) -> Metrics:
    """Every result of a cycle; traceable and batched like the cycle itself."""
    motor, point = cycle.motor, cycle.point
    samples = quadrature_samples(cycle)
    piston = samples.piston
    corners = sample_elements(cycle, jnp.asarray(EXTREMUM_FRACTIONS))

    per_amount = 1 / cycle.fluid.content(point.supply_pressure)
    back_per_amount = 1 / cycle.fluid.content(point.return_pressure)
    gauge = piston.chamber_pressure - point.return_pressure
    flows = [piston.supply_flow * per_amount, piston.return_flow * back_per_amount]
    pressure, *of_one = chamber_spectra(
        cycle, samples, [gauge, piston.torque, *flows], highest_order
    )
    torque, flow, back = (of_all_pistons(each, motor.pistons) for each in of_one)
    shaft = torque_range(cycle)

    # Falls undo rises over a period, so half the total travel is the sum of rises.
    quarter = cycle.orbit.mesh.width / (len(EXTREMUM_FRACTIONS) - 1)
    travel = total_variation(corners.radius.value, corners.radius.first, quarter)
    rises = motor.cam.repeats * travel / 2
    if motor.valve_plate.idle_lobes:
        rises = rises_between_knots(motor)
    least_pressure = minimum(corners.chamber_pressure)
    found = Measured(
        power=power_balance(cycle, samples),
        mean_torque=torque.mean,
        mean_gauge_pressure=pressure.mean,
        torque_power=torque.power(),
        pressure_power=pressure.power(),
        flow_power=flow.power(),
        return_flow_power=back.power(),
        torque_span=shaft.highest - shaft.lowest,
        lowest_radius=extreme_radius(motor.cam, -1),
        highest_radius=extreme_radius(motor.cam, 1),
        rises=rises,
        mean_volume=samples.mean(piston.chamber.volume),
        lowest_pressure=least_pressure,
        highest_pressure=maximum(corners.chamber_pressure),
        supply_pressure_swing=_swing(corners.supply_pressure),
        return_pressure_swing=_swing(corners.return_pressure),
        cavitation=cavitation(cycle, corners.chamber_pressure, least_pressure),
        least_force=minimum(corners.force),
        most_stress=maximum(corners.contact_stress),
        endured=Endured(*map(samples.mean, endured(piston, motor))),
        least_undercut=minimum(undercut_factor(corners.radius, motor.roller.radius)),
        most_tilt=maximum(jnp.abs(pressure_angle(corners.radius))),
        steepest=maximum(jnp.abs(corners.radius.first)),
        most_bent=maximum(jnp.abs(corners.radius.second)),
        most_jerky=maximum(jnp.abs(corners.radius.third)),
        mean_square_jerk=samples.mean(piston.radius.third**2),
    )
    return results(cycle, found)
