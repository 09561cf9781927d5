"""What every exported file says of itself: which motor, which program, which way angles run."""

from dataclasses import dataclass
from datetime import date

from camring.files.motor import MotorFile
from camring.files.motor.document import printable
from camring.studies.study_folder import digest
from camring.version import __version__

__all__ = ["FRAME", "ROTATION", "About", "about"]

FRAME = (
    "Angles are of the shaft, in degrees, from +x towards +y (anticlockwise); "
    "angle 0 is that of the motor file, by default an inner dead centre."
)
ROTATION = (
    "At positive speed the cylinder block turns anticlockwise in this view; ring and valve plate "
    "stand still and are drawn from the same end of the shaft. Mirror the plate to see its face "
    "from the other side."
)


@dataclass(frozen=True)
class About:
    """Where a file comes from."""

    motor: str
    file: str
    digest: str
    program: str
    day: str

    def lines(self) -> list[str]:
        """A sentence each, for comments and notes."""
        return [
            f"Motor: {self.motor}",
            f"From: {self.file}, sha256 {self.digest}, by {self.program} on {self.day}",
            FRAME,
            ROTATION,
        ]


def about(file: MotorFile) -> About:
    """Where the files exported from a motor file come from."""
    return About(
        motor=" ".join((file.system.motor.name or "radial-piston motor").split()),
        file=printable(file.path),
        digest=digest(file.text.encode())[:16],
        program=f"camring {__version__}",
        day=f"{date.today():%Y-%m-%d}",
    )
