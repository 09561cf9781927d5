"""A motor, its server and one Chromium, for all tests of the page."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from studio_page import PATIENCE, answered, until

RUN = "from camring.cli.app import main; main()"
EXAMPLE = Path(__file__).parents[2] / "examples" / "wheel_motor.toml"


def chromium(playwright):
    """The system's, else one that Playwright has installed; None for neither."""
    for name in ("chromium", "chromium-browser", "google-chrome"):
        if shutil.which(name):
            return shutil.which(name)
    with playwright.sync_playwright() as run:
        path = Path(run.chromium.executable_path)
        shell = sorted(path.parents[2].glob("chromium_headless_shell*/*/*headless*shell"))
    return next((str(each) for each in (path, *shell) if each.is_file()), None)


@pytest.fixture(scope="package")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("motors")
    shutil.copy(EXAMPLE, place / "motor.toml")
    return place


@pytest.fixture(scope="package")
def state(tmp_path_factory):
    """Where the server keeps what was done to the motor."""
    return tmp_path_factory.mktemp("state")


@pytest.fixture(scope="package")
def address(folder, state):
    server = subprocess.Popen(
        [sys.executable, "-c", RUN, "studio", str(folder / "motor.toml"), "--no-browser"],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "XDG_STATE_HOME": str(state)},
    )
    yield server.stdout.readline().strip()
    server.terminate()
    server.wait(30)


@pytest.fixture(scope="package")
def browser():
    playwright = pytest.importorskip("playwright.sync_api", reason="needs the extra `browser`")
    program = chromium(playwright)
    if program is None:
        pytest.skip("there is no Chromium here")
    with playwright.sync_playwright() as run:
        browser = run.chromium.launch(executable_path=program, args=["--no-sandbox"])
        yield browser
        browser.close()


def given_again(page, folder, state):
    """The motor as the example gives it, whatever an earlier test has done to it."""
    until(page, "camringStudio.known.model !== null")
    given = "camringStudio.known.model.undo === null && !camringStudio.known.model.unsaved"
    deadline = time.monotonic() + PATIENCE
    while True:
        shutil.copy(EXAMPLE, folder / "motor.toml")
        shutil.rmtree(state / "camring" / "studio", ignore_errors=True)
        answered(page, "'open', { name: 'motor.toml' }")
        if page.evaluate(given):
            return
        assert time.monotonic() < deadline, given


def at_rest(page):
    """Waits until the server has all that was done on a page: nothing is left for the next one."""
    page.keyboard.press(
        "Control"
    )  # arrow keys are kept once they rest, or at once before a command
    answered(page, "'view', { point: 0 }")


@pytest.fixture
def page(browser, address, folder, state):
    page = browser.new_page(viewport={"width": 1440, "height": 900}, reduced_motion="reduce")
    page.set_default_timeout(1000 * PATIENCE)
    page.faults, page.outside = [], []
    page.on("pageerror", lambda error: page.faults.append(str(error)))
    host = urlsplit(address).netloc

    def seen(request):
        if urlsplit(request.url).netloc not in ("", host):
            page.outside.append(request.url)

    page.on("request", seen)
    page.goto(address)
    given_again(page, folder, state)
    yield page
    at_rest(page)
    assert page.faults == []
    assert page.outside == []
    page.close()
