"""What stands beside the waveforms of a file: which motor, from what, working as what."""

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from camring.version import __version__

if TYPE_CHECKING:
    from camring.physics.system import System


def works_as(results: Sequence[Mapping[str, float]]) -> dict[str, str]:
    """Motor, pump or brake at each operating point, where that is known."""
    from camring.metrics.efficiency import working_as

    if not results or not {"input_power", "output_power"} <= results[0].keys():
        return {}
    words = [str(working_as(each["input_power"], each["output_power"])) for each in results]
    return {"operating_mode": ", ".join(words)}


def attributes_of(system: "System", source: str) -> dict[str, object]:
    import jax

    motor = system.motor
    return {
        "title": f"Waveforms of {motor.name or 'a radial-piston motor'}",
        "pistons": motor.pistons,
        "lobes": motor.lobes,
        "source": f"camring {__version__}, jax {jax.__version__}",
        "history": f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ} written by camring {__version__}",
        "motor_file": source,
        "comment": "chamber variables belong to the piston that stands at the shaft angle; "
        "the angle grows the way the cylinder block turns at positive speed, anticlockwise in "
        "the drawings of `camring export`; angle 0 is that of the motor file",
    }
