"""The common tasks: ``nox -l`` lists them, ``nox -s tests`` runs one."""

import nox

nox.needs_version = ">=2025.2"
nox.options.sessions = ["lint", "typecheck", "tests"]
nox.options.default_venv_backend = "venv"


def install(session: nox.Session, extra: str, *packages: str) -> None:
    """Install the package with an extra of pyproject.toml, and other packages."""
    session.install("-e", f".[{extra}]", *packages)


@nox.session
def tests(session: nox.Session) -> None:
    """Run the tests; arguments are pytest's, such as ``-- -m 'not slow'``."""
    install(session, "test")
    session.run("pytest", *session.posargs)


@nox.session(venv_backend="none")
@nox.parametrize("resolution", ["lowest", "newest"])
def versions(session: nox.Session, resolution: str) -> None:
    """Run the fast tests on the lowest versions that pyproject.toml names, and on the newest."""
    session.run(".ci/versions", resolution, *session.posargs, external=True)


@nox.session
def lint(session: nox.Session) -> None:
    """Run every pre-commit hook on every file, and check the layers and circles of imports."""
    install(session, "check", "pre-commit")
    session.run("pre-commit", "run", "--all-files", *session.posargs)
    session.run("lint-imports")
    session.run("python", ".ci/circles")


@nox.session
def typecheck(session: nox.Session) -> None:
    """Check the types."""
    install(session, "check,test")
    session.run("pyright", *session.posargs)


@nox.session
def docs(session: nox.Session) -> None:
    """Write the generated reference pages and build the documentation."""
    install(session, "docs")
    session.run("python", "docs/generate.py")
    session.run("mkdocs", *(session.posargs or ["build"]))


@nox.session
def benchmarks(session: nox.Session) -> None:
    """Run one benchmark, such as ``-- model_speed``."""
    install(session, "test")
    for name in session.posargs or ["model_speed", "trajectory_speed", "balancing_speed"]:
        session.run("python", "-m", f"benchmarks.{name}")


@nox.session
def usd_readers(session: nox.Session) -> None:
    """Read the exported USD with OpenUSD's validators and Newton, which take much disk space."""
    readers = ("newton", "newton-usd-schemas", "usd-core")
    session.install("-e", ".", *readers, "pytest", "pytest-xdist", "hypothesis")
    session.run("pytest", "tests/engines/usd_readers.py", *session.posargs)


@nox.session
def monkey(session: nox.Session) -> None:
    """Use the explorer at random and say what fails: ``-- --seed 3 --minutes 60``."""
    install(session, "test")
    session.run("python", "-m", "tests.support.monkey", *session.posargs)


@nox.session
def mutants(session: nox.Session) -> None:
    """Say which changes of a subpackage its tests notice: ``-- identification --seed 3``."""
    install(session, "test")
    session.run("python", "-m", "mutants.run", *session.posargs)


@nox.session
def package(session: nox.Session) -> None:
    """Build sdist and wheel and try both outside the checkout."""
    session.install("build")
    session.run(".ci/packages", "python", external=True)


@nox.session
def review(session: nox.Session) -> None:
    """Check the repository against the rules of scientific-python."""
    session.install("sp-repo-review[cli]", "validate-pyproject")
    session.run("repo-review", ".", *session.posargs)
