"""How fast `camring studio` follows the hand, in headless Chromium.

    python benchmarks/studio_latency.py [--moves 60] [--motor examples/wheel_motor.toml]

A real pointer takes a handle of the cam and moves it; each position is timed from the pointer
event to the task after the frame that shows its numbers; `stages_ms` says where the median goes,
and `cpu_ms` how much processor time a position takes in the server, which a loaded machine
does not change. Prints one JSON document. Needs the extra `browser` and a Chromium on the PATH.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from urllib.parse import urlsplit

RUN = "from camring.cli.app import main; main()"
ROOT = Path(__file__).parent.parent
PAUSE = 40  # ms between two positions, once the last is painted
PATIENCE = 5_000  # ms for a position to be painted
SLOPES = "() => camringStudio.known.arrows !== null"
STAGES = ("to_sent", "to_answered", "of_it_engine", "to_drawn", "to_painted")
START = 180_000  # ms for the first frame; a motor never simulated here is compiled first


def started(motor: Path, state: str) -> tuple[subprocess.Popen, str]:
    """The server, and its address."""
    server = subprocess.Popen(
        [sys.executable, "-c", RUN, "studio", str(motor), "--no-browser"],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "XDG_STATE_HOME": state},
    )
    assert server.stdout is not None
    return server, server.stdout.readline().strip()


def processor_seconds(process: int) -> float:
    """That a process has used so far, in all its threads."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def dragged(page, handle: str, moves: int) -> None:
    """A handle of the cam to and fro, one position after the other is painted."""
    box = page.get_by_test_id(handle).bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    for k in range(moves):
        before = page.evaluate("camringStudio.answered()")
        page.mouse.move(x, y + (k % 20 - 10) * 0.8 + 0.3)
        page.wait_for_function(
            "before => camringStudio.answered() > before", arg=before, timeout=PATIENCE
        )
        page.wait_for_timeout(PAUSE)
    page.mouse.up()


def measured(motor: Path, moves: int, chromium: str) -> dict[str, object]:
    from playwright.sync_api import sync_playwright

    with tempfile.TemporaryDirectory() as state, sync_playwright() as playwright:
        began = time.perf_counter()
        server, address = started(motor, state)
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        try:
            page = browser.new_page(viewport={"width": 1440, "height": 900})
            outside: list[str] = []
            host = urlsplit(address).netloc
            page.on(
                "request",
                lambda request: (
                    outside.append(request.url)
                    if urlsplit(request.url).netloc not in ("", host)
                    else None
                ),
            )
            page.goto(address)
            page.wait_for_selector("#veil", state="hidden", timeout=START)
            first = time.perf_counter() - began
            page.wait_for_function(SLOPES, timeout=START)  # else they are still being compiled
            dragged(page, "cam-handle-3", 5)
            page.wait_for_timeout(2_000)
            page.wait_for_function(SLOPES, timeout=START)
            already = page.evaluate("camringStudio.answered()")
            before = processor_seconds(server.pid)
            dragged(page, "cam-handle-3", moves)
            spent = processor_seconds(server.pid) - before
            log = page.evaluate("camringStudio.log")[already:]
            times = sorted(painted - pointed for _, pointed, painted, *_ in log)
            took = [
                (sent - pointed, answered - sent, server, drawn - answered, painted - drawn)
                for _, pointed, painted, sent, answered, drawn, server in log
            ]
            return {
                "median_ms": round(median(times), 1),
                "p95_ms": round(times[min(len(times) - 1, int(0.95 * len(times)))], 1),
                "least_ms": round(times[0], 1),
                "answered": len(times),
                "moves": moves,
                "outside_requests": len(outside),
                "stages_ms": {
                    name: round(median(each), 1)
                    for name, each in zip(STAGES, zip(*took, strict=True), strict=True)
                },
                "cpu_ms": round(1e3 * spent / moves, 1),
                "first_page_s": round(first, 2),
                "load_average": round(os.getloadavg()[0], 1),
            }
        finally:
            browser.close()
            server.terminate()
            server.wait(10)


def run(what: str, measured: Callable[[Path, int, str], dict[str, object]], moves: int) -> None:
    """The command of a measurement: reads its options, prints one JSON document."""
    words = argparse.ArgumentParser(description=what.partition("\n")[0])
    words.add_argument("--moves", type=int, default=moves)
    words.add_argument("--motor", type=Path, default=ROOT / "examples" / "wheel_motor.toml")
    given = words.parse_args()
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        sys.exit("There is no chromium on the PATH.")
    print(json.dumps(measured(given.motor, given.moves, chromium), indent=1))


if __name__ == "__main__":
    run(__doc__ or "", measured, moves=60)
