"""The cam's share of a design space: smooth modes of its control values.

Raw control values as variables give almost no feasible cam: neighbours that
move apart wrinkle the ring. Cosines and sines over the lobe, the bound of the
harmonic `k` of the lobe falling as `1/k^2`, give every mode the same say in
acceleration and curvature.
"""

from math import pi

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.geometry.cam import AbstractCam, PlanarCam, RadialCam
from camring.numerics.quantity import ArrayLike, Q, real
from camring.physics.system import System

_SAMPLES_PER_SPAN = 16


class CamModes(eqx.Module):
    """Harmonics of the lobe, added to the control values of the given cam.

    The mean of the control values never changes. With `keep_displacement` the
    result is scaled about its mean until the sum of all rises is that of the
    given cam, so the modes change the law of motion and not the size of the
    motor; the harmonic 1 is then left out, for it would only scale and turn.

    Attributes
    ----------
    harmonics
        Of the lobe, ascending, at most half the control values of a lobe.
    amplitude
        Largest change that harmonic 1 could make to a control value; harmonic
        `k` has `amplitude / k^2` either way.
    lobes
        Lobes in one period of the cam: 1, or all of them for a free ring.
    mirror
        Cosines only: a cam that is symmetric about its dead centres stays so.
    """

    harmonics: tuple[int, ...] = eqx.field(static=True)
    amplitude: Q[Float[Array, ""], "m"] = eqx.field(converter=real)
    count: int = eqx.field(static=True)
    lobes: int = eqx.field(static=True, default=1)
    mirror: bool = eqx.field(static=True, default=False)
    keep_displacement: bool = eqx.field(static=True, default=True)

    @property
    def terms(self) -> tuple[tuple[str, int], ...]:
        """("cos", 2), ("sin", 2), ... in the order of the coordinates."""
        kinds = ("cos",) if self.mirror else ("cos", "sin")
        # At half the number of control values the sine is zero at all of them.
        return tuple(
            (kind, k)
            for k in self.harmonics
            for kind in kinds
            if not (kind == "sin" and 2 * k * self.lobes == self.count)
        )

    @property
    def dimension(self) -> int:
        return len(self.terms)

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(f"cam {kind} {k}" for kind, k in self.terms)

    def bounds(self) -> Q[Float[Array, " mode"], "m"]:
        """Largest amplitude of each mode."""
        return self.amplitude / np.array([float(k) ** 2 for _, k in self.terms])

    def shapes(self) -> Float[np.ndarray, "mode control"]:
        """The modes at the control values, each within [-1, 1]."""
        phase = 2 * pi * self.lobes * np.arange(self.count) / self.count
        return np.array([getattr(np, kind)(k * phase) for kind, k in self.terms])

    def apply(self, cam: AbstractCam, unit_point: ArrayLike) -> AbstractCam:
        """The cam at a point of the unit box; its middle is the given cam."""
        change = ((2 * real(unit_point) - 1) * self.bounds()) @ self.shapes()
        given = control_values(cam)
        mean = jnp.mean(given)
        changed = with_control_values(cam, given + change)
        if not self.keep_displacement:
            return changed
        scale = sum_of_rises(cam) / sum_of_rises(changed)
        return with_control_values(cam, mean + scale * (given + change - mean))


def control_values(cam: AbstractCam) -> Q[Float[Array, " control"], "m"]:
    """Control radii, or the distances of planar control points from the shaft."""
    if isinstance(cam, RadialCam):
        return cam.control_radii
    assert isinstance(cam, PlanarCam)
    return jnp.hypot(cam.control_points[..., 0], cam.control_points[..., 1])


def with_control_values(cam: AbstractCam, values: Q[Float[Array, " control"], "m"]) -> AbstractCam:
    """The cam with other control radii; planar points move along their own rays."""
    if isinstance(cam, RadialCam):
        return eqx.tree_at(lambda each: each.control_radii, cam, values)
    assert isinstance(cam, PlanarCam)
    points = cam.control_points * (values / control_values(cam))[..., None]
    return eqx.tree_at(lambda each: each.control_points, cam, points)


@jax.custom_jvp
def sum_of_rises(cam: AbstractCam) -> Q[Float[Array, ""], "m"]:
    """What the pitch radius climbs in one period, all rises together, from samples."""
    return _sum_of_rises(cam)


@sum_of_rises.defjvp
def _slope_of_rises(primals: tuple, tangents: tuple) -> tuple[Array, Array]:
    # The gradient once, instead of all samples again for each direction.
    (cam,), (rate,) = primals, tangents
    rises, gradient = jax.value_and_grad(_sum_of_rises)(cam)
    parts = jax.tree.leaves(jax.tree.map(lambda g, r: jnp.sum(g * r), gradient, rate))
    return rises, jnp.sum(jnp.stack(parts))


def _sum_of_rises(cam: AbstractCam) -> Q[Float[Array, ""], "m"]:
    angles = cam.period * jnp.arange(cam.control_count * _SAMPLES_PER_SPAN)
    radius = cam.pitch_radius(angles / (cam.control_count * _SAMPLES_PER_SPAN)).value
    return jnp.sum(jnp.abs(jnp.roll(radius, -1) - radius)) / 2


def unit_point_for(
    modes: CamModes, system: System, target: Float[np.ndarray, " control"]
) -> tuple[np.ndarray, float]:
    """Where in the box a cam lies, and how far it is from there.

    Parameters
    ----------
    target
        Control values over one period, any stroke, m.

    Returns
    -------
    The coordinates of its projection, inside the unit box or not, and the
    largest difference left between the control values, as a share of their range.

    Notes
    -----
    With the displacement kept, size and mean of the target are free: it is
    scaled and turned until its first harmonic is the given one.
    """
    given = np.asarray(control_values(system.motor.cam))
    wanted = given - np.mean(given), target - np.mean(target)
    phase = 2 * pi * modes.lobes * np.arange(modes.count) / modes.count
    if modes.keep_displacement:
        first = [np.sum(values * np.exp(-1j * phase)) for values in wanted]
        scale = abs(first[0]) / abs(first[1])
    else:
        scale = 1.0
    difference = scale * wanted[1] - wanted[0]
    shapes = modes.shapes()
    strength = shapes @ difference / np.sum(shapes**2, axis=1)
    left = difference - strength @ shapes
    unit = 0.5 + 0.5 * strength / np.asarray(modes.bounds())
    return unit, float(np.max(np.abs(left)) / np.ptp(given))
