"""What long commands say where no terminal shows a bar."""

import pytest

from physgnn.cli import console


def test_a_log_gets_lines_instead_of_a_bar(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(console, "SECONDS_A_LINE", 0.0)
    with console.progress("training") as move:
        move(1, 4, "epoch 0 · loss 1.5")
        move(2, 4, "epoch 1 · loss 1.25")
    out, err = capsys.readouterr()
    assert out == ""
    first, second = err.splitlines()[:2]
    assert first.startswith("training: 25.0 % after 0 s")
    assert first.endswith("epoch 0 · loss 1.5")
    assert second.startswith("training: 50.0 %")


def test_a_further_part_of_the_work_has_a_bar_of_its_own(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(console, "SECONDS_A_LINE", 0.0)
    with console.progress("training") as move:
        move(3, 4, "epoch 2")
        move(1000, 1000, "epoch 3")
        move(1, 10, "calibrating")
        move(9, 10, "calibrating")
    lines = capsys.readouterr().err.splitlines()
    assert [line.split(" %")[0] for line in lines] == [
        "training: 75.0",
        "training: 100.0",
        "training, calibrating: 10.0",
        "training, calibrating: 90.0",
    ]
    assert not any(line.endswith("calibrating") for line in lines)


def test_lines_are_a_minute_apart(capsys: pytest.CaptureFixture[str]) -> None:
    with console.progress("training") as move:
        for done in range(100):
            move(done, 100, "epoch 0")
    assert "training: " not in capsys.readouterr().err
