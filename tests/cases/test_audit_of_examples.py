"""What must hold in every run, checked on every example with public names only."""

import dataclasses
import json
import math

import numpy as np
import pytest

from .conftest import EXAMPLES

NAMES = sorted(p.stem for p in EXAMPLES.glob("*.toml"))
RTOL = 1e-11
