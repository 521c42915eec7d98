"""Files that are whole or not there."""

import contextlib
import os


def write_safely(path, data):
    """All or nothing; a file that holds the same stays, so that nothing is compiled again."""
    if os.path.exists(path) and not os.path.isfile(path):
        raise OSError(f"{path}: expected a file, found a folder or a device")
    if os.path.exists(path):
        with open(path, "rb") as file:
            if file.read() == data:
                return
    partial = f"{path}.partial"
    try:
        with open(partial, "wb") as file:
            file.write(data)
        os.replace(partial, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(partial)
        raise
