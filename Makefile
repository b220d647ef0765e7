# Everything here works on a fresh machine with Python >= 3.11 (venv) and Rust >= 1.89; benches need gcc as well.
.PHONY: demo test test-rust test-instructions test-python test-long test-proofs test-embedded coverage fuzz bench docs test-docs package lint build clean
PY := .venv/bin/python
STAMP := .venv/.installed

.venv/.tools: pyproject.toml
	python3 -m venv .venv
	$(PY) -m pip install --quiet --upgrade pip "maturin>=1.9,<2"
	touch $@

# The compiled package, installed into .venv with what the tests and the report page need.
$(STAMP): .venv/.tools $(shell find crates python -name '*.rs' -o -name '*.toml' -o -name '*.py') Cargo.toml pyproject.toml
	. .venv/bin/activate && maturin develop --release --quiet --extras tables,report
	touch $@

build: $(STAMP)

demo: build
	.venv/bin/stillrate demo

.venv/.test-tools: $(STAMP)
	. .venv/bin/activate && maturin develop --release --quiet --extras all,test,lint,docs
	touch $@

test: test-rust test-instructions test-python test-docs test-embedded

test-rust:
	cargo test --workspace --exclude stillrate-py --quiet

# Fails where a filter became more than 3 % slower; skipped without valgrind.
test-instructions:
	python3 benches/instructions.py

test-python: .venv/.test-tools
	$(PY) -m pytest

test-long: .venv/.test-tools
	cargo test --workspace --exclude stillrate-py --release -- --ignored
	$(PY) -m pytest -m long

# No step can panic or allocate, and C gives the bits of Rust.
test-proofs:
	cargo test --quiet -p stillrate-c
	cargo test --quiet -p stillrate-lab --test allocation

# Every filter on an emulated Cortex-M4F and M7; says so and passes where the tools cannot be had.
test-embedded:
	sh tests/embedded/run.sh

# Lines and branches of the core that the tests of core and lab run; needs cargo-llvm-cov and LLVM's tools.
coverage:
	python3 tests/coverage.py

# Every fuzz target with the address sanitizer, SECONDS each.
SECONDS := 60
fuzz:
	sh fuzz/run.sh $(SECONDS)

# The site, into site/: every warning is an error, and no page needs the network.
docs: .venv/.test-tools
	rm -rf site docs/generated
	$(PY) -m sphinx -W --keep-going -q -E -d docs/generated/doctrees docs site
	$(PY) docs/check_site.py site

# The code blocks themselves run in tests/test_docs.py.
test-docs: docs

bench: $(STAMP)
	$(PY) -m pip install --quiet -r benches/requirements.txt
	cd benches && ../$(PY) bench.py && ../$(PY) accuracy.py && ../$(PY) scaling.py

# Wheel, source archive and crates, installed and used as a stranger would; takes what it depends on from the indexes.
package: .venv/.tools
	$(PY) tests/install_check.py dist

# Crates that are no members of the workspace, for its tools.
APART := examples/own_model benches/kfilter crates/stillrate-c/abi fuzz

lint: .venv/.test-tools
	cargo fmt --check
	for crate in $(APART); do cargo fmt --check --manifest-path $$crate/Cargo.toml || exit 1; done
	RUSTDOCFLAGS="-D warnings" cargo doc --quiet --no-deps --package stillrate --package stillrate-lab
	cargo clippy --workspace --all-targets --quiet -- -D warnings
	.venv/bin/ruff check python tests benches docs examples crates
	.venv/bin/ruff format --check python tests benches docs examples
	.venv/bin/mypy
	.venv/bin/stubtest stillrate._native --mypy-config-file pyproject.toml --allowlist tests/stubtest.txt
	$(PY) tests/public_items.py

clean:
	rm -rf target .venv dist site docs/generated
