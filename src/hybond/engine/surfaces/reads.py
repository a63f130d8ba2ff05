"""What switching functions and followers read, by number, as the tables say it."""

from typing import Final

READS_STORED: Final = 0
READS_SIGNAL: Final = 1
READS_TIME: Final = 2
READS_INPUT: Final = 3
READS_BOND: Final = 4
READS_SWITCH: Final = 5
"""What a switching function has a slope by, `surface_kind`: the last is what is ON, or a state."""
BY_STATES: Final = 0
BY_STORED: Final = 1
BY_BONDS: Final = 2
"""What the guards of a follower read, `follower_asks`: states of machines, time and inputs alone;
what is stored and signals, too; bond variables, for which a mode has to be solved."""
