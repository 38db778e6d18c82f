"""Write the mesh files of the fixed parts: ``python -m paminsa_viz.meshes [folder]``."""

from __future__ import annotations

import sys
from pathlib import Path

from paminsa_viz.meshes.library import checkout_folder, write_meshes


def main(arguments: list[str]) -> int:
    """Write the files to the folder given, or to ``assets/meshes``; return the exit status."""
    if len(arguments) > 1 or any(item.startswith("-") for item in arguments):
        print("usage: python -m paminsa_viz.meshes [folder]", file=sys.stderr)
        return 2
    folder = Path(arguments[0]) if arguments else checkout_folder()
    for path in write_meshes(folder):
        print(path)
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
