"""What courses are remembered by where a step begins: a run that goes on takes that step again.

The end of a run cuts its last step short. What goes on begins where that step did, and looks ahead
from there as the run in one did: by what it knew then, not by what it has learned since.
"""

from __future__ import annotations

from hybond.engine.expressions.course_records import Courses
from hybond.engine.model import Model


def keep_courses(m: Model, c: Courses) -> None:
    """Keep what is known."""
    k = m.courses
    for i in range(k):
        c.memory[i] = c.size[i]
        c.memory[k + i] = c.peak[i]
        c.memory[2 * k + i] = c.peak_at[i]
        c.memory[3 * k + i] = float(c.told[i])
    first = 4 * k
    for i in range(m.course_plants):
        c.memory[first + i] = c.plant[i]
        c.memory[first + m.course_plants + i] = c.ranges.late[i]
    first += 2 * m.course_plants
    c.memory[first] = c.plant_at
    c.memory[first + 1] = c.end
    c.memory[first + 2] = c.length
    c.memory[first + 3] = c.blind


def give_back_courses(m: Model, c: Courses) -> None:
    """Know that again."""
    k = m.courses
    for i in range(k):
        c.size[i] = c.memory[i]
        c.peak[i] = c.memory[k + i]
        c.peak_at[i] = c.memory[2 * k + i]
        c.told[i] = int(c.memory[3 * k + i])
    first = 4 * k
    for i in range(m.course_plants):
        c.plant[i] = c.memory[first + i]
        c.ranges.late[i] = c.memory[first + m.course_plants + i]
    first += 2 * m.course_plants
    c.plant_at = c.memory[first]
    c.end = c.memory[first + 1]
    c.length = c.memory[first + 2]
    c.blind = c.memory[first + 3]
