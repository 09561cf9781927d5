"""A sampler for Optuna that asks our strategies."""

import contextlib
import math
import threading
import zlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import optuna
from optuna.distributions import BaseDistribution
from optuna.samplers import BaseSampler
from optuna.study import Study, StudyDirection
from optuna.trial import FrozenTrial, TrialState

from camring.exchange.optuna.box import Axis, Box, require_numeric
from camring.exchange.optuna.past import ASKED, DEAF, Past, note_of, past_of
from camring.files.errors import InputError, quote
from camring.search.problem import Proposal, Stop
from camring.search.sampling import generator, initial_point
from camring.search.strategies import STRATEGIES, Task, strategy_named

DESCENDING = ("automatic", "differences", "gradient")
"""Not offered: they go by tiny steps, which trials on a grid, and running ones, do not answer."""
WITHOUT_SLOPES = tuple(name for name in STRATEGIES if name not in DESCENDING)
ENDLESS = 10**9  # evaluations: no descent at the end
CONSTRAINTS = "constraints"
TRIES = 64
_logger = optuna.logging.get_logger(__name__)


class CamringSampler(BaseSampler):
    """Proposes an Optuna study's trials by one of our strategies.

    It keeps nothing of its own: what a strategy has to remember stands in the trials, so
    one sampler serves several studies, and a study in a database goes on in any process.

    Parameters
    ----------
    strategy
        "bayesian", "cma-es", "cobyqa", "nelder-mead" or "scbo".
    seed
        Where all chance comes from: the same seed, the same trials, bit for bit.
    space
        Distributions of the parameters, where they are known beforehand. Otherwise the
        first trial is the middle of every range, and the search begins with the second.
    budget
        Trials after which nothing more will come: "bayesian" refines the best design by
        quadratic models with the last fifth of them. None: it never does.
    constraints_func
        Takes a finished trial and returns what must be at most 0, as Optuna's own
        samplers do; `trial.set_constraint` inside the objective does the same.
    batch
        Trials chosen at once, for `n_jobs` of as many.

    Raises
    ------
    InputError
        When strategy, seed, budget or batch cannot be used; later, when a study has
        several objectives or a parameter is a choice without an order.
    """

    def __init__(
        self,
        strategy: str = "scbo",
        *,
        seed: int = 0,
        space: Mapping[str, BaseDistribution] | None = None,
        budget: int | None = None,
        constraints_func: Callable[[FrozenTrial], Sequence[float]] | None = None,
        batch: int = 1,
    ) -> None:
        if strategy not in WITHOUT_SLOPES:
            raise InputError(
                "strategy", f"is {quote(strategy)}", f"choose {' or '.join(WITHOUT_SLOPES)}"
            )
        for name, value, low in (("seed", seed, 0), ("budget", budget, 1), ("batch", batch, 1)):
            if name == "budget" and value is None:
                continue
            if isinstance(value, bool) or not isinstance(value, int) or value < low:
                raise InputError(name, f"is {quote(value)}", f"give a whole number from {low} up")
        self._strategy, self._seed = strategy, seed
        self._budget, self._batch = budget, batch
        self._constraints_func = constraints_func
        self._space = None if space is None else _searchable(space)
        self._lock = threading.Lock()

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "_lock"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._lock = threading.Lock()

    def reseed_rng(self) -> None:
        """Nothing: processes of one study see each other's trials, and need no other chance."""

    def infer_relative_search_space(
        self, study: Study, trial: FrozenTrial
    ) -> dict[str, BaseDistribution]:
        """Parameters that the search chooses together: those given, or all trials have."""
        if len(study.directions) > 1:
            raise InputError(
                "study",
                f"has {len(study.directions)} objectives, and CamringSampler minimises one",
                "make the others constraints, or add them up",
            )
        if self._space is not None:
            return dict(self._space)
        common: dict[str, BaseDistribution] | None = None
        # Of failed trials too, which Optuna's own rule leaves out: had the first ones
        # failed, nothing would be learned from them.
        finished = [one for one in _trials(study) if one.state.is_finished() and one.distributions]
        looked_at = [one for one in finished if one.state != TrialState.FAIL]
        for one in looked_at or finished:
            seen = one.distributions
            common = {
                name: distribution
                for name, distribution in (seen if common is None else common).items()
                if seen.get(name) == distribution
            }
        return _searchable(common or {})

    def sample_relative(
        self, study: Study, trial: FrozenTrial, search_space: dict[str, BaseDistribution]
    ) -> dict[str, Any]:
        """The parameters of the next trial."""
        if not search_space:
            return {}
        box = Box(search_space)
        with self._lock:
            others = [one for one in _trials(study) if one.number != trial.number]
            sign = -1.0 if study.direction == StudyDirection.MAXIMIZE else 1.0
            past = past_of(others, box, self._signature, sign)
            budget = ENDLESS if self._budget is None else self._budget
            strategy = strategy_named(
                self._strategy, Task(box.dimension, budget, batch=self._batch)
            )
            answer = strategy.propose(past.history, past.memory, self._seed)
            if isinstance(answer, Stop):
                answer = self._after_the_end(study, answer, past, box)
            point = self._untried(box, answer, past)
            note = note_of(box, self._signature, point, answer.phase, answer.memory)
            study._storage.set_trial_system_attr(trial._trial_id, ASKED, note)
        return box.values(point)

    def sample_independent(
        self,
        study: Study,
        trial: FrozenTrial,
        param_name: str,
        param_distribution: BaseDistribution,
    ) -> Any:
        """A parameter that not all trials have: the middle in the first one, then anywhere."""
        require_numeric(param_name, param_distribution)
        unit = 0.5
        if trial.number > 0:
            stream = zlib.crc32(param_name.encode())
            unit = float(generator(self._seed, trial.number, stream).random())
        return Axis(param_name, param_distribution).value(unit)

    def after_trial(
        self,
        study: Study,
        trial: FrozenTrial,
        state: TrialState,
        values: Sequence[float] | None,
    ) -> None:
        """Keeps the constraints of a trial where Optuna and its dashboard look for them."""
        if self._constraints_func is None or state not in (TrialState.COMPLETE, TrialState.PRUNED):
            return
        found = [float(value) for value in self._constraints_func(trial)]
        if any(math.isnan(value) for value in found):
            _logger.warning(f"Trial {trial.number} has a constraint without a value.")
            found = [math.inf if math.isnan(value) else value for value in found]
        study._storage.set_trial_system_attr(trial._trial_id, CONSTRAINTS, found)

    @property
    def _signature(self) -> str:
        return f"{self._strategy} {self._seed} {self._budget} {self._batch}"

    def _after_the_end(self, study: Study, stop: Stop, past: Past, box: Box) -> Proposal:
        _logger.info(f"{stop.reason} The study stops after this trial, which looks elsewhere.")
        # Where somebody else's loop asks, that loop decides when to end.
        with contextlib.suppress(RuntimeError):
            study.stop()
        place = len(past.history)
        return Proposal(
            initial_point(place, box.dimension, self._seed), "after the end", past.memory
        )

    def _untried(self, box: Box, answer: Proposal, past: Past) -> np.ndarray:
        """The point asked for; where steps make it one of the past, one beside it."""
        point = box.settled(answer.point)
        if not box.stepped or answer.phase in DEAF:
            return point
        taken = [box.values(one.point) for one in past.history]
        random = generator(self._seed, len(past.history), 3)
        near = point
        for attempt in range(TRIES):
            if box.values(near) not in taken:
                return near
            reach = 0.5 * (attempt + 1) / TRIES
            step = reach * random.uniform(-1, 1, box.dimension)
            near = box.settled(np.clip(answer.point + step, 0.0, 1.0))
        return point


def _searchable(space: Mapping[str, BaseDistribution]) -> dict[str, BaseDistribution]:
    for name, distribution in space.items():
        require_numeric(name, distribution)
    return {name: space[name] for name in sorted(space) if not space[name].single()}


def _trials(study: Study) -> list[FrozenTrial]:
    return study.get_trials(deepcopy=False)
