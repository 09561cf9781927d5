"""Archives of others: what would climb out, or grow without end, is refused before it is unpacked.

An archive says the size of each file in it, and reading stops there (`zipfile`); hence what they
add up to is a bound, whatever the compressed size.
"""

import stat
from pathlib import Path, PurePosixPath
from zipfile import BadZipFile, ZipFile, ZipInfo

from camring.files.errors import InputError, quote
from camring.files.visible import visible

__all__ = ["LARGEST_UNPACKED", "MOST_FILES", "require_harmless"]

LARGEST_UNPACKED = 500_000_000  # bytes, of all files
LARGEST_DESCRIPTION = 50_000_000  # bytes, of the XML that is held in memory
MOST_FILES = 20_000
_TEXT = (".xml", ".xsd")


def require_harmless(path: Path) -> None:
    """Refuses an archive before anything of it is read.

    Raises
    ------
    InputError
        For no archive or a damaged one, a path that leads out of its folder, a link, or too much.
    """
    shown = visible(path)
    try:
        with ZipFile(path) as archive:
            inside = archive.infolist()
    # `zipfile` says NotImplementedError of a version of ZIP that it does not read.
    except (BadZipFile, OSError, ValueError, NotImplementedError) as error:
        raise InputError(
            shown, f"is no archive that can be read ({visible(error)})", "export it anew"
        ) from None
    for each in inside:
        _require_inside(shown, each)
    total = sum(each.file_size for each in inside)
    texts = [each.file_size for each in inside if each.filename.lower().endswith(_TEXT)]
    if total > LARGEST_UNPACKED or len(inside) > MOST_FILES:
        raise InputError(
            shown,
            f"unpacks to {len(inside):,} files of {total:,} bytes, more than the {MOST_FILES:,} "
            f"files or {LARGEST_UNPACKED:,} bytes that an FMU may have",
            "export it without what a simulation does not need",
        )
    if max(texts, default=0) > LARGEST_DESCRIPTION:
        raise InputError(
            shown,
            f"holds {max(texts):,} bytes of XML in one file, more than the "
            f"{LARGEST_DESCRIPTION:,} of a description",
            "export it with fewer variables",
        )


def _require_inside(shown: str, each: ZipInfo) -> None:
    name = each.filename.replace("\\", "/")
    parts = PurePosixPath(name).parts
    outside = name.startswith("/") or ".." in parts or ":" in name.split("/")[0]
    link = stat.S_ISLNK(each.external_attr >> 16)
    if outside or link or not name.isprintable():
        raise InputError(
            shown,
            f"holds {quote(each.filename)}, which {'is a link' if link else 'leads elsewhere'}",
            "take an FMU from another source: no program writes such a path by itself",
        )
