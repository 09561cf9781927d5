"""The page's own files: contrast in both themes, and nothing loaded from elsewhere."""

import re
from pathlib import Path

import pytest

import camring.studio

PAGE = Path(camring.studio.__file__).parent / "page"
STYLE = (PAGE / "style.css").read_text()
TEXT = ("ink", "quiet", "now", "before", "limit", "good", "supply", "return")
LEAST = 4.5  # of text on its ground: WCAG 2.2, AA
LEAST_GRAPHIC = 3.0


def colours(theme):
    """Of a theme, by name; the dark one changes some of the light one's."""
    light, dark = STYLE.index(":root {"), STYLE.index(":root[data-theme")
    blocks = [STYLE[light:dark]]
    if theme == "dark":
        blocks.append(STYLE[dark : STYLE.index("* { box-sizing")])
    return dict(re.findall(r"--([a-z-]+):\s*(#[0-9a-f]{6})", "".join(blocks)))


def luminance(colour):
    channels = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    red, green, blue = (
        c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in channels
    )
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def contrast(one, other):
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_text_can_be_read_in_both_themes(theme):
    found = colours(theme)
    grounds = [(name, "paper") for name in TEXT]
    grounds += [("ink", "ground"), ("quiet", "ground"), ("ink", "margin"), ("ink", "near")]
    grounds += [("ink", "soft"), ("ink", "limit-soft"), ("quiet", "limit-soft")]
    grounds += [(name, "accent-soft") for name in ("ink", "quiet", "limit", "now")]
    grounds += [("limit", "limit-soft"), ("quiet", "soft"), ("paper", "now"), ("paper", "ink")]
    weak = {pair: contrast(*(found[name] for name in pair)) for pair in grounds}
    assert not {pair: ratio for pair, ratio in weak.items() if ratio < LEAST}
    assert contrast(found["before"], found["margin"]) >= LEAST_GRAPHIC


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_what_is_no_text_is_seen_in_both_themes(theme):
    """Lines, edges of what can be typed into, the ring around what has the focus."""
    found = colours(theme)
    pairs = [(line, ground) for line in ("now", "before") for ground in ("paper", "soft", "steel")]
    pairs += [("limit", ground) for ground in ("paper", "soft", "limit-soft")]
    pairs += [("supply", "paper"), ("return", "paper"), ("good", "paper"), ("quiet", "paper")]
    pairs += [("now", "margin"), ("before", "near"), ("before", "limit-soft")]
    pairs += [("steel-edge", "paper"), ("steel-edge", "steel")]
    pairs += [("edge", ground) for ground in ("paper", "ground", "soft")]
    pairs += [("focus", ground) for ground in ("paper", "ground", "soft", "steel", "accent-soft")]
    weak = {pair: contrast(*(found[name] for name in pair)) for pair in pairs}
    assert not {pair: ratio for pair, ratio in weak.items() if ratio < LEAST_GRAPHIC}


def test_every_colour_of_the_page_is_one_of_both_themes():
    """A colour written anywhere else would escape the tests of contrast."""
    light, dark = colours("light"), colours("dark")
    assert set(light) == set(dark)
    used = set()
    for file in PAGE.glob("*.*s"):
        text = file.read_text()
        used |= set(re.findall(r"var\(--([a-z-]+)\)", text))
        used |= set(re.findall(r"colour\(\"([a-z-]+)\"\)", text))
        if file.name != "style.css":
            assert not re.findall(r":\s*#[0-9a-f]{3,6}\b", text), file.name
    assert used - {"radius", "gap"} <= set(light)


def test_no_file_of_the_page_names_an_address_to_load():
    for file in PAGE.glob("*"):
        if file.suffix in (".js", ".css", ".html"):
            found = re.findall(r"(?:https?:)?//[a-z0-9.-]+\.[a-z]{2,}", file.read_text())
            assert not [each for each in found if "www.w3.org" not in each], file.name


def test_what_is_not_ours_comes_with_its_licence():
    assert "MIT" in (PAGE / "vendor" / "uPlot.LICENSE").read_text()
    assert "v1.6.32" in (PAGE / "vendor" / "uPlot.iife.min.js").read_text()[:200]


def test_every_module_that_is_imported_is_there():
    for file in PAGE.glob("*.js"):
        for name in re.findall(r'from "\./([a-z]+\.js)"', file.read_text()):
            assert (PAGE / name).is_file(), (file.name, name)
