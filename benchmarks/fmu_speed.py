"""How long a step of an exported FMU takes in C: inputs set, step done, outputs read.

    python benchmarks/fmu_speed.py [MOTOR.toml]

Exports the motor, compiles its sources with tests/exchange/fmu_driver.c and runs a
million steps over the whole table.
"""

import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from camring.programs.compilation_cache import keep_compiled_programs

ROOT = Path(__file__).parent.parent
STEPS = 1_000_000


def main(motor: Path) -> None:
    keep_compiled_programs()

    from camring.exchange.drawings import export
    from camring.exchange.fmu.compiler import SOURCES
    from camring.files.motor import read_motor_file

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        written = export(read_motor_file(motor), folder, only=["fmu"])
        with zipfile.ZipFile(written[0].path) as archive:
            archive.extractall(folder)
        sources = [folder / "sources" / each for each in SOURCES]
        driver = ROOT / "tests" / "exchange" / "fmu_driver.c"
        subprocess.run(
            ["cc", "-std=c99", "-O2", "-I", folder / "sources", "-o", folder / "driver", driver,
             *sources, "-lm"], check=True,
        )  # fmt: skip
        print(written[0].path.name, written[0].holds, *written[0].notes, sep="\n", flush=True)
        subprocess.run([folder / "driver", (folder / "resources").as_uri(), str(STEPS)], check=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "examples" / "wheel_motor.toml")
