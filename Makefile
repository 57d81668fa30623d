# Needs only make and Python 3.11 or later with venv. Everything else goes into .venv.
#   make run ARGS="rpur-table2 --port 9000"     make test ARGS="tests/kinematics -x"

.DEFAULT_GOAL := run
.DELETE_ON_ERROR:
MAKEFLAGS += --no-print-directory

VENV := .venv
BIN := $(VENV)/bin
ARGS ?=
# Tests on all cores; ARGS="-n 0" for one process.
PARALLEL := -n auto --maxprocesses 8 --dist loadfile --no-loadscope-reorder

# PYTHON may name any interpreter; left out, the first one on the path that is new enough.
PYTHON ?= $(shell for python in python3 python3.11 python3.12 python3.13 python3.14 python; do \
	"$$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1 \
	&& { echo "$$python"; break; }; done)

export PIP_DISABLE_PIP_VERSION_CHECK := 1
export PIP_NO_INPUT := 1
export PIP_ROOT_USER_ACTION := ignore

.PHONY: run test check check-all sweeps mutants format docs schemas bench pictures start-solutions clean

run: $(VENV)/installed
	@exec $(BIN)/bohemia $(ARGS)

test: $(VENV)/installed-tools
	@$(BIN)/python -m pytest $(PARALLEL) $(ARGS)

check: $(VENV)/installed-tools
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/mypy
	@PYTHONPATH=. $(BIN)/lint-imports

# Everything, and what is slow and rarely breaks: run before an issue is closed.
check-all: check sweeps
	@$(MAKE) test ARGS="-m 'slow or not slow' $(ARGS)"

# Designs, files and commands drawn at random; more by SWEEP=10000, others by FROM=10000.
FROM ?= 0
SWEEP ?= 300
sweeps: $(VENV)/installed-tools
	@for what in designs files commands; do \
		$(BIN)/python -W error -m tests.sweeps $$what $(FROM) $$(( $(FROM) + $(SWEEP) )) || exit 1; done

# Whether the tests notice a wrong operator; ARGS="--count 20 --only kinematics/screws".
mutants: $(VENV)/installed-tools
	@$(BIN)/python tests/mutants.py $(ARGS)

format: $(VENV)/installed-tools
	@$(BIN)/ruff check --fix .
	@$(BIN)/ruff format .

# The documentation, from its sources in assets/docs and from the program itself, into build/docs;
# without a network, every warning an error, every link followed.
docs: $(VENV)/installed-docs
	@$(BIN)/python -m sphinx -b html -q -E --fail-on-warning --keep-going -d build/doctrees \
		assets/docs build/docs
	@echo "build/docs/index.html"

# The forms of JSON answers again, from what all commands answer; read the difference.
schemas: $(VENV)/installed-tools
	@$(BIN)/python -m tests.schemas

bench: $(VENV)/installed-tools
	@for script in tests/benchmarks/bench_*.py; do \
		echo "== $$script"; $(BIN)/python "$$script" $(ARGS) || exit 1; done

# The README's pictures of the page as it is.
pictures: $(VENV)/installed-tools
	@$(BIN)/python -m tests.pictures assets/readme

# Makes the start sets of the forward kinematics again, from nothing; takes a few minutes.
start-solutions: $(VENV)/installed
	@$(BIN)/python -m kinematics.mechanisms.five_rpur.forward.monodromy assets/start_solutions
	@$(BIN)/python -m kinematics.mechanisms.four_sps_spr.forward.monodromy assets/start_solutions
	@$(BIN)/python -m kinematics.mechanisms.parallel.forward.monodromy assets/start_solutions

clean:
	rm -rf $(VENV) build dist .pytest_cache .mypy_cache .ruff_cache .hypothesis .mutants \
		.import_linter_cache
	find app kinematics tests -name __pycache__ -type d -prune -exec rm -rf {} +

$(VENV)/created:
	@test -n "$(PYTHON)" || { echo "Bohemia needs Python 3.11 or later, and none was found;" \
		"install one, or name it: make PYTHON=/path/to/python3.11" >&2; exit 1; }
	@"$(PYTHON)" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
		echo "Bohemia needs Python 3.11 or later, and $(PYTHON) is not;" \
		"name another one: make PYTHON=/path/to/python3.11" >&2; exit 1; }
	@rm -rf $(VENV)
	@"$(PYTHON)" -m venv $(VENV) || { rm -rf $(VENV); \
		echo "$(PYTHON) cannot make a virtual environment;" \
		"on Debian or Ubuntu: apt install python3-venv" >&2; exit 1; }
	@touch $@

$(VENV)/installed: $(VENV)/created pyproject.toml
	@echo "Installing Bohemia into $(VENV); this happens once and takes about half a minute."
	@$(BIN)/python -m pip install --quiet --editable .
	@touch $@

$(VENV)/installed-tools: $(VENV)/created pyproject.toml
	@echo "Installing Bohemia and its test tools into $(VENV); this happens once."
	@$(BIN)/python -m pip install --quiet --editable '.[test,check]'
	@touch $(VENV)/installed $@

$(VENV)/installed-docs: $(VENV)/created pyproject.toml
	@echo "Installing Bohemia and what builds its documentation into $(VENV); this happens once."
	@$(BIN)/python -m pip install --quiet --editable '.[docs]'
	@touch $(VENV)/installed $@
