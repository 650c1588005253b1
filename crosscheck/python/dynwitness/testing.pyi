# What testing.py has.
from typing import Mapping, Union

from .program import Function, SceneLike

def assert_engine(fn: Union[Function, Mapping[str, Function]], scene: SceneLike, *, states: int = 10, seed: int = 1) -> None: ...
