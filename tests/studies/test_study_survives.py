"""Nothing completed is lost, whatever happens, and a study goes on as if nothing had."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import fake_study
import pytest
from processes import wait_for

PROGRAM = Path(fake_study.__file__)
BUDGET = 60


def start(folder, seconds=0.004, budget=BUDGET, workers=None, **options):
    command = [sys.executable, str(PROGRAM), str(folder), str(budget), str(seconds)]
    command += [] if workers is None else [str(workers)]
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True, **options)


def wait_for_evaluations(folder, count, process, patience=60):
    """Until that many evaluations are kept; their sequence when last looked at."""
    deadline = time.monotonic() + patience
    while time.monotonic() < deadline:
        if (folder / "study.sqlite").exists():
            rows, _ = fake_study.sequence(folder)
            if len(rows) >= count:
                return rows
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.002)
    raise AssertionError(f"no {count} evaluations within {patience} s")


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    folder = tmp_path_factory.mktemp("uninterrupted") / "study"
    assert fake_study.run(folder, BUDGET) == f"The budget of {BUDGET} evaluations is spent."
    return fake_study.sequence(folder)


def test_a_study_killed_many_times_is_bit_identical_to_one_that_was_not(tmp_path, uninterrupted):
    folder = tmp_path / "study"
    kept = []
    for count in (1, 2, 7, 8, 20, 35, 50, 59):
        process = start(folder)
        seen = wait_for_evaluations(folder, max(count, len(kept) + 1), process)
        process.send_signal(signal.SIGKILL)
        assert process.wait() in (-signal.SIGKILL, 0)
        process.stderr.close()
        kept, _ = fake_study.sequence(folder)
        # What a reader had seen before the kill is there after it, to the bit.
        assert kept[: len(seen)] == seen
    fake_study.run(folder, BUDGET)
    assert fake_study.sequence(folder) == uninterrupted


def test_evaluations_ahead_of_their_turn_are_repeated_after_a_kill(tmp_path):
    """In the middle of batches; with two workers, then one, then none."""
    fake_study.run(tmp_path / "whole", BUDGET, strategy=fake_study.in_batches())
    folder = tmp_path / "study"
    for workers, count in ((2, 3), (2, 17), (1, 29)):
        process = start(folder, workers=workers)
        wait_for_evaluations(folder, count, process)
        process.kill()
        process.communicate()
    fake_study.run(folder, BUDGET, strategy=fake_study.in_batches())
    assert fake_study.sequence(folder) == fake_study.sequence(tmp_path / "whole")


def test_a_kill_at_any_instant_leaves_a_whole_study_or_none(tmp_path, uninterrupted):
    """Also before the first evaluation, while imports run and the folder is made."""
    wanted, memory = uninterrupted
    began = time.monotonic()
    start(tmp_path / "timing", seconds=0, budget=1).communicate()
    whole = time.monotonic() - began
    for trial in range(8):
        folder = tmp_path / f"study_{trial}"
        process = start(folder)
        time.sleep(whole * (0.6 + 0.08 * trial))
        process.kill()
        process.communicate()
        if folder.exists():
            assert fake_study.sequence(folder)[0] == wanted[: len(fake_study.sequence(folder)[0])]
        fake_study.run(folder, BUDGET)
        assert fake_study.sequence(folder) == (wanted, memory)


def test_ctrl_c_stops_within_a_second_and_loses_nothing(tmp_path, uninterrupted):
    folder = tmp_path / "study"
    process = start(folder, seconds=0.05)
    wait_for_evaluations(folder, 5, process)
    # An evaluation of half a minute is not waited for.
    process.kill()
    process.communicate()
    process = start(folder, seconds=30)
    # Its imports take longer the busier the machine is; with the lock it has begun.
    wait_for(lambda: f"process {process.pid} " in (folder / ".lock").read_text())
    time.sleep(1.0)
    began = time.monotonic()
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=120) == 130
    assert time.monotonic() - began < 15  # of the thirty that the evaluation takes
    assert "Traceback" not in process.stderr.read()
    fake_study.run(folder, BUDGET)
    assert fake_study.sequence(folder) == uninterrupted


def test_ctrl_c_stops_workers_too(tmp_path):
    """The terminal sends it to every process of the program."""
    folder = tmp_path / "study"
    process = start(folder, workers=2, seconds=0.02, start_new_session=True)
    wait_for_evaluations(folder, 3, process)
    os.killpg(process.pid, signal.SIGINT)
    _, said = process.communicate(timeout=300)
    assert process.returncode == 130
    assert "Traceback" not in said


def test_a_file_size_limit_stops_the_study_in_a_sentence(tmp_path, uninterrupted):
    resource = pytest.importorskip("resource")
    folder = tmp_path / "study"
    fake_study.run(folder, 5)
    size = max(file.stat().st_size for file in folder.iterdir())

    process = start(
        folder,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)),
    )
    _, said = process.communicate(timeout=300)
    assert process.returncode == 1
    assert "takes no more" in said
    assert "Traceback" not in said
    kept, _ = fake_study.sequence(folder)
    assert len(kept) >= 5
    fake_study.run(folder, BUDGET)
    assert fake_study.sequence(folder) == uninterrupted


@pytest.mark.skipif(os.geteuid() != 0, reason="mounting a small disk takes root")
def test_a_full_disk_stops_the_study_in_a_sentence(tmp_path, uninterrupted):
    disk = tmp_path / "disk"
    disk.mkdir()
    if subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=200k", "tmpfs", str(disk)], capture_output=True
    ).returncode:
        pytest.skip("no right to mount here")
    try:
        folder = disk / "study"
        process = start(folder, seconds=0, budget=400)
        _, said = process.communicate(timeout=300)
        assert process.returncode == 1, said
        assert "takes no more" in said
        kept, _ = fake_study.sequence(folder)
        assert kept == uninterrupted[0][: len(kept)] or len(kept) > BUDGET
        subprocess.run(["mount", "-o", "remount,size=20m", str(disk)], check=True)
        fake_study.run(folder, max(BUDGET, len(kept) + 5))
        assert fake_study.sequence(folder)[0][:BUDGET] == uninterrupted[0]
    finally:
        subprocess.run(["umount", str(disk)], check=True)


def test_the_lock_dies_with_its_process(tmp_path):
    folder = tmp_path / "study"
    process = start(folder, seconds=0.05)
    wait_for_evaluations(folder, 1, process)
    second = start(folder)
    _, said = second.communicate(timeout=300)
    assert second.returncode == 2
    assert f"is in use by process {process.pid}" in said
    process.kill()
    process.communicate()
    fake_study.run(folder, 3)
