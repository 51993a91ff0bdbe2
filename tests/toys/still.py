"""Systems that declare what a plan needs, and never run."""

from faultpath.system import Library, SceneRef, System, Variant


class Still(System):
    """A subclass has an interface, and variants or by variant the readers it has."""

    control_dt_s, scenes, named = 0.1, 5, "s{}"
    interface, variants = None, {}
    readers: dict[str, set[str]]

    def __init_subclass__(cls) -> None:
        if "readers" in vars(cls):
            cls.variants = {v: Variant(v, "", frozenset(r)) for v, r in cls.readers.items()}

    def library(self, name: str) -> Library:
        scenes = tuple(SceneRef(self.named.format(i), i) for i in range(self.scenes))
        return Library(name, scenes, f"{name}-1")

    def run(self, variant, scenes, taps, seed):
        raise AssertionError("it never runs")
