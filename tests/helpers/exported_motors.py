"""Motors of every kind of cam, and how far drawn points are from their exact curves."""

from math import pi

import motor_files
import numpy as np
from scipy.spatial import cKDTree

from camring.files.motor import parse_motor_file
from camring.geometry.outline import outline_of

MOTORS = {
    "lobes": motor_files.SOUND,
    "ring": motor_files.ring(),
    "planar": motor_files.planar(),
    "planar ring": motor_files.planar(repeats=1, count=72),
}
MICROMETRE = 1e-3  # in the millimetres of the files


def motor(text):
    return parse_motor_file(text)


def normal_error(file, points, distance):
    """Largest distance in mm of points (complex, mm) from the exact curve `distance` outside.

    Another way than the exporter's: the nearest of very many exact places,
    and the distance from its tangent.
    """
    outline = outline_of(file.system.motor.cam)
    dense = outline.places(np.linspace(0, 2 * pi, 200_001), distance)
    flat = np.stack([dense.point.real, dense.point.imag], axis=1)
    _, nearest = cKDTree(flat).query(np.stack([points.real, points.imag], axis=1) / 1e3)
    away = points / 1e3 - dense.point[nearest]
    return 1e3 * np.abs(np.real(away * np.conj(dense.normal[nearest]))).max()
