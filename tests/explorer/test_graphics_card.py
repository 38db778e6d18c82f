"""Whether a browser draws on a graphics card."""

from __future__ import annotations

import pytest

from paminsa_viz.explorer.page import has_graphics_card


@pytest.mark.parametrize(
    ("renderer", "card"),
    [
        ("ANGLE (NVIDIA, NVIDIA GeForce RTX 3060 Direct3D11 vs_5_0 ps_5_0, D3D11)", True),
        ("Apple M2", True),
        ("ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device (Subzero)), SwiftShader driver)", False),
        ("llvmpipe (LLVM 15.0.7, 256 bits)", False),
        ("", False),
        (None, False),
    ],
)
def test_a_program_is_no_graphics_card(renderer: object, card: bool) -> None:
    assert has_graphics_card(renderer) is card
