"""Results as the plain data of report.json."""

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

Content = Mapping[str, Any]


def content_of(result: Any) -> Any:
    """A result as tables, lists, numbers and texts: as its `to_dict` decides, or by its fields."""
    if hasattr(result, "to_dict"):
        return content_of(result.to_dict())
    if dataclasses.is_dataclass(result):
        names = [field.name for field in dataclasses.fields(result)]
        return {name: content_of(getattr(result, name)) for name in names}
    if isinstance(result, Mapping):
        return table_of(result)
    # JSON has no infinity
    if isinstance(result, float) and math.isinf(result):
        return None
    if isinstance(result, list | tuple):
        return [content_of(x) for x in result]
    return result


def table_of(results: Mapping[str, Any]) -> dict[str, Any]:
    """Results by name, as tables, lists, numbers and texts."""
    return {name: content_of(x) for name, x in results.items()}
