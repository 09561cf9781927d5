"""What a page may ask for, each by its name; nothing else can be asked."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from camring.evaluation.unfinished import place_of
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.files.starting.library import class_of, library, library_text
from camring.studio.comparison import compared
from camring.studio.description import described, files_in
from camring.studio.downloads import choices
from camring.studio.engine import Engine
from camring.studio.inside_folder import inside
from camring.studio.memory import NOW
from camring.studio.runs.analysis import Analysis
from camring.studio.runs.improvement import Improvement, Say
from camring.studio.session import Session

LIBRARY_START = "wheel"
MOST_BUDGET = 100_000

Answers = list[tuple[str, Any]]
"""To whom, `here` or `all`, and what."""


class Actions:
    """One open motor, and the study that improves it."""

    def __init__(self, folder: Path, path: Path | None, engine: Engine, say: Say) -> None:
        self.folder, self.engine, self._say = folder, engine, say
        self.session = Session(folder, path) if path is not None else _begun(folder)
        self.study: Improvement | None = None
        self.analysis: Analysis | None = None
        self._seed: int | None = None

    def end(self) -> None:
        for each in (self.study, self.analysis):
            if each is not None:
                each.end()

    def greet(self) -> Answers:
        """What a page needs that has just been opened."""
        words: Answers = [
            ("here", described(self.session)),
            (
                "here",
                {
                    "type": "choices",
                    "library": [
                        {"name": name, "class": class_of(text)} for name, text in library().items()
                    ],
                    "downloads": choices(),
                    "folder": str(self.folder),
                    **files_in(self.folder),
                },
            ),
        ]
        if self.study is not None:
            words.append(("here", self.study.standing(self.study.records())))
        if self.analysis is not None:
            words.append(("here", self.analysis.message()))
        words += [("here", each) for each in self._before()]
        self.engine.follow(lambda: self.session.asked({}))
        return words

    def act(self, message: Mapping[str, Any]) -> Answers:
        """One thing that a page has asked for.

        Raises
        ------
        CamringError
            With the sentence that the command line says.
        """
        name = str(message.get("op"))
        action: Callable[[Mapping[str, Any]], Answers] | None = getattr(self, f"_on_{name}", None)
        if action is None:
            raise InputError(repr(name), "is nothing that a page can ask for", "load it anew")
        return action(message)

    def _news(self, message: Mapping[str, Any], *, before: bool = False) -> Answers:
        """The motor in words for all pages, and its numbers after them."""
        of = {"number": message.get("number", 0), "page": message.get("page", "")}
        news: Answers = [("all", {**described(self.session), "of": of})]
        if before:
            news += [("all", each) for each in self._before()]
        self.engine.follow(lambda: self.session.asked(of))
        return news

    def _before(self) -> list[Any]:
        asked = self.session.before()
        return [{"type": "no before"}] if asked is None else [self.engine.before(asked)]

    # -- the hand ----------------------------------------------------------------------------

    def _on_commit(self, message: Mapping[str, Any]) -> Answers:
        try:
            self.session.commit(message)
        except InputError:
            for _, news in self._news(message):
                self._say(news)
            raise
        return self._news(message)

    def _on_free(self, message: Mapping[str, Any]) -> Answers:
        bounds = message.get("bounds")
        self.session.free(
            str(message["path"]), None if bounds is None else [str(each) for each in bounds]
        )
        return self._news(message)

    def _on_view(self, message: Mapping[str, Any]) -> Answers:
        points = len(self.session.opened.file.system.operating_points)
        self.session.point = min(max(int(message["point"]), 0), points - 1)
        return self._news(message, before=True)

    # -- memory ------------------------------------------------------------------------------

    def _on_undo(self, message: Mapping[str, Any]) -> Answers:
        self.session.go(-1)
        return self._news(message)

    def _on_redo(self, message: Mapping[str, Any]) -> Answers:
        self.session.go(1)
        return self._news(message)

    def _on_snapshot(self, message: Mapping[str, Any]) -> Answers:
        pin = bool(message.get("pin"))
        self.session.snapshot(str(message.get("name", "")), pin)
        return self._news(message, before=pin)

    def _on_pin(self, message: Mapping[str, Any]) -> Answers:
        self.session.pin(message.get("name"))
        return self._news(message, before=True)

    def _on_restore(self, message: Mapping[str, Any]) -> Answers:
        self.session.restore(str(message["name"]))
        return self._news(message)

    def _on_forget(self, message: Mapping[str, Any]) -> Answers:
        self.session.forget(str(message["name"]))
        return self._news(message, before=True)

    def _on_compare(self, message: Mapping[str, Any]) -> Answers:
        texts = {**self.session.memory.snapshots, NOW: self.session.memory.text}
        names = [str(message["first"]), str(message["second"])]
        for name in names:
            if name not in texts:
                raise InputError(f"{name!r}", "is no snapshot", "choose one from the list")
        files = [parse_motor_file(texts[name], self.session.path) for name in names]
        return [("here", compared(names, files))]

    # -- files -------------------------------------------------------------------------------

    def _on_save(self, message: Mapping[str, Any]) -> Answers:
        name = message.get("name")
        self.session.save(None if name is None else str(name), bool(message.get("replace")))
        self._say({"type": "files", **files_in(self.folder)})
        return self._news(message)

    def _on_open(self, message: Mapping[str, Any]) -> Answers:
        self.session.open(str(message["name"]))
        return self._news(message, before=True)

    def _on_begin(self, message: Mapping[str, Any]) -> Answers:
        """From the library, or from a line of a catalogue."""
        if message.get("like"):
            like = str(message["like"])
            self.session.begin(library_text(like), like)
        else:
            self.session.begin(_of_catalogue(message), "motor")
        return self._news(message, before=True)

    # -- the machine -------------------------------------------------------------------------

    def _on_improve(self, message: Mapping[str, Any]) -> Answers:
        session = self.session
        if session.opened.file.design_space is None:
            raise InputError(
                "this motor", "has nothing that may change", "mark a number as free first"
            )
        if self.study is not None and self.study.running:
            raise InputError("a study", "is running already", "stop it first")
        budget = min(max(int(message.get("budget") or 300), 1), MOST_BUDGET)
        name = str(message.get("folder") or self._free_folder())
        self.study = Improvement(inside(self.folder, name), self._say, budget)
        self.study.begin(session.memory.text, session.path, self._seed)
        return [("all", self.study.standing([]))]

    def _on_command(self, message: Mapping[str, Any]) -> Answers:
        """What does the same at a terminal."""
        budget = int(message.get("budget") or 300)
        folder = str(message.get("folder") or self._free_folder())
        study = Improvement(self.folder / folder, self._say, budget)
        line = study.command(self.session.path.name, self._seed)
        line = line.replace(str(self.folder / folder), folder)
        return [("here", {"type": "command", "line": line, "folder": folder})]

    def _on_pause(self, _: Mapping[str, Any]) -> Answers:
        self._running().stop("paused")
        return []

    def _on_stop(self, _: Mapping[str, Any]) -> Answers:
        self._running().stop("stopped")
        return []

    def _on_continue(self, _: Mapping[str, Any]) -> Answers:
        self._running().go_on()
        return []

    def _on_study(self, message: Mapping[str, Any]) -> Answers:
        """A study that lies in the folder, with all its designs."""
        if self.study is not None and self.study.running:
            raise InputError("a study", "is running", "stop it before opening another")
        place = inside(self.folder, str(message["name"]))
        study = Improvement(place, self._say, 300, "done")
        records = study.records()
        if not records:
            raise InputError(place.name, "is no study with evaluations", "choose another folder")
        study.budget = len(records)
        self.study = study
        return [("all", study.standing(records))]

    def _on_take(self, message: Mapping[str, Any]) -> Answers:
        """A design of the study into the hand: the best so far, or a trial."""
        trial = message.get("trial")
        text, number = self._running().design(None if trial is None else int(trial))
        self.session.take(text, f"trial {number} of {self._running().folder.name}")
        return self._news(message)

    def _on_analyse(self, message: Mapping[str, Any]) -> Answers:
        """A front of compromises, or what tolerances do; with `ask` only the command line."""
        kind = str(message.get("kind"))
        folder = self.folder / self._free_folder(kind)
        analysis = Analysis.of_message(folder, self._say, message)
        line = analysis.command(self.session.path.name)
        if message.get("ask"):
            return [("here", {"type": "command", "line": line, "folder": folder.name})]
        if self.analysis is not None and self.analysis.running:
            raise InputError("an analysis", "is running already", "stop it first")
        self.analysis = analysis
        analysis.begin(self.session.memory.text, self.session.path)
        return [("all", analysis.message())]

    def _on_end_analysis(self, _: Mapping[str, Any]) -> Answers:
        if self.analysis is not None:
            self.analysis.stop()
        return []

    def _on_take_compromise(self, message: Mapping[str, Any]) -> Answers:
        """A design of the front into the hand."""
        if self.analysis is None:
            raise InputError("a front", "is not there", "trace one first")
        number = int(message["design"])
        self.session.take(self.analysis.design(number), f"design {number} of the front")
        return self._news(message)

    def _running(self) -> Improvement:
        if self.study is None:
            raise InputError("a study", "is not there", "begin one with “improve this”")
        return self.study

    def _free_folder(self, kind: str = "study") -> str:
        stem = f"{self.session.path.stem}_{kind}"
        names = (stem, *(f"{stem}_{k}" for k in range(2, 10_000)))
        places = ((name, self.folder / name) for name in names)
        return next(name for name, at in places if not (at.exists() or place_of(at).exists()))


def _begun(folder: Path) -> Session:
    """The first motor file of a folder; in a folder without any a motor of the library."""
    motors = files_in(folder)["motors"]
    for name in motors:
        try:
            return Session(folder, folder / name)
        except InputError:
            continue
    names = library()
    like = LIBRARY_START if LIBRARY_START in names else next(iter(names))
    return Session.new(folder, names[like], like)


def _of_catalogue(message: Mapping[str, Any]) -> str:
    from camring.files.starting.demand import read_counts, read_demand
    from camring.files.starting.impossible import refusal
    from camring.files.starting.sized_file import sized_text
    from camring.files.starting.sizing import sized

    def given(key: str) -> str | None:
        return str(message[key]).strip() or None if message.get(key) else None

    demand = read_demand(
        given("displacement"), given("pressure"), given("speed"), given("outer_diameter")
    )
    counts = read_counts(given("counts"))
    found = sized(demand, counts)
    if not len(found):
        raise refusal(demand, counts)
    return sized_text(found, 0, demand)
