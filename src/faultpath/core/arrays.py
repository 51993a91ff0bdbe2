"""Operations on arrays, NumPy and torch alike, without importing torch.

Readings carry the scene batch on their first axis, `[B, ...]`. Nothing here reads a value back
from an accelerator except `to_numpy`, which is meant for the end of a run.
"""

from functools import lru_cache
from typing import Any, TypeAlias, cast

import array_api_compat
import numpy as np
from numpy.typing import NDArray

from faultpath.core.text import counted

Array: TypeAlias = Any
"""A NumPy array, or an array of any other namespace that `array_api_compat` knows."""

HostArray: TypeAlias = NDArray[Any]
"""A NumPy array."""

Constant: TypeAlias = float | tuple[float, ...] | tuple[tuple[float, ...], ...]
"""A number, or numbers along the last axes of a reading."""

_COMPAT = cast(Any, array_api_compat)
"""Untyped, because its annotations name array libraries that may not be installed."""

_is_torch: Any = _COMPAT.is_torch_array
_NAMESPACES: dict[type, Any] = {}


def namespace(array: Array) -> Any:
    """Return the array-API namespace of `array`, remembered by type (a look-up costs 2 us)."""
    kind = cast("type[Any]", type(array))
    if kind not in _NAMESPACES:
        _NAMESPACES[kind] = _COMPAT.array_namespace(array)
    return _NAMESPACES[kind]


def is_array(value: Any) -> bool:
    """Return whether `value` is an array of a namespace that `array_api_compat` knows."""
    if isinstance(value, np.ndarray):
        return True
    return bool(_COMPAT.is_array_api_obj(value)) and isinstance(
        getattr(value, "shape", None), tuple
    )


def device_kind(array: Array) -> str:
    """Return `cpu`, `cuda`, `meta` or the like."""
    return "cpu" if isinstance(array, np.ndarray) else str(_COMPAT.device(array)).partition(":")[0]


def read_only(array: Array) -> Array:
    """Return a read-only view of a NumPy array, and any other array as it is.

    The array itself stays writeable, because its owner may go on using it.
    """
    if not isinstance(array, np.ndarray):
        return array
    host = cast(HostArray, array)
    if not host.flags.writeable:
        return host
    view = host.view()
    view.setflags(write=False)
    return view


def copy(array: Array) -> Array:
    """Return an independent copy."""
    if type(array) is np.ndarray:
        return np.array(array)
    return namespace(array).asarray(array, copy=True)


def match_device(host: HostArray, reading: Array, dtype: Any = None) -> Array:
    """Return `host` in the namespace and on the device of `reading`, as `dtype` if given.

    On an accelerator the copy is queued, so the host does not wait for the device.
    """
    if isinstance(reading, np.ndarray):
        return host if dtype is None else host.astype(dtype, copy=False)
    return _to_device(namespace(reading).asarray(host, dtype=dtype), _COMPAT.device(reading))


_PINNING = {"cuda"}
"""Devices whose copies are asynchronous only from pinned memory."""


def _to_device(array: Array, device: Any) -> Array:
    if not _is_torch(array):
        return _COMPAT.to_device(array, device)
    if device.type in _PINNING:
        array = array.pin_memory()
    return array.to(device, non_blocking=True)


class Inexact(ValueError):
    """Numbers with fractions were to be held in the whole numbers or truths of a reading."""


def _check_exact(value: Any, reading: Array) -> None:
    if not _has_fractions(reading):
        numbers = np.asarray(value, np.float64)
        truths = bool(namespace(reading).isdtype(reading.dtype, "bool"))
        if np.any(numbers != (numbers.astype(bool) if truths else np.trunc(numbers))):
            raise Inexact


def like(host: HostArray, reading: Array) -> Array:
    """Return `host` in the namespace, on the device and with the dtype of `reading`.

    Raises `Inexact` for fractions where that holds none; so do `constant` and `filled`.
    """
    _check_exact(host, reading)
    return match_device(host, reading, reading.dtype)


@lru_cache(maxsize=1024)
def _constant_array(value: Any, xp: Any, dtype: Any, device: Any) -> Array:
    return _to_device(xp.asarray(value, dtype=dtype), device)


def constant(value: Constant, reading: Array) -> Any:
    """Return `value` ready to combine with `reading`; a tuple is copied to the device only once."""
    if not isinstance(value, tuple):
        return value
    _check_exact(value, reading)
    return _constant_array(value, namespace(reading), reading.dtype, _COMPAT.device(reading))


def filled(value: Constant, reading: Array) -> Array:
    """Return a new array like `reading` that holds `value` for every scene."""
    xp = namespace(reading)
    _check_exact(value, reading)
    if not isinstance(value, tuple):
        return xp.full_like(reading, value)
    return copy(xp.broadcast_to(constant(value, reading), reading.shape))


def rows(per_scene: Array, reading: Array) -> Array:
    """Return `per_scene` `[B]` with trailing axes of length one, to combine with `reading`."""
    if reading.ndim == 1:
        return per_scene
    return namespace(per_scene).reshape(per_scene, (-1,) + (1,) * (reading.ndim - 1))


def pick(condition: Array, yes: Array, no: Array) -> Array:
    """Return, scene by scene, `yes` where `condition` `[B]` holds and `no` elsewhere."""
    return namespace(yes).where(rows(condition, yes), yes, no)


def differs(value: Array, reading: Array) -> Array:
    """Return `[B]`: whether any number of a scene differs. A NaN equals a NaN."""
    unequal = value != reading
    if _has_fractions(reading):
        unequal = unequal & ((value == value) | (reading == reading))
    if unequal.ndim == 1:
        return unequal
    xp = namespace(unequal)
    return xp.any(xp.reshape(unequal, (unequal.shape[0], -1)), axis=1)


def _has_fractions(reading: Array) -> bool:
    if isinstance(reading, np.ndarray):
        return cast(HostArray, reading).dtype.kind == "f"
    return bool(namespace(reading).isdtype(reading.dtype, "real floating"))


def is_zero(value: Constant) -> bool:
    """Return whether every number of `value` is zero."""
    return not np.any(np.asarray(value))


def misfit(name: str, value: Constant, shape: tuple[int, ...]) -> str | None:
    """Return why `value` does not fit one scene's reading of `shape`; `None` if it does."""
    own = np.shape(np.asarray(value, dtype=np.float64))
    if not own or (len(own) <= len(shape) and shape[len(shape) - len(own) :] == own):
        return None
    reading = f"the reading of one scene has {_size(shape)}"
    advice = "give one number" + (", or as many as it has" if shape else "")
    return f"{name} has {_size(own)}, and {reading}: {advice}"


def _size(shape: tuple[int, ...]) -> str:
    """Return `3 numbers`, or the shape of what has no or several axes."""
    if not shape:
        return "one number"
    return counted(shape[0], "number") if len(shape) == 1 else f"the shape {list(shape)}"


def to_numpy(array: Any) -> HostArray:
    """Return `array` as NumPy; this waits for the device that holds it."""
    if type(array) is np.ndarray:
        return array
    if _is_torch(array):
        host = array.detach().cpu()
        # NumPy has no bfloat16, each number of which is one in single precision too.
        return np.asarray(host.float() if str(host.dtype) == "torch.bfloat16" else host)
    return np.asarray(array)


def row_bytes(array: Array) -> NDArray[np.uint8]:
    """Return the bytes of each row, `[B, bytes]`; this waits for the device.

    Any type of number will do, also torch's bfloat16, which NumPy does not have.
    """
    if type(array) is not np.ndarray and _is_torch(array):
        flat = array.detach().cpu().reshape(array.shape[0], -1).contiguous()
        return to_numpy(flat.view(namespace(array).uint8))
    return np.ascontiguousarray(to_numpy(array).reshape(array.shape[0], -1)).view(np.uint8)


def together(one: Any, other: Any) -> tuple[Any, Any]:
    """Return two masks or counts on one device: on the accelerator if either is there.

    A bool or an int combines with anything and is returned as it is.
    """
    if isinstance(one, int) or isinstance(other, int):
        return one, other
    if type(one) is type(other) is np.ndarray:
        return one, other
    if namespace(one) is namespace(other) and one.device == other.device:
        return one, other
    if isinstance(one, np.ndarray) or (str(one.device) == "cpu" and _is_torch(other)):
        return match_device(to_numpy(one), other), other
    return one, match_device(to_numpy(other), one)
