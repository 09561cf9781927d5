"""A study on disk: the motor file as given, one database, and what came of it.

A new folder appears whole or not at all: it is made under another name beside
its place and renamed. From then on the motor file in it never changes; its
digest stands in the database and is checked at every opening.
"""

import errno
import hashlib
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

from camring.files.errors import InputError
from camring.files.whole_file import make_folder, sync_names, usual_mode, write_safely
from camring.studies.database import DATABASE_NAME, StudyDamaged, StudyError
from camring.studies.lock import FolderInUse, FolderLock
from camring.studies.store import Store

GIVEN_NAME = "given.toml"
BEST_NAME = "best.toml"
FOUND_BY = "camring optimise"
VALIDATION_NAME = "validation.json"
REPORT_NAME = "report.html"


class StudyFolder:
    """An open study: its paths, its database and, when it may be changed, its lock."""

    def __init__(self, path: Path, store: Store, lock: FolderLock | None) -> None:
        self.path = path
        self.store = store
        self._lock = lock

    @classmethod
    def create(cls, path: Path, given: bytes, facts: Mapping[str, str]) -> "StudyFolder":
        """A new study at a place where nothing is yet.

        Parameters
        ----------
        given
            The motor file, byte for byte.
        facts
            What the study is about: seed, budget and the like.
        """
        require_vacant(path)
        unfinished: Path | None = None
        try:
            make_folder(path.parent)
            unfinished = Path(tempfile.mkdtemp(prefix=f".{path.name}.", dir=path.parent))
            unfinished.chmod(usual_mode(folder=True))
            write_safely(unfinished / GIVEN_NAME, given)
            Store.create(unfinished, {**facts, "given_digest": digest(given)}).close()
            lock = FolderLock(unfinished)
            _rename_to_nothing(unfinished, path)
            sync_names(path.parent)
        except OSError as error:
            raise unwritable(path, error) from error
        finally:
            if unfinished is not None:
                shutil.rmtree(unfinished, ignore_errors=True)
        return cls(path, Store.open(path, write=True), lock)

    @classmethod
    def open(cls, path: Path, *, write: bool) -> "StudyFolder":
        """An existing study, locked against other processes when it is to be changed.

        Raises
        ------
        InputError
            When it is no study, of an unknown version, in use by another process,
            not writable, or its motor file is no longer what was given.
        StudyDamaged
            When it is to be changed and any part of its database is not what was kept.
        """
        if not (path / DATABASE_NAME).is_file():
            problem = "holds no study" if path.is_dir() else "is no folder of a study"
            raise InputError(
                str(path), problem, "start one with `camring optimise MOTOR.toml --out FOLDER`"
            )
        lock = _lock(path) if write else None
        try:
            store = Store.open(path, write=write)
            folder = cls(path, store, lock)
            try:
                folder._require_unchanged()
            except BaseException:
                store.close()
                raise
        except BaseException:
            if lock is not None:
                lock.release()
            raise
        return folder

    @property
    def given_path(self) -> Path:
        return self.path / GIVEN_NAME

    @property
    def best_path(self) -> Path:
        return self.path / BEST_NAME

    @property
    def validation_path(self) -> Path:
        return self.path / VALIDATION_NAME

    @property
    def report_path(self) -> Path:
        return self.path / REPORT_NAME

    def close(self) -> None:
        self.store.close()
        if self._lock is not None:
            self._lock.release()

    def _require_unchanged(self) -> None:
        try:
            given = self.given_path.read_bytes()
        except OSError as error:
            raise InputError(
                str(self.given_path),
                f"cannot be read ({error.strerror})",
                "bring back the motor file that the study began with",
            ) from error
        facts, damage = self.store.sound_facts()
        if damage and "given_digest" not in facts:
            raise StudyDamaged(self.path, damage)
        if digest(given) != facts.get("given_digest"):
            raise InputError(
                str(self.given_path),
                "is not the motor file that this study began with",
                "undo the change, or start a new study from the changed file with "
                "`camring optimise`",
            )


def require_vacant(path: Path) -> None:
    """Raises `InputError` when anything at all is at the place of a new study."""
    if path.exists() or path.is_symlink():
        raise _occupied(path)


def digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def unwritable(path: Path, error: OSError) -> InputError | StudyError:
    """The sentence for a file or folder that the system refuses to write."""
    if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
        return StudyError(
            f"The disk of {path} takes no more ({error.strerror}): every evaluation completed "
            f"before is kept; make room, then `camring resume` goes on."
        )
    if error.errno in (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP):
        return InputError(
            str(path),
            f"lies on a disk that keeps no locks ({error.strerror}), as some network disks do",
            "choose a place on a disk of this machine, and copy the study afterwards",
        )
    return InputError(
        str(path),
        f"cannot be written ({error.strerror})",
        "choose a place where you may write",
    )


def _lock(path: Path) -> FolderLock:
    try:
        return FolderLock(path)
    except FolderInUse as error:
        raise InputError(
            str(path), f"is in use by {error}", "wait for it to end, or stop it"
        ) from error
    except OSError as error:
        raise unwritable(path, error) from error


def _occupied(path: Path) -> InputError:
    if (path / DATABASE_NAME).is_file():
        return InputError(
            str(path),
            "holds a study already",
            f"go on with `camring resume {path}`, or give another --out",
        )
    return InputError(str(path), "exists and is no study", "give a new folder as --out")


def _rename_to_nothing(source: Path, target: Path) -> None:
    # Renaming onto a folder succeeds only while that folder is empty, so a study
    # that came into being meanwhile is never replaced.
    try:
        source.rename(target)
    except OSError as error:
        if error.errno in (errno.ENOTEMPTY, errno.EEXIST, errno.ENOTDIR):
            raise _occupied(target) from error
        raise
