"""`Part`: what was collected of members that follow each other, and as bytes."""

from __future__ import annotations

import io
import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.records import dataclass

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Part:
    """Members from `first` on, and what was collected of them.

    Parameters
    ----------
    first : int
    status : list of str
        How each ended: ``ok``, ``accumulation``, ``unsound`` or ``error``.
    t_end : array, shape (members,)
        s.
    said : dict of int to tuple
        Code, place and message of what failed, and warnings, by the number within the part.
    columns : dict of str to array or list of str
        By the text of the collector: shape (members,), of a curve (members, points).
    """

    first: int
    status: list[str]
    t_end: Vector
    said: dict[int, tuple[str, str, str, str]]
    columns: dict[str, Any]

    def __len__(self) -> int:
        return len(self.status)

    @property
    def last(self) -> int:
        """The number after that of the last member."""
        return self.first + len(self)

    def to_bytes(self, key: str) -> bytes:
        """Return it as the bytes of a file of NumPy arrays, with the key of the sweep."""
        texts = {"status": self.status}
        arrays: dict[str, NDArray[Any]] = {"t_end": self.t_end}
        names: list[list[str]] = []
        for k, (name, column) in enumerate(self.columns.items()):
            if isinstance(column, list):
                texts[name] = column
                names.append([name, ""])
            else:
                names.append([name, f"c{k}"])
                arrays[f"c{k}"] = column
        about: dict[str, Any] = {"key": key, "first": self.first, "columns": names, "texts": {}}
        for k, (name, column) in enumerate(texts.items()):
            known: dict[str, int] = {}
            arrays[f"t{k}"] = np.array(
                [known.setdefault(word, len(known)) for word in column], dtype=np.int32
            )
            about["texts"][name] = [f"t{k}", list(known)]
        about["said"] = [[k, *words] for k, words in sorted(self.said.items())]
        text = json.dumps(about, ensure_ascii=False).encode()
        file = io.BytesIO()
        np.savez(file, allow_pickle=False, about=np.frombuffer(text, dtype=np.uint8), **arrays)
        return file.getvalue()

    @staticmethod
    def from_bytes(data: bytes, key: str) -> Part:
        """Return the part that bytes hold.

        Raises
        ------
        ValueError
            If they are damaged, or of another sweep.

        Examples
        --------
        >>> part = Part(4, ["ok"], np.array([1.0]), {}, {"ended": ["ok"], "final(x)": np.ones(1)})
        >>> again = Part.from_bytes(part.to_bytes("k"), "k")
        >>> again.first, again.columns
        (4, {'ended': ['ok'], 'final(x)': array([1.])})
        """
        try:
            with np.load(io.BytesIO(data), allow_pickle=False) as file:
                arrays = {name: file[name] for name in file.files}
            if not all(isinstance(array, np.ndarray) for array in arrays.values()):
                raise ValueError("bytes in place of an array")
            about = json.loads(arrays["about"].tobytes().decode())
            if about["key"] != key:
                raise ValueError(f"a part of another sweep, {about['key']}")
            texts = {
                name: [known[j] for j in arrays[at].tolist()]
                for name, (at, known) in about["texts"].items()
            }
            columns = {name: arrays[at] if at else texts[name] for name, at in about["columns"]}
            said = {
                int(k): (code, place, why, warned) for k, code, place, why, warned in about["said"]
            }
            part = Part(about["first"], texts["status"], arrays["t_end"], said, columns)
            many = len(part)
            if not all(len(column) == many for column in (part.t_end, *columns.values())):
                raise ValueError("columns of different lengths")
            return part
        except MemoryError:
            raise
        except Exception as error:  # ways of packing, headers of arrays have errors of their own
            raise ValueError(f"damaged: {error}") from error
