"""Bars keep their cross section: masses and inertias follow lengths."""

from __future__ import annotations

import pytest

from paminsa_viz.model import APPENDIX_4, resized


def test_bars_grow_with_their_length() -> None:
    values = {"geometry.crank_length": 0.84, "geometry.magnification": 1.5}
    big = resized(APPENDIX_4, values)
    assert big.links.b8 == pytest.approx(2 * APPENDIX_4.links.b8)
    assert big.inertias.b8_transverse == pytest.approx(8 * APPENDIX_4.inertias.b8_transverse)
    assert big.inertias.b3_axial == pytest.approx(2 * APPENDIX_4.inertias.b3_axial)
    assert big.links.b7 == pytest.approx(2 * APPENDIX_4.links.b7)
    assert big.links.b4 == APPENDIX_4.links.b4
    plain = resized(APPENDIX_4, values, scale_bars=False)
    assert plain == APPENDIX_4.vary(values)


def test_arm_and_guide_grow_with_their_length() -> None:
    values = {"geometry.arm_length": 0.616, "geometry.guide_link_length": 2 * 0.3635}
    big = resized(APPENDIX_4, values)
    assert big.links.b1 == pytest.approx(2 * APPENDIX_4.links.b1)
    assert big.links.b10 == pytest.approx(2 * APPENDIX_4.links.b10)
    assert big.inertias.b10_vertical == pytest.approx(8 * APPENDIX_4.inertias.b10_vertical)
    none = APPENDIX_4.vary({"geometry.arm_length": 0.0})
    assert resized(none, values).links.b1 == APPENDIX_4.links.b1
