# make setup   install into .venv           make demo    the whole job on a bundled brain
# make test    everything that checks us    make bundled the model in the package
# make docs    the site, in site/              make clean   remove what these made
#
# PYTHON picks the interpreter (3.11 to 3.13); PIP_FLAGS goes to pip, see README.md.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/installed

.PHONY: setup demo bundled docs test clean

setup: $(STAMP)

$(STAMP): pyproject.toml constraints.txt
	$(PYTHON) -c 'import sys; v = sys.version_info[:2]; sys.exit(0 if (3, 11) <= v <= (3, 13) else f"physgnn needs Python 3.11 to 3.13, and {sys.executable} is {v[0]}.{v[1]}: name another with make PYTHON=…")'
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet $(PIP_FLAGS) --constraint constraints.txt --editable '.[tetgen,segment,dev]'
	touch $@

demo: setup
	$(BIN)/physgnn demo demo

bundled: setup
	$(BIN)/physgnn bundle data/bundled

docs: setup
	$(BIN)/properdocs build --strict --quiet --config-file mkdocs.yml

test: setup docs
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/pytest

clean:
	rm -rf $(VENV) demo site src/*.egg-info .*_cache
	find src tests benchmarks examples -name __pycache__ -prune -exec rm -rf {} +
