"""The program itself, as its start script and ``python -m paminsa_viz`` run it.

Until Ctrl-C has a handler Python answers it with a traceback, so nothing else is done before: no
import of the package brings another module, and the handler is set by what is part of Python.
"""


def main() -> int:
    """Run the command line, and return its exit code."""
    import _signal  # `signal` itself first makes its enumerations  # pyright: ignore

    _signal.signal(_signal.SIGINT, _stop)
    from paminsa_viz.cli import main as run

    return run()


def _stop(*_: object) -> None:
    # No work has begun that a stop could tear. `interrupts` takes over when the command line runs.
    import os

    os.write(2, b"paminsa-viz: stopped\n")
    os._exit(130)


if __name__ == "__main__":
    raise SystemExit(main())
