"""Draws the pictures of docs/guide/studio.md: the wheel motor in the page, with headless Chromium.

Run from the root of a checkout, with the extra `browser`: `python docs/pictures/draw_studio.py`.
Needs Chromium (`chromium` on the path, or named by CHROMIUM), and Pillow, which matplotlib brings.
Prints what the guide says of them: ripple by hand and after the search, and margins.
"""

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from PIL import Image
from playwright.sync_api import sync_playwright

HERE = Path(__file__).parent
MOTOR = HERE.parent.parent / "examples" / "wheel_motor.toml"
RUN = "from camring.cli.app import main; main()"
CHROMIUM = os.environ.get("CHROMIUM", "chromium")
PATIENCE = 900.0  # seconds: what was never simulated on this machine is compiled first
STEPS, BUDGET = 16, 80
KNOWN = "camringStudio.known"
SLOPES = f"{KNOWN}.arrows !== null && {KNOWN}.arrows !== window.slopesBefore"
PINNED = f"{KNOWN}.model.pinned !== null && {KNOWN}.before !== null"


def until(page: Any, script: str) -> None:
    """Waits until a script of the page is true."""
    deadline = time.monotonic() + PATIENCE
    while not page.evaluate(script):
        if time.monotonic() > deadline:
            raise TimeoutError(script)
        page.wait_for_timeout(100)


def settled(page: Any, act: Callable[[], object]) -> None:
    """Does something to the design, and waits for the slopes of the new one."""
    page.evaluate(f"() => {{ window.slopesBefore = {KNOWN}.arrows; }}")
    act()
    until(page, SLOPES)


def photograph(page: Any, name: str) -> None:
    """The page once its envelope is drawn finely, in 256 colours."""
    page.mouse.move(720, 5)
    until(page, f"{KNOWN}.envelope.fine !== null")
    page.wait_for_timeout(5000)  # what is said goes, and the fine envelope grows finer
    seen = Image.open(BytesIO(page.screenshot())).convert("RGB")
    picture = seen.quantize(256, dither=Image.Dither.NONE)
    picture.save(HERE / f"studio_{name}.png", optimize=True)
    said = [page.get_by_test_id(f"headline-{each}").inner_text() for each in ("ripple", "limit")]
    margins = page.get_by_test_id("plot-margins").inner_text()
    print(f"{name}: {' '.join(said)}; {margins}".replace("\n", " "), flush=True)


def pictures(page: Any) -> None:
    """Begin, sixteen steps by hand, a search from where it began, a limit of its best design."""
    until(page, SLOPES)
    photograph(page, "start")
    page.get_by_test_id("pin").click()
    until(page, f"{PINNED} && {KNOWN}.arrows !== null")
    for _ in range(STEPS):
        settled(page, page.get_by_test_id("follow").click)
    photograph(page, "by_hand")
    settled(page, lambda: page.evaluate("camringStudio.ask('restore', {name: 'before'})"))
    page.keyboard.press("i")
    page.get_by_test_id("budget").fill(str(BUDGET))
    page.get_by_test_id("budget").press("Enter")
    until(page, f"({KNOWN}.study?.trials.length ?? 0) === {BUDGET}")
    settled(page, page.get_by_test_id("take-best").click)
    photograph(page, "search")
    until(page, f"['done', 'failed'].includes({KNOWN}.study.state)")
    print(page.get_by_test_id("study-best").inner_text(), flush=True)
    page.get_by_test_id("take-best").click()
    page.wait_for_timeout(3000)  # the same design again, if nothing better came
    until(page, f"{KNOWN}.arrows !== null")
    page.get_by_label("Close the study").click()
    page.locator("button.figure").click()  # the tightest limit
    page.locator(".row.lit").first.evaluate("row => row.scrollIntoView({ block: 'center' })")
    photograph(page, "limit")


def main() -> None:
    """A server of a copy of the motor, and a browser."""
    with TemporaryDirectory() as folder, sync_playwright() as playwright:
        motor = Path(shutil.copy(MOTOR, folder))
        server = subprocess.Popen(
            [sys.executable, "-c", RUN, "studio", str(motor), "--no-browser"],
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "XDG_STATE_HOME": f"{folder}/state"},
        )
        program = shutil.which(CHROMIUM) or CHROMIUM
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        try:
            assert server.stdout is not None
            page = browser.new_page(viewport={"width": 1440, "height": 900})
            page.set_default_timeout(1000 * PATIENCE)
            page.goto(server.stdout.readline().strip())
            page.wait_for_selector("#veil", state="hidden")
            pictures(page)
        finally:
            browser.close()
            server.terminate()
            server.wait(30)


if __name__ == "__main__":
    main()
