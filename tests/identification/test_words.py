"""Numbers of causes against least squares with each of them, and the words of results."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import t as student

from paminsa_viz.errors import InvalidInput
from paminsa_viz.identification import (
    ExcitationLimits,
    ExcitationSettings,
    IdentificationSettings,
)
from paminsa_viz.identification.causes import (
    MOST_NAMED,
    NEARLY,
    SIGNIFICANCE,
    Cause,
    PossibleCause,
    _size,
    _tried,
)
from paminsa_viz.identification.columns import (
    BLOCK_PERIODS,
    LARGE_DELAY,
    LARGE_SHARE,
    LARGE_TORQUE,
    FitParameter,
)
from paminsa_viz.identification.estimate import CONFIDENCE, ITERATIONS, normal_blocks, solve
from paminsa_viz.identification.excitation import FINE, NOISE_SHARE
from paminsa_viz.identification.excitation_search import (
    GROUP,
    HOP,
    HOP_SIZE,
    HOPS,
    LEAST_GAIN,
    LEAST_REACH,
    MOST_OUTSIDE,
    RANDOM_SHARE,
    REACH,
    STAGES,
    TOLERANCE,
)
from paminsa_viz.identification.filtering import (
    ANTI_ALIAS,
    LOWEST_RATE,
    ORDER,
    OVERSAMPLING,
    POSITION_CUT_OFF,
    SETTLING,
)
from paminsa_viz.identification.identify import (
    DELAY_STEPS,
    FEW_SECONDS,
    LEAST_MOVE,
    MOST_MOVE,
    OTHER_CUT_OFFS,
)
from paminsa_viz.identification.information import COULOMB_SHARE
from paminsa_viz.identification.log import EVEN, FASTEST, LONGEST_STEP, SLOWEST
from paminsa_viz.identification.log_poses import MOST_CONDITION, SHORTEST_SEGMENT
from paminsa_viz.identification.nearest import SMALL, SPREAD, UNTOLD
from paminsa_viz.identification.results import IDENTITY_Z, Estimate, Identification, Identity
from paminsa_viz.identification.validation import EXACT, MOST_RATIO
from tests.identification.test_estimate import random_columns
from tests.support.documentation import missing

CAUSE = Cause("gain of M1", "", 0, 0.1, 0.05, 0.5, 0.2, 0.3, 0.3)


@pytest.mark.parametrize("seed", range(3))
def test_a_cause_has_the_size_and_share_of_a_fit_with_its_column(seed: int) -> None:
    """With intervals of a jackknife, whose p values count how many causes were tried."""
    base, x, numbers = random_columns(seed)
    rng = np.random.default_rng(seed + 50)
    extra = rng.standard_normal((240, 4, 4))
    extra[..., 2] = base[..., 0] + 0.5 * base[..., 3]  # what the model has already
    extra[..., 3] = 0.0  # what does not move
    torque = base @ x + 0.5 * extra[..., 0] + rng.standard_normal((240, 4))
    solution = solve(normal_blocks(base, torque, numbers))
    candidates = [PossibleCause(f"c{i}", "", i, 1.0, extra[..., i]) for i in range(4)]
    found = _tried(
        SimpleNamespace(solution=solution, settings=IdentificationSettings()),  # type: ignore[arg-type]
        normal_blocks(np.concatenate([base, extra], axis=-1), torque, numbers),
        list(range(5)), {f"c{i}": 5 + i for i in range(4)}, candidates,
    )  # fmt: skip
    rows = np.concatenate([base, extra], axis=-1) / solution.noise[:, None]
    right = torque / solution.noise

    def fit(columns: list[int], part: np.ndarray) -> tuple[np.ndarray, float]:
        matrix, y = rows[part][..., columns].reshape(-1, len(columns)), right[part].ravel()
        numbers = np.linalg.lstsq(matrix, y)[0]
        return numbers, float(((y - matrix @ numbers) ** 2).sum())

    every = np.arange(240)
    own = [0, 1, 2, 3, 4]
    _, residual = fit(own, every)
    blocks = numbers.max() + 1
    critical = student.isf(0.5 * SIGNIFICANCE / 4, blocks - 1)
    for place, cause in enumerate(found[:2]):
        values, left = fit([*own, 5 + place], every)
        kept = [np.flatnonzero(numbers != number) for number in range(blocks)]
        without = [fit([*own, 5 + place], part)[0][-1] for part in kept]
        error = np.sqrt((blocks - 1) / blocks * ((without - np.mean(without)) ** 2).sum())
        assert cause.value == pytest.approx(values[-1], rel=1e-6)
        assert cause.explains == pytest.approx((residual - left) / residual, rel=1e-6)
        assert cause.half_width == pytest.approx(solution.quantile * error, rel=1e-6)
        assert cause.detectable == pytest.approx(critical * error, rel=1e-6)
        chance = 4 * 2 * student.sf(abs(values[-1]) / error, blocks - 1)
        assert cause.p_value == pytest.approx(min(1.0, chance), rel=1e-6)
        assert (cause.leg, cause.significant) == (place, chance < SIGNIFICANCE)
    assert found[0].significant
    for unseen in found[2:]:
        assert (unseen.value, unseen.explains, unseen.p_value) == (0.0, 0.0, 1.0)
        assert (unseen.half_width, unseen.detectable) == (np.inf, np.inf)


@pytest.mark.parametrize(("share", "seen"), [(1.05e-8, True), (0.95e-8, False)])
def test_a_cause_is_seen_of_which_a_hundred_millionth_is_left_without_the_model(
    share: float, seen: bool
) -> None:
    """Of its square: the rest is a column of the model, what is left is at right angles to it."""
    base, x, numbers = random_columns(6)
    noise = np.random.default_rng(7).standard_normal((240, 4))
    extra = np.random.default_rng(8).standard_normal((240, 4))
    torque = base @ x + noise
    solution = solve(normal_blocks(base, torque, numbers))
    rows = (base / solution.noise[:, None]).reshape(-1, 5)
    away = (extra / solution.noise).ravel()
    away -= rows @ np.linalg.lstsq(rows, away)[0]
    whole = rows[:, 0] / np.linalg.norm(rows[:, 0])
    whole = np.sqrt(1 - share) * whole + np.sqrt(share) * away / np.linalg.norm(away)
    column = whole.reshape(240, 4) * solution.noise
    (found,) = _tried(
        SimpleNamespace(solution=solution, settings=IdentificationSettings()),  # type: ignore[arg-type]
        normal_blocks(np.concatenate([base, column[..., None]], axis=-1), torque, numbers),
        list(range(5)), {"c": 5}, [PossibleCause("c", "", 0, 1.0, column)],
    )  # fmt: skip
    assert np.isfinite(found.detectable) == seen
    assert seen or found.p_value == 1.0


def test_blocks_that_say_the_same_give_no_interval_and_a_log_without_noise_a_share() -> None:
    """Of two blocks alike each is all of the other; what is left is a 1e-12th of all at least."""
    base, x, _ = random_columns(6)
    extra = np.random.default_rng(8).standard_normal((240, 4))
    extra[120:], base[120:] = extra[:120], base[:120]
    numbers = np.arange(240) // 120
    solution = SimpleNamespace(noise=np.ones(4), quantile=2.0)
    square = ((base @ x) ** 2).sum()
    away = extra.ravel()
    away = away - base.reshape(-1, 5) @ np.linalg.lstsq(base.reshape(-1, 5), away)[0]
    torque = base @ x + extra * np.sqrt(1e-14 * square / (away**2).sum())
    (found,) = _tried(
        SimpleNamespace(solution=solution, settings=IdentificationSettings()),  # type: ignore[arg-type]
        normal_blocks(np.concatenate([base, extra[..., None]], axis=-1), torque, numbers),
        list(range(5)), {"c": 5}, [PossibleCause("c", "", 0, 1.0, extra)],
    )  # fmt: skip
    assert (found.half_width, found.p_value, found.detectable) == (np.inf, 1.0, np.inf)
    assert found.explains == pytest.approx(1e-14 / 1e-12, rel=1e-3)


def test_a_cause_says_what_it_may_as_well_be() -> None:
    assert CAUSE.text == "gain of M1"
    for alike, words in (
        (("delay",), "delay explains nearly as much"),
        (("delay", "spring"), "delay and spring explain nearly as much"),
        (("delay", "spring", "zero"), "delay, spring and zero explain nearly as much"),
    ):
        assert replace(CAUSE, alike=alike).text == f"most like gain of M1 ({words})"
    bar = replace(CAUSE, label="leg 2: B4 heavier", leg=2, alike=("leg 2: B8 heavier",))
    assert bar.text == "leg 2; most like B4 heavier (B8 heavier explains nearly as much)"
    assert replace(CAUSE, p_value=0.999 * SIGNIFICANCE).significant
    assert not replace(CAUSE, p_value=SIGNIFICANCE).significant
    assert CAUSE.visible  # a plausible size would just be named
    assert not replace(CAUSE, detectable=0.301).visible
    assert _size(replace(CAUSE, detectable=0.0123)) == "1.2 %"
    assert _size(replace(CAUSE, detectable=1.3)) == "130 %"
    assert _size(replace(CAUSE, detectable=np.radians(0.123), unit="rad")) == "0.12°"
    assert _size(replace(CAUSE, detectable=0.0055, unit="m")) == "5.5 mm"
    assert _size(replace(CAUSE, detectable=np.inf)) == "any size"


def test_an_estimate_says_why_it_is_unknown_and_the_identity_whether_it_holds() -> None:
    parameter = FitParameter("b_1", "N", "weight", "base", 25.0, 2.5, "any motion")
    item = Estimate(parameter, 24.0, 1.0, True)
    assert (item.symbol, item.low, item.high, item.reason()) == ("b_1", 23.0, 25.0, "")
    wide = replace(item, half_width=3.0, known=False)
    assert wide.reason() == "the interval is wider than ± 2.5; any motion would tell it"
    lost = replace(item, half_width=np.inf, known=False)
    assert lost.reason() == "the motion does not excite it; any motion would tell it"
    found = SimpleNamespace(estimates=(item, wide))
    found.unknown = Identification.unknown.fget(found)  # type: ignore[attr-defined]
    assert found.unknown == (wide,)
    assert Identification.advice.fget(found) == (  # type: ignore[attr-defined]
        "unknown, with what would tell it: b_1 (any motion)"
    )
    found.unknown = ()
    assert Identification.advice.fget(found) == ""  # type: ignore[attr-defined]
    assert Identification.estimate(found, "b_1") is item  # type: ignore[arg-type]
    with pytest.raises(InvalidInput, match="symbol: there is no 'b_2'; there are b_1, b_1"):
        Identification.estimate(found, "b_2")  # type: ignore[arg-type]
    for z, holds in ((0.999, True), (-0.999, True), (1.0, False), (-1.0, False)):
        assert Identity(0.1, 0.2, z * IDENTITY_Z).holds is holds
    assert Identity(np.nan, np.inf, np.nan).holds is None


def test_numbers_of_the_documentation_are_those_of_the_program() -> None:
    settings, search = IdentificationSettings(), ExcitationSettings()
    limits = ExcitationLimits(np.ones(4), np.ones(4))
    low, high = OTHER_CUT_OFFS
    (first, iterations, kept), (second, same, left), (third, again, _) = STAGES
    assert iterations == same == again
    sentences = [
        f"{FEW_SECONDS:g} s or more are advised",
        f"Rows more than {LONGEST_STEP:g} sample times apart are a gap",
        f"each piece of {SHORTEST_SEGMENT:g} s or more is filtered by itself",
        f"Fewer than {SLOWEST:g} rows a second are refused",
        f"uneven by more than {EVEN:g} of a sample time",
        f"and by more than {LEAST_MOVE:g} of what would make them unknown",
        f"over that of its own fit, is at most {MOST_RATIO:g}, or it is at most {100 * EXACT:g} %",
        f"a step as soft as {COULOMB_SHARE:g} of the largest speed, offsets; noise is "
        f"{NOISE_SHARE:g} of the torques",
        "at more than {:g} rad/s or {:g} m/s".format(*FASTEST),
        f"Butterworth of order {ORDER}, forward and backward",
        f"at least {LOWEST_RATE:g} rows in a period of it, and then {OVERSAMPLING:g} samples in "
        "one of the cut-off of the positions",
        f"Each pass settles within {SETTLING:g} periods",
        "halves at {:g} times the cut-off, and at most at {:g} of the rate that is left".format(
            *ANTI_ALIAS
        ),
        f"(`--delay`; they are shifted by it and fitted again {DELAY_STEPS} times)",
        f"the noise of each actuator that of its residuals, in {ITERATIONS} rounds",
        f"taken to be off by {100 * SPREAD:g} %, and a mass that it has none of by as much of "
        f"{SMALL:g} of those like it",
        f"at most {MOST_NAMED} one after the other",
        f"condition number κ is above {MOST_CONDITION:g} is refused with its row",
        f"half at {settings.cut_off:g} Hz (`--cut-off`)",
        f"a jackknife over blocks of {settings.block:g} s, and of {BLOCK_PERIODS:g} periods of the "
        f"cut-off below {BLOCK_PERIODS / settings.block:g} Hz, with Student's t",
        f"The cut-off is below {POSITION_CUT_OFF:g} Hz for torques and columns only: positions are "
        f"filtered at {POSITION_CUT_OFF:g} Hz then, or at a quarter of the rate of a log of fewer "
        f"than {POSITION_CUT_OFF * LOWEST_RATE:g} rows a second",
        f"it checks the model (|z| < {IDENTITY_Z:g})",
        f"a delay known worse than {1e3 * LARGE_DELAY:g} ms",
        f"posterior over prior above {UNTOLD:g}",
        f"times the number of tries is below {100 * SIGNIFICANCE:g} %",
        f"Where others explain at least {100 * NEARLY:g} % as much",
        f"{search.harmonics} harmonics of {search.period:g} s by default",
        f"* κ ≤ {limits.condition:g}:",
        f"* {1e3 * limits.clearance:g} mm from the limits of reach",
        f"{search.random} random motions, or what a quarter of `--seconds` allows, each as large "
        "as its limits, are improved",
        f"the best {GROUP} first, at most {iterations} iterations in each of three stages",
        f"softened by 1/{first:g}, 1/{second:g} and 1/{third:g}, and {kept} and then {left} of",
        f"Later groups are {HOPS} motions near the best one, its {HOP_SIZE:g}-fold with "
        f"coefficients moved by {HOP:g} at random, and one more of the {search.random}.",
        f"A stage changes each by at most {REACH:g}, and by a quarter of that where {MOST_OUTSIDE} "
        f"steps in a row leave the workspace, down to {LEAST_REACH:g}; on the way a limit may be "
        f"exceeded by {TOLERANCE:g} of it",
        f"ends where log det changes by {LEAST_GAIN:g} only",
        f"{search.samples} times a period in the search and {FINE * search.samples} times at the",
    ]
    assert missing("identification", sentences) == []
    # "above a tenth of", "more than two standard errors", "two thirds and one and a half"
    assert (LARGE_SHARE, LARGE_TORQUE, MOST_MOVE, RANDOM_SHARE) == (0.1, 0.1, 2.0, 0.25)
    assert (low, high) == pytest.approx((2 / 3, 3 / 2))
    # "Intervals are of 95 %", in the docstrings of `Estimate` and `Cause`
    assert pytest.approx(95.0) == 100 * CONFIDENCE
    # as `IdentificationSettings` and `ExcitationSettings` say of themselves
    on = {name for name, value in vars(settings).items() if value is True}
    assert on == {"viscous", "coulomb", "offsets", "robustness"}
    assert (search.periods, search.evaluations, search.seconds, search.seed) == (2, 3000, 60.0, 0)
