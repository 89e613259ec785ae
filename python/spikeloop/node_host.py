"""What the library spikeloop_python_nodes calls: it loads files, makes nodes, describes exceptions.

Not for users. What crosses to C++ is strings, numbers, lists and NumPy arrays.
"""

import os
import sys
import traceback
import types

from .declare import NodeError, defined
from .steps import SPIKE, Session

PACKAGE = os.path.dirname(os.path.abspath(__file__))
LONGEST_MESSAGE = 1200  # characters; the border's buffer has 2048 bytes
MOST_LINES = 60  # of a traceback
READ_ONLY = ("assignment destination is read-only", "output array is read-only")


class LoadError(Exception):
    """The file is not a file of nodes; the text is the whole message."""


def begin():
    """Once, after the interpreter has started."""
    # The interpreter is never finalized, so nothing would write out what is left in a buffer.
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.reconfigure(line_buffering=True)


def load(path):
    """Runs the file; gives the Definitions of its nodes, in the order in which they stand there."""
    found = []

    def check(module, new):
        found.extend(each for each in new if each.module == module.__name__)
        _check_names(path, found)

    run(path, check)
    return found


def run(path, check=lambda module, new: None):
    """Runs the file; gives its module. check: called with it, and with what it has declared; if that raises, the
    module goes again."""
    name = os.path.splitext(os.path.basename(path))[0]
    if name in sys.stdlib_module_names or name in ("numpy", "spikeloop"):
        raise LoadError(f"plug-in '{path}': has the name of Python's own module '{name}', which it "
                        f"would hide; rename it, for example to {name}_node.py")
    module = types.ModuleType(_free_name(name))
    module.__file__ = os.path.abspath(path)
    directory = os.path.dirname(module.__file__)
    if directory not in sys.path:
        sys.path.append(directory)  # last: a numpy.py there hides nothing
    code = compile(_source(path), path, "exec")
    sys.modules[module.__name__] = module
    first = len(defined)
    try:
        exec(code, module.__dict__)
        check(module, defined[first:])
    except BaseException:
        del sys.modules[module.__name__]
        raise
    return module


def create(definition, name, seed, widths, parameters):
    """A Session. widths: in the order of the ports."""
    return Session(definition, name, seed, dict(zip(definition.ports, widths)), parameters)


def description(definition):
    """(name, text, ports, parameters): what spikeloop_node_class holds."""
    names = list(definition.ports)
    ports = [(name, port.text, port.kind, name in definition.inputs, port.width or 0,
              -1 if port.same_as is None else names.index(port.same_as))
             for name, port in definition.ports.items()]
    parameters = [each.plain(name) for name, each in definition.parameters.items()]
    return definition.name, definition.text, ports, parameters


def report(error, trace):
    """(message, lines): one line that says where and what, and the traceback's lines.

    The place is the innermost line of the user's, beside or below the file that began; else the
    innermost that is not of this package.
    """
    if isinstance(error, LoadError):
        return str(error), []
    frames = [frame for frame in traceback.extract_tb(trace)
              if not frame.filename.startswith((PACKAGE + os.sep, "<frozen "))]
    if isinstance(error, SyntaxError) and error.filename:
        place = f"{error.filename}:{error.lineno}: "
    elif frames:
        last = _users(frames)
        inside = "" if last.name == "<module>" else f"in {last.name}: "
        place = f"{last.filename}:{last.lineno}: {inside}"
    else:
        place = ""
    message = place + _what(error)
    if isinstance(error, NodeError):
        return _shortened(message), []  # its text says everything
    lines = ["Traceback (most recent call last):",
             *traceback.StackSummary.from_list(frames).format(),
             *traceback.TracebackException(type(error), error, None).format_exception_only()]
    lines = [_printable(line) for text in lines for line in text.rstrip().splitlines()]
    if len(lines) > MOST_LINES:
        lines[MOST_LINES // 2:-MOST_LINES // 2] = ["  ..."]
    return _shortened(message), lines


def _users(frames):
    """The innermost frame of a file in the folder of the first one's, or below it."""
    folder = os.path.dirname(os.path.realpath(frames[0].filename)) + os.sep
    own = [frame for frame in frames
           if os.path.realpath(frame.filename).startswith(folder)
           and not {"site-packages", "dist-packages"} & set(frame.filename.split(os.sep))]
    return (own or frames)[-1]


def _what(error):
    kind = type(error).__name__
    if isinstance(error, NodeError):
        return str(error)
    try:
        text = error.msg if isinstance(error, SyntaxError) else str(error)
        text = " ".join(text.split())
    except BaseException as second:  # whatever str() does, the first error is what counts
        return f"{kind} (its text cannot be had: str() raised {type(second).__name__})"
    if isinstance(error, ValueError) and text in READ_ONLY:
        text += "; inputs are read-only: work on a copy, as step.inputs['in'].copy()"
    if isinstance(error, SystemExit):
        text = f"{text or 0}; a node must not end the program: raise another exception"
    return f"{kind}: {text}" if text else kind


def _shortened(message):
    if len(message) > LONGEST_MESSAGE:
        half = LONGEST_MESSAGE // 2
        message = message[:half] + " ... " + message[-half:]
    return _printable(message)


def _printable(text):
    """Surrogates cannot be written as UTF-8."""
    return text.encode("utf-8", "backslashreplace").decode()


def _source(path):
    try:
        with open(path, "rb") as file:
            return file.read()
    except OSError as error:
        raise LoadError(f"plug-in '{path}': cannot be read: {error.strerror}") from None


def _free_name(name):
    """Two files of one name, in two directories, are two modules."""
    free, number = name, 2
    while free in sys.modules:
        free, number = f"{name}_{number}", number + 1
    return free


def _check_names(path, found):
    if not found:
        raise LoadError(f"plug-in '{path}': defines no node; write @spikeloop.node before a class "
                        "or a function")
    lines = {}
    for each in found:
        if each.name in lines:
            raise LoadError(f"plug-in '{path}': lines {lines[each.name]} and {each.line} both "
                            f"define the node '{each.name}'; give one another name, with "
                            "@spikeloop.node(name=...)")
        lines[each.name] = each.line


__all__ = ["SPIKE", "begin", "create", "description", "load", "report"]
