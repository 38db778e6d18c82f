"""The script next to the mesh files, as a module."""

from __future__ import annotations

import importlib
import sys
from typing import Any

from paminsa_viz.meshes.part import checkout_folder

ASSETS = checkout_folder().parent
sys.path.insert(0, str(ASSETS))
script: Any = importlib.import_module("make_parts")
sys.path.remove(str(ASSETS))
