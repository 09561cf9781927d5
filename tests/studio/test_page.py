"""The page in a browser: one motor, one server, one Chromium for all of it."""

from pathlib import Path

import pytest
from studio_page import PATIENCE, answered, until, value_of

EXAMPLE = Path(__file__).parents[2] / "examples" / "wheel_motor.toml"
FIELD_OF = "document.querySelector('[data-testid=\"field-{}\"]').value"
pytestmark = pytest.mark.slow


def number_of(page, testid):
    return float(page.get_by_test_id(testid).inner_text().split("%")[0].split()[0])


def test_the_pictures_follow_a_handle_while_it_is_dragged_and_undo_takes_it_back(page):
    before = page.get_by_test_id("headline-ripple").inner_text()
    box = page.get_by_test_id("cam-handle-3").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    for k in range(3):
        answered = page.evaluate("camringStudio.answered()")
        page.mouse.move(x, y - 4 * (k + 1))
        until(page, f"camringStudio.answered() > {answered}")
    assert page.get_by_test_id("headline-ripple").inner_text() != before  # the hand holds it still
    page.mouse.up()
    until(page, "camringStudio.known.model.undo !== null")
    page.keyboard.press("Control+z")
    until(page, "camringStudio.known.model.undo === null")
    until(page, f"document.querySelector('[data-testid=headline-ripple]').innerText === {before!r}")


def test_a_wrong_number_is_refused_beside_its_field_and_stays_there_after_a_reload(page):
    field = "field-motor.valve_plate.supply_width"
    fault = "fault-motor.valve_plate.supply_width"
    page.get_by_test_id(field).fill("65")
    page.get_by_test_id(field).press("Enter")
    said = f"document.querySelector('[data-testid=\"{fault}\"]')?.textContent ?? ''"
    until(page, f"({said}).includes('wider than the pitch of 60 deg')")
    page.reload()
    until(page, f"({said}).includes('wider than the pitch of 60 deg')")
    assert page.get_by_test_id(field).input_value() == "65"
    page.get_by_test_id(field).fill("28.8")
    page.get_by_test_id(field).press("Enter")
    until(page, f"({said}) === ''")


def test_two_pages_show_the_same_motor(page, browser, address):
    other = browser.new_page(reduced_motion="reduce")
    other.set_default_timeout(1000 * PATIENCE)
    other.goto(address)
    other.wait_for_selector("#veil", state="hidden")
    slider = page.get_by_test_id("slider-motor.valve_plate.shift")
    slider.focus()
    for _ in range(10):
        slider.press("ArrowLeft")
    wanted = page.get_by_test_id("field-motor.valve_plate.shift").input_value()
    assert float(wanted) < 0
    until(other, f"{FIELD_OF.format('motor.valve_plate.shift')} === {wanted!r}")
    until(other, "camringStudio.known.model.unsaved")
    other.close()


LATE = """
const Prompt = WebSocket;
window.WebSocket = class extends Prompt {
  set onmessage(take) { super.onmessage = (event) => setTimeout(take, 1000, event); }
};
"""


FRAMES_LATE = """
const Prompt = WebSocket;
const kind = (data) => JSON.parse(new TextDecoder().decode(
  new Uint8Array(data, 4, new DataView(data).getUint32(0, true)))).type;
window.heldBack = [];
window.WebSocket = class extends Prompt {
  set onmessage(take) {
    super.onmessage = (event) => {
      const late = typeof event.data !== "string" && kind(event.data) === "frame";
      if (late && window.heldBack) window.heldBack.push(() => take(event)); else take(event);
    };
  }
};
"""


def test_what_comes_before_the_numbers_that_it_is_about_is_no_fault(page, browser, address):
    """Arrows of the design before, when a file has just been opened, or on a page that is new."""
    early = browser.new_page(reduced_motion="reduce")
    early.set_default_timeout(1000 * PATIENCE)
    faults = []
    early.on("pageerror", lambda error: faults.append(str(error)))
    early.add_init_script(FRAMES_LATE)
    early.goto(address)
    until(early, "camringStudio.known.model !== null")
    until(early, "document.querySelector('[data-testid=cam-handle-3]') !== null")
    for _ in range(2):  # which brings arrows to every page, the second time after the first frame
        until(page, "camringStudio.known.arrows !== null")
        answered(page, "'view', { point: 0 }")
    until(page, "camringStudio.known.arrows !== null")
    early.get_by_test_id("cam-handle-3").evaluate(
        "each => each.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowUp' }))"
    )
    early.set_viewport_size({"width": 1200, "height": 800})
    early.wait_for_timeout(300)
    assert early.evaluate("camringStudio.known.now") is None
    early.evaluate("heldBack.splice(0).forEach((each) => each()); heldBack = null")
    until(early, "camringStudio.known.now !== null")
    assert faults == []
    answered(page, "'view', { point: 0 }")
    until(early, "camringStudio.known.arrows !== null")
    early.close()


@pytest.mark.parametrize(
    "element",
    [
        "slider-motor.valve_plate.shift",
        "field-motor.valve_plate.shift",
        "cam-handle-3",
    ],
)
def test_answers_that_come_late_take_nothing_out_of_the_hand(page, browser, address, element):
    late = browser.new_page(reduced_motion="reduce")
    late.set_default_timeout(1000 * PATIENCE)
    late.add_init_script(LATE)
    late.goto(address)
    late.wait_for_selector("#veil", state="hidden")
    late.get_by_test_id("cam-keep").uncheck()  # else each step of the cam scales the one before
    held = late.get_by_test_id(element)

    def shown():
        if element.startswith(("slider", "field")):
            return value_of(late, "motor.valve_plate.shift")
        return float(held.get_attribute("aria-valuetext").split()[-2])

    def pressed(after):
        late.wait_for_timeout(after)
        held.press("ArrowDown")

    def all_answered():
        late.wait_for_timeout(500)
        answered(late, "'view', { point: 0 }")
        late.wait_for_timeout(100)

    held.focus()
    start = shown()
    pressed(0)
    all_answered()
    step = shown() - start
    for pause in [0, 550, 50, 550, 50]:
        pressed(pause)  # some after a rest, in which what was pressed is kept
    all_answered()
    assert step < 0
    assert shown() == pytest.approx(start + 6 * step)
    fields = "JSON.stringify(camringStudio.known.model.fields)"
    until(page, f"{fields} === {late.evaluate(fields)!r}")
    late.close()


def test_the_keyboard_alone_reaches_the_numbers_and_saves(page, folder):
    page.keyboard.press("/")
    page.keyboard.type("return width")
    assert page.get_by_test_id("field-motor.valve_plate.return_width").is_visible()
    assert not page.get_by_test_id("field-motor.valve_plate.shift").is_visible()
    page.keyboard.press("Tab")
    page.get_by_test_id("field-motor.valve_plate.return_width").focus()
    page.keyboard.press("Control+a")
    page.keyboard.type("28.3 deg")
    page.keyboard.press("Enter")
    until(page, "camringStudio.known.model.unsaved")
    page.keyboard.press("Control+s")
    until(page, "!camringStudio.known.model.unsaved")
    assert 'return_width = "28.3 deg"' in (folder / "motor.toml").read_text()
    assert (folder / "motor.toml").read_text().startswith(EXAMPLE.read_text().split("\n")[0])


def test_a_design_of_a_study_goes_into_the_hand_by_keys_alone(page):
    page.keyboard.press("i")
    page.get_by_test_id("budget").fill("12")
    page.get_by_test_id("budget").press("Enter")
    until(page, "['done', 'failed'].includes(camringStudio.known.study?.state)")
    assert page.evaluate("camringStudio.known.study.state") == "done"
    page.get_by_test_id("plot-study").focus()
    page.keyboard.press("End")
    page.keyboard.press("Enter")
    until(page, "(camringStudio.known.model.undo ?? '').startsWith('trial ')")


def test_the_page_says_what_tolerances_need_that_are_not_there(page):
    page.keyboard.press("a")
    page.get_by_test_id("kind-tolerance").check()
    line = "document.querySelector('[data-testid=\"analysis-line\"]').textContent"
    until(page, f"{line}.startsWith('camring tolerance motor.toml --samples 1024')")
    page.get_by_test_id("begin-analysis").click()
    words = "document.querySelector('[data-testid=\"analysis-words\"]').textContent"
    until(page, f"{words}.includes('[tolerances]')")
