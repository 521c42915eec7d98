"""Files that are whole or not there."""

import os


def write_safely(path, data):
    """All or nothing; a file that holds the same stays, so that nothing is compiled again."""
    if os.path.exists(path):
        with open(path, "rb") as file:
            if file.read() == data:
                return
    partial = f"{path}.partial"
    with open(partial, "wb") as file:
        file.write(data)
    os.replace(partial, path)
