# Everything that is installed goes into .venv; `make clean` leaves it alone, `make distclean` does not.

PYTHON ?= python3
JOBS ?= 2
ARGS ?=
SEED ?= random

VENV := .venv
BIN := $(VENV)/bin
STAMPS := $(VENV)/stamps
INPUTS := pyproject.toml constraints.txt quadrotor/pyproject.toml paper/pyproject.toml quadrotor/hatch_build.py $(wildcard quadrotor/src/faultpath_quadrotor/native/source/*)
BENCH := .venv-bench
BENCH_JAX := .venv-bench-jax
PYTHONS := 3.12 3.13
SOURCES := src quadrotor paper tests examples benchmarks

# Installing compiles the kernels for whoever asks, and all that is installed here is for the quadrotor too.
export HATCH_BUILD_HOOK_ENABLE_CUSTOM := true

# --no-compile leaves byte code to the first import: most of what is installed is never imported.
PIP_INSTALL := $(BIN)/python -m pip install --no-compile --disable-pip-version-check --quiet -c constraints.txt

# The command refuses an option given twice, so one in ARGS takes the place of the recipe's.
unless_given = $(if $(filter $(1) $(1)=%,$(ARGS)),,$(1) $(2))

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help setup setup-runtime prerequisites audit confirm decision reproduce train test test-pythons test-foreign fuzz statistics bench references docs lint format clean distclean

help: ## Show this list
	@awk 'BEGIN {FS = ":.*## "} /^[a-z-]+:.*## / {printf "  make %-14s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

setup: $(STAMPS)/dev ## Create .venv with everything needed to develop

setup-runtime: $(STAMPS)/runtime ## Create .venv with what an audit needs

audit: $(STAMPS)/runtime ## Audit a repair of the quadrotor's wind reconstruction; more in ARGS="..."
	$(BIN)/faultpath audit quadrotor $(call unless_given,--baseline,gru) \
	  $(call unless_given,--repair,gru+dcc) $(call unless_given,--fault,calibration=+0.1) \
	  $(call unless_given,--library,held-out) $(call unless_given,--wind,L3) $(ARGS)
	$(if $(ARGS),,@$(BIN)/python -c "from faultpath_paper.central import shipped; print(shipped())")

confirm: $(STAMPS)/runtime ## Ask the same of 300 new scenes and three trainings: it decides what that leaves open
	$(BIN)/faultpath audit quadrotor --baseline gru --repair gru+dcc --fault calibration=+0.1 \
	  --library confirmation --wind L3 --seeds 0,1,2 $(ARGS)

decision: $(STAMPS)/runtime ## Ask how large the loss is where the fault is shared: 400 scenes, six trainings; resumes
	$(BIN)/faultpath audit quadrotor --baseline gru --repair gru+dcc --fault calibration=+0.1 \
	  --library decision --wind L3 --seeds 0,1,2,3,4,5 $(ARGS)

reproduce: $(STAMPS)/runtime ## Reproduce the paper, quickly; all of it with ARGS="--profile paper"
	$(BIN)/faultpath reproduce $(ARGS)

train: $(STAMPS)/runtime ## Collect flights and fit every learned model of the quadrotor
	$(BIN)/faultpath train quadrotor $(ARGS)

# Processes of the tests write no byte code: a file that a test edits twice within a second, to the
# same length, would go on as it was. What they import is compiled before, torch above all, since
# compiling it in each process would take most of their time.
test test-pythons test-foreign fuzz: export PYTHONDONTWRITEBYTECODE := 1
test fuzz: $(STAMPS)/compiled

test: $(STAMPS)/dev prerequisites ## Run the tests; more options in ARGS="..."
	@$(BIN)/python -m compileall -qq src quadrotor paper
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n $(JOBS) --dist worksteal $(ARGS)

# torch, and with it the quadrotor, is tested under the Python of .venv alone: the engine is for all of
# them. What is about the project (documents, wheel, site) and what takes a browser is not asked again.
test-pythons: ## Run the engine's tests under the other Pythons that are found here
	@$(FIND_PYTHON); failed=; \
	for version in $(PYTHONS); do \
	  python=$$(find_python $$version) || { \
	    echo "There is no Python $$version here: the engine is not tested under it."; continue; }; \
	  $(MAKE) --no-print-directory .venv-$$version/ready OTHER=$$python && \
	  .venv-$$version/bin/python -m compileall -qq src && \
	  OMP_NUM_THREADS=1 .venv-$$version/bin/python -m pytest -n $(JOBS) --dist worksteal \
	    --ignore tests/project -m "not browser" -p no:cacheprovider $(ARGS) \
	    || failed="$$failed $$version"; \
	done; \
	[ -z "$$failed" ] || { echo "The engine's tests fail under Python$$failed."; exit 1; }

test-foreign: .venv-foreign/ready .venv-lerobot/ready ## Run the examples' tests on packages of other people
	OMP_NUM_THREADS=1 .venv-foreign/bin/python -m pytest -n $(JOBS) --dist worksteal tests/foreign \
	  -p no:cacheprovider $(ARGS)
	OMP_NUM_THREADS=1 .venv-lerobot/bin/python -m pytest tests/foreign/test_lerobot.py \
	  -p no:cacheprovider $(ARGS)

fuzz: $(STAMPS)/dev ## Try the laws and the command line with random inputs; SEED=7 repeats
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n $(JOBS) --dist worksteal -m "hypothesis or fuzz" \
	  --hypothesis-profile=explore --fuzz-seed=$(SEED) --fuzz-whole $(ARGS)

statistics: $(STAMPS)/dev ## Simulate what the statistics promise, and write its page: some minutes; ARGS='"SECTION"' for one
	OMP_NUM_THREADS=1 $(BIN)/python tests/stats/simulation_page.py docs/statistics-check.md $(ARGS)

bench: $(BENCH)/ready $(BENCH_JAX)/ready $(STAMPS)/dev ## Measure side by side with other software; ARGS="ROW" for one
	$(BENCH)/bin/python -m benchmarks $(ARGS)
	$(BIN)/python tools/documents.py

references: $(STAMPS)/dev ## Fly stored runs again whose code has changed; resumes; ARGS="--list" only looks
	$(BIN)/python tools/references.py $(ARGS)

docs: $(STAMPS)/dev ## Write what follows from numbers, and build/site; ARGS="--check" only looks
	$(BIN)/python tools/documents.py $(ARGS)
	$(if $(filter --check,$(ARGS)),,$(BIN)/python -m sphinx -W --keep-going -q docs build/site)

lint: $(STAMPS)/dev ## Check format, style, types and layers
	$(BIN)/ruff format --check
	$(BIN)/ruff check
	$(BIN)/pyright
	$(BIN)/lint-imports

format: $(STAMPS)/dev ## Put the code into the project's format
	$(BIN)/ruff format
	$(BIN)/ruff check --fix

clean: ## Remove caches and build outputs; keep .venv and results
	rm -rf .pytest_cache .ruff_cache .import_linter_cache .hypothesis build dist
	find $(wildcard $(SOURCES)) -name __pycache__ -type d -prune -exec rm -rf {} +

distclean: clean ## Remove .venv and the other environments as well
	rm -rf $(VENV) $(wildcard .venv-*)

# The browser tests need a Chromium. Root on a machine with apt gets it; anyone else is told how.
prerequisites:
	@for name in chromium chromium-browser google-chrome; do \
	  if command -v $$name >/dev/null 2>&1; then exit 0; fi; \
	done; \
	if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1; then \
	  echo "No Chromium here: installing it for the browser tests with apt-get install chromium."; \
	  if apt-get -qq update && \
	    DEBIAN_FRONTEND=noninteractive apt-get -qq -y install --no-install-recommends chromium >/dev/null; \
	  then exit 0; fi; \
	fi; \
	echo "The browser tests need Chromium; on Debian install it with: apt-get install chromium"

define CHECK_PYTHON
command -v $(PYTHON) >/dev/null 2>&1 || { \
  echo "There is no '$(PYTHON)' here: install Python 3.11 or newer, or name one with make PYTHON=python3.11"; \
  exit 1; }; \
$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
  echo "faultpath needs Python 3.11 or newer and '$(PYTHON)' is $$($(PYTHON) -V): name a newer one with make PYTHON=python3.11"; \
  exit 1; }; \
$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { \
  echo "'$(PYTHON)' cannot create virtual environments: on Debian install that part with apt-get install python3-venv"; \
  exit 1; }
endef

# Says where a Python of a version is, if one runs here: the command of its name, or pyenv's.
define FIND_PYTHON
find_python() { \
  for chosen in "$$PYENV_VERSION" "$$(pyenv latest $$1 2>/dev/null)"; do \
    PYENV_VERSION=$$chosen python$$1 -c 'import ensurepip, sys, venv; print(sys.executable)' \
      2>/dev/null && return; \
  done; return 1; }
endef

# A stamp is written only after everything before it has worked. $(VENV)/incomplete lies there while
# pip writes, so an environment in which an install was cut short is built again from nothing.
$(STAMPS)/runtime: PARTS := -e . -e ./quadrotor -e ./paper
$(STAMPS)/dev: PARTS := -e '.[dev]' -e './quadrotor[mujoco]' -e ./paper
$(STAMPS)/runtime $(STAMPS)/dev: $(INPUTS)
	@if [ -e $(VENV)/incomplete ] || ! $(BIN)/python -m pip --version >/dev/null 2>&1; then \
	  $(CHECK_PYTHON); \
	  echo "Creating $(VENV)"; \
	  rm -rf $(VENV) && $(PYTHON) -m venv $(VENV); \
	fi
	@touch $(VENV)/incomplete
	@echo "Installing faultpath and its quadrotor into $(VENV); the first time this takes a minute or two"
	@$(PIP_INSTALL) $(PARTS)
	@mkdir -p $(STAMPS)
	@touch $(STAMPS)/runtime $@
	@rm $(VENV)/incomplete

# Some packages hold files for other versions of Python, which do not compile.
$(STAMPS)/compiled: $(STAMPS)/dev
	@echo "Compiling what the tests import"
	-@PYTHONDONTWRITEBYTECODE= $(BIN)/python -m compileall -qq -j $(JOBS) $(VENV)/lib
	@touch $@

# The peers of the measurements have an environment of their own, which nothing else uses.
$(BENCH)/ready: $(INPUTS) benchmarks/requirements.txt
	@if [ -e $(BENCH)/incomplete ] || ! $(BENCH)/bin/python -m pip --version >/dev/null 2>&1; then \
	  $(CHECK_PYTHON); \
	  rm -rf $(BENCH) && $(PYTHON) -m venv $(BENCH); \
	fi
	@touch $(BENCH)/incomplete
	@echo "Installing faultpath and what it is compared with into $(BENCH); the first time takes minutes"
	@$(BENCH)/bin/python -m pip install --no-compile --disable-pip-version-check --quiet \
	  -c constraints.txt -r benchmarks/requirements.txt -e . -e './quadrotor[mujoco]' -e ./paper
	@rm $(BENCH)/incomplete
	@touch $@

# jax-mppi asks for a newer Python than torch's build may be for. Without one its row says so.
$(BENCH_JAX)/ready: benchmarks/requirements-jax.txt
	@$(FIND_PYTHON); python=$$(for each in $(PYTHONS); do find_python $$each && break; done); \
	if [ -z "$$python" ]; then echo "There is no Python 3.12 here: jax-mppi is not measured."; exit 0; fi; \
	echo "Installing jax-mppi into $(BENCH_JAX)"; \
	rm -rf $(BENCH_JAX) && $$python -m venv $(BENCH_JAX) && \
	$(BENCH_JAX)/bin/python -m pip install --no-compile --disable-pip-version-check --quiet \
	  -r benchmarks/requirements-jax.txt && touch $@

# The engine with what its tests need. Not all pins have a build for every Python: they hold for
# what they are the tested versions of, and the rest is what pip finds.
.venv-%/ready: pyproject.toml constraints.txt
	@echo "Installing the engine for Python $* into .venv-$*"
	@rm -rf .venv-$* && $(OTHER) -m venv .venv-$*
	@.venv-$*/bin/python -m pip install --disable-pip-version-check --quiet \
	  -c constraints.txt -e '.[test,motulator]'
	@touch $@

# Basilisk wants older versions of what the tools of development pin, so this takes what pip finds,
# except of torch, whose pin has a build for the CPU.
.venv-foreign/ready: pyproject.toml constraints.txt
	@$(CHECK_PYTHON)
	@echo "Installing the packages that examples audit into .venv-foreign"
	@rm -rf .venv-foreign && $(PYTHON) -m venv .venv-foreign
	@.venv-foreign/bin/python -m pip install --disable-pip-version-check --quiet \
	  -e '.[rotorpy,do-mpc,basilisk,wpilib,opendbc,gymnasium,inspect,policies,stable-worldmodel]' "$$(grep '^torch==' constraints.txt)" \
	  hypothesis pytest pytest-xdist
	@touch $@

# LeRobot asks for Python 3.12 and a torch below 2.12. This takes the Python and the torch of the other
# tests, and of what LeRobot asks for only what its processor imports, in the versions that it names.
.venv-lerobot/ready: pyproject.toml constraints.txt
	@$(CHECK_PYTHON)
	@echo "Installing LeRobot into .venv-lerobot"
	@rm -rf .venv-lerobot && $(PYTHON) -m venv .venv-lerobot
	@.venv-lerobot/bin/python -m pip install --disable-pip-version-check --quiet \
	  -e . "$$(grep '^torch==' constraints.txt)" 'numpy>=2,<2.3' 'safetensors>=0.4.3,<1' \
	  'draccus>=0.11.6,<0.12' 'einops>=0.8,<0.9' 'huggingface-hub>=1.6,<2' 'pillow>=10,<13' \
	  hypothesis pytest pytest-xdist
	@.venv-lerobot/bin/python -m pip install --disable-pip-version-check --quiet \
	  --no-deps --ignore-requires-python lerobot==0.6.1 torchvision==0.28.0
	@touch $@
