"""Whether some piston pushes at every angle, by counting: else the shaft cannot start there.

A piston pushes while it stands inside a rising flank of a lobe that is fed. Flanks are taken to
be half a lobe each, with windows from dead centre to dead centre, so that one ends where the
other begins; a lobe that rises over more than half its pitch pushes longer.
"""

from functools import lru_cache
from itertools import combinations
from math import comb

__all__ = ["pushes_everywhere", "some_split_pushes_everywhere"]

MOST_PATTERNS = 2_000  # looked at; with more nothing is said


def pushes_everywhere(pistons: int, lobes: int, idle: tuple[int, ...] = ()) -> bool:
    """Whether at every angle some piston stands on a rising flank that is fed.

    Parameters
    ----------
    idle
        Lobes that idle, counted from 0.

    Examples
    --------
    >>> pushes_everywhere(8, 6), pushes_everywhere(8, 6, (0, 2, 4)), pushes_everywhere(8, 6, (0, 3))
    (True, True, False)
    """
    fed = ~_bits(idle)
    return all(pushed & fed for pushed in _pushed(pistons, lobes))


def some_split_pushes_everywhere(pistons: int, lobes: int, idle: int, times: int) -> bool | None:
    """Whether so many idle lobes can be chosen that some piston pushes at every angle.

    Parameters
    ----------
    idle
        How many lobes idle.
    times
        How often a revolution their pattern repeats; it divides both counts.

    Returns
    -------
    None where there are more patterns than are looked at.
    """
    if not pushes_everywhere(pistons, lobes):
        return False
    length, few = lobes // times, idle // times
    if comb(length, few) > MOST_PATTERNS:
        return None
    return any(
        pushes_everywhere(
            pistons, lobes, tuple(lobe + turn * length for lobe in chosen for turn in range(times))
        )
        for chosen in combinations(range(length), few)
    )


def _bits(lobes: tuple[int, ...]) -> int:
    return sum(1 << lobe for lobe in lobes)


@lru_cache
def _pushed(pistons: int, lobes: int) -> frozenset[int]:
    """The sets of lobes with a piston inside their rising flank, as bits, at every angle.

    Fewest stand there where one has just come to a dead centre; these angles are enough. In
    parts of which a flank has as many as there are pistons, every place is a whole number.
    """
    flank, lobe, ring = pistons, 2 * pistons, 2 * pistons * lobes
    places = [2 * lobes * piston for piston in range(pistons)]
    turns = {(-place) % flank + side for place in places for side in (0, flank)}
    found = set()
    for turn in turns:
        standing = {(place + turn) % ring for place in places}
        pushed = _bits(tuple({at // lobe for at in standing if 0 < at % lobe < flank}))
        for turned in range(lobes):
            found.add((pushed << turned | pushed >> (lobes - turned)) & ((1 << lobes) - 1))
    return frozenset(found)
