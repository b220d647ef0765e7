"""``stillrate export-c``: a configuration as source code for firmware."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from stillrate.cli.options import Force, load_settings, refuse_no_folder, refuse_taken


def command(
    config: Annotated[Path, Parameter(name="CONFIG")],
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    dtype: Literal["float32", "float64"] = "float32",
    force: Force = False,
) -> int:
    """Write a checked configuration as C and Rust source, with a self-test for the firmware's start-up.

    Parameters
    ----------
    config
        Settings (TOML), as `tune` writes them.
    output
        Folder for stillrate.h, stillrate_config.h, stillrate_selftest.h and stillrate_config.rs; made if missing.
    dtype
        Number type of the firmware.
    force
        Overwrite files.
    """
    from rich.console import Console

    from stillrate import _native
    from stillrate.io.safely import atomic

    refuse_no_folder(output)
    settings = load_settings(config)
    texts = _native.export_c(settings.method, settings.settings(), dtype == "float32")
    names = ["stillrate_config.h", "stillrate_selftest.h", "stillrate_config.rs", "stillrate.h"]
    paths = [output / name for name in names]
    output.mkdir(parents=True, exist_ok=True)
    refuse_taken(paths, force=force)
    with ExitStack() as stack:
        for path, text in zip(paths, texts, strict=True):
            stack.enter_context(atomic(path, force=force)).write_text(text, encoding="utf-8")
    Console(stderr=True).print(f"wrote {', '.join(names)} in {output}", highlight=False, markup=False, soft_wrap=True)
    return 0
