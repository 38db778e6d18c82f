"""How results say where they have no value, and why: ``status``, ``leg``, ``ok``, ``reason``."""

from __future__ import annotations

from enum import IntEnum
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray


class Status(IntEnum):
    """Whether there is a value, or why not; 0 is that there is one."""

    _reason: str

    def __new__(cls, code: int, reason: str) -> Status:
        found = int.__new__(cls, code)
        found._value_ = code
        found._reason = reason
        return found

    @property
    def word(self) -> str:
        """The name used in tables and files."""
        return self.name.lower().replace("_", "-")

    def reason(self, leg: int = -1) -> str:
        """Return why there is no value; ``leg`` is the index of the leg, -1 for none."""
        return self._reason.format(leg=f"leg {leg + 1}" if leg >= 0 else "a leg")


class WithStatus:
    """A result of batch shape (...) that has no value in some places.

    It has ``status`` (...), codes of `KINDS`, and where a leg can be the reason ``leg`` (...), the
    index of that leg, -1 for none.
    """

    KINDS: ClassVar[type[Status]]
    status: NDArray[np.uint8]

    @property
    def ok(self) -> NDArray[np.bool_]:
        """Where there is a value, (...)."""
        return self.status == 0

    def reason(self, index: int | tuple[int, ...] = ()) -> str:
        """Return why there is no value at a place of the batch, "" where there is one."""
        status = self.KINDS(int(np.asarray(self.status)[index]))
        leg = getattr(self, "leg", None)
        return status.reason(-1 if leg is None else int(np.asarray(leg)[index])) if status else ""
