"""The catalogue of faults: name -> Fault. A fault modifies a recording and states the permitted reactions of the program.

A fault's function takes (recording, random generator) and returns a dictionary of
  until        the trajectory must be complete up to this image
  fatal        nothing can be estimated
  jump         (last stamp on the old clock in ns, offset in s): the truth keeps the old clock
  what         the random draw, for the table
"""
from dataclasses import dataclass
from typing import Callable


@dataclass
class Fault:
    apply: Callable
    does_harm: bool  # the run must report a finding
    is_calibration: bool = False  # whether it does harm depends on the draw


FAULTS = {}


def fault(does_harm=True, is_calibration=False):
    def add(function):
        FAULTS[function.__name__] = Fault(function, does_harm, is_calibration)
        return function
    return add


def middle(recording, rng):
    """Index of an image in the middle part of the recording."""
    frames = recording.frames()
    return rng.randrange(int(frames * 0.35), int(frames * 0.75))


@fault(does_harm=False)
def none(recording, rng):
    return {}
