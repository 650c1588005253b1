# What is in the package: _core computes in process, program runs the program.
from . import program as program, testing as testing
from ._core import InputError as InputError, Scene as Scene, __version__ as __version__, from_text as from_text, load as load
from .program import (Drawing as Drawing, Maths as Maths, Picture as Picture, ProgramFailed as ProgramFailed, Report as Report,
                      SceneText as SceneText, Step as Step, Table as Table, audit as audit, chart as chart,
                      check as check, crosscheck as crosscheck, derive as derive, drift as drift,
                      evaluate as evaluate, growth as growth, parameters as parameters, plot as plot,
                      python_function as python_function, run as run, show as show, simulate as simulate,
                      ulps as ulps)
