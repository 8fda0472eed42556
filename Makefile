# Everything a new machine needs: Python >= 3.11 and make. `make demo` and `make test` do the rest.
SHELL := /bin/bash
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt

.PHONY: demo test check docs bench tables fuzz mutants format clean

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
	rm -rf $(VENV) demo site .pytest_cache .mypy_cache .ruff_cache .import_linter_cache

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
