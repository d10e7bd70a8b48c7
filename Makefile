# The two commands of the README: `make demo` and `make test`. They need Python >= 3.11, make and a package index.

VENV := .venv
BIN  := $(VENV)/bin
BARE := .venv-bare
PIP  := python -m pip --disable-pip-version-check
RUN  := runs/demo
SOURCES := $(shell find src -type f -not -path '*/__pycache__/*')

.PHONY: help install demo test format lint types layers bare unit viewer clean

help:
	@echo "make install  the environment .venv with the command .venv/bin/punchform"
	@echo "make demo     install, then form the packaged case of the paper; says where the report is"
	@echo "make test     install with the test extras, then every check (as CI runs them)"
	@echo "make viewer   rewrite the 3D viewer from its sources (needs Node)"
	@echo "make format   rewrite the sources in the house format"
	@echo "make clean    remove the environments, the caches and runs/demo"

# --- environments: each is made once and again only when pyproject.toml changes -----------------------------

$(VENV)/pyvenv.cfg $(BARE)/pyvenv.cfg:
	@python=$$(PYTHON="$(PYTHON)" scripts/find-python) && echo "making $(@D) with $$python" && "$$python" -m venv $(@D)

$(VENV)/.installed: pyproject.toml | $(VENV)/pyvenv.cfg
	$(VENV)/bin/$(PIP) install --quiet --editable .
	@touch $@

$(VENV)/.test-ready: pyproject.toml | $(VENV)/pyvenv.cfg
	$(VENV)/bin/$(PIP) install --quiet --editable '.[test,fast]'
	@touch $(VENV)/.installed $@

$(BARE)/.ready: pyproject.toml | $(BARE)/pyvenv.cfg
	$(BARE)/bin/$(PIP) install --quiet .
	@touch $@

install: $(VENV)/.installed
	@echo "installed: $(CURDIR)/$(BIN)/punchform"

# --- the main job on a real case ------------------------------------------------------------------------------
# The command ends with 1 when the dish is out of its tolerance, as a dish of elastic wires is; anything else fails.

demo: install
	@echo "$(BIN)/punchform form packaged:paper -o $(RUN) --overwrite"
	@$(BIN)/punchform form packaged:paper -o $(RUN) --overwrite || [ $$? -eq 1 ]
	@echo
	@echo "report: $(CURDIR)/$(RUN)/report.html"

# --- checks; pytest comes last so that its closing line closes the output -----------------------------------

test: lint types layers bare unit

format: $(VENV)/.test-ready
	$(BIN)/ruff check --fix --quiet src tests
	$(BIN)/ruff format src tests

lint: $(VENV)/.test-ready
	$(BIN)/ruff format --check src tests
	$(BIN)/ruff check src tests

types: $(VENV)/.test-ready
	$(BIN)/mypy

layers: $(VENV)/.test-ready
	$(BIN)/lint-imports

unit: $(VENV)/.test-ready
	$(BIN)/pytest --numprocesses auto --dist loadfile

bare: $(BARE)/.checked

# The package as a user would get it: built, installed without extras, and used from another folder.
$(BARE)/.checked: $(BARE)/.ready $(SOURCES) scripts/check-bare
	$(BARE)/bin/$(PIP) install --quiet --no-deps --force-reinstall .
	scripts/check-bare $(BARE)/bin
	@touch $@

# The 3D viewer anew from its sources, as it is committed; a test compares the two. Needs Node.
viewer:
	scripts/build-viewer

clean:
	rm -rf $(VENV) $(BARE) $(RUN) build dist .mypy_cache .pytest_cache .ruff_cache .import_linter_cache .hypothesis
