"""A fault of several sizes, as text: `gain:scale=0.8,0.9,1.1,onset=20@observer`."""

from faultpath.errors import UserError


def each_size(text: str) -> tuple[str, ...]:
    """Return the text of a fault for each of its sizes; a fault of one size is its own only text.

    Sizes stand after each other, apart from options by having no name. `UserError` for a size that
    is given twice, or where the first is missing.
    """
    head, *rest = text.split(",")
    more = [item.strip() for item in rest if _is_size(item)]
    if not more:
        return (text,)
    what, equals, first = head.partition("=")
    if not equals or not _is_size(first):
        raise UserError(
            f"fault '{text}': {more[0]} is a further size, and there is no first: write "
            "CHANNEL:KIND=SIZE,SIZE"
        )
    sizes = [size.partition("@")[0].strip() for size in (first, *more)]
    if len({_value(size) for size in sizes}) < len(sizes):
        raise UserError(f"fault '{text}' names a size twice: name each once")
    at = "".join(size[size.index("@") :] for size in (first, *more) if "@" in size)
    options = [item for item in rest if not _is_size(item)]
    return tuple(",".join((f"{what}={size}{at}", *options)) for size in sizes)


def _is_size(item: str) -> bool:
    try:
        _value(item.partition("@")[0])
    except ValueError:
        return False
    return True


def _value(size: str) -> tuple[float, ...]:
    return tuple(map(float, size.split("/")))
