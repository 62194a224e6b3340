"""The API against its own description: schemathesis makes requests, right and wrong ones, and looks at every answer.

`make requests` is the long run; AXISCAL_REQUESTS says how many of each kind.
"""

import os
import sys
from collections import Counter
from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from tests.web.served import Served, served, started

REQUESTS = int(os.environ.get("AXISCAL_REQUESTS", "12"))
CHECKS = (
    "status_code_conformance",
    "content_type_conformance",
    "response_schema_conformance",
    "negative_data_rejection",
)
MADE: Counter[tuple[str, str, str]] = Counter()
"""Requests so far: of a kind with few forms hypothesis makes fewer than it may."""
QUESTIONS = "start stage rows curve plan state typed cost check"
STEPS = "draft open readings jogs skips notes accepts undo next finish leave"
METHODS = {"get": QUESTIONS, "post": STEPS}
OPERATIONS = [(f"/api/1/{name}", method) for method, names in METHODS.items() for name in names.split()]


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A campaign that is served."""
    with served(started(tmp_path_factory.mktemp("conformance"))) as running:
        yield running
    sys.stdout.write(
        f"\n{MADE.total():,} requests of {len(MADE)} kinds, the fewest {min(MADE.values(), default=0):,}\n"
    )


@pytest.fixture(scope="module")
def described(page: Served) -> Any:
    """Its description as schemathesis reads it."""
    import schemathesis  # a second of every worker that only looks for its tests

    schema = schemathesis.openapi.from_dict(page.call("openapi.json").document)
    schema.config.update(base_url=f"http://127.0.0.1:{page.port}")
    rejection = schema.config.checks.negative_data_rejection
    rejection.expected_statuses = [*rejection.expected_statuses, "413"]  # a file's text may be longer than a request
    return schema


@pytest.mark.long
@pytest.mark.parametrize(("path", "method"), OPERATIONS)
@pytest.mark.parametrize("mode", ["positive", "negative"])
def test_every_answer_is_as_described(page: Served, described: Any, path: str, method: str, mode: str) -> None:
    import schemathesis
    from schemathesis.checks import not_a_server_error
    from schemathesis.specs.openapi import checks as of_openapi

    checks = [not_a_server_error, *(getattr(of_openapi, name) for name in CHECKS)]
    operation = described[path][method.upper()]

    @settings(max_examples=REQUESTS, deadline=None, suppress_health_check=list(HealthCheck), phases=[Phase.generate])
    @given(st.data())
    def answered(data: st.DataObject) -> None:
        case = data.draw(operation.as_strategy(generation_mode=schemathesis.GenerationMode(mode)))
        if isinstance(case.query, dict) and isinstance(case.query.get("wait"), int | float):
            case.query["wait"] = min(case.query["wait"], 0)  # nobody waits for news in a test
        MADE[path, method, mode] += 1
        case.call_and_validate(headers={"Authorization": f"Bearer {page.token}"}, checks=checks)

    answered()
