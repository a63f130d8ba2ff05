"""The server of the studio answers its own page and nobody else."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("starlette")
pytest.importorskip("httpx")

from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from hybond.errors import UsageError
from hybond.studio.server import application, dumped, listening
from hybond.studio.session import Session

HOST = "127.0.0.1:7777"
RIGHT = {"host": HOST, "origin": f"http://{HOST}"}


@pytest.fixture
def client(tmp_path: Path) -> Iterator[TestClient]:
    session = Session(tmp_path / "m.toml", journal=False)
    with TestClient(application(session, "secret", {HOST}), base_url=f"http://{HOST}") as client:
        yield client


def test_the_page_asks_for_the_token(client: TestClient) -> None:
    assert client.get("/").status_code == 403
    assert client.get("/?token=wrong").status_code == 403
    page = client.get("/?token=secret")
    assert page.status_code == 200
    assert "default-src 'none'" in page.headers["content-security-policy"]


def test_a_page_under_another_name_is_not_answered(client: TestClient) -> None:
    # what a name that a stranger points at this machine would send
    assert client.get("/?token=secret", headers={"host": "evil.example"}).status_code == 421
    assert client.get("/assets/studio.js", headers={"host": "evil.example"}).status_code == 404


@pytest.mark.parametrize("name", ["../server.py", "..%2fserver.py", "nothing.js", "%2e%2e/x"])
def test_only_the_page_is_served(client: TestClient, name: str) -> None:
    assert client.get(f"/assets/{name}").status_code == 404


@pytest.mark.parametrize(
    ("token", "headers"),
    [
        ("wrong", RIGHT),
        ("secret", {**RIGHT, "origin": "http://evil.example"}),
        ("secret", {**RIGHT, "origin": "null"}),
        ("secret", {"host": HOST}),
        ("secret", {**RIGHT, "host": "evil.example"}),
    ],
)
def test_a_stranger_is_not_talked_to(
    client: TestClient, token: str, headers: dict[str, str]
) -> None:
    with (
        pytest.raises(WebSocketDisconnect),
        client.websocket_connect(f"/talk?token={token}", headers=headers) as socket,
    ):
        socket.receive_text()


def test_ten_pages_see_one_model(client: TestClient) -> None:
    sockets = [
        client.websocket_connect("/talk?token=secret", headers=RIGHT).__enter__() for _ in range(10)
    ]
    edit = {"do": "add", "name": "a", "element": {"junction": 1}}
    sockets[3].send_text(json.dumps({"id": 1, "ask": "edit", "edit": edit, "client": "three"}))
    for socket in sockets:
        told = json.loads(socket.receive_text())
        assert told.get("tell") == "changed" or told["id"] == 1
    sockets[7].send_text(json.dumps({"id": 2, "ask": "look"}))
    answer = json.loads(sockets[7].receive_text())
    assert [n["name"] for n in answer["view"]["nodes"]] == ["a"]
    for socket in sockets:
        socket.__exit__(None, None, None)


def test_a_page_is_told_what_another_program_writes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("hybond.studio.server.GLANCE", 0.02)
    file = tmp_path / "m.toml"
    file.write_text('hybond = 1\n[elements]\na = { R = "1 ohm" }\n')
    session = Session(file, journal=False)
    with (
        TestClient(application(session, "secret", {"testserver"})) as client,
        client.websocket_connect(
            "/talk?token=secret", headers={"host": "testserver", "origin": "http://testserver"}
        ) as socket,
    ):
        file.write_text('hybond = 1\n[elements]\na = { R = "20 ohm" }\n')
        told = json.loads(socket.receive_text())
        assert (told["tell"], told["outside"]) == ("changed", True)
        assert "20 ohm" in session.document.text
        socket.send_text(json.dumps({"id": 1, "ask": "edit", "edit": {"do": "undo"}}))
    session.close()


@pytest.mark.parametrize("text", ["", "[", "3", '{"id": 1}', "[" * 100_000, '{"ask": ["edit"]}'])
def test_what_is_no_question_is_answered_by_a_refusal(client: TestClient, text: str) -> None:
    with client.websocket_connect("/talk?token=secret", headers=RIGHT) as socket:
        socket.send_text(text)
        assert json.loads(socket.receive_text())["error"]["code"] == "HB-W101"
        socket.send_text(json.dumps({"id": 2, "ask": "look"}))
        assert json.loads(socket.receive_text())["id"] == 2


@pytest.mark.slow
def test_a_message_of_100_megabytes_is_not_read(tmp_path: Path) -> None:
    """Asked of the server as it runs: it lets that page go, and goes on."""
    connect = pytest.importorskip("websockets.sync.client").connect
    closed = pytest.importorskip("websockets.exceptions").ConnectionClosed
    command = [sys.executable, "-m", "hybond", "studio", "m.toml", "--no-browser"]
    env = {**os.environ, "HYBOND_STATE": str(tmp_path / "state")}
    with subprocess.Popen(
        command, cwd=tmp_path, stdout=subprocess.PIPE, text=True, env=env
    ) as process:
        try:
            assert process.stdout is not None
            found = re.search(r"http://(\S+)/\?(token=\S+)", process.stdout.readline())
            assert found is not None
            address, origin = f"ws://{found[1]}/talk?{found[2]}", f"http://{found[1]}"
            with (
                connect(address, origin=origin, max_size=None, compression=None) as socket,
                pytest.raises(closed),
            ):
                socket.send(json.dumps({"id": 1, "ask": "replace", "text": "x" * 100_000_000}))
                socket.recv(timeout=20)
            with connect(address, origin=origin) as socket:
                socket.send(json.dumps({"id": 2, "ask": "look"}))
                assert json.loads(socket.recv(timeout=20))["id"] == 2
        finally:
            process.kill()


def test_a_port_that_is_taken_is_refused() -> None:
    first = listening(0)
    with pytest.raises(UsageError, match="HB-W107"):
        try:
            listening(first.getsockname()[1])
        except UsageError as error:
            assert error.code == "HB-W107"
            raise UsageError(str(error), code=error.code) from None
        finally:
            first.close()


def test_numbers_that_json_lacks_are_null() -> None:
    assert (
        dumped({"a": [1.0, float("nan"), {"b": float("inf")}]}) == '{"a": [1.0, null, {"b": null}]}'
    )
