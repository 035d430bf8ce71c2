# make setup   install into .venv           make demo    the whole job on a bundled brain
# make test    everything that checks us    make bundled the models in the package
# make docs    the site, in site/              make clean   remove what these made
# make bench   the benchmarks of speed, in bench/
#
# The tests run in JOBS processes of one thread each; with make --jobs 3 test the other
# checks run beside them. PYTHON picks the interpreter (3.11 to 3.13). PyTorch comes in its
# CPU build where its index can be reached; TORCH=pypi takes what PyPI has, on Linux with
# 3 GB of CUDA. PIP_FLAGS goes to pip, BENCH_FLAGS to the benchmarks.

PYTHON ?= python3
JOBS ?= 2
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

ONE_THREAD := OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 NUMBA_NUM_THREADS=1

.PHONY: setup demo bundled bench docs test style types layers tests clean

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

bench: setup
	$(BIN)/python benchmarks/bench.py -o bench $(BENCH_FLAGS)

docs: setup
	$(BIN)/properdocs build --strict --quiet --config-file mkdocs.yml

test: style types layers tests

style: setup
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .

types: setup
	$(BIN)/mypy

layers: setup
	$(BIN)/lint-imports

# tests/docs builds the site. A file of tests stays in one process, for what its tests share.
tests: setup
	$(ONE_THREAD) $(BIN)/pytest --numprocesses $(JOBS) --dist loadfile --no-loadscope-reorder

clean:
	rm -rf $(VENV) demo site bench src/*.egg-info .*_cache
	find src tests benchmarks examples -name __pycache__ -prune -exec rm -rf {} +
