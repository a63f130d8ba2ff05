"""What a refusal shows of hybond itself: its door, unless somebody looks for a fault in it."""

import traceback

import pytest

import hybond as hb


def refused() -> list[str]:
    m = hb.Model("rc", domain="electrical")
    m.add(c=hb.C("1 mF"), r=hb.R("1 kohm/nowhere"), node=hb.Zero())
    m.bond("node -> c", "node -> r")
    with pytest.raises(hb.HybondError) as caught:
        hb.simulate(m, until="1 s")
    return [frame.name for frame in traceback.extract_tb(caught.value.__traceback__)]


def test_a_refusal_leads_to_the_call_that_was_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("HYBOND_DEBUG", raising=False)
    assert refused() == ["refused", "call"]


def test_all_frames_are_there_for_who_asks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HYBOND_DEBUG", "1")
    found = refused()
    assert found[:3] == ["refused", "call", "simulate"] and len(found) > 5
