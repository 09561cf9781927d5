"""What the page offers as a download, each made from the text that is open."""

import io
import tempfile
import zipfile
from pathlib import Path

from camring.files.errors import InputError
from camring.files.motor import MotorFile

CAD = {
    "ring": "DXF and SVG of the ring",
    "points": "Point table of the ring",
    "plate": "DXF and table of the valve plate",
    "sheet": "Drawing sheet A3",
    "step": "STEP solid of the ring",
    "fmu": "FMU and Modelica",
}
WAVEFORMS = {
    ".csv": "Waveforms, CSV",
    ".xlsx": "Waveforms, Excel",
    ".mat": "Waveforms, MATLAB",
    ".nc": "Waveforms, NetCDF",
}


def choices() -> list[dict[str, str]]:
    """Every download with its words."""
    named = [("motor", "Motor file, TOML"), ("report", "Report, one HTML file")]
    named += list(CAD.items())
    named += [(f"waves{ending}", words) for ending, words in WAVEFORMS.items()]
    return [{"name": name, "words": words} for name, words in named]


def made(name: str, file: MotorFile) -> tuple[str, bytes]:
    """A file's name and content; several files come as one archive.

    Raises
    ------
    InputError
        As `camring export` and `camring simulate` raise it.
    """
    stem = file.path.stem
    if name == "motor":
        return f"{stem}.toml", file.text.encode()
    with tempfile.TemporaryDirectory(prefix="camring-studio-") as folder:
        place = Path(folder)
        _write(name, file, place, stem)
        return _together(place, f"{stem}_{name.strip('.').replace('.', '_')}")


def _write(name: str, file: MotorFile, place: Path, stem: str) -> None:
    if name in CAD:
        from camring.exchange.drawings.products import export

        export(file, place, only=[name])
    elif name == "report":
        from camring.report import gather_single, write_page

        write_page(place / f"{stem}.html", gather_single(file))
    elif name.startswith("waves") and name.removeprefix("waves") in WAVEFORMS:
        from camring.analyses.simulation import simulated
        from camring.exchange.waveforms.file import write_simulation

        found = simulated(file, estimate=False)
        write_simulation(
            place / f"{stem}{name.removeprefix('waves')}",
            file.system,
            found.cycles,
            found.outcome.results,
            source=file.text,
        )
    else:
        raise InputError(name, "is no download", "choose one of those that the page shows")


def _together(folder: Path, name: str) -> tuple[str, bytes]:
    files = sorted(each for each in folder.rglob("*") if each.is_file())
    if len(files) == 1:
        return files[0].name, files[0].read_bytes()
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as zipped:
        for each in files:
            zipped.writestr(str(each.relative_to(folder)), each.read_bytes())
    return f"{name}.zip", archive.getvalue()
