"""Every code block of the documentation and of the README does what its page says."""

from __future__ import annotations

import json
import re
import runpy
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "docs" / "_ext"))

from blocks import Block, BlockError, Session, blocks  # noqa: E402

PAGES = sorted(
    path for path in (ROOT / "docs").rglob("*.md") if "generated" not in path.relative_to(ROOT / "docs").parts
)
TEXTS = [ROOT / "README.md", *PAGES]


def _name(path: Path) -> str:
    return str(path.relative_to(ROOT))


@pytest.mark.parametrize("page", TEXTS, ids=_name)
def test_every_block_of_the_page_runs(page: Path, tmp_path: Path) -> None:
    session = Session(tmp_path)
    for block in blocks(page.read_text(encoding="utf-8")):
        session.run(block, _name(page))


def test_a_block_that_is_not_run_gives_its_reason_in_words() -> None:
    for page in TEXTS:
        text = page.read_text(encoding="utf-8")
        marks = len(re.findall(r"^<!-- not run:", text, flags=re.M))
        excepted = [block for block in blocks(text) if block.reason is not None]
        assert len(excepted) == marks, f"{_name(page)}: a mark that stands before no block"
        assert all(len(str(block.reason).split()) >= 4 for block in excepted), _name(page)


def test_every_rust_block_is_among_the_examples_of_the_crates() -> None:
    listed = (ROOT / "crates/stillrate-lab/src/lib.rs").read_text(encoding="utf-8")
    for page in PAGES:
        rust = [b for b in blocks(page.read_text(encoding="utf-8")) if b.language == "rust" and b.reason is None]
        if rust:
            assert f'"../../../{_name(page)}"' in listed, _name(page)


def test_every_method_has_a_page_with_its_settings_and_its_picture() -> None:
    from stillrate.config import methods

    for name, cls in methods().items():
        text = (ROOT / f"docs/methods/{name}.md").read_text(encoding="utf-8")
        assert f"{{settings}} {cls.__name__}" in text, name
        assert f"/generated/methods/{name}.svg" in text, name
        for heading in ("## Equations", "## Settings", "## When it helps", "## When it hurts", "## Source"):
            assert heading in text, f"{name}: {heading}"


def test_the_costs_in_words_are_those_of_the_counted_instructions() -> None:
    counts = json.loads((ROOT / "benches/instructions.json").read_text(encoding="utf-8"))["per_sample"]
    one, many = ", f64 x 1", ", f32 x 16 avx2"
    # Words such as "about four times": as far off as rounding them to whole numbers allows, and a little.
    assert 3.4 < counts[f"one-euro{one}"] / counts[f"pt1{one}"] < 4.6
    assert 5.4 < counts[f"one-euro{many}"] / counts[f"pt1{many}"] < 6.8
    assert 80 < counts[f"variable-forgetting{one}"] < 125
    assert 0.4 < counts[f"ms-imm-ikf, light{one}"] / counts[f"ms-imm-ikf{one}"] < 0.6
    assert max(counts, key=lambda name: counts[name] if name.endswith(one) else 0.0) == f"ms-imm-ikf{one}"


def test_the_page_of_the_benches_holds_what_was_measured() -> None:
    page = runpy.run_path(str(ROOT / "benches/tables.py"))["page"]
    assert (ROOT / "benches/README.md").read_text(encoding="utf-8") == page()


def test_the_number_of_filters_in_words_is_right() -> None:
    from stillrate.config import methods

    said = [page for page in TEXTS if re.search(r"\bfifteen\b", page.read_text(encoding="utf-8"), flags=re.I)]
    assert len(methods()) == 15, f"say so in {[_name(page) for page in said]}"


def _one(text: str) -> Block:
    return blocks(text)[0]


@pytest.mark.parametrize(
    "text",
    [
        "```console\nstillrate filter nowhere.csv -o clean.csv\n```",
        "```console\nfalse\n```",
        "```python\nassert False\n```",
        "```toml\nmethod = 'pt1'\nsample_rate_hz = -1.0\n```",
        "```toml\nno toml\n```",
        "```basic\n10 PRINT\n```",
    ],
)
def test_a_wrong_block_is_found(text: str, tmp_path: Path) -> None:
    with pytest.raises(BlockError):
        Session(tmp_path).run(_one(text))


def test_a_block_with_a_reason_is_left_alone_and_the_next_is_not(tmp_path: Path) -> None:
    first, second = blocks(
        "<!-- not run: needs a sensor on the port -->\n```console\nfalse\n```\n\n```console\nfalse\n```"
    )
    assert Session(tmp_path).run(first) == ""
    with pytest.raises(BlockError):
        Session(tmp_path).run(second)


def test_formulas_use_no_accents_which_browsers_lose() -> None:
    for page in PAGES:
        found = re.findall(r"\\(?:d{0,3}dot|hat|bar|tilde|vec)\b", page.read_text(encoding="utf-8"))
        assert not found, f"{_name(page)}: {found[0]}: write a prime, or another letter"


def test_every_public_name_has_its_place_in_the_reference() -> None:
    import stillrate as sr

    text = "\n".join(path.read_text(encoding="utf-8") for path in (ROOT / "docs/reference").glob("*.md"))
    for name in set(sr.__all__) - {"__version__"}:
        asked = rf"auto(?:class|function|exception)::\s+{name}$|automodule:: stillrate\.{name}$"
        assert re.search(asked, text, flags=re.M), name


def test_the_table_of_formats_holds_every_ending() -> None:
    from stillrate.io import readable, writable

    rows = re.findall(r"^\| (`\..+?) \|.*\| (yes)? ?\|$", (ROOT / "docs/reference/logs.md").read_text(), flags=re.M)
    told = {ending: bool(written) for cell, written in rows for ending in re.findall(r"`(\.\w+)`", cell)}
    assert told == {ending: ending in writable() for ending in readable()}


def _modules() -> list[str]:
    import pkgutil

    import stillrate

    found = ["stillrate", *(item.name for item in pkgutil.walk_packages(stillrate.__path__, "stillrate."))]
    return [name for name in found if not name.endswith("__main__")]


def test_the_examples_in_docstrings_run() -> None:
    import doctest
    import importlib

    tried, wrong = 0, []
    for name in _modules():
        try:
            module = importlib.import_module(name)
        except ImportError:  # an extra that is not installed
            continue
        result = doctest.testmod(module, verbose=False)
        wrong += [name] * (result.failed > 0)
        tried += result.attempted
    assert not wrong and tried > 80, (wrong, tried)


def test_no_example_of_a_class_is_overlooked() -> None:
    """Of a compiled class doctest sees the class and its methods, but not its properties: an example there would never run."""
    import doctest
    import importlib
    import inspect

    run: set[str] = set()
    for name in _modules():
        try:
            module = importlib.import_module(name)
        except ImportError:  # an extra that is not installed
            continue
        run |= {test.name for test in doctest.DocTestFinder().find(module) if test.examples}
        for kind in [item for item in vars(module).values() if inspect.isclass(item) and item.__module__ == name]:
            members = {key: m for key, m in vars(kind).items() if inspect.isroutine(m) or inspect.isdatadescriptor(m)}
            for place, item in {"": kind, **{f".{key}": member for key, member in members.items()}}.items():
                own = getattr(item, "__module__", name) == name
                shown = own and ">>> " in (item.__doc__ or "")
                assert not shown or f"{name}.{kind.__qualname__}{place}" in run, f"{kind.__qualname__}{place}"
    assert {"stillrate.Filter", "stillrate.Filter.update"} <= run


def test_a_page_that_fetches_from_elsewhere_or_leads_nowhere_is_found(tmp_path: Path) -> None:
    sys.path.insert(0, str(ROOT / "docs"))
    from check_site import problems

    sound = "<img src='a.svg'><a href='#here' id='here'>x</a><a href='https://example.org'>a link is no fetch</a>"
    (tmp_path / "a.svg").write_text("<svg/>")
    (tmp_path / "index.html").write_text(sound)
    assert problems(tmp_path) == []
    for wrong in (
        "<script src='https://example.org/a.js'></script>",
        "<link rel='stylesheet' href='//example.org/a.css'>",
        "<a href='nowhere.html'>x</a>",
        "<a href='index.html#nowhere'>x</a>",
        "<img src='gone.png'>",
    ):
        (tmp_path / "page.html").write_text(wrong)
        assert len(problems(tmp_path)) == 1, wrong
    (tmp_path / "page.html").write_text("")
    (tmp_path / "a.css").write_text('@font-face { src: url("https://example.org/font.woff2") }')
    assert len(problems(tmp_path)) == 1
