"""Design explorer for the PAMINSA, a 4-DoF parallel manipulator with three pantograph legs."""

__version__ = "0.1.0"
