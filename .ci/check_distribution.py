"""Checks a built distribution against git: `python .ci/check_distribution.py FOLDER`.

The sdist has to hold every tracked file, and the wheel the tracked files of the package and nothing else.
"""

import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path


def main(folder: Path) -> None:
    """Raises SystemExit if a file is missing, or is where it should not be."""
    listed = subprocess.run(["git", "ls-files", "-z"], capture_output=True, text=True, check=True).stdout
    tracked = {name for name in listed.split("\0") if name and Path(name).is_file()}
    (sdist,), (wheel,) = folder.glob("*.tar.gz"), folder.glob("*.whl")
    with tarfile.open(sdist) as archive:
        packed = {member.name.partition("/")[2] for member in archive.getmembers() if member.isfile()}
    with zipfile.ZipFile(wheel) as archive:
        installed = {name for name in archive.namelist() if ".dist-info/" not in name}
    package = {name for name in tracked if name.startswith("symjax/")}
    wrong = {
        f"not in {sdist.name}": tracked - packed,
        f"not in {wheel.name}": package - installed,
        f"in {wheel.name}, but not part of the package": installed - package,
    }
    complaints = [f"{what}: {', '.join(sorted(names))}" for what, names in wrong.items() if names]
    if complaints:
        sys.exit("\n".join(complaints))
    print(f"{sdist.name}: {len(packed)} files; {wheel.name}: {len(installed)} files")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
