# The two commands of the README: `make demo` and `make test`. They need Python >= 3.11, make and a package index.

VENV := .venv
BIN  := $(VENV)/bin
BARE := .venv-bare
PIP  := python -m pip --disable-pip-version-check
RUN  := runs/demo
SOURCES := $(shell find src -type f -not -path '*/__pycache__/*')

.PHONY: help install demo test docs format lint types layers bare unit viewer clean

help:
	@echo "make install  the environment .venv with the command .venv/bin/punchform"
	@echo "make demo     install, then form the packaged case of the paper; says where the report is"
	@echo "make test     install with the test extras, then every check (as CI runs them)"
	@echo "make viewer   rewrite the 3D viewer from its sources (needs Node)"
	@echo "make docs     the documentation: the site in docs/_build/html, and every page executed"
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

$(VENV)/.docs-ready: $(VENV)/.test-ready
	$(VENV)/bin/$(PIP) install --quiet --editable '.[docs]'
	@touch $@

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
	@test -f $(RUN)/report.html
	@echo "report: $(CURDIR)/$(RUN)/report.html"

# --- the documentation: a warning of the site and a page that says something else than the program are errors -----

docs: $(VENV)/.docs-ready
	$(BIN)/python -m sphinx -q -W --keep-going -b html -d docs/_build/doctrees docs docs/_build/html
	$(BIN)/pytest tests/pages --numprocesses auto --dist loadgroup
	@echo "documentation: $(CURDIR)/docs/_build/html/index.html"

# --- checks; pytest comes last so that its closing line closes the output -----------------------------------

test: lint types layers bare unit

format: $(VENV)/.test-ready
	$(BIN)/ruff check --fix --quiet src tests docs/conf.py docs/_ext
	$(BIN)/ruff format src tests docs/conf.py docs/_ext

lint: $(VENV)/.test-ready
	$(BIN)/ruff format --check src tests docs/conf.py docs/_ext
	$(BIN)/ruff check src tests docs/conf.py docs/_ext

types: $(VENV)/.test-ready
	$(BIN)/mypy

layers: $(VENV)/.test-ready
	$(BIN)/lint-imports

unit: $(VENV)/.test-ready
	$(BIN)/pytest --numprocesses auto --dist loadfile --ignore tests/pages

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
	rm -rf $(VENV) $(BARE) $(RUN) build dist docs/_build .mypy_cache .pytest_cache .ruff_cache .import_linter_cache .hypothesis
