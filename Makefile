# Two commands do everything on a machine that has Python (3.11 or newer) and make.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
DEMO_ARGS ?=
# Small matrices: more BLAS threads only get in each other's way.
export OPENBLAS_NUM_THREADS = 1

.PHONY: demo test lint benchmarks dashboard clean

$(VENV)/.installed: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check --editable '.[dev]'
	touch $@

demo: $(VENV)/.installed ## the main job, end to end: simulator, service, summary; Ctrl-C ends it
	$(BIN)/rundown demo $(DEMO_ARGS)

lint: $(VENV)/.installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

test: lint
	$(BIN)/pytest -n 2 --dist loadfile

benchmarks: $(VENV)/.installed
	$(BIN)/python -m benchmarks

dashboard: ## build the page anew into service/dashboard/, where it is committed; needs Node.js 20
	cd dashboard && npm ci --no-audit --no-fund && npm run build

clean:
	rm -rf $(VENV) build *.egg-info
