# Everything starts from here; each target sets up what it needs by itself.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# one arithmetic thread: the products are small, and sums must not depend on the number of cores
export OPENBLAS_NUM_THREADS ?= 1

.PHONY: demo test lint bench docs evidence reconstruct format clean clean-kernels

demo: $(VENV)/.installed
	$(BIN)/chromanoise demo

test: $(VENV)/.dev
	$(BIN)/python -m pytest -n 2

evidence: $(VENV)/.dev
	$(BIN)/python -m pytest -m evidence

lint: $(VENV)/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: $(VENV)/.bench
	$(BIN)/python benchmarks/closed_form_against_sampling.py
	$(BIN)/python benchmarks/imaging.py --write
	$(BIN)/python benchmarks/startup.py --write
	$(BIN)/python benchmarks/page.py --write

docs: $(VENV)/.dev
	$(BIN)/python tools/make_docs.py
	$(BIN)/chromanoise catalog --markdown docs/catalog.md
	$(BIN)/python -m pytest tests/shells/test_docs.py

reconstruct: $(VENV)/.dev
	$(BIN)/python tools/reconstruct_onyx.py

format: $(VENV)/.dev
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

clean-kernels:
	rm -rf src/chromanoise/imaging/__pycache__/kernels-*
	find src -name '*.nb[ic]' -delete

clean: clean-kernels
	rm -rf $(VENV) out

$(VENV)/.installed: pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "chromanoise needs Python 3.11 or newer; set PYTHON=python3.12, for example")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e .
	touch $@

$(VENV)/.dev: $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[dev]"
	touch $@

$(VENV)/.bench: $(VENV)/.dev
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[bench]"
	touch $@
