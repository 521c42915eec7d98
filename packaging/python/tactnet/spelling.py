"""How layers are spelled in C++."""


def call(name, *arguments):
    """A template with its arguments, each (text, default); defaults at the end are left out."""
    arguments = list(arguments)
    while arguments and arguments[-1][0] == arguments[-1][1]:
        arguments.pop()
    return f"{name}<{', '.join(text for text, _ in arguments)}>" if arguments else name


def extent(rows, columns):
    return str(rows) if rows == columns else f"extent2d{{{rows}, {columns}}}"
