"""Files made to harm: they are refused, soon, by a FileError and nothing else."""

import time
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hybond.errors import FileError
from hybond.files import limits, load, loads

H = "hybond = 1\n"

DEEP = 100_000
TEXTS: dict[str, tuple[str, str]] = {
    "lists": ("toml", H + "title = " + "[" * DEEP),
    "closed lists": ("toml", H + "title = " + "[" * DEEP + "]" * DEEP),
    "tables": ("toml", H + "title = " + "{a=" * DEEP),
    "long key": ("toml", H + ".".join(["a"] * DEEP) + " = 1"),
    "long spaced key": ("toml", H + " . ".join(["a"] * DEEP) + " = 1"),
    "long quoted key": ("toml", H + ".".join(['"="'] * DEEP) + " = 1"),
    "long literal key": ("toml", H + ".".join(["'{'"] * DEEP) + " = 1"),
    "long inline key": ("toml", H + "x = {" + ".".join(["a"] * DEEP) + " = 1}"),
    "long header": ("toml", H + "[" + ".".join(["a"] * DEEP) + "]"),
    "many long keys": ("toml", H + "".join(f"a{k}{'.b' * 30} = 1\n" for k in range(2000))),
    "deep models": ("toml", H + "[" + ".".join(["models.m"] * 66) + "]"),
    "deep data": ("toml", H + "x = " + "[" * 300 + "]" * 300),
    "digits": ("toml", H + "[parameters]\nm = " + "9" * 10_000),
    "float digits": ("toml", H + "[parameters]\nm = " + "9" * 10_000 + ".0"),
    "quotes": ("toml", H + '"' * 200_001),
    "triple quotes": ("toml", H + 'title = """' + "\\" * 100_001),
    "json lists": ("json", "[" * DEEP),
    "json tables": ("json", '{"a":' * DEEP),
    "json deep data": ("json", '{"hybond": 1, "x":' + "[" * 300 + "]" * 300 + "}"),
    "json digits": ("json", '{"hybond": 1, "parameters": {"m": ' + "9" * 10_000 + "}}"),
    "json exponent": ("json", '{"hybond": 1, "parameters": {"m": 1e999999999}}'),
    "json surrogates": ("json", '{"hybond": 1, "\\udc00": 1}'),
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", TEXTS)
def test_refused_soon(name: str) -> None:
    format, text = TEXTS[name]
    start = time.perf_counter()
    with pytest.raises(FileError) as caught:
        loads(text, format=format)  # type: ignore[arg-type]
    assert time.perf_counter() - start < 5
    assert caught.value.code in ("HB-F103", "HB-F105", "HB-F108")
    assert len(str(caught.value)) < 1000


def test_many_dots_in_text_and_comments_are_fine() -> None:
    dots = "a." * 500
    assert loads(f'hybond = 1 # {dots} "\ntitle = "{dots}"\n').title == dots


def test_a_large_file_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "large.toml"
    with path.open("wb") as file:
        file.write(b"hybond = 1\n")
        file.truncate(limits.FILE_BYTES + 1)
    with pytest.raises(FileError, match="larger than 16 MiB") as caught:
        load(path)
    assert caught.value.code == "HB-F103"
    with pytest.raises(FileError, match="larger than 16 MiB"):
        loads(H + "#" * limits.FILE_BYTES)


def test_too_many_elements(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "ELEMENTS", 3)
    inner = "[models.d.elements]\na.C = 1\nb.C = 1\n"
    assert loads(H + "[elements]\na.C = 1\n" + inner)
    with pytest.raises(FileError, match="more than 3 elements") as caught:
        loads(H + "[elements]\na.C = 1\nb.C = 1\n" + inner)
    assert caught.value.code == "HB-F103"


def test_a_large_model_loads() -> None:
    lines = "".join(f'e{k} = {{ C = "1 F" }}\n' for k in range(10_000))
    assert len(loads(H + "[elements]\n" + lines).elements) == 10_000


@pytest.fixture
def tree(tmp_path: Path) -> Callable[..., Path]:
    def make(**files: str) -> Path:
        for name, reference in files.items():
            body = f'[elements]\nx = {{ submodel = "{reference}" }}\n' if reference else ""
            path = tmp_path / "top" / (name.replace("__", "/") + ".toml")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(H + body)
        return tmp_path / "top"

    return make


@pytest.mark.parametrize(
    ("reference", "why"),
    [
        ("/etc/passwd", "absolute"),
        ("/etc/x.toml", "absolute"),
        ("C:/x.toml", "absolute"),
        ("//host/x.toml", "absolute"),
        ("../secret.toml", "upwards"),
        ("sub/../../secret.toml", "upwards"),
        ("sub/../b.toml", "upwards"),
        ("sub\\\\b.toml", "portable"),
        ("sub/part", "not a model file"),
        ("a\\u0000.toml", "portable"),
        ("link.toml", "leads out"),
        ("dir/secret.toml", "leads out"),
    ],
)
def test_submodels_stay_inside(tree: Callable[..., Path], reference: str, why: str) -> None:
    top = tree(a=reference)
    (top.parent / "secret.toml").write_text(H)
    (top / "link.toml").symlink_to(top.parent / "secret.toml")
    (top / "dir").symlink_to(top.parent)
    with pytest.raises(FileError, match=why) as caught:
        load(top / "a.toml")
    assert caught.value.code == "HB-F115"
    assert caught.value.where == f"{top / 'a.toml'}:3: elements.x.submodel"


def test_cycles_name_their_files(tree: Callable[..., Path]) -> None:
    top = tree(a="b.toml", b="c.toml", c="b.toml", me="me.toml")
    with pytest.raises(FileError, match=r"b\.toml -> c\.toml -> b\.toml") as caught:
        load(top / "a.toml")
    assert caught.value.code == "HB-F116"
    assert caught.value.where == f"{top / 'c.toml'}:3: elements.x.submodel"
    with pytest.raises(FileError, match=r"me\.toml -> me\.toml"):
        load(top / "me.toml")
    (top / "alias.toml").symlink_to(top / "a.toml")
    (top / "c.toml").write_text((top / "c.toml").read_text().replace("b.toml", "alias.toml"))
    with pytest.raises(FileError, match="contains itself"):
        load(top / "a.toml")


def test_a_long_chain_of_files(tree: Callable[..., Path]) -> None:
    top = tree(**{f"m{k}": f"m{k + 1}.toml" for k in range(80)}, m80="")
    assert load(top / "m20.toml")
    with pytest.raises(FileError, match="64 models inside one another"):
        load(top / "m0.toml")


def test_many_files(tree: Callable[..., Path]) -> None:
    top = tree(**{f"m{k}": "" for k in range(101)})
    for count, fine in ((99, True), (100, False)):
        lines = "".join(f'x{k} = {{ submodel = "m{k}.toml" }}\n' for k in range(count))
        (top / "top.toml").write_text(H + "[elements]\n" + lines)
        if fine:
            assert len(load(top / "top.toml").models) == 99
        else:
            with pytest.raises(FileError, match="more than 100 files"):
                load(top / "top.toml")


def test_a_diamond_is_read_once(tree: Callable[..., Path]) -> None:
    # Each file refers twice to the next: 2^40 paths, 41 files.
    top = tree(**{f"m{k}": "" for k in range(41)})
    for k in range(40):
        two = "".join(f'{x} = {{ submodel = "m{k + 1}.toml" }}\n' for x in "xy")
        (top / f"m{k}.toml").write_text(H + "[elements]\n" + two)
    model = load(top / "m0.toml")
    assert model.models["m1.toml"].models["m2.toml"].name == "m2"


@settings(max_examples=300, deadline=None)
@given(st.text(max_size=60) | st.text("[]{}=\"'.,#\n ab1", max_size=60))
def test_noise_is_refused_by_a_file_error_only(text: str) -> None:
    for format in ("toml", "json"):
        for body in (text, H + text, H + "[elements]\n" + text):
            try:
                loads(body, format=format)  # type: ignore[arg-type]
            except FileError as error:
                assert error.code.startswith(("HB-F1", "HB-M10"))
