"""Draws the pictures of docs/guide/reading-a-report.md from a report, with a headless Chromium.

    camring optimise examples/wheel_motor.toml --out wheel_study
    python docs/pictures/draw_report.py wheel_study/report.html

Needs Chromium (`chromium` on the path, or named by CHROMIUM), and Pillow, which matplotlib brings.
"""

import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image, ImageChops

HERE = Path(__file__).parent
CHROMIUM = os.environ.get("CHROMIUM", "chromium")
WIDTH, HEIGHT, MARGIN = 1160, 2600, 12
SHOWN = {
    "head": ("header", "nav", "#machine"),
    "limits": ("#limits",),
    "pressure": ("#pressure",),
    "torque": ("#torque",),
    "contact": ("#contact",),
    "search": ("#search",),
    "sensitivity": ("#sensitivity",),
}
"""Which parts of the page each picture shows."""


def part(report: str, shown: tuple[str, ...]) -> str:
    """The page with all its other parts hidden."""
    hidden = "header, nav, main > section, footer { display: none; }"
    keep = "".join(f"{each} {{ display: {_display(each)} !important; }}" for each in shown)
    style = f"<style>{hidden} {keep} header, section {{ padding-top: 6px !important; }}</style>"
    return report.replace("</head>", style + "</head>", 1)


def _display(part: str) -> str:
    return "flex" if part == "nav" else "block"


def photographed(page: Path, picture: Path) -> Image.Image:
    """The page without the white round it, in 256 colours."""
    options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"]
    subprocess.run(
        [
            CHROMIUM,
            *options,
            f"--window-size={WIDTH},{HEIGHT}",
            f"--screenshot={picture}",
            page.as_uri(),
        ],
        check=True,
        capture_output=True,
    )
    seen = Image.open(picture).convert("RGB")
    box = ImageChops.difference(seen, Image.new("RGB", seen.size, "white")).getbbox()
    assert box is not None, "the page is empty"
    left, top, right, bottom = box
    return seen.crop(
        (left - MARGIN, max(top - MARGIN, 0), right + MARGIN, bottom + MARGIN)
    ).quantize(256, dither=Image.Dither.NONE)


if __name__ == "__main__":
    report = Path(sys.argv[1]).read_text(encoding="utf-8")
    with TemporaryDirectory() as folder:
        for name, shown in SHOWN.items():
            page = Path(folder) / f"{name}.html"
            page.write_text(part(report, shown), encoding="utf-8")
            picture = photographed(page, Path(folder) / f"{name}.png")
            picture.save(HERE / f"report_{name}.png", optimize=True)
