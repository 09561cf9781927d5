"""What tests of the studio's page wait for."""

import time

PATIENCE = 600.0  # seconds: a motor never simulated on this machine is compiled first


def until(page, script):
    """Waits until a script of the page is true."""
    deadline = time.monotonic() + PATIENCE
    while not page.evaluate(script):
        assert time.monotonic() < deadline, script
        page.wait_for_timeout(50)


def answered(page, words):
    """Asks the server for something, and waits until that and all before it is done."""
    asked = page.evaluate(f"camringStudio.ask({words})")
    until(page, f"camringStudio.known.now?.head.number >= {asked}")


def value_of(page, path):
    """The number that a field shows."""
    return float(page.get_by_test_id(f"field-{path}").input_value())


def undone(page, label):
    """Waits until a step of that name is kept, and takes back all of that name.

    Presses that follow each other are one step; on a busy machine they come apart.
    """
    until(page, f"camringStudio.known.model.undo === {label!r}")
    while page.evaluate(f"camringStudio.known.model.undo === {label!r}"):
        page.evaluate("camringStudio.known.model.seen = true")
        page.keyboard.press("Control+z")
        until(page, "camringStudio.known.model.seen !== true")
    until(page, f"camringStudio.known.model.redo === {label!r}")
