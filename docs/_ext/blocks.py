"""Code blocks of a page: found in its Markdown, and run in order in a folder of their own.

The same functions serve the build of the site, which shows what the blocks print, and the tests.

A fence says what happens to its block: ``console`` holds commands, one a line; ``python`` runs in one namespace a
page; ``toml`` must parse, and build a configuration where it names a method; ``c`` must compile beside the
files that ``export-c`` wrote before it on the page; ``rust`` runs with the examples of the crates. Words behind the
language: ``output`` (the site shows what was printed), ``hidden`` (the site leaves the block out). A comment
``<!-- not run: REASON -->`` before a fence excepts it, and ``<!-- run first: COMMAND -->`` prepares what it needs
where a hidden block would show (the README).
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

LANGUAGES = {"console", "python", "toml", "c", "rust", "text", ""}
"""What a fence may name; ``text`` and nothing are not run."""

_OPENING = re.compile(r"^(`{3,})([^`]*)$")
_EXCEPTED = re.compile(r"^<!-- not run: (.+) -->$")
_FIRST = re.compile(r"^<!-- run first: (.+) -->$")
_WIDTH = "96"


@dataclass(frozen=True)
class Block:
    """A fenced block: its lines in the page are ``first`` (the opening fence) to before ``after``."""

    language: str
    options: frozenset[str]
    code: str
    first: int
    after: int
    reason: str | None
    prepare: str | None = None


class BlockError(AssertionError):
    """A block that did not do what the page says."""


def blocks(page: str) -> list[Block]:
    """Return the code blocks of a page in order; directives (``{name}``) are none."""
    lines = page.split("\n")
    found: list[Block] = []
    at = 0
    while at < len(lines):
        opening = _OPENING.match(lines[at])
        if opening is None:
            at += 1
            continue
        end = next(
            (i for i in range(at + 1, len(lines)) if lines[i].rstrip() == opening[1]),
            len(lines),
        )
        words = opening[2].split()
        if not (words and words[0].startswith("{")):
            before = _line_before(lines, at)
            excepted, first = _EXCEPTED.match(before), _FIRST.match(before)
            found.append(
                Block(
                    language=words[0] if words else "",
                    options=frozenset(words[1:]),
                    code="\n".join(lines[at + 1 : end]),
                    first=at,
                    after=min(end + 1, len(lines)),
                    reason=excepted[1] if excepted else None,
                    prepare=first[1] if first else None,
                )
            )
        at = end + 1
    return found


def _line_before(lines: list[str], at: int) -> str:
    while at > 0 and not lines[at - 1].strip():
        at -= 1
    return lines[at - 1].strip() if at > 0 else ""


@dataclass
class Session:
    """A page being run: its folder and what its Python blocks have defined."""

    folder: Path
    names: dict[str, Any] = field(default_factory=lambda: {"__name__": "__page__"})

    def run(self, block: Block, where: str = "page") -> str:
        """Run one block and return what it printed.

        Raises
        ------
        BlockError
            If a command fails, Python raises, a file does not parse or source does not compile.
        """
        if block.language not in LANGUAGES:
            raise BlockError(
                f"{where}:{block.first + 1}: language {block.language!r} (one of {sorted(LANGUAGES)})"
            )
        if block.reason is not None or block.language in ("text", "", "rust"):
            return ""
        place = f"{where}:{block.first + 1}"
        with _inside(self.folder):
            if block.prepare is not None:
                self._command(block.prepare, place)
            if block.language == "console":
                return "".join(self._command(line, place) for line in _commands(block.code))
            if block.language == "python":
                return self._python(block.code, place)
            if block.language == "toml":
                return _check_toml(block.code, place)
            return _compile_c(block.code, place)

    def _command(self, line: str, place: str) -> str:
        if line.startswith("stillrate ") and not re.search(r"[|<>&;]", line):
            from stillrate.cli import main

            printed = io.StringIO()
            with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
                code = main(shlex.split(line)[1:])
            text = printed.getvalue()
        else:
            done = subprocess.run(
                ["sh", "-c", line],
                check=False,
                capture_output=True,
                text=True,
                timeout=120,
                env=_environment(),
            )
            code, text = done.returncode, done.stdout + done.stderr
        if code != 0:
            raise BlockError(f"{place}: exit code {code} from: {line}\n{text}")
        return text

    def _python(self, code: str, place: str) -> str:
        printed = io.StringIO()
        try:
            with contextlib.redirect_stdout(printed):
                exec(compile(code, place, "exec"), self.names)
        except Exception as error:
            raise BlockError(f"{place}: {type(error).__name__}: {error}\n{code}") from error
        return printed.getvalue()


def _commands(code: str) -> list[str]:
    joined = re.sub(r"\\\n\s*", "", code)
    return [
        line.strip()
        for line in joined.split("\n")
        if line.strip() and not line.startswith("#")
    ]


def _environment() -> dict[str, str]:
    """Return the environment of a shell in which ``stillrate`` and ``python`` are those that run now."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    return {**os.environ, "PATH": path}


@contextlib.contextmanager
def _inside(folder: Path) -> Iterator[None]:
    kept = {name: os.environ.get(name) for name in ("COLUMNS", "MPLBACKEND")}
    os.environ.update({"COLUMNS": _WIDTH, "MPLBACKEND": "agg"})
    try:
        with contextlib.chdir(folder):
            yield
    finally:
        for name, value in kept.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def _check_toml(code: str, place: str) -> str:
    try:
        table = tomllib.loads(code)
    except tomllib.TOMLDecodeError as error:
        raise BlockError(f"{place}: {error}") from error
    if "method" in table:
        from stillrate import ConfigError, load_config

        path = Path("block-of-the-page.toml")
        path.write_text(code, encoding="utf-8")
        try:
            load_config(path)
        except ConfigError as error:
            raise BlockError(f"{place}: {error}") from error
        finally:
            path.unlink()
    return ""


def _compile_c(code: str, place: str) -> str:
    compiler = shutil.which("cc")
    if compiler is None:
        return ""
    includes = [f"-I{header.parent}" for header in sorted(Path().rglob("stillrate.h"))]
    flags = [
        "-std=c99",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-c",
        "-x",
        "c",
        "-",
        "-o",
        os.devnull,
    ]
    done = subprocess.run(
        [compiler, *includes, *flags],
        check=False,
        input=code,
        capture_output=True,
        text=True,
    )
    if done.returncode != 0:
        raise BlockError(f"{place}: does not compile:\n{done.stderr}")
    return ""
