"""LeRobot's `eval_info.json`: episodes by task, or by seed as before there were tasks."""

from collections.abc import Iterator, Mapping
from typing import Any, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from faultpath.core.files.plain import Misread


class _Episode(BaseModel):
    model_config = ConfigDict(extra="allow")

    episode_ix: Any
    seed: Any


class _Metrics(BaseModel):
    success: list[Any] = Field(alias="successes")
    sum_reward: list[Any] | None = Field(default=None, alias="sum_rewards")
    max_reward: list[Any] | None = Field(default=None, alias="max_rewards")

    @model_validator(mode="after")
    def _of_one_length(self) -> Self:
        if len({len(values) for _, values in self if values is not None}) > 1:
            raise ValueError("holds lists of different lengths, and must have one entry an episode")
        return self


class _Task(BaseModel):
    task_group: Any
    task_id: Any
    metrics: _Metrics


class _Info(BaseModel):
    per_episode: list[_Episode] | None = None
    per_task: list[_Task] | None = None


def cells(info: Mapping[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the episodes: by task and place, or by seed where the file gives one."""
    read = _Info.model_validate(info)
    if read.per_episode is not None:
        for number, episode in enumerate(read.per_episode):
            seed = episode.seed
            scene = f"episode {episode.episode_ix}" if seed is None else f"seed {seed}"
            yield f", episode {number}", {**episode.model_dump(), "scene": scene, "seed": None}
    elif read.per_task is not None:
        for evaluation in read.per_task:
            task = f"{evaluation.task_group}/{evaluation.task_id}"
            columns = evaluation.metrics.model_dump(exclude_none=True)
            for at, row in enumerate(zip(*columns.values(), strict=True)):
                entries = dict(zip(columns, row, strict=True))
                yield f", {task}, episode {at}", {**entries, "task": task, "scene": f"episode {at}"}
    else:
        raise Misread(
            "is neither LeRobot's eval_info.json (per_task or per_episode) nor a log of Inspect "
            "(eval and samples); give one of these, or columns as CSV"
        )
