"""Nobody but the person at this computer reaches the campaign, whatever is sent to the port."""

import json
import re
import socket
import tomllib
from collections.abc import Iterator
from contextlib import ExitStack
from importlib import resources
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.web.served import Served, served, started

HOSTS = ["evil.example", "127.0.0.1", "127.0.0.1:1", "localhost", "[::1]:{port}", "127.0.0.2:{port}", "0.0.0.0:{port}"]
HOSTS += ["127.0.0.1.evil.example:{port}", "localhost.:{port}", "evil.example:{port}", "127.0.0.1:{port}@evil.example"]
HOSTS += ["", " ", "127.1:{port}", "2130706433:{port}", "127.0.0.1:{port}/", "127.0.0.1:0{port}"]
HOSTS += [f"{n}.rebind.example:{{port}}" for n in range(84)]
STATIC = resources.files("axiscal.web").joinpath("static")
_STEPS = ["..", "%2e%2e", "..%2f", "%2e%2e%2f", "..%5c", "..\\", "%c0%ae%c0%ae", "....//", "%252e%252e%252f", ".%00."]
_GOALS = ["etc/passwd", "mill.axiscal", "page.py", "mill.axiscal%00.css", "\\\\host\\share\\file"]
_ROOTS = ["/", "/report.pdf/", "/page.css/", "/api/1/"]
TRAVERSALS = [f"{root}{step}/{goal}" for root in _ROOTS for step in _STEPS for goal in _GOALS]


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A campaign that is served."""
    with served(started(tmp_path_factory.mktemp("guarded"))) as running:
        yield running


def test_it_listens_on_the_loopback_alone(page: Served) -> None:
    listening = [line.split()[1] for line in Path("/proc/net/tcp").read_text().splitlines()[1:]]
    assert next(each for each in listening if each.endswith(f":{page.port:04X}")).startswith("0100007F")
    sixth = Path("/proc/net/tcp6")
    assert not sixth.is_file() or f":{page.port:04X} " not in sixth.read_text()


def test_a_page_that_renamed_itself_is_refused(page: Served) -> None:
    assert len(HOSTS) >= 100
    for host in HOSTS:
        answer = page.ask("GET", "/", Host=host.format(port=page.port))
        assert answer.status == 400, host


@pytest.mark.parametrize("path", ["/api/1/state", "/api/1/start", "/machine.svg", "/setup.svg", "/report.pdf", "/x"])
@pytest.mark.parametrize("query", ["", "?token=", "?token={token}"])
def test_nothing_of_the_campaign_is_shown_without_the_token(page: Served, path: str, query: str) -> None:
    for cookie in ("", f"axiscal-{page.port}={page.token}"):
        answer = page.ask("GET", path + query.format(token=page.token), Cookie=cookie)
        assert (answer.status, answer.document["problem"]) == (403, "forbidden")


def test_the_token_is_long_and_no_answer_holds_it(page: Served) -> None:
    assert len(page.token) * 6 >= 128
    for path in ("/", "/elements.js", "/api/1/state", "/api/1/openapi.json"):
        answer = page.ask("GET", path, Authorization=f"Bearer {page.token}")
        assert answer.status == 200
        assert page.token not in f"{answer.headers} {answer.body!r}"
        assert "set-cookie" not in answer.headers
    assert page.ask("GET", "/api/1/state", Authorization=f"Bearer {page.token[:-1]}").status == 403


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "https://127.0.0.1:{port}", "http://127.0.0.1", ""])
def test_another_page_cannot_post(page: Served, origin: str) -> None:
    last = page.state()["last"]
    body = json.dumps({"after": last, "text": "1"}).encode()
    headers = {"Authorization": f"Bearer {page.token}", "Origin": origin.format(port=page.port)}
    assert page.ask("POST", "/api/1/readings", body, **headers).status == 403
    assert page.ask("POST", "/api/1/readings", body).status == 403
    assert page.state()["last"] == last


def test_no_path_leads_to_another_file(page: Served) -> None:
    assert len(TRAVERSALS) == 200
    for path in TRAVERSALS:
        assert page.ask("GET", path, Authorization=f"Bearer {page.token}").status == 404, path


def test_every_answer_forbids_scripts_that_are_not_ours(page: Served) -> None:
    for path in ("/", "/page.css", "/api/1/state", "/nothing"):
        policy = page.ask("GET", path).headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert "unsafe" not in policy
    start = STATIC.joinpath("start.html").read_text()
    html = page.ask("GET", "/").body.decode() + start
    assert "<script>" not in html
    assert re.search(r"\son\w+=", html) is None
    assert "style=" not in html


def test_the_script_writes_text_and_nothing_else() -> None:
    sources = [path.read_text() for path in STATIC.iterdir() if path.name.endswith(".js")]
    assert len(sources) == 6
    makes_markup = r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\b|Function\(|DOMParser|srcdoc"
    assert [found for text in sources for found in re.findall(makes_markup, text)] == []


def test_every_file_of_the_page_is_in_the_package() -> None:
    project = tomllib.loads((Path(__file__).resolve().parents[2] / "pyproject.toml").read_text())
    kinds = {pattern.rpartition(".")[2] for pattern in project["tool"]["setuptools"]["package-data"]["axiscal"]}
    assert {path.name.rpartition(".")[2] for path in STATIC.iterdir()} <= kinds


def test_a_large_body_is_refused(page: Served) -> None:
    answer = page.ask("POST", "/api/1/readings", b"x" * 100_000, Authorization=f"Bearer {page.token}")
    assert (answer.status, answer.document["problem"]) == (413, "large")


@pytest.mark.parametrize("kind", ["silent", "of half a head", "of half a body"])
def test_requests_that_never_end_do_not_stop_the_others(page: Served, kind: str) -> None:
    body = (
        f"POST /api/1/notes HTTP/1.1\r\nHost: 127.0.0.1:{page.port}\r\n"
        f"Authorization: Bearer {page.token}\r\nContent-Length: 9\r\n\r\n"
    )
    said = {"silent": "", "of half a head": "GET / HTTP/1.1\r\nHost: 127", "of half a body": body}[kind]
    with ExitStack() as stack:
        for _ in range(120):
            stack.enter_context(socket.create_connection(("127.0.0.1", page.port))).sendall(said.encode())
        assert page.state()["machine"] == "One axis"


def test_a_large_head_is_refused_before_it_ends(page: Served) -> None:
    with socket.create_connection(("127.0.0.1", page.port), timeout=20) as large:
        large.sendall(b"GET / HTTP/1.1\r\nX: " + 20_000 * b"x")
        assert large.recv(12) == b"HTTP/1.1 400"


ODD = st.none() | st.booleans() | st.integers() | st.floats() | st.text() | st.lists(st.integers())
BODIES = st.dictionaries(st.sampled_from(["after", "text", "reason", "keep", "else"]), ODD).map(json.dumps)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.sampled_from(["readings", "skips", "undo", "next", "state", "typed", "", "x"]),
    st.sampled_from(["GET", "POST", "PUT", "DELETE", "HEAD", "OPTIONS"]),
    st.binary(max_size=200) | BODIES.map(str.encode),
)
def test_no_request_is_a_fault_of_the_server(page: Served, path: str, method: str, body: bytes) -> None:
    answer = page.ask(method, f"/api/1/{path}", body, Authorization=f"Bearer {page.token}")
    assert answer.status < 500
    if answer.status >= 400 and method != "HEAD":
        assert answer.document["sentence"]


@pytest.mark.parametrize("query", ["seen=x", "wait=1e9", "wait=nan", "seen=-1", "else=1", "seen=" + "9" * 5000])
def test_a_query_without_sense_is_refused_in_words(page: Served, query: str) -> None:
    answer = page.ask("GET", f"/api/1/state?{query}", Authorization=f"Bearer {page.token}")
    assert (answer.status, answer.document["problem"]) == (422, "malformed")


def test_a_body_that_says_it_is_no_json_is_refused(page: Served) -> None:
    body, bearer = b'{"text": "a note"}', f"Bearer {page.token}"
    answer = page.ask("POST", "/api/1/notes", body, Authorization=bearer, Content_Type="text/plain")
    assert (answer.status, answer.document["problem"]) == (422, "malformed")
    assert page.state()["notes"] == []
