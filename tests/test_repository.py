"""What a copy of the repository holds: small, each picture once, links that lead somewhere."""

import re
import subprocess
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet

ROOT = Path(__file__).parent.parent
PICTURES = (".png", ".svg", ".pdf", ".jpg", ".webp", ".gif")
MEGABYTE, LARGEST_PICTURE = 1e6, 300e3
PAGES = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")


@pytest.fixture(scope="module")
def files():
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    if listed.returncode:
        pytest.skip("not a checkout")
    return [path for name in listed.stdout.splitlines() if (path := ROOT / name).is_file()]


def test_a_copy_is_below_ten_megabytes(files):
    assert sum(path.stat().st_size for path in files) < 10 * MEGABYTE


def test_each_picture_has_one_form_and_is_small(files):
    pictures = [path for path in files if path.suffix in PICTURES]
    stems = [path.with_suffix("") for path in pictures]
    assert len(stems) == len(set(stems)), "a picture stands there in two forms"
    assert not [str(path) for path in pictures if path.stat().st_size > LARGEST_PICTURE]


def test_each_picture_is_shown_on_a_page(files):
    text = "".join(path.read_text() for path in files if path.suffix == ".md")
    pictures = [path for path in files if path.parent == ROOT / "docs" / "pictures"]
    unseen = [path.name for path in pictures if path.suffix in PICTURES and path.name not in text]
    assert not unseen


def test_links_of_the_first_pages_lead_to_files():
    for name in PAGES:
        targets = re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", (ROOT / name).read_text())
        local = [target for target in targets if "://" not in target]
        missing = [target for target in local if not (ROOT / target).exists()]
        assert not missing, f"{name} links to {missing}"


def test_pages_and_sections_that_sources_cite_are_there(files):
    theory = (ROOT / "docs" / "theory.md").read_text()
    sections = {int(found) for found in re.findall(r"(?m)^## (\d+)\b", theory)}
    for path in files:
        if path.suffix != ".py" or path == Path(__file__):
            continue
        text = re.sub(r"\s+", " ", path.read_text())
        cited = set(re.findall(r"\b(?:docs/)?[\w/-]+\.md\b", text))
        pages = {page for page in cited if page.startswith("docs/") or page == "model.md"}
        assert not [page for page in pages if not (ROOT / page).exists()], path
        for numbers in re.findall(r"theory\.md,? sections? ([\d, and]+)", text):
            assert {int(each) for each in re.findall(r"\d+", numbers)} <= sections, path


OLDEST_PYTHON = "3.11.0"


def test_every_pinned_version_runs_on_the_oldest_python():
    """Of the packages that are installed; nobody there could install a pin that asks for more."""
    asked = {}
    for line in (ROOT / "constraints.txt").read_text().splitlines():
        if not line or line.startswith("#"):
            continue
        pin = Requirement(line)
        try:
            found = metadata(pin.name)
        except PackageNotFoundError:
            continue
        if found["Version"] in pin.specifier:
            asked[pin.name] = found.get("Requires-Python", "")
    assert {"jax", "numpy"} <= asked.keys()
    refused = {
        name for name, pythons in asked.items() if OLDEST_PYTHON not in SpecifierSet(pythons)
    }
    assert not refused
