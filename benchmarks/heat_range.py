"""Whether batches close the heat balance of motors far from where they are usually asked.

    python benchmarks/heat_range.py [--designs 512]

The designs are random points of the derivation motor's space with every law and a heat balance,
each at 2 to 250 % of its speed and 15 to 160 % of its supply pressure, -10 to 40 degC around it
and 0 to 60 W/K to carry its heat off. Printed are how many are not converged, and the largest and
the smallest rise.
"""

import argparse
from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
from batch_speed import OF_BATCHES
from wheel_motor import as_given, at_one_point, with_heat

from camring.physics.heat.batch_simulation import simulate_batch
from camring.physics.heat.thermal import Thermal
from camring.programs.batch_program import BatchProgram


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--designs", type=int, default=512)
    designs = drawn(parser.parse_args().designs)
    print("| resolution | motors | not converged | rise |\n|---|---|---|---|")
    for name, resolution in OF_BATCHES.items():
        cycle = BatchProgram(simulate_batch)(*designs, resolution).cycle
        rise, code = np.asarray(cycle.motor.thermal.rise), np.asarray(cycle.verdict.code)
        span = f"{rise.min():.0f} to {rise.max():.0f} K"
        print(f"| {name} | {len(code)} | {np.count_nonzero(code)} | {span} |")


def drawn(count: int):
    """Motors, oils and operating points, the batch along the last axis."""
    file, chance = as_given(), np.random.default_rng(0)
    system, found = with_heat(at_one_point(file.system)), []
    for point in chance.uniform(size=(count, file.design_space.dimension)):
        design = file.design_space.apply(system, point)
        thermal = Thermal(chance.uniform(263, 313), chance.uniform(0, 60))
        [at] = design.operating_points
        at = replace(
            at,
            shaft_speed=at.shaft_speed * chance.uniform(0.02, 2.5),
            supply_pressure=at.supply_pressure * chance.uniform(0.15, 1.6),
        )
        found.append((replace(design.motor, thermal=thermal), design.fluid, at))
    return jax.tree.map(lambda *leaves: jnp.stack(leaves, axis=-1), *found)


if __name__ == "__main__":
    main()
