"""The table `[evaluator]`: a user's own program that judges designs."""

from typing import Annotated as Key

from camring.interfaces.config.entries import Number, Numbers, Text
from camring.interfaces.config.table import Table

USUAL_TIMEOUT = 600.0


class EvaluatorTable(Table):
    """[evaluator]: which program to run for each design, and how long to wait."""

    command: Key[
        list[str],
        Numbers(
            "the program and its arguments, each in quotes",
            '["python", "my_model.py"]',
            item=Text("a word of the command", '"my_model.py"'),
            most=50,
        ),
    ]
    timeout: Key[
        float,
        Number("the time after which it is stopped", '"60 s"', unit="s", low=1e-3, high=1e7),
    ] = USUAL_TIMEOUT
