"""What became of a computation, as data beside the numbers.

Inside `jit` nothing can be raised, and one bad design must not sink a batch:
each fault sets a bit, and the edge of the program turns bits into sentences.
"""

from enum import IntFlag

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Int


class Fault(IntFlag):
    """Reasons not to trust a result."""

    NONE = 0
    NOT_CONVERGED = 1
    ORBIT_NOT_UNIQUE = 2
    CHAMBER_VOLUME_NOT_POSITIVE = 4
    NOT_FINITE = 8


EXPLANATIONS = {
    Fault.NOT_CONVERGED: (
        "the periodic pressure was not found to solver accuracy: ask for a finer resolution"
    ),
    Fault.ORBIT_NOT_UNIQUE: (
        "the chamber neither opens nor leaks within a period, so any amount of oil in it is a "
        "solution: give it a leakage coefficient or a port that opens"
    ),
    Fault.CHAMBER_VOLUME_NOT_POSITIVE: (
        "chamber volume falls to zero or below within the stroke: enlarge dead_volume"
    ),
    Fault.NOT_FINITE: "a result is not a finite number",
}


class Verdict(eqx.Module):
    """A sum of `Fault` bits; zero is sound."""

    code: Int[Array, "..."]

    @property
    def sound(self) -> Bool[Array, "..."]:
        return self.code == 0

    def explain(self) -> str:
        """One sentence for each fault; empty when sound. For a single verdict, outside `jit`."""
        return "; ".join(
            sentence for fault, sentence in EXPLANATIONS.items() if int(self.code) & fault
        )


def verdict(**faults: Bool[Array, "..."]) -> Verdict:
    """Collect faults by their names in lower case, each a truth value or an array of them."""
    code = sum(jnp.where(present, int(Fault[name.upper()]), 0) for name, present in faults.items())
    return Verdict(jnp.asarray(code))
