# Everything starts from here; each target sets up what it needs by itself.
VENV := .venv
ifeq ($(OS),Windows_NT)
PYTHON ?= python
BIN := $(VENV)/Scripts
else
PYTHON ?= python3
BIN := $(VENV)/bin
endif
# one arithmetic thread: the products are small, and sums must not depend on the number of cores
export OPENBLAS_NUM_THREADS ?= 1
# kept bytecode: else every process that a test starts compiles all sources again
export PYTHONDONTWRITEBYTECODE =

.PHONY: demo test web web-test lowest lint lint-python lint-js bench docs docs-pictures linkcheck evidence reconstruct format size clean clean-kernels

demo: $(VENV)/.installed
	$(BIN)/chromanoise demo

test: $(VENV)/.dev
	$(BIN)/python -m pytest -n 2 --durations=20

# a few tests with the lowest versions that pyproject.toml declares; Python 3.11 has wheels of all
LOWEST := out/lowest
LOWEST_BIN := $(LOWEST)/$(notdir $(BIN))
lowest: $(LOWEST)/.installed
	$(LOWEST_BIN)/python -m pytest -k "not pgm and not exif_in_a_tiff_of_pillow and not shrinks" \
	    tests/test_public_api.py tests/laws/test_pixel_toml.py tests/laws/test_frame_formats.py \
	    tests/shells/test_given_matrices.py tests/shells/test_metric_named.py \
	    tests/shells/test_lowest.py

evidence: $(VENV)/.dev
	$(BIN)/python -m pytest -m evidence
	$(BIN)/python -m pytest --hypothesis-profile=thorough tests/laws

size: $(VENV)/.dev
	$(BIN)/python tools/size.py

# the page as one HTML file, and as a folder for any host: web/README.md
web: $(VENV)/.dev
	$(BIN)/python web/build.py

web-test: web
	$(BIN)/python -m pytest -m "evidence or not evidence" tests/offline

lint: lint-python lint-js

lint-python: $(VENV)/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

# without Node.js the JavaScript is not checked, which fails only where CI is set
lint-js:
	@if node -e 'process.exit(parseInt(process.versions.node) >= 18 ? 0 : 1)' 2>/dev/null \
	        && command -v npm >/dev/null; then \
	    $(MAKE) --no-print-directory --silent node_modules/.installed && npm run --silent lint; \
	else \
	    echo "The JavaScript was not checked, because Node.js 18 or newer with npm is missing: install it and repeat 'make lint-js'." >&2; \
	    test -z "$$CI"; \
	fi

bench: $(VENV)/.bench
	$(BIN)/python benchmarks/closed_form_against_sampling.py
	$(BIN)/python benchmarks/whole_pixel.py
	$(BIN)/python benchmarks/separation.py
	$(BIN)/python benchmarks/design.py
	$(BIN)/python benchmarks/denoising.py
	$(BIN)/python benchmarks/imaging.py --write
	$(BIN)/python benchmarks/startup.py --write
	$(BIN)/python benchmarks/whole_jobs.py --install --write
	$(BIN)/python benchmarks/page.py --write
	$(BIN)/python benchmarks/web_file.py --write

# the site: warnings are errors; a second build reads only what changed
docs: $(VENV)/.docs
	$(BIN)/python -m sphinx -W --keep-going -q -j 2 -b html -d out/doctrees docs out/site
	@if test -d out/web/site; then rm -rf out/site/try && cp -r out/web/site out/site/try \
	    && cp out/web/chromanoise.html out/site/try && cd out/site/try \
	    && sha256sum chromanoise.html > chromanoise.html.sha256; fi
	@echo "The site is in out/site/index.html."

# the committed pictures and tables of README and docs
docs-pictures: $(VENV)/.dev
	$(BIN)/python tools/make_docs.py
	$(BIN)/chromanoise catalog --markdown docs/catalog.md
	$(BIN)/python -m pytest -n 2 tests/shells/test_docs.py tests/shells/test_site.py

# asks the network whether the links to other sites still work
linkcheck: $(VENV)/.docs
	$(BIN)/python -m sphinx -W --keep-going -q -b linkcheck -d out/doctrees docs out/linkcheck

reconstruct: $(VENV)/.dev
	$(BIN)/python tools/reconstruct_onyx.py

format: $(VENV)/.dev
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

clean-kernels:
	find src -path '*__pycache__/kernels-*' -prune -exec rm -rf {} +
	find src -name '*.nb[ic]' -delete

clean: clean-kernels
	rm -rf $(VENV) node_modules out docs/auto_gallery docs/reference/api docs/reference/commands \
	    docs/reference/study_keys.rst docs/reference/result_keys.rst docs/reference/results

$(VENV)/.installed: pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "chromanoise needs Python 3.11 or newer; set PYTHON=python3.12, for example")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[compiled]"
	touch $@

# Pillow below 12 cannot write some files of the tests, which are left out
$(LOWEST)/.installed: pyproject.toml tools/lowest_requirements.py
	$(PYTHON) -m venv $(LOWEST)
	$(PYTHON) tools/lowest_requirements.py > $(LOWEST)/requirements.txt
	$(LOWEST_BIN)/python -m pip install --quiet --disable-pip-version-check --only-binary :all: \
	    -r $(LOWEST)/requirements.txt pytest hypothesis httpx beartype jaxtyping pyyaml
	$(LOWEST_BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps -e .
	touch $@

$(VENV)/.dev: $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[dev]"
	touch $@

$(VENV)/.docs: $(VENV)/.installed pyproject.toml
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[docs]"
	touch $@

$(VENV)/.bench: $(VENV)/.dev
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[bench]"
	touch $@

node_modules/.installed: package.json package-lock.json
	npm ci --silent --no-audit --no-fund --ignore-scripts
	touch $@
