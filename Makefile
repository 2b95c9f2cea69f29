# Two commands do everything on a machine that has Python (3.11 or newer) and make.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
DEMO_ARGS ?=
# Tests wait for services more than they compute: three at once keep two cores busy.
PROCESSES ?= 3
# A file of tests stays in one process; files begin in the order of tests/conftest.py, not the one with most tests first.
IN_PARALLEL := --dist loadfile --no-loadscope-reorder
# Folders of short tests lie in memory where there is room [kB]: their stores wait for no disk. The long ones keep the disk.
IN_MEMORY := $(shell [ -w /dev/shm ] && [ "$$(df -Pk /dev/shm | awk 'NR == 2 {print $$4}')" -ge 8000000 ] && echo /dev/shm)
# Wherever Python may: else every process of every run would work out the tests' assertions anew, 10 s each.
export PYTHONDONTWRITEBYTECODE =
# Small matrices: more BLAS threads only get in each other's way.
export OPENBLAS_NUM_THREADS = 1

.PHONY: demo compiled test test-browser test-long test-postgresql lint audit benchmarks dashboard docs sbom clean

$(VENV)/.installed: pyproject.toml setup.py
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check --no-compile --editable '.[dev]'
	-$(BIN)/python -m compileall -qq -j 0 $(VENV)/lib # as pip does, but on all cores; some packages hold files that are no Python
	touch $@

demo: $(VENV)/.installed ## the main job, end to end: simulator, service, summary; Ctrl-C ends it
	$(BIN)/rundown demo $(DEMO_ARGS)

lint: $(VENV)/.installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# As an installed package is: where Python may not write its caches, each service started would compile all of it anew.
compiled: $(VENV)/.installed
	$(BIN)/python -m compileall -q -j 0 estimator formats rotorundown service storage tests benchmarks
	$(BIN)/python -m tests.rewritten_assertions

test: lint compiled
	PYTEST_DEBUG_TEMPROOT=$(IN_MEMORY) $(BIN)/pytest -n $(PROCESSES) $(IN_PARALLEL) -m 'not long' --ignore tests/browser

test-browser: compiled ## the page in a real browser, which needs chromium
	$(BIN)/pytest -n $(PROCESSES) $(IN_PARALLEL) tests/browser

test-long: compiled ## what takes minutes: real processes killed, parted and fed with rubbish
	$(BIN)/pytest -n $(PROCESSES) $(IN_PARALLEL) -m long $$(grep -rl --include='test_*.py' 'mark\.long' tests | sort)

# tests/storage is run on both kinds of database by `make test` already. These wait for the server most of their time.
test-postgresql: PROCESSES := 5
test-postgresql: compiled ## what uses a database once more, on a PostgreSQL server that the tests start
	PYTEST_DEBUG_TEMPROOT=$(IN_MEMORY) RUNDOWN_TEST_DATABASE=postgresql $(BIN)/pytest -n $(PROCESSES) $(IN_PARALLEL) -m 'not long' tests/service tests/end_to_end/test_main_job.py

audit: $(VENV)/.installed ## known vulnerabilities of what is installed; says so where the advisories cannot be had
	$(BIN)/python -m benchmarks.dependency_audit

benchmarks: $(VENV)/.installed
	$(BIN)/python -m benchmarks

dashboard: $(VENV)/.installed ## build the page anew into service/dashboard/, where it is committed; needs Node.js 20
	$(BIN)/python -m service.commands.page_declarations dashboard/src/declarations
	cd dashboard && npm ci --no-audit --no-fund && npm run build

docs: $(VENV)/.installed ## the documentation as a site in build/site, to be opened and searched without a server
	$(BIN)/python -m docs_site

sbom: $(VENV)/.installed ## what an installation of the service consists of, as CycloneDX, in build/rotorundown.cdx.json
	$(BIN)/python -m benchmarks.sbom

clean:
	rm -rf $(VENV) build *.egg-info
