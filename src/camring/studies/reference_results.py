"""What the second solver says of a motor, and what it does not say."""

import math
from collections.abc import Mapping
from typing import Any

GEOMETRY_ALONE = ("min_lift", "max_lift")
"""Results that are the cam's, which the second solver is not asked for."""


def all_results(ours: Mapping[str, Any], found: Mapping[str, Any]) -> dict[str, Any]:
    """Every result as the second solver has it: NaN for what it does not compute.

    So a limit on such a result is never said to hold by a solver that has not seen it.
    """
    unseen = {name: ours[name] if name in GEOMETRY_ALONE else math.nan for name in ours}
    return {**unseen, **found}
