"""Systems that declare what a plan needs, and never run."""

from faultpath.system import Library, SceneRef, System


class Still(System):
    """A subclass has an interface and variants."""

    control_dt_s, scenes, named = 0.1, 5, "s{}"
    interface, variants = None, {}

    def library(self, name: str) -> Library:
        scenes = tuple(SceneRef(self.named.format(i), i) for i in range(self.scenes))
        return Library(name, scenes, f"{name}-1")

    def run(self, variant, scenes, taps, seed):
        raise AssertionError("it never runs")
