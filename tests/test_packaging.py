"""What is handed out is whole, is ours to hand out, and says one version."""

from __future__ import annotations

import importlib.metadata
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
from pathlib import Path

import licences
import pytest

ROOT = Path(__file__).parents[1]
WORKSPACE = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
PUBLISHED = ("stillrate", "stillrate-lab")


def _needs(program: str) -> str:
    beside = Path(sys.executable).parent
    found = shutil.which(program, path=f"{beside}{os.pathsep}{os.environ.get('PATH', '')}")
    if found is None:
        pytest.skip(f"{program} is not installed")
    return found


@pytest.fixture(scope="module")
def sdist(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    folder = tmp_path_factory.mktemp("sdist")
    _needs("cargo")
    subprocess.run([_needs("maturin"), "sdist", "--out", folder], cwd=ROOT, check=True, capture_output=True)
    with tarfile.open(next(folder.glob("*.tar.gz"))) as archive:
        files = [member for member in archive if member.isfile()]
        return {member.name.split("/", 1)[1]: archive.extractfile(member).read() for member in files}  # type: ignore[union-attr]


def test_the_source_archive_holds_all_that_a_build_takes(sdist: dict[str, bytes]) -> None:
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    if tracked.returncode != 0:
        pytest.skip("not in a checkout")
    crates = [f"crates/{name}/src/" for name in ("stillrate", "stillrate-lab", "stillrate-py")]
    needed = [
        name for name in tracked.stdout.splitlines() if name.startswith(("python/", *crates)) and (ROOT / name).exists()
    ]
    missing = set(needed) - set(sdist)
    assert len(needed) > 250 and not missing, sorted(missing)[:5]
    assert {"Cargo.lock", "LICENSE-MIT", "LICENSE-APACHE", "README.md", "pyproject.toml"} <= set(sdist)


def test_the_source_archive_holds_no_leftovers_and_no_path_of_a_machine(sdist: dict[str, bytes]) -> None:
    leftovers = [
        name for name in sdist if re.search(r"__pycache__|\.pyc$|\.so$|_cache/|\.egg-info|(^|/)target/|\.whl$", name)
    ]
    assert not leftovers, leftovers[:5]
    here = [str(ROOT).encode(), str(Path.home()).encode() + b"/."]
    assert not [name for name, content in sdist.items() if any(path in content for path in here)]


def test_every_published_crate_has_its_readme_and_both_licences(sdist: dict[str, bytes]) -> None:
    for crate in PUBLISHED:
        for licence in ("LICENSE-MIT", "LICENSE-APACHE"):
            assert sdist[f"crates/{crate}/{licence}"] == (ROOT / licence).read_bytes(), crate
        listed = subprocess.run(
            [_needs("cargo"), "package", "--list", "--allow-dirty", "-p", crate],
            cwd=ROOT,
            check=True,
            capture_output=True,
            text=True,
        )
        files = listed.stdout.split()
        assert {"README.md", "LICENSE-MIT", "LICENSE-APACHE", "src/lib.rs"} <= set(files), crate
        assert not [name for name in files if name.startswith(("tests/", "target/"))], crate


def test_the_version_is_the_same_everywhere() -> None:
    version = WORKSPACE["package"]["version"]
    assert "version" in PROJECT["dynamic"]  # taken from Cargo.toml
    for crate in PUBLISHED:
        assert WORKSPACE["dependencies"][crate]["version"] == version, crate
    abi = tomllib.loads((ROOT / "crates/stillrate-c/abi/Cargo.toml").read_text(encoding="utf-8"))
    assert abi["package"]["version"] == version
    citation = re.search(r"^version: (\S+)$", (ROOT / "CITATION.cff").read_text(encoding="utf-8"), flags=re.M)
    changes = re.search(r"^## (\S+)", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), flags=re.M)
    assert citation is not None and citation[1] == version
    assert changes is not None and changes[1] == version
    try:
        assert importlib.metadata.version("stillrate") == version
    except importlib.metadata.PackageNotFoundError:
        pytest.skip("run from the sources; all but the installed version was compared")


def test_the_oldest_supported_versions_are_said_where_they_are_set() -> None:
    page = (ROOT / "docs/contributing.md").read_text(encoding="utf-8")
    for name in ("docs/contributing.md", "docs/index.md", "README.md"):
        assert f"Rust {WORKSPACE['package']['rust-version']}" in (ROOT / name).read_text(encoding="utf-8"), name
    assert f"Python {PROJECT['requires-python'].removeprefix('>=')}" in page
    for requirement in PROJECT["dependencies"]:
        assert requirement.replace(">=", " ") in page, requirement


@pytest.mark.parametrize(
    ("expression", "allowed"),
    [
        ("MIT OR Apache-2.0", True),
        ("MIT/Apache-2.0", True),
        ("(MIT OR Apache-2.0) AND Unicode-3.0", True),
        ("MIT OR GPL-3.0-only", True),
        ("Apache-2.0 WITH LLVM-exception", True),
        ("MIT AND GPL-3.0-only", False),
        ("(MIT AND LGPL-2.1-or-later) OR AGPL-3.0-only", False),
        ("GPL-3.0-only", False),
        ("", False),
    ],
)
def test_a_licence_is_allowed_where_permissive_ones_suffice(expression: str, allowed: bool) -> None:
    assert licences.is_allowed(expression) is allowed


def test_every_crate_we_build_with_has_a_licence_we_may_ship_beside() -> None:
    _needs("cargo")
    found = licences.of_crates()
    assert len(found) > 50
    assert not {package: licence for package, licence in found.items() if not licences.is_allowed(licence)}


def test_every_python_package_we_pull_in_has_a_licence_we_may_ship_beside() -> None:
    found = licences.of_python()
    assert any(package.startswith("numpy ") for package in found)
    assert not {package: licence for package, licence in found.items() if not licences.is_allowed(licence)}
