"""The runner of experiments/ locks files and kills process groups, as Linux and macOS do and Windows does not."""

import sys

collect_ignore_glob = ["*/test_*.py"] if sys.platform == "win32" else []
