"""The outer diameter of a motor file's ring: as given, or by the rule of sizing; in words."""

from camring.files.motor import MotorFile
from camring.geometry.ring_body import RING_WALL, usual_outer_radius, wall_outside

__all__ = ["beyond_the_body", "body_in_words", "outer_diameter_of", "thin_wall"]

_NEARLY = 0.98  # of the usual wall: what rounding and a search's last digits take away


def outer_diameter_of(file: MotorFile, greatest: float) -> float:
    """Outer diameter of the ring's body, m.

    Parameters
    ----------
    greatest
        Greatest radius of the pitch curve, m.
    """
    if file.outer_diameter is not None:
        return file.outer_diameter
    motor = file.system.motor
    return 2 * float(
        usual_outer_radius(greatest, float(motor.roller.radius), float(motor.piston.bore))
    )


def body_in_words(file: MotorFile, greatest: float) -> str:
    """Outer diameter and wall, and where they come from."""
    wall, bores = _wall(file, outer_diameter_of(file, greatest), greatest)
    source = "given" if file.outer_diameter is not None else "by rule"
    return (
        f"outer diameter {1e3 * outer_diameter_of(file, greatest):.5g} mm ({source}), "
        f"wall {1e3 * wall:.3g} mm ({bores:.2g} bores) outside the deepest place"
    )


def beyond_the_body(file: MotorFile, greatest: float) -> list[str]:
    """A sentence where the working surface leaves no body at all."""
    if file.outer_diameter is None:
        return []
    wall, _ = _wall(file, file.outer_diameter, greatest)
    if wall > 0:
        return []
    deepest = file.outer_diameter / 2 - wall
    return [
        f"The ring does not fit its body: its working surface reaches to a diameter of "
        f"{2e3 * deepest:.5g} mm, but motor.cam.outer_diameter is "
        f"{1e3 * file.outer_diameter:.5g} mm; give at least "
        f"{2e3 * (deepest + RING_WALL * float(file.system.motor.piston.bore)):.5g} mm, or a "
        "smaller cam."
    ]


def thin_wall(file: MotorFile, outer_diameter: float, greatest: float) -> list[str]:
    """A sentence where a body's wall is thinner than that of the rule."""
    wall, bores = _wall(file, outer_diameter, greatest)
    if bores >= _NEARLY * RING_WALL:
        return []
    return [
        f"The ring of {1e3 * outer_diameter:.5g} mm leaves {1e3 * wall:.3g} mm or {bores:.2g} "
        f"bores of wall outside its deepest place, less than the {RING_WALL:g} bores of a sketch: "
        "have its strength checked."
    ]


def _wall(file: MotorFile, outer_diameter: float, greatest: float) -> tuple[float, float]:
    motor = file.system.motor
    wall = float(wall_outside(outer_diameter, greatest, float(motor.roller.radius)))
    return wall, wall / float(motor.piston.bore)
