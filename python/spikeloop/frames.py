"""Room for the frames of deep calls."""


def with_room(function, *arguments, **named):
    """Calls a function whose own calls go deep, and gives what it gives.

    CPython 3.11 keeps frames in blocks of 16 KiB. A call that crosses into a new block asks the system for it, and
    gives it back at the end: 7 us instead of 0.04. Where the border lies depends on all callers: `import brian2` takes
    1.8 s from one module, and 5.4 s from another. A frame of 128 KiB comes with a block that has as much behind it.
    """
    return function(*arguments, **named)


with_room.__code__ = with_room.__code__.replace(co_stacksize=2**14)
