# Everything a new machine needs: Python >= 3.11 and make. `make demo` and `make test` do the rest.
SHELL := /bin/bash
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt

.PHONY: demo test check check-minimum check-python docs bench tables fuzz mutants format clean

demo: $(VENV)/.run
	$(BIN)/osculate run --output demo

test: $(VENV)/.test
	$(BIN)/python -m pytest -n 2 --dist loadfile

check: $(VENV)/.dev
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet --site-dir site
	$(MAKE) test

# The tests marked "core" with the lowest versions that pyproject.toml admits. What lies beside them may
# be newer and deprecate what they do.
check-minimum: .venv-minimum/.test
	OSCULATE_CACHE_DIR=.venv-minimum/osculate .venv-minimum/bin/python -m pytest -m core \
	  -W ignore::DeprecationWarning -W ignore::PendingDeprecationWarning

# The same tests with another Python: make check-python PYTHON=python3.13
PYTHON ?= python3.13
OTHER := .venv-$(notdir $(PYTHON))
check-python: $(OTHER)/.test
	OSCULATE_CACHE_DIR=$(OTHER)/osculate $(OTHER)/bin/python -m pytest -m core

docs: $(VENV)/.dev
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --site-dir site

bench: $(VENV)/.test
	$(BIN)/python benchmarks/speed.py

tables: $(VENV)/.test
	$(BIN)/python scripts/tables.py

mutants: $(VENV)/.test
	$(BIN)/python scripts/mutants.py

fuzz: $(VENV)/.test
	$(BIN)/python benchmarks/fuzz_files.py
	$(BIN)/python benchmarks/fuzz_formulas.py
	$(BIN)/python benchmarks/fuzz_stepper.py --steps 10000000

format: $(VENV)/.dev
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

clean:
	rm -rf $(VENV) .venv-* demo site .pytest_cache .mypy_cache .ruff_cache .import_linter_cache

$(VENV)/.made:
	@bash scripts/make-venv.sh $(VENV)
	@touch $@

$(VENV)/.run: $(VENV)/.made pyproject.toml constraints.txt
	$(PIP) -e .
	@touch $@

$(VENV)/.test: $(VENV)/.run
	$(PIP) -e '.[test]'
	@bash scripts/install-opengl.sh $(BIN)/python
	@touch $@

$(VENV)/.dev: $(VENV)/.test
	$(PIP) -e '.[test,docs,dev]'
	@touch $@

.venv-minimum/.test: pyproject.toml scripts/minimum.py
	@bash scripts/make-venv.sh .venv-minimum python3.11 python3.12 python3.13
	.venv-minimum/bin/python scripts/minimum.py test > .venv-minimum/constraints.txt
	.venv-minimum/bin/python -m pip install --quiet --disable-pip-version-check \
	  -c .venv-minimum/constraints.txt -e '.[test]'
	@touch $@

$(OTHER)/.test: pyproject.toml constraints.txt
	@bash scripts/make-venv.sh $(OTHER) $(PYTHON)
	$(OTHER)/bin/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[test]'
	@touch $@
