# The four commands: make run, make test, make evidence, make wheel. Each sets up .venv first, once.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.ready
JOBS   ?= 2

.PHONY: run test evidence wheel build clean

run: build
	@$(BIN)/navfmu campaign system_ssp/backup_navigator/campaigns/main.toml --out results/main
	@$(BIN)/navfmu sweep backup_navigator --variant scanning --faults gps_lost --stop 900 --out results/steps \
		--steps 0.002,0.005,0.01,0.02,0.05,0.1,0.2,0.5,1

test: $(READY)
	@$(BIN)/ruff check --quiet .
	@$(BIN)/ruff format --check --quiet .
	@$(BIN)/python build_fmus.py
	@$(BIN)/python -m pytest -n $(JOBS) --dist loadfile -q

evidence: build
	@$(BIN)/python -m evidence --out results/evidence

wheel: $(READY)
	@$(BIN)/python -m tools.wheel --out dist

build: $(READY)
	@$(BIN)/python build_fmus.py

$(READY): pyproject.toml
	@echo "Setting up $(VENV): about 250 MB to load and 1.2 GB on disk (a compiler for five platforms), once"
	@$(PYTHON) -m venv $(VENV)
	@$(BIN)/python -m pip install --disable-pip-version-check -e ".[test]"
	@touch $@

clean:
	rm -rf $(VENV) dist results
