"""Model and design explorer of the PAMINSA, a 4-DoF parallel manipulator with pantograph legs.

The names below are what most scripts need; `paminsa_viz.model`, `trajectory`, `balancing`,
`studies` and `notebook` hold the rest. Functions take the design or its geometry first, then the
pose (..., 4) = (x, y, theta, z) [m, m, rad, m], then its rates; results are (..., n), in SI units.
"""

# Nothing is imported here, as the program starts with this file: see `paminsa_viz.__main__`.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from paminsa_viz.balancing import balance
    from paminsa_viz.files.design_file import load_design, save_design
    from paminsa_viz.model import (
        APPENDIX_4,
        Design,
        KneeBranch,
        check_reach,
        forward_dynamics,
        forward_kinematics,
        inverse_dynamics,
        inverse_kinematics,
        solve_field,
        static_torques,
        xy_grid,
    )
    from paminsa_viz.trajectory import analyze
    from paminsa_viz.version import __version__ as __version__

__all__ = [
    "APPENDIX_4",
    "Design",
    "KneeBranch",
    "analyze",
    "balance",
    "check_reach",
    "forward_dynamics",
    "forward_kinematics",
    "inverse_dynamics",
    "inverse_kinematics",
    "load_design",
    "save_design",
    "solve_field",
    "static_torques",
    "xy_grid",
]


def __getattr__(name: str) -> object:
    # Late (PEP 562): NumPy and SciPy take longer to load than the command line's --help.
    from paminsa_viz.late import late_names

    return late_names(__name__)(name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
