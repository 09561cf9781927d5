"""Which outer diameter the ring is drawn with, and which is refused."""

from camring.exchange.drawings.ring import Ring
from camring.files.errors import InputError
from camring.files.motor import MotorFile
from camring.files.motor.document import printable
from camring.files.ring_body import beyond_the_body, outer_diameter_of

__all__ = ["outer_diameter"]


def outer_diameter(file: MotorFile, ring: Ring, asked: float | None) -> float:
    """Outer diameter of the ring's body, m: asked for, given in the file, or by rule.

    Raises
    ------
    InputError
        For one within the working surface, and one beyond what the motor file gives.
    """
    inside, given = 2 * ring.surface_outer, file.outer_diameter
    usual = outer_diameter_of(file, ring.outer[0])
    if asked is None:
        if beyond_the_body(file, ring.outer[0]):
            assert given is not None
            raise InputError(
                printable(file.path),
                f"has a motor.cam.outer_diameter of {1e3 * given:.6g} mm, within the working "
                f"surface of {1e3 * inside:.6g} mm",
                "give a larger one there, or make the cam smaller",
            )
        return usual
    if asked <= inside:
        raise InputError(
            "--outer-diameter",
            f"is {1e3 * asked:.6g} mm, within the working surface of {1e3 * inside:.6g} mm",
            f"give more, such as {1e3 * max(usual, inside + ring.roller_radius):.5g} mm",
        )
    if given is not None and asked > given * (1 + 1e-9):
        raise InputError(
            "--outer-diameter",
            f"is {1e3 * asked:.6g} mm, beyond the {1e3 * given:.6g} mm that the motor file gives "
            "as motor.cam.outer_diameter",
            "give at most that, or change it in the file",
        )
    return asked
