"""`net.json`: reading it, unknown fields refused by their names, and writing it as the program does."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from typing import Any

from deepshade.attributes import ATTRIBUTES
from deepshade.effects import EFFECTS
from deepshade.errors import SpecError
from deepshade.spec import (
    Block,
    Correction,
    Estimate,
    Filter,
    Folded,
    Head,
    Image,
    Input,
    Joined,
    NetSpec,
    Plain,
    Pooled,
    Reach,
    Source,
)

#: Reads a value that stands at a place, such as `blocks[2].kernel`.
Parser = Callable[[Any, str], Any]


def read(text: str | bytes) -> NetSpec:
    """The spec that a `net.json` states. Whether a network can have it is for `spec_check` to say."""
    try:
        value = json.loads(text)
    except ValueError as error:
        raise SpecError(f"is not JSON: {error}") from error
    fields: dict[str, Parser] = {
        "effect": _one_of(EFFECTS),
        "inputs": _list(_one_of(ATTRIBUTES)),
        "leak": _number,
        "blocks": _list(_block),
        "reach": _reach,
    }
    optional: dict[str, Parser] = {
        "estimates": _list(_estimate),
        "colour": _one_of(("mono", "rgb")),
        "head": _head,
        "trained": _or_none(_trained),
        "environment": _or_none(_environment),
    }
    return NetSpec(**_record(value, "", fields, optional))


def write(spec: NetSpec) -> str:
    """The text of a `net.json`."""
    value: dict[str, Any] = {"effect": spec.effect, "inputs": list(spec.inputs)}
    if spec.estimates:
        value["estimates"] = [_estimate_value(estimate) for estimate in spec.estimates]
    value["colour"] = spec.colour
    value["leak"] = spec.leak
    value["blocks"] = [_block_value(block) for block in spec.blocks]
    value["head"] = _head_value(spec.head)
    value["reach"] = vars(spec.reach)
    if spec.trained is not None:
        value["trained"] = spec.trained
    if spec.environment is not None:
        value["environment"] = spec.environment
    return json.dumps(value, indent=2) + "\n"


def _record(
    value: Any, place: str, required: Mapping[str, Parser], optional: Mapping[str, Parser] | None = None
) -> dict[str, Any]:
    """The fields of an object: all that are required, and no others than these and the optional ones."""
    if not isinstance(value, dict):
        raise SpecError(f"{_named(place)} has to be an object with {', '.join(required)}")
    known = {**required, **(optional or {})}
    for name in value:
        if name not in known:
            raise SpecError(f"unknown field `{_at(place, name)}`; known are {', '.join(known)}")
    for name in required:
        if name not in value:
            raise SpecError(f"field `{_at(place, name)}` is missing")
    return {name: known[name](field, _at(place, name)) for name, field in value.items()}


def _tagged(value: Any, place: str, units: Mapping[str, Any], tagged: Mapping[str, Parser]) -> Any:
    """One of several forms: a bare name, or a name with a value."""
    if isinstance(value, str) and value in units:
        return units[value]
    if isinstance(value, dict) and len(value) == 1:
        [(name, content)] = value.items()
        if name in tagged:
            return tagged[name](content, _at(place, name))
    raise SpecError(f"{_named(place)} is {json.dumps(value)}; known are {', '.join([*units, *tagged])}")


def _at(place: str, name: str) -> str:
    return f"{place}.{name}" if place else name


def _named(place: str) -> str:
    return f"`{place}`" if place else "a spec"


def _one_of(names: Mapping[str, Any] | tuple[str, ...]) -> Parser:
    def parse(value: Any, place: str) -> str:
        if not isinstance(value, str) or value not in names:
            raise SpecError(f"{_named(place)} is {json.dumps(value)}; known are {', '.join(names)}")
        return value

    return parse


def _list(parser: Parser, length: int | None = None) -> Parser:
    def parse(value: Any, place: str) -> tuple[Any, ...]:
        if not isinstance(value, list) or length not in (None, len(value)):
            count = "" if length is None else f" of {length}"
            raise SpecError(f"{_named(place)} has to be a list{count}")
        return tuple(parser(item, f"{place}[{index}]") for index, item in enumerate(value))

    return parse


def _or_none(parser: Parser) -> Parser:
    return lambda value, place: None if value is None else parser(value, place)


def _count(value: Any, place: str) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or value < 0:
        raise SpecError(f"{_named(place)} is {json.dumps(value)}; it has to be a whole number")
    return value


def _number(value: Any, place: str) -> float:
    if not isinstance(value, int | float) or isinstance(value, bool) or not math.isfinite(value):
        raise SpecError(f"{_named(place)} is {json.dumps(value)}; it has to be a number")
    return float(value)


def _text(value: Any, place: str) -> str:
    if not isinstance(value, str):
        raise SpecError(f"{_named(place)} is {json.dumps(value)}; it has to be a text")
    return value


def _flag(value: Any, place: str) -> bool:
    if not isinstance(value, bool):
        raise SpecError(f"{_named(place)} is {json.dumps(value)}; it has to be true or false")
    return value


def _block(value: Any, place: str) -> Block:
    required = {"name": _text, "reads": _source, "kernel": _count, "outputs": _count}
    return Block(**_record(value, place, required, {"groups": _count}))


def _source(value: Any, place: str) -> Source:
    def joined(value: Any, place: str) -> Joined:
        return Joined(**_record(value, place, {"coarse": _count, "skip": _count}, {"groups": _count}))

    tagged: dict[str, Parser] = {
        "plain": lambda value, place: Plain(_count(value, place)),
        "pooled": lambda value, place: Pooled(_count(value, place)),
        "joined": joined,
    }
    source: Source = _tagged(value, place, {"input": Input(), "folded": Folded()}, tagged)
    return source


def _head(value: Any, place: str) -> Head:
    counts: dict[str, Parser] = {"levels": _count, "kernel": _count}
    inputs: dict[str, Parser] = {"of": _one_of(ATTRIBUTES), "over": _one_of(ATTRIBUTES)}
    tagged: dict[str, Parser] = {
        "filter": lambda value, place: Filter(**_record(value, place, counts, {"black": _flag})),
        "correction": lambda value, place: Correction(
            **_record(value, place, inputs | counts, {"gain": _flag, "gated": _flag})
        ),
    }
    head: Head = _tagged(value, place, {"image": Image()}, tagged)
    return head


def _reach(value: Any, place: str) -> Reach:
    fields = {"radius": _number, "diagonal_share": _number, "height": _count}
    return Reach(**_record(value, place, fields))


def _estimate_value(estimate: Estimate) -> dict[str, str]:
    """Without an effect where it is the network's own."""
    return {name: value for name, value in vars(estimate).items() if value is not None}


def _estimate(value: Any, place: str) -> Estimate:
    required: dict[str, Parser] = {"method": _text, "quality": _text}
    return Estimate(**_record(value, place, required, {"effect": _one_of(EFFECTS)}))


def _trained(value: Any, place: str) -> dict[str, Any]:
    required = {"pixels": _list(_number, 2), "rows": _list(_count, 2)}
    optional = {"depths": _list(_number, 2)}
    return {name: list(field) for name, field in _record(value, place, required, optional).items()}


def _environment(value: Any, place: str) -> dict[str, Any]:
    def named(name: str, parser: Parser) -> Parser:
        return lambda value, place: {name: parser(value, place)}

    tagged = {"sky": named("sky", _count), "file": named("file", _text)}
    environment: dict[str, Any] = _tagged(value, place, {}, tagged)
    return environment


def _block_value(block: Block) -> dict[str, Any]:
    groups = {} if block.groups == 1 else {"groups": block.groups}
    reads = _source_value(block.reads)
    return {"name": block.name, "reads": reads, "kernel": block.kernel, **groups, "outputs": block.outputs}


def _source_value(source: Source) -> Any:
    match source:
        case Input() | Folded():
            return type(source).__name__.lower()
        case Plain(index) | Pooled(index):
            return {type(source).__name__.lower(): index}
        case Joined(coarse, skip, groups):
            dealt = {} if groups == 1 else {"groups": groups}
            return {"joined": {"coarse": coarse, "skip": skip, **dealt}}


def _head_value(head: Head) -> Any:
    name = type(head).__name__.lower()
    fields = {key: field for key, field in vars(head).items() if field is not False}
    return {name: fields} if fields else name
