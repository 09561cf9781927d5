"""Points to start from: those given, then a scrambled Sobol sequence.

All chance in the search package comes from here, and from the seed and the trial
number alone.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float


def generator(seed: int, trial: int, stream: int = 0) -> np.random.Generator:
    """Random numbers that belong to one trial of one seed, and one use within it."""
    sequence = np.random.SeedSequence([seed, trial, stream])
    return np.random.Generator(np.random.Philox(sequence))


def sobol(
    count: int, dimension: int, random: np.random.Generator
) -> Float[np.ndarray, "count dimension"]:
    """The first `count` points of a scrambled Sobol sequence in the unit box.

    The sequence is extensible: more points begin with the same points.
    Owen (1998), Scrambling Sobol' and Niederreiter-Xing points.
    """
    from scipy.stats import qmc  # half a second, which whoever only simulates need not wait

    sampler = qmc.Sobol(dimension, scramble=True, rng=random)
    # Always a power of two: balanced, and scipy does not warn.
    return sampler.random_base2(max(count - 1, 1).bit_length())[:count]


def initial_point(
    trial: int, dimension: int, seed: int, given: Sequence[Sequence[float]] = ()
) -> Float[np.ndarray, " dimension"]:
    """Point number `trial` of the initial design: the given ones first, then Sobol's."""
    if trial < len(given):
        return np.clip(np.asarray(given[trial], dtype=float), 0.0, 1.0)
    place = trial - len(given)
    return sobol(place + 1, dimension, generator(seed, 0))[place]
