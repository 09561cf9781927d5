"""Spectra of waves known on the elements of meshes, side by side (`numerics/batch.py`).

As in `fourier.py`: a wave is a cubic on each element, integrated four times, exactly,
however thin the element, and only then sampled. What would alias is damped: order `m`
picks up order `K - m` times `(m/(K - m))^4` only, `K` being the number of samples.
"""

from math import pi

from jaxtyping import Array, Float

from camring.numerics.batch import take
from camring.numerics.batch_mesh import locate_round
from camring.numerics.compilation import computed_once
from camring.numerics.fourier import INTEGRATIONS, integral
from camring.numerics.mesh import Mesh
from camring.numerics.radau import element_powers, horner

__all__ = ["INTEGRATIONS", "integrated_samples"]

Values = Float[Array, "4 element batch"]


def integrated_samples(
    waves: list[Values], mesh: Mesh, period: float, count: int
) -> list[Float[Array, "place batch"]]:
    """The fourfold integrals of waves at places round the period, equally far apart.

    Parameters
    ----------
    waves
        Each at an element's start and its three collocation points.

    Returns
    -------
    Each up to a constant, by the angle of which a period has `2 pi`: the wave is their
    `INTEGRATIONS`-th derivative (`batch_fourier.power_of_orders`).
    """
    element, fraction = computed_once(locate_round(mesh, count, period))
    width = mesh.width * (2 * pi / period)
    found = []
    for wave in waves:
        powers = list(element_powers(wave[0], wave[1:]))
        for _ in range(INTEGRATIONS):
            powers = integral(powers, width, axis=0)
        powers = computed_once(powers)
        found.append(horner([take(each, element) for each in powers], fraction))
    return found
