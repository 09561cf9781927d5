"""The motor file: read once, at the edge (docs/theory.md section 9)."""

from camring.files.motor.motor_file import (
    MotorFile,
    missing_design_space,
    missing_tolerances,
    parse_motor_file,
    read_motor_file,
)

__all__ = [
    "MotorFile",
    "missing_design_space",
    "missing_tolerances",
    "parse_motor_file",
    "read_motor_file",
]
