"""The kinds of value that messages are made of."""

from collections.abc import Collection
from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field
from pydantic_core import PydanticCustomError

from physgnn.serving.scene.colours import FIELDS
from physgnn.serving.scene.section import AXES

MAX_MM = 1e5  # no place in a room is farther away


def _key_of(table: Collection[str]) -> AfterValidator:
    """Return a check that a text is a key of a table, as the table is then."""

    def check(name: str) -> str:
        if name not in table:
            known = " or ".join(f"'{key}'" for key in table)
            raise PydanticCustomError(
                "key", "Input should be {known}", {"known": known}
            )
        return name

    return AfterValidator(check)


Number = Annotated[float, Field(allow_inf_nan=False)]
Coordinate = Annotated[Number, Field(ge=-MAX_MM, le=MAX_MM)]
FieldName = Annotated[str, _key_of(FIELDS)]
Axis = Annotated[str, _key_of(AXES)]


class CheckedMessage(BaseModel):
    """A message with these fields and no others, of exactly these types."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)
