"""A gigabyte of zeros in a megabyte of archive: refused in how much time and memory."""

import argparse
import resource
import tempfile
import time
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

from camring.files.archive import require_harmless
from camring.files.errors import InputError


def archives(asked: argparse.Namespace) -> int:
    """1 when it was not refused."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "large.fmu"
        with (
            ZipFile(path, "w", ZIP_DEFLATED, compresslevel=1) as archive,
            archive.open("resources/zeros", "w", force_zip64=True) as inside,
        ):
            for _ in range(1_000):
                inside.write(bytes(1_000_000))
        before, began = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.perf_counter()
        try:
            require_harmless(path)
        except InputError as error:
            after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
            print(f"{path.stat().st_size:,} bytes refused: {error}")
            print(f"{time.perf_counter() - began:.3f} s, {after - before} KiB more memory")
            return 0
    print("not refused")
    return 1
