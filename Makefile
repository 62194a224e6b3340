# Everything is set up in .venv inside the checkout; nothing else on the machine is touched.
PYTHON ?=
BIN := .venv/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet
LOCK := $(BIN)/pip-compile --quiet --generate-hashes --strip-extras --allow-unsafe \
	--no-header --no-emit-index-url --no-emit-trusted-host --no-emit-find-links
PEERS := trieste torch others
# Compiled once, not by every worker and every command that a test gives.
unexport PYTHONDONTWRITEBYTECODE
CONTROLS := $(or $(AXISCAL_CONTROLS),../shared/controls)

.PHONY: help demo demo-linuxcnc howto-linuxcnc test test-long check quick golden bench bench-peers docs docs-site languages trust controls reliability fuzz requests lock clean distclean

help:
	@echo "make demo       set everything up and calibrate a built-in five-axis machine"
	@echo "make demo-linuxcnc  calibrate six machines that a real LinuxCNC moves, load the tables, show the error before, after and expected"
	@echo "make howto-linuxcnc  run every command of docs/linuxcnc.md beside a headless LinuxCNC that stands in for somebody's mill"
	@echo "make test       set everything up, run linters, type checker and the tests that take little time; five minutes once installed (make check is the same)"
	@echo "make test-long  the other tests, which take seconds each; a quarter of an hour"
	@echo "make quick      linters and the tests that take no time, in half a minute; for between two edits"
	@echo "make golden     26 campaigns in two languages give what they gave, numbers to 1e-4, in a minute (ONLY='mill prior'; RENEW=1: keep what comes now)"
	@echo "make bench      measure the figures that the README states"
	@echo "make bench-peers  measure side by side with other libraries, into docs/evidence/peers.md (half an hour; ARGS='--only trieste')"
	@echo "make docs       make the generated pages of docs/ anew"
	@echo "make languages  bring the translations of prompt, page and report up to the messages there are (src/axiscal/language/translations)"
	@echo "make docs-site  the documentation as a site in build/site, tools in .venv-docs"
	@echo "make trust      measure how far the printed bands can be trusted, into docs/evidence/trust.md (PART=iso, PART=zoo, PART=widths: only that section; PART=attacks MACHINES=100 of each, 20 unless said, MINUTES=30 at a time; ONLY='step; bump': shown, not written)"
	@echo "make controls   the exports in real controls: LinuxCNC, Klipper, RepRapFirmware; a row each (ONLY=klipper)"
	@echo "make reliability  faults, kills, lost power, changed bits, bad files: one table of what was tried and lost (LONG=1: hours, MINUTES=20 at a time; ROWS='8 9': only these; DISK=/mnt/stick: on another disk; PYTHONS=...: other interpreters too)"
	@echo "make fuzz       every reader on thousands of files that are changed at random (EXAMPLES=50000: the long run; SECONDS=600 of each kind; KIND=name)"
	@echo "make requests   right and wrong requests to the page's API, each answer held to its description (EXAMPLES=1000 of each of 20 kinds)"
	@echo "make lock       renew the pinned requirements (UPGRADE=1: to the newest releases)"
	@echo "make clean      remove caches and outputs; make distclean removes .venv too"

demo: .venv/run.stamp
	$(BIN)/axiscal demo --out demo-out

demo-linuxcnc: .venv/run.stamp
	$(BIN)/python -m benchmarks.linuxcnc_demo --out demo-linuxcnc-out

howto-linuxcnc: .venv/dev.stamp
	$(BIN)/python -m benchmarks.linuxcnc_howto

test check: .venv/dev.stamp
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy --num-workers 2
	$(BIN)/lint-imports
	$(BIN)/pytest -n 3 --dist loadfile -m "not long"

# The controls that lie beside the checkout are tried as well, in an environment of their own.
test-long: .venv/dev.stamp $(if $(wildcard $(CONTROLS)),.venv-controls/stamp)
	$(BIN)/pytest -n 4 --dist loadfile --no-loadscope-reorder -m long tests

# Whole rooms where their tests take seconds, else the files that do.
QUICK := core/test_docstrings.py description docs/test_constants.py docs/test_house.py docs/test_shapes.py document errors/test_gauge.py \
	estimation/test_alignment.py estimation/test_criterion.py \
	estimation/test_yardstick.py evaluation/test_around_a_turn.py evaluation/test_evaluation.py \
	machine measurement/test_displacement.py \
	measurement/test_instrument_files.py numerics present/test_edges.py present/test_wording.py programs/test_programs.py \
	python/test_surface.py record refusals units
SLOW := description/test_sights.py record/test_store.py

quick: .venv/dev.stamp
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pytest -n 2 -m "not long" $(addprefix --ignore=tests/,$(SLOW)) $(addprefix tests/,$(QUICK))

golden: .venv/dev.stamp
	$(BIN)/python -m tests.golden $(ONLY:%=--only %) $(if $(RENEW),--renew)

bench: .venv/dev.stamp
	@set -e; for file in benchmarks/bench_*.py; do echo "== $$file"; $(BIN)/python "$$file"; done

bench-peers: .venv/dev.stamp $(PEERS:%=.venv-peers/%/stamp)
	$(BIN)/python -m benchmarks.peers $(ARGS)

docs: .venv/dev.stamp
	$(BIN)/python -m tests.docs.equations
	$(BIN)/python -m tests.docs.examples
	$(BIN)/python -m tests.docs.stories
	$(BIN)/python -m tests.docs.api
	$(BIN)/python -m tests.docs.cli
	$(BIN)/python -m tests.docs.result
	$(BIN)/python -m tests.docs.howtos

docs-site: .venv-docs/stamp
	.venv-docs/bin/mkdocs build --quiet
	@echo "axiscal: open build/site/index.html"

languages: .venv/dev.stamp
	$(BIN)/python -m tests.docs.languages

trust: .venv/dev.stamp
	$(BIN)/python -m benchmarks.trust $(if $(PART),--part $(PART)) $(if $(MACHINES),--attacked $(MACHINES)) \
		$(if $(MINUTES),--minutes $(MINUTES)) $(if $(PROCESSES),--processes $(PROCESSES)) $(if $(ONLY),--only "$(ONLY)")

controls: .venv/dev.stamp .venv-controls/stamp
	$(BIN)/python -m tests.controls $(ONLY:%=--only %)

reliability: .venv/dev.stamp
	$(if $(DISK),AXISCAL_DISK=$(DISK)) $(BIN)/python -m benchmarks.reliability $(if $(LONG),--long) $(if $(MINUTES),--minutes $(MINUTES)) $(ROWS:%=--row %) $(PYTHONS:%=--python %)

fuzz: .venv/dev.stamp
	$(BIN)/python -m benchmarks.reliability.fuzz $(if $(EXAMPLES),--examples $(EXAMPLES)) $(if $(SECONDS),--seconds $(SECONDS)) $(if $(KIND),--kind $(KIND))

requests: .venv/dev.stamp
	AXISCAL_REQUESTS=$(or $(EXAMPLES),1000) $(BIN)/pytest -q -s tests/web/test_conformance.py

lock: | .venv/bin/pip-compile
	$(LOCK) $(if $(UPGRADE),--upgrade) --build-deps-for editable --extra app -o requirements/run.txt pyproject.toml
	$(LOCK) $(if $(UPGRADE),--upgrade) --build-deps-for editable --extra app --extra dev --constraint requirements/run.txt -o requirements/dev.txt pyproject.toml
	$(LOCK) $(if $(UPGRADE),--upgrade) -o requirements/controls.txt requirements/controls.in
	$(LOCK) $(if $(UPGRADE),--upgrade) -o requirements/docs.txt requirements/docs.in

clean:
	rm -rf build out demo-out demo-linuxcnc-out .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache .benchmarks
	find . -path ./.venv -prune -o -name __pycache__ -type d -prune -exec rm -rf {} +

distclean: clean
	rm -rf .venv .venv-controls .venv-docs .venv-peers src/*.egg-info

.venv/run.stamp: requirements/run.txt pyproject.toml | .venv/bin/pip
	@echo "axiscal: installing the locked packages into .venv (a minute or two the first time)"
	@$(PIP) install --require-hashes -r requirements/run.txt
	@$(PIP) install --no-deps --no-build-isolation -e .
	@touch $@

.venv/dev.stamp: requirements/dev.txt pyproject.toml | .venv/bin/pip
	@echo "axiscal: installing the locked packages and the test tools into .venv (a minute or two the first time)"
	@$(PIP) install --require-hashes -r requirements/dev.txt
	@$(PIP) install --no-deps --no-build-isolation -e .
	@touch .venv/run.stamp $@

# A library that cannot be installed is a sentence in the table, so it does not end the run.
.venv-peers/%/stamp: benchmarks/peers/requirements/%.txt | .venv/bin/pip
	@echo "axiscal: installing the other libraries of $< into .venv-peers/$*"
	@$(BIN)/python -m venv .venv-peers/$*
	@if .venv-peers/$*/bin/python -m pip --disable-pip-version-check --quiet install -r $<; then touch $@; \
	else echo "axiscal: not everything of $< could be installed; the table says what is missing"; fi

.venv-controls/stamp: requirements/controls.txt | .venv/bin/pip
	@echo "axiscal: installing what Klipper's host needs into .venv-controls"
	@$(BIN)/python -m venv .venv-controls
	@.venv-controls/bin/python -m pip --disable-pip-version-check --quiet install --require-hashes -r requirements/controls.txt
	@touch $@

.venv-docs/stamp: requirements/docs.txt | .venv/bin/pip
	@echo "axiscal: installing the tools of the documentation into .venv-docs"
	@$(BIN)/python -m venv .venv-docs
	@.venv-docs/bin/python -m pip --disable-pip-version-check --quiet install --require-hashes -r requirements/docs.txt
	@touch $@

.venv/bin/pip-compile: | .venv/bin/pip
	@$(PIP) install --require-hashes -r requirements/dev.txt

.venv/bin/pip:
	@for python in $(PYTHON) python3 python3.14 python3.13 python3.12 python3.11; do \
	    if $$python -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then found=$$python; break; fi; \
	done; \
	if [ -z "$$found" ]; then \
	    echo "axiscal needs Python 3.11 or later and found none; on Debian or Ubuntu: sudo apt-get install python3 python3-venv" >&2; \
	    exit 1; \
	fi; \
	if ! $$found -c 'import ensurepip, venv' 2>/dev/null; then \
	    echo "axiscal needs Python's venv, which this Python lacks; on Debian or Ubuntu: sudo apt-get install python3-venv" >&2; \
	    exit 1; \
	fi; \
	$$found -m venv .venv
