"""The files that a command is to write, looked at before the work."""

from collections.abc import Mapping
from pathlib import Path

from symjax.errors import InvalidArgumentError


def check_outputs(
    outputs: Mapping[str, Path | None], force: bool, *inputs: Path, endings: Mapping[str, tuple[str, ...]] | None = None
) -> None:
    """Refuse before the work, not after it.

    Args:
        outputs: the path that each option names.
        force: files that exist may be replaced.
        *inputs: files that are read.
        endings: those that the path of an option may have, where its format depends on it.

    Raises:
        InvalidArgumentError: a path that cannot be written to, or must not be.
    """
    seen = {path.resolve() for path in inputs}
    for option, path in outputs.items():
        if path is None:
            continue
        known = (endings or {}).get(option, ())
        why = ""
        if path.resolve() in seen:
            why = "it is the input or another output"
        elif path.is_dir():
            why = "it is a folder"
        elif path.exists() and not force:
            why = "it exists; use --force to replace it"
        elif not path.parent.is_dir():
            why = f"there is no folder {str(path.parent)!r}"
        elif known and path.suffix.lower() not in known:
            why = f"the format follows from the ending; end the name in {' or '.join(known)}"
        if why:
            raise InvalidArgumentError(f"cannot write {str(path)!r} (--{option}): {why}")
        seen.add(path.resolve())
