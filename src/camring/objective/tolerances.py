"""What scatters from one built motor to the next, on top of what the design says.

A tolerance adds to a number wherever the design has put it; waviness adds a wave to
the ring. Amounts are standardised deviates, mean 0 and variance 1: which distribution
they come from is for those to know who draw them.
"""

from math import pi

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.geometry.cam import RadialCam
from camring.numerics.quantity import ArrayLike, Q, real
from camring.objective.design_space import AbstractSpace, DesignSpace, with_leaves
from camring.physics.system import System


class Deviation(eqx.Module):
    """A number of the system, or several that deviate alike.

    Attributes
    ----------
    name
        Of the first number, its path in the motor file.
    leaves
        Every leaf that holds it.
    deviation
        One standard deviation, in SI, or as a share of the number if `relative`.
    """

    name: str = eqx.field(static=True)
    leaves: tuple[str, ...] = eqx.field(static=True)
    deviation: Float[Array, ""] = eqx.field(converter=real)
    relative: bool = eqx.field(static=True, default=False)

    def apply(self, system: System, amount: ArrayLike) -> System:
        """The system so many standard deviations away."""
        change = self.deviation * amount
        return with_leaves(
            system,
            self.leaves,
            lambda given: given * (1 + change) if self.relative else given + change,
        )


class Waviness(eqx.Module):
    """Waves of the pitch curve round the ring.

    Attributes
    ----------
    orders
        Waves in a revolution, ascending.
    amplitudes
        Of each wave, half its height from valley to peak.
    unfold
        Whether the ring must be described lobe by lobe, as some order is no multiple of
        the lobes, at as many times the cost.
    """

    orders: tuple[int, ...] = eqx.field(static=True)
    amplitudes: Q[Float[Array, " order"], "m"] = eqx.field(converter=real)
    unfold: bool = eqx.field(static=True)

    def apply(self, system: System, amounts: Float[Array, " amount"]) -> System:
        """The system with waves on its cam.

        Parameters
        ----------
        amounts
            Cosine and sine of each order's phase, both times the root of two.

        Notes
        -----
        A wave of control radii is smaller in the curve, by the sinc of the B-spline; the
        amplitudes are those of the curve's harmonic.
        """
        cam = system.motor.cam
        assert isinstance(cam, RadialCam)
        radii, repeats = cam.control_radii, cam.repeats
        if self.unfold:
            radii, repeats = jnp.tile(radii, repeats), 1
        waves = jnp.asarray(_waves(self.orders, len(radii), repeats, cam.degree))
        change = jnp.repeat(self.amplitudes / np.sqrt(2.0), 2) * amounts @ waves
        wavy = RadialCam(radii + change, repeats=repeats, degree=cam.degree)
        return eqx.tree_at(lambda each: each.motor.cam, system, wavy)


def _waves(
    orders: tuple[int, ...], count: int, repeats: int, degree: int
) -> Float[np.ndarray, "wave control"]:
    """Control values of cosine and sine of each order with amplitude 1 in the curve."""
    place = np.arange(count) / count
    rows = []
    for order in orders:
        waves = order // repeats
        strength = 1 / np.sinc(waves / count) ** (degree + 1)
        turn = 2 * pi * waves * place
        rows += [strength * np.cos(turn), strength * np.sin(turn)]
    return np.array(rows)


class ToleratedSpace(AbstractSpace):
    """Designs, and what scatters about them: first the design's coordinates, then deviates.

    Without a design space the given motor alone is looked at.
    """

    design: DesignSpace | None
    deviations: tuple[Deviation, ...]
    waviness: Waviness | None = None

    @property
    def design_dimension(self) -> int:
        """How many of the coordinates are the design's."""
        return self.design.dimension if self.design is not None else 0

    @property
    def names(self) -> tuple[str, ...]:
        designed = self.design.names if self.design is not None else ()
        orders = self.waviness.orders if self.waviness is not None else ()
        waves = tuple(f"{kind} of order {each}" for each in orders for kind in ("cosine", "sine"))
        return designed + tuple(each.name for each in self.deviations) + waves

    def apply(self, system: System, unit_point: ArrayLike) -> System:
        """The system of one built motor; traceable, differentiable, batched with `vmap`.

        Parameters
        ----------
        system
            The given one.
        unit_point
            Coordinates of the design in [0, 1], then standardised deviates.
        """
        point = real(unit_point)
        if self.design is not None:
            system = self.design.apply(system, point[: self.design_dimension])
        amounts = point[self.design_dimension :]
        for place, each in enumerate(self.deviations):
            system = each.apply(system, amounts[place])
        if self.waviness is None:
            return system
        return self.waviness.apply(system, amounts[len(self.deviations) :])


__all__ = ["Deviation", "ToleratedSpace", "Waviness"]
