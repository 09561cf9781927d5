"""The exported FMU, called as importers call it, against the motor that it stands for."""

import ctypes
import json
import shutil
import subprocess
from math import tau
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree
from zipfile import ZipFile

import motor_files
import numpy as np
import pytest
from command_line import EXAMPLE
from fmu_slave import ERROR, NAMES, OK, OUTPUTS, RIPPLE, WARNING, Library, Slave
from typer.testing import CliRunner

from camring.cli.app import app
from camring.exchange.drawings import Wishes, export
from camring.exchange.fmu import compiler, filling
from camring.exchange.fmu.axes import BAR, RPM, Ranges, axes_of
from camring.exchange.fmu.filling import filled_table
from camring.exchange.fmu.identity import identifier
from camring.exchange.fmu.places import Found, angles_of, simulated_places
from camring.exchange.fmu.table import QUANTITIES
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.reference import independent_solution
from camring.reference.results import total_torque

pytestmark = pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-fPIC", "-shared")
# The motor file's first operating point is one of the table's.
RANGES = Ranges(
    speed="100 rpm, 300 rpm, 450 rpm", pressure="130 bar, 250 bar",
    low_pressure="10 bar, 20 bar",
)  # fmt: skip

UNSUPPORTED = (
    "fmi2CancelStep", "fmi2SetRealInputDerivatives", "fmi2GetRealOutputDerivatives",
    "fmi2GetDirectionalDerivative", "fmi2GetStatus", "fmi2GetStringStatus",
)  # fmt: skip


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """Motor file, folder, what was written, the library."""
    file = parse_motor_file(motor_files.SOUND)
    folder = tmp_path_factory.mktemp("fmu")
    written = export(file, folder, only=["fmu"], wishes=Wishes(table=RANGES))
    fmu = written[0].path
    library = Library(fmu, tmp_path_factory.mktemp("unpacked"))
    return SimpleNamespace(file=file, folder=folder, written=written, fmu=fmu, library=library)


@pytest.fixture(scope="module")
def solved():
    """The first operating point by the independent solver."""
    system = parse_motor_file(motor_files.SOUND).system
    return independent_solution(system.motor, system.fluid, system.operating_points[0])


@pytest.fixture
def slave(exported):
    slave = Slave(exported.library)
    assert slave.handle, slave.said
    yield slave
    slave.close()


def operating_point(file):
    """Inputs that stand for the first operating point."""
    point = file.system.operating_points[0]
    values = (point.shaft_speed, point.supply_pressure, point.return_pressure, point.case_pressure)
    return dict(zip(NAMES, map(float, values), strict=False))


def turned(slave, angles):
    """Outputs at ascending angles, shape (4, angle); steps as long as it takes."""
    (speed,) = slave.get("speed")
    time, rows = 0.0, []
    for angle in angles:
        step = (angle - slave.get("angle")[0]) / speed
        assert slave.step(time, step) == OK, slave.said
        time += step
        rows.append(slave.get(*OUTPUTS))
    return np.array(rows).T


def test_fmpy_finds_nothing_to_complain_of(exported):
    validation = pytest.importorskip("fmpy.validation", reason="the extra camring[fmu]")
    assert validation.validate_fmu(str(exported.fmu)) == []


def test_fmpy_simulates_it_from_the_motor_file_s_own_point(exported, solved):
    fmpy = pytest.importorskip("fmpy", reason="the extra camring[fmu]")
    point = exported.file.system.operating_points[0]
    turn = tau / float(point.shaft_speed)
    result = fmpy.simulate_fmu(
        str(exported.fmu), stop_time=turn, step_size=turn / 4800, output_interval=turn / 4800
    )
    assert result["angle"][-1] == pytest.approx(tau)
    mean = np.mean(result["torque"][:-1])
    assert mean == pytest.approx(solved.results["mean_torque"], rel=1e-5)


def test_at_a_point_of_the_table_it_is_the_motor_s_own_cycle(exported, slave):
    system, here = exported.file.system, operating_point(exported.file)
    count = angles_of(system.motor)
    drop = here["supplyPressure"] - here["returnPressure"]
    place = np.array([[here["speed"], drop, here["returnPressure"] - here["casePressure"]]])
    cycle = simulated_places(system.motor, system.fluid, here["casePressure"], place, count)
    slave.start(**here)
    waves = turned(slave, tau / 24 * np.arange(count) / count)
    peak = np.abs(waves).max(axis=1, keepdims=True)
    np.testing.assert_allclose(waves / peak, cycle.waves[0] / peak, rtol=0, atol=1e-6)
    slave.set_ripple(0)
    np.testing.assert_allclose(slave.get(*OUTPUTS), cycle.means[0], rtol=1e-12)


def test_at_a_point_of_the_table_the_second_solver_agrees(exported, slave, solved):
    """SciPy's, which shares no formula with the table's: means, and torque as it ripples."""
    results = solved.results
    angle = np.linspace(0, 3, 97)
    slave.start(**operating_point(exported.file))
    torque = total_torque(solved.orbit, angle)
    np.testing.assert_allclose(turned(slave, angle)[0] / torque.max(), torque / torque.max(),
                               rtol=0, atol=2e-5)  # fmt: skip
    slave.set_ripple(0)
    torque, supply, back, case = slave.get(*OUTPUTS)
    assert torque == pytest.approx(results["mean_torque"], rel=1e-6)
    assert supply == pytest.approx(results["supply_flow"], rel=1e-6)
    # Oil of constant modulus grows by the work it does: docs/theory.md section 6, compression.
    work = results["output_power"] + results["friction_loss"]
    grown = work / float(exported.file.system.fluid.bulk_modulus)
    assert back + case - supply == pytest.approx(grown, rel=1e-5)


def test_over_a_revolution_the_ripple_has_the_mean(exported, slave):
    slave.start(**operating_point(exported.file))
    count = 24 * 512
    waves = turned(slave, tau * np.arange(count) / count)
    slave.set_ripple(0)
    np.testing.assert_allclose(waves.mean(axis=1), slave.get(*OUTPUTS), rtol=1e-5)
    period = waves.reshape(4, 24, 512)
    spread = np.ptp(period, axis=1).max(axis=1) / np.ptp(waves, axis=1)
    assert np.all(spread < 1e-8)


def test_between_points_it_strays_no_further_than_it_says(exported):
    """At places and angles that the export did not look at; the worst is near the middles."""
    file, random = exported.file, np.random.default_rng(7)
    filled = filled_table(file, axes_of(file, RANGES))
    table, errors = filled.table, filled.errors
    quiet = {f"{name}_rms_error": rms for name, rms in zip(QUANTITIES, errors.rms, strict=True)}
    assert exported.written[0].figures.items() >= quiet.items()
    speed = random.uniform(*np.abs(table.speed[[-3, -1]]), 20) * random.choice([-1, 1], 20)
    drop, low = (random.uniform(axis[0], axis[-1], 20) for axis in table.axes[1:])
    places = np.stack([speed, drop, low], axis=1)
    motor, count = file.system.motor, angles_of(file.system.motor)
    truth = simulated_places(motor, file.system.fluid, filled.case_pressure, places, count, 0.25)
    angle = tau / 24 / count * (np.arange(count) + 0.25)
    found = []
    for speed, drop, low in places:
        slave = Slave(exported.library)
        lower = filled.case_pressure + low
        slave.start(
            speed=speed, casePressure=filled.case_pressure,
            supplyPressure=lower + max(drop, 0), returnPressure=lower + max(-drop, 0),
        )  # fmt: skip
        # Backwards the angle falls from a whole revolution.
        found.append(turned(slave, angle if speed > 0 else angle[::-1] - tau))
        if speed < 0:
            found[-1] = found[-1][:, ::-1]
        slave.set_ripple(0)
        of_means = np.abs(np.array(slave.get(*OUTPUTS)) - truth.means[len(found) - 1])
        assert np.all(of_means <= 1.1 * np.array(errors.mean) * np.abs(table.means).max((0, 1, 2)))
        slave.close()
    away = np.sqrt(np.mean((np.array(found) - truth.waves) ** 2, axis=-1))
    assert np.all(away <= 1.1 * np.array(errors.rms) * np.abs(table.waves).max((0, 1, 2, 4)))


def test_places_side_by_side_are_those_one_by_one(monkeypatch):
    """Forwards and backwards, driven and braking, half a step ahead."""
    system = parse_motor_file(motor_files.SOUND).system
    places = np.array([[300 * RPM, 200 * BAR, 10 * BAR], [-100 * RPM, -100 * BAR, 20 * BAR],
                       [-100 * RPM, 100 * BAR, 10 * BAR]])  # fmt: skip
    asked = system.motor, system.fluid, 2 * BAR, places, angles_of(system.motor), 0.5
    together = simulated_places(*asked)
    monkeypatch.setattr("camring.exchange.fmu.places.fits", lambda motor: False)
    alone = simulated_places(*asked)
    assert not together.faults.any()
    assert not alone.faults.any()
    np.testing.assert_allclose(together.means, alone.means, rtol=1e-7)
    largest = np.abs(alone.waves).max(axis=-1)
    away = np.sqrt(np.mean((together.waves - alone.waves) ** 2, axis=-1))
    assert np.max(away / largest) < 1e-4
    np.testing.assert_allclose(together.lowest_pressure, alone.lowest_pressure, rtol=5e-3)


def test_turned_backwards_with_the_ports_swapped_a_symmetric_motor_is_the_same(exported, slave):
    """What one port does the other did, and oil that went in comes out."""
    ahead = operating_point(exported.file) | {"speed": 200 * RPM, "supplyPressure": 180 * BAR}
    slave.set_ripple(0)
    slave.start(**ahead)
    torque, supply, back, case = slave.get(*OUTPUTS)
    slave.set(speed=-ahead["speed"], supplyPressure=ahead["returnPressure"],
              returnPressure=ahead["supplyPressure"])  # fmt: skip
    np.testing.assert_allclose(slave.get(*OUTPUTS), [-torque, -back, -supply, case], rtol=1e-6)


def test_all_pressures_raised_together_change_nothing(exported, slave):
    """Of an oil of constant modulus: so the table has no axis for the case's pressure."""
    here = operating_point(exported.file)
    slave.start(**here)
    before = slave.get(*OUTPUTS)
    slave.set(**{name: here[name] + 7 * BAR for name in here if name != "speed"})
    np.testing.assert_allclose(slave.get(*OUTPUTS), before, rtol=1e-12)


def test_instances_know_nothing_of_each_other(exported):
    one, two = Slave(exported.library), Slave(exported.library, name=b"other")
    here = operating_point(exported.file)
    one.start(**here)
    two.start(**here | {"speed": -100 * RPM, "supplyPressure": 50 * BAR})
    alone = one.get(*OUTPUTS)
    assert two.step(0.0, 0.01) == OK
    assert one.get(*OUTPUTS, "angle") == [*alone, 0.0]
    two.close()
    assert one.step(0.0, 0.01) == OK
    assert one.get("angle") == pytest.approx([0.01 * here["speed"]])
    one.close()


def test_beyond_the_table_inputs_are_held_and_reported_once(exported, slave):
    here = operating_point(exported.file)
    slave.start(**here | {"speed": 450 * RPM})
    edge = slave.get(*OUTPUTS)
    slave.set(speed=900 * RPM)
    for place in range(5):
        assert slave.step(0.001 * place, 0.001) == OK
    assert [status for status, _ in slave.said] == [WARNING]
    assert "speed (rad/s) is 94.2478, outside the table's -47.1239 to 47.1239" in slave.said[0][1]
    assert slave.get("angle") == pytest.approx([900 * RPM * 0.005])
    again = Slave(exported.library)
    again.start(**here | {"speed": 900 * RPM, "initialAngle": 0.0})
    assert again.get(*OUTPUTS) == edge
    again.close()


def test_through_standstill_nothing_jumps(exported, slave):
    slave.set_ripple(0)
    slave.start(**operating_point(exported.file))
    rows = []
    for speed in np.linspace(-120, 120, 241) * RPM:
        slave.set(speed=speed)
        rows.append(slave.get(*OUTPUTS))
    steps = np.abs(np.diff(rows, axis=0)).max(axis=0)
    assert np.all(steps <= 0.02 * np.abs(rows).max(axis=0))


def test_a_saved_state_goes_on_as_before(exported, slave):
    slave.start(**operating_point(exported.file))
    slave.step(0.0, 0.003)
    state, size = slave.saved(), ctypes.c_size_t()
    slave.step(0.003, 0.001)
    slave.set(speed=10.0)
    later = ctypes.byref
    assert slave.call("fmi2SetFMUstate", state) == OK
    here = slave.get(*NAMES)
    assert slave.call("fmi2SerializedFMUstateSize", state, later(size)) == OK
    content = ctypes.create_string_buffer(size.value)
    assert slave.call("fmi2SerializeFMUstate", state, content, size) == OK
    other, copy = Slave(exported.library, name=b"other"), ctypes.c_void_p()
    assert other.call("fmi2DeSerializeFMUstate", content, size, later(copy)) == OK
    assert other.call("fmi2SetFMUstate", copy) == OK
    assert other.get(*NAMES) == here
    assert other.step(0.003, 0.001) == OK
    for each, kept in ((slave, state), (other, copy)):
        assert each.call("fmi2FreeFMUstate", later(kept)) == OK
        assert not kept.value
    assert slave.call("fmi2Reset") == OK
    assert slave.get("angle", "speed") == [0.0, operating_point(exported.file)["speed"]]
    other.close()


def test_misuse_is_an_error_with_a_sentence(exported, slave):
    def refused_with(status, words):
        assert status == ERROR
        assert words in slave.said[-1][1]

    refused_with(slave.step(0.0, 0.1), "must not be called before initialization")
    refused_with(slave.call("fmi2ExitInitializationMode"), "before initialization")
    slave.start()
    refused_with(slave.call("fmi2EnterInitializationMode"), "while stepping")
    refused_with(slave.step(0.0, -0.1), "must be finite and not negative")
    refused_with(slave.step(0.5, 0.1), "the last step ended at 0 s")
    refused_with(slave.set_by_number([NAMES.index("torque")], [1.0]), "is an output")
    refused_with(slave.set_by_number([0], [float("nan")]), "must be finite")
    refused_with(slave.set_by_number([RIPPLE], [1.0]), "no such variable")
    refused_with(slave.set_by_number([NAMES.index("initialAngle")], [1.0]), "cannot be set")
    one = (ctypes.c_uint * 1)(0), ctypes.c_size_t(1)
    for name in ("fmi2GetInteger", "fmi2SetInteger", "fmi2GetString", "fmi2SetString"):
        refused_with(slave.call(name, *one, None), "no such variable")
        assert slave.call(name, None, ctypes.c_size_t(0), None) == OK
    for name in UNSUPPORTED:
        refused_with(slave.call(name, *one, None, None, None, None), "is not supported")
    assert slave.call("fmi2Terminate") == OK
    refused_with(slave.step(0.0, 0.1), "after termination")
    calls = exported.library.calls
    assert calls.fmi2DoStep(None, ctypes.c_double(0), ctypes.c_double(1), 0) == ERROR
    assert calls.fmi2GetVersion() == b"2.0"
    assert calls.fmi2GetTypesPlatform() == b"default"


def test_what_cannot_be_instantiated_says_why(exported, tmp_path):
    library = exported.library
    (tmp_path / "a b").mkdir()
    cut = tmp_path / "a b" / "table.bin"
    with ZipFile(exported.fmu) as archive:
        cut.write_bytes(archive.read("resources/table.bin")[:-1])
    for given, words in (
        (dict(guid="{other}"), "GUID"),
        (dict(kind=0), "co-simulation only"),
        (dict(name=b""), "needs a name"),
        (dict(resources=tmp_path.as_uri()), "cannot be opened"),
        (dict(resources=(tmp_path / "a b").as_uri()), "is cut off"),
    ):
        slave = Slave(library, **given)
        assert slave.handle is None
        assert (slave.said[0][0], words in slave.said[0][1]) == (ERROR, True)
    cut.write_bytes(b"no table" * 100)
    assert "is none of camring's" in Slave(library, resources=cut.parent.as_uri()).said[0][1]


def test_every_function_of_the_standard_is_there(exported):
    """Of co-simulation, FMI 2.0; its sources compile without a warning, alone and with a prefix."""
    names = set(exported.library.calls.__dict__)
    header = compiler.source_texts()["camring_fmi2.h"]
    wanted = {part.split("(")[0].split(")")[0] for part in header.split("fmi2")[1:]}
    functions = {f"fmi2{name}" for name in wanted if f"(fmi2{name})(" in header}
    assert len(functions) == 34
    assert all(getattr(exported.library.calls, name) for name in functions), names
    with ZipFile(exported.fmu) as archive:
        sources = [name for name in archive.namelist() if name.startswith("sources/")]
        folder = exported.folder / "strict"
        archive.extractall(folder, sources)
        listed = ElementTree.fromstring(archive.read("modelDescription.xml")).iter("File")
    files = [each.get("name") for each in listed]
    for extra in ((), ("-DFMI2_FUNCTION_PREFIX=motor_",)):
        subprocess.run(
            ["cc", *STRICT, *extra, "-o", "motor.so", *files, "-lm"],
            cwd=folder / "sources", check=True,
        )  # fmt: skip


def test_sanitizers_find_nothing(exported, tmp_path):
    """Of addresses, leaks and undefined behaviour, over the table and beyond it."""
    with ZipFile(exported.fmu) as archive:
        archive.extractall(tmp_path)
    driver = Path(__file__).with_name("fmu_driver.c")
    sources = [tmp_path / "sources" / name for name in compiler.SOURCES]
    checks = "-fsanitize=address,undefined"
    built = subprocess.run(
        ["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", checks, "-g",
         "-fno-sanitize-recover=undefined", "-I", tmp_path / "sources",
         "-o", tmp_path / "driver", driver, *sources, "-lm"],
        capture_output=True, text=True,
    )  # fmt: skip
    if "asan" in built.stderr:
        pytest.skip("the compiler comes without its sanitizers")
    assert built.returncode == 0, built.stderr
    resources = (tmp_path / "resources").as_uri()
    ran = subprocess.run([tmp_path / "driver", resources], capture_output=True, text=True)
    assert (ran.returncode, ran.stderr) == (0, "")


def test_modelica_reads_the_same_numbers(exported, slave):
    """The header for Modelica, with its tool's messages left out, is compiled as C."""
    text = (exported.folder / "motor.mo").read_text()
    folder = exported.folder / "motor_files"
    assert text.count('IncludeDirectory="modelica://motor/motor_files"') == 3
    assert "modelica://motor/motor_files/table.bin" in text
    (folder / "ModelicaUtilities.h").write_text(
        "void ModelicaError(const char *message);\n"
        "void ModelicaFormatError(const char *format, ...);\n"
        "void ModelicaFormatMessage(const char *format, ...);\n"
    )
    (folder / "all.c").write_text(
        '#include "camring_modelica.h"\n'
        "void *(*const open)(const char *) = camring_modelica_open;\n"
        "void (*const close)(void *) = camring_modelica_close;\n"
        "void (*const look_up)(void *, double, double, double, double, double, int, double *)\n"
        "    = camring_modelica_look_up;\n"
        "void ModelicaError(const char *message) { (void)message; }\n"
        "void ModelicaFormatError(const char *format, ...) { (void)format; }\n"
        "void ModelicaFormatMessage(const char *format, ...) { (void)format; }\n"
    )
    # `open` and `close` are the library's own names here, not those of POSIX.
    subprocess.run(["cc", *STRICT, "-o", "all.so", "all.c", "-lm"], cwd=folder, check=True)
    calls = ctypes.CDLL(str(folder / "all.so"))
    pointer, number = ctypes.c_void_p, ctypes.c_double
    kinds = {
        "open": ctypes.CFUNCTYPE(pointer, ctypes.c_char_p),
        "close": ctypes.CFUNCTYPE(None, pointer),
        "look_up": ctypes.CFUNCTYPE(None, pointer, *[number] * 5, ctypes.c_int, pointer),
    }
    call = {name: kind(ctypes.c_void_p.in_dll(calls, name).value) for name, kind in kinds.items()}
    table, found = call["open"](str(folder / "table.bin").encode()), (number * 4)()
    here = operating_point(exported.file)
    call["look_up"](table, *here.values(), 0.37, 1, found)
    call["close"](table)
    slave.start(**here, initialAngle=0.37)
    assert slave.get(*OUTPUTS) == list(found)


def test_without_a_compiler_the_sources_go_alone_and_it_is_said(exported, monkeypatch):
    monkeypatch.setenv("CC", "no-such-compiler")
    binary = compiler.compiled(compiler.source_texts(), "motor")
    assert (binary.content, "no C compiler was found" in binary.why) == (b"", True)
    monkeypatch.setenv("CC", "cc -include no-such-file.h")
    assert "failed and said" in compiler.compiled(compiler.source_texts(), "motor").why


def pretended(faulty=lambda places: np.zeros(len(places), bool)):
    """In place of `simulated_places`: a motor of constant torque and flows."""

    def found(motor, fluid, case, places, count, ahead=0.0):
        ones = np.ones((len(places), 4))
        waves = np.repeat(ones[..., None], count, axis=-1)
        return Found(ones, waves, 1 * faulty(places), 9e5 * ones[:, 0], ones[:, 0])

    return found


def test_braking_without_a_cycle_is_left_out_and_it_is_said(monkeypatch):
    bad = pretended(lambda places: (places[:, 0] > 0) & (places[:, 1] < 0))
    monkeypatch.setattr(filling, "simulated_places", bad)
    file = parse_motor_file(motor_files.SOUND)
    filled = filled_table(file, axes_of(file, Ranges(points="5x3")))
    assert filled.table.drop[0] == 0
    assert len(filled.table.speed) == 10
    assert "Only positive pressure drops" in filled.warnings[0]


def test_driving_without_a_cycle_is_refused_with_the_place(monkeypatch):
    bad = pretended(lambda places: np.arange(len(places)) == len(places) - 1)
    monkeypatch.setattr(filling, "simulated_places", bad)
    file = parse_motor_file(motor_files.SOUND)
    with pytest.raises(InputError, match="1 of 60 points without a result, the first at 450 rpm"):
        filled_table(file, axes_of(file, Ranges(points="5x3")))


def test_a_notch_leaves_the_forward_direction_and_it_is_said(monkeypatch):
    monkeypatch.setattr(filling, "simulated_places", pretended())
    text = motor_files.added("[motor.valve_plate]", "notch_angle = 0.03\nnotch_area = 0.05")
    file = parse_motor_file(text)
    filled = filled_table(file, axes_of(file, Ranges(points="3x2")))
    assert "Only forward speeds" in filled.warnings[0]
    assert filled.table.speed[0] > 0


@pytest.mark.parametrize(
    ("path", "name"),
    [("my motor-2.toml", "my_motor_2"), ("2nd.toml", "motor_2nd"), ("model.toml", "motor_model"),
     ("study/best.toml", "study"), ("…​.toml", "motor")],
)  # fmt: skip
def test_names_are_fit_for_c_and_modelica(tmp_path, path, name):
    assert identifier(SimpleNamespace(path=tmp_path / path)) == name


def test_the_command_writes_and_tells(tmp_path, monkeypatch):
    monkeypatch.setattr(filling, "simulated_places", pretended())
    monkeypatch.setenv("CAMRING_CACHE", "off")

    def run(*arguments):
        return CliRunner().invoke(app, ["export", str(EXAMPLE), "--out", str(tmp_path), *arguments])

    done = run("--fmu", "--points", "3x2", "--json")
    assert done.exit_code == 0, done.output
    files = json.loads(done.stdout)["files"]
    assert {each["path"].removeprefix(f"{tmp_path}/") for each in files} == {
        "derivation_motor.fmu", "derivation_motor.mo", "derivation_motor_files/table.bin",
        "derivation_motor_files/camring_modelica.h", "derivation_motor_files/camring_table.c",
        "derivation_motor_files/camring_table.h",
    }  # fmt: skip
    assert files[0]["torque_mean_error"] < 1e-12
    assert any("Beyond, inputs are held" in note for note in files[0]["notes"])
    again = run("--only", "fmu", "--points", "2x2")
    assert (again.exit_code, "derivation_motor.fmu exists" in again.stderr) == (2, True)
    assert "- torque: mean" in run("--fmu", "--force", "--points", "2x2").stdout
