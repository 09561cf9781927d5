"""Friction that falls with speed from its value at rest, by the second solver."""

from typing import Any

import numpy as np

from camring.reference.user_laws import Friction, Rubbing


def stribeck(law: Any) -> Friction:
    """`StribeckFriction` in plain numbers, written as shares of the coefficient at rest."""
    rest = {name: float(getattr(law, f"{name}_static")) for name in ("roller", "side")}
    fast = {name: float(getattr(law, name)) for name in ("roller", "side")}
    fall = {name: float(getattr(law, f"{name}_stribeck")) for name in ("roller", "side")}

    def coefficient(name: str, speed: np.ndarray) -> np.ndarray:
        left = np.exp(-speed / fall[name])
        return rest[name] * left + fast[name] * (1 - left)

    def loss_torque(at: Rubbing) -> np.ndarray:
        pressed = np.where(at.normal_force > 0, at.normal_force, 0.0)
        rolling = coefficient("roller", np.abs(at.roller_speed)) * pressed * at.ring_length
        sliding = coefficient("side", at.piston_speed) * at.side_force * np.abs(at.slope)
        return rolling + sliding

    return Friction(float(law.damping), loss_torque)
