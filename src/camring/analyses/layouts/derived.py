"""A motor of other counts from a given one, by stated rules.

Pistons, rollers, ports and everything else that belongs to one cylinder stay as they are,
and so do the ring's outer radius, the displacement, operating points, oil and limits. The stroke
makes up for the number of strokes in a revolution; the law of motion keeps its shape over
a lobe; the valve plate's angles, and their bounds, keep their share of the lobe pitch.
Hence layouts differ in what the counts themselves do, and share their parts.
"""

from copy import deepcopy
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.interpolate import CubicSpline

from camring.analyses.layouts.layout import Layout
from camring.files.errors import InputError
from camring.files.motor import MotorFile, parse_motor_file
from camring.files.motor.document import printable
from camring.files.motor.keys import key_map
from camring.files.motor.motor_file import missing_design_space, validated
from camring.files.motor.paths import flat_paths
from camring.files.motor.tables import RadialCamTable
from camring.files.motor.writer import whole_text
from camring.files.starting import sizing_rules as rules
from camring.files.starting.sized_file import control_count
from camring.files.units import split_quantity
from camring.geometry.block import wall_between
from camring.geometry.contour import undercut_factor
from camring.geometry.profiles import control_values
from camring.geometry.sampling import sample_spline
from camring.numerics.quantity import real
from camring.numerics.spline import Jet

__all__ = ["Original", "Unbuildable"]

OF_THE_PITCH = ("supply_width", "return_width", "supply_centre", "return_centre", "shift")
NOTCHES = ("notch_angle", "supply_notch_angle", "return_notch_angle")
OF_THE_STROKE = ("stroke", "lift")
PLATE = "motor.valve_plate."

PER_SPAN = 16


class Unbuildable(Exception):
    """Why there is no motor of some counts; completes "7x4 ..."."""


class Original:
    """The given motor, from which motors of other counts are derived.

    Raises
    ------
    InputError
        When the file has no design space, or a cam that belongs to its own counts.
    """

    def __init__(self, file: MotorFile) -> None:
        if file.design_space is None:
            raise missing_design_space(file.path)
        _, tables = validated(file.document)
        motor, cam = tables.motor, tables.motor.cam
        if not isinstance(cam, RadialCamTable) or cam.symmetry != "lobes":
            raise InputError(
                "motor.cam",
                "is planar or free round the whole ring, and has no law of one lobe that could "
                "serve other counts",
                'give control_radii of one lobe, with symmetry = "lobes"',
            )
        if isinstance(cam.reference_radius, float):
            raise InputError(
                "motor.cam.reference_radius",
                "is a length, which belongs to the given stroke",
                'write reference_radius = "minimum" and a dead_volume to match',
            )
        if motor.modes:
            raise InputError(
                "[motor.modes]",
                f"names lobes of {motor.lobes}, which other counts do not have",
                "leave it out, and the mode of each operating point, to compare layouts",
            )
        self.file = file
        self.layout = Layout(motor.pistons, motor.lobes)
        self.bore, self.roller_radius = motor.bore, motor.roller.radius
        self.degree = cam.degree
        self.control = np.array(cam.control_radii)
        pitch = 2 * pi / motor.lobes
        radius = sample_spline(self.control, pitch, cam.degree, PER_SPAN)
        self.greatest, self.least = float(radius.value.max()), float(radius.value.min())
        self.rises = _rises(radius.value)
        phase = 2 * pi * radius.angle / pitch
        self._law = CubicSpline(
            np.append(phase, phase[0] + 2 * pi),
            np.append(radius.value, radius.value[0]),
            bc_type="periodic",
        )

    @property
    def stroke(self) -> float:
        return self.greatest - self.least

    def derived(self, layout: Layout) -> str:
        """The text of a complete motor file of these counts; of the given ones as it stands.

        Raises
        ------
        Unbuildable
            When no such motor can be built, with the number and the limit.
        """
        if layout.phases < rules.LEAST_PHASES:
            raise Unbuildable(
                f"has {layout.phases} distinct piston phase{'s' * (layout.phases > 1)}, fewer "
                f"than the {rules.LEAST_PHASES} that a motor needs to start from any angle"
            )
        if layout == self.layout:
            return self.file.text
        radii = self._radii(layout)
        self._require_buildable(layout, radii)
        text = self._header(layout) + whole_text(self._document(layout, radii))
        try:
            parse_motor_file(text, Path(f"{layout}.toml"))
        except InputError as error:
            raise Unbuildable(f"makes no sound motor file: {error}") from error
        return text

    def _radii(self, layout: Layout) -> Float[np.ndarray, " control"]:
        """Control radii of one lobe: the given law at the stroke of the same displacement."""
        given, control = self.layout, self.control
        if len(control) % 2 or len(control) % layout.phases:
            # No zero-ripple cam would exist in such a spline for the search to begin with.
            count = control_count(layout.phases)
            control = control_values(lambda phase: self._law(phase), count, self.degree)
        shape = sample_spline(control, 2 * pi / layout.lobes, self.degree, PER_SPAN).value
        strokes = given.pistons * given.lobes / (layout.pistons * layout.lobes)
        scale = strokes * self.rises / _rises(shape)
        return self.greatest + scale * (control - shape.max())

    def _require_buildable(self, layout: Layout, radii: np.ndarray) -> None:
        pitch = 2 * pi / layout.lobes
        radius = sample_spline(radii, pitch, self.degree, PER_SPAN)
        least, stroke = float(radius.value.min()), float(np.ptp(radius.value))
        longest = max(rules.STROKES[1] * self.bore, self.stroke)
        if stroke > longest:
            raise Unbuildable(
                f"needs a stroke of {1e3 * stroke:.3g} mm for the displacement, above the "
                f"{1e3 * longest:.3g} mm that a piston of {1e3 * self.bore:.3g} mm keeps guided"
            )
        reach = rules.PISTON_LENGTH * self.bore
        given = wall_between(self.layout.pistons, self.bore, self.least - reach)
        wall = float(wall_between(layout.pistons, self.bore, least - reach))
        thinnest = min(rules.LEAST_WALL * self.bore, float(given))
        if wall < thinnest:
            raise Unbuildable(
                f"leaves {1e3 * wall:.2g} mm of block between the bores at their inner ends, "
                f"below {1e3 * thinnest:.2g} mm: a smaller bore or a larger ring would fit"
            )
        cubic = CubicSpline(
            np.append(radius.angle, radius.angle[0] + pitch),
            np.append(radius.value, radius.value[0]),
            bc_type="periodic",
        )
        jet = Jet(*(real(cubic(radius.angle, order)) for order in range(4)))
        undercut = float(np.min(undercut_factor(jet, real(self.roller_radius))))
        if undercut <= 0:
            raise Unbuildable(
                f"has a ring that rollers of {1e3 * self.roller_radius:.3g} mm undercut (factor "
                f"{undercut:.2g}): smaller rollers or a larger ring would fit"
            )

    def _document(self, layout: Layout, radii: np.ndarray) -> dict[str, Any]:
        document = deepcopy(self.file.document)
        motor = document["motor"]
        before, pitch = self.layout, self.layout.lobes / layout.lobes
        stroke = before.pistons * before.lobes / (layout.pistons * layout.lobes)
        motor["pistons"], motor["lobes"] = layout.pistons, layout.lobes
        name = motor.get("name", self.file.path.stem)
        motor["name"] = f"{layout.words}, from: {name}"[:200]
        motor["cam"]["control_radii"] = [f"{1e3 * radius:.6f} mm" for radius in radii]
        plate = motor["valve_plate"]
        for key in (*OF_THE_PITCH, *NOTCHES):
            if key in plate:
                plate[key] = _scaled(plate[key], pitch)
        for key in OF_THE_STROKE:
            if key in document.get("constraints", {}):
                document["constraints"][key] = _scaled(document["constraints"][key], stroke)
        document["design_space"] = self._space(len(radii), pitch, stroke)
        return document

    def _space(self, count: int, pitch: float, stroke: float) -> dict[str, Any]:
        given = deepcopy(self.file.document["design_space"])
        angles = {PLATE + key for key in (*OF_THE_PITCH, *NOTCHES)}
        space: dict[str, Any] = {
            path: _scaled(bounds, pitch) if path in angles else bounds
            for path, bounds in flat_paths(given, key_map(self.file.choices), without="cam")
        }
        if "cam" in given:
            cam = space["cam"] = given["cam"]
            most, modes = count // 2, cam["modes"]
            cam["modes"] = (
                [each for each in modes if each <= most]
                if isinstance(modes, list)
                else min(modes, most)
            )
            amplitude = cam["amplitude"]
            if not (isinstance(amplitude, str) and amplitude.rstrip().endswith("%")):
                cam["amplitude"] = _scaled(amplitude, stroke)
        return space

    def _header(self, layout: Layout) -> str:
        return (
            f"# {layout.words}, derived by `camring layouts` from {printable(self.file.path)}:\n"
            "# the same displacement, outer radius, pistons, rollers, ports, operating points and\n"
            "# limits; stroke, and angles of the valve plate, follow from the counts.\n\n"
        )


def _rises(radius: np.ndarray) -> float:
    """All that a piston rises over one lobe."""
    return float(np.sum(np.maximum(np.diff(radius, append=radius[0]), 0)))


def _scaled(value: Any, factor: float) -> Any:
    """A quantity, a list of them or bounds in a table, times a factor, in its own unit."""
    if isinstance(value, str):
        number, unit = split_quantity(value)
        return f"{number * factor:.9g} {unit}".strip()
    if isinstance(value, list):
        return [_scaled(each, factor) for each in value]
    if isinstance(value, dict):
        return {
            key: _scaled(each, factor) if key == "bounds" else each for key, each in value.items()
        }
    return value * factor
