# make setup   install into .venv           make demo    the whole job on a bundled brain
# make test    everything that checks us    make bundled the models in the package
# make docs    the site, in site/              make clean   remove what these made
#
# PYTHON picks the interpreter (3.11 to 3.13). PyTorch comes in its CPU build where its
# index can be reached; TORCH=pypi takes what PyPI has, on Linux with 3 GB of CUDA.
# PIP_FLAGS goes to pip.

PYTHON ?= python3
TORCH ?= cpu
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/installed
TORCH_INDEX := https://download.pytorch.org/whl/$(TORCH)
ifneq ($(TORCH),pypi)
TRY_INDEX := $(BIN)/python -c 'from urllib.request import urlopen; urlopen("$(TORCH_INDEX)/torch/", timeout=10)' \
	2>/dev/null && echo "--extra-index-url $(TORCH_INDEX)"
else
TRY_INDEX := true
endif

.PHONY: setup demo bundled docs test clean

setup: $(STAMP)

$(STAMP): pyproject.toml constraints.txt
	$(PYTHON) -c 'import sys; v = sys.version_info[:2]; sys.exit(0 if (3, 11) <= v <= (3, 13) else f"physgnn needs Python 3.11 to 3.13, and {sys.executable} is {v[0]}.{v[1]}: name another with make PYTHON=…")'
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	index=$$($(TRY_INDEX)); $(BIN)/python -m pip install --quiet $$index $(PIP_FLAGS) --constraint constraints.txt --editable '.[tetgen,meshfix,segment,dev]'
	touch $@

demo: setup
	$(BIN)/physgnn demo demo

bundled: setup
	$(BIN)/physgnn bundle data/bundled
	$(BIN)/physgnn bundle data/family --family

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
