"""Files that are never there by half, as write_file() of core."""


def write_whole(path, text):
    """Writes beside the path and renames. @raises OSError"""
    new = path.with_name(path.name + ".new")
    new.write_text(text, encoding="utf-8")
    new.replace(path)
