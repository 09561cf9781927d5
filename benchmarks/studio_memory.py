"""Whether `camring studio` grows while a hand moves for long, in headless Chromium.

    python benchmarks/studio_memory.py [--moves 10000] [--motor examples/wheel_motor.toml]

The page moves one number to and fro, each position once the last is painted. Prints one JSON
document: resident memory of the server and heap of the page, MB, after a tenth of the moves and
at the end.
"""

import tempfile
from pathlib import Path

from studio_latency import START, run, started

PATH = "motor.valve_plate.shift"
BATCH = 50  # positions in one call of the page

MOVES = """async ([count, path]) => {
  const link = await import("/page/link.js");
  for (let k = 0; k < count; k += 1) {
    const before = link.answered();
    link.log.length = 0;
    link.move({ set: { [path]: -0.01 + 0.0002 * (k % 50) } }, performance.now());
    while (link.answered() === 0) await new Promise((done) => setTimeout(done, 1));
  }
  return performance.memory.usedJSHeapSize;
}"""


def resident(process: int) -> float:
    """MB of a process."""
    text = Path(f"/proc/{process}/status").read_text()
    return int(text.partition("VmRSS:")[2].split()[0]) / 1024


def measured(motor: Path, moves: int, chromium: str) -> dict[str, object]:
    from playwright.sync_api import sync_playwright

    with tempfile.TemporaryDirectory() as state, sync_playwright() as playwright:
        server, address = started(motor, state)
        options = ["--no-sandbox", "--enable-precise-memory-info", "--js-flags=--expose-gc"]
        browser = playwright.chromium.launch(executable_path=chromium, args=options)
        try:
            page = browser.new_page()
            page.goto(address)
            page.wait_for_selector("#veil", state="hidden", timeout=START)
            page.set_default_timeout(START)
            found = []
            for count in (moves // 10, moves - moves // 10):
                for _ in range(count // BATCH):
                    page.evaluate(MOVES, [BATCH, PATH])
                page.evaluate("gc()")
                heap = page.evaluate("performance.memory.usedJSHeapSize") / 2**20
                found.append((resident(server.pid), heap))
            (first, first_heap), (last, last_heap) = found
            return {
                "moves": moves,
                "server_mb": [round(first, 1), round(last, 1)],
                "page_heap_mb": [round(first_heap, 1), round(last_heap, 1)],
            }
        finally:
            browser.close()
            server.terminate()
            server.wait(20)


if __name__ == "__main__":
    run(__doc__ or "", measured, moves=10_000)
