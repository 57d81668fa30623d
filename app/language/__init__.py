"""The texts of the page, one file for each language: what a translation leaves out is English.

A text is a `str.format` template with named fields. One that depends on a count ``n`` is a table of
forms, the number or "other" each: ``{ 1 = "1 piece", other = "{n} pieces" }``.
"""

from __future__ import annotations

import os
import string
import tomllib
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import platformdirs

from kinematics.errors import InputError

VARIABLE = "BOHEMIA_LANGUAGE"
"""The environment variable that names the language, for the processes of the page as well."""
ENGLISH = "en"
OTHER = "other"
"""The form of a text whose count has none of its own."""
_HERE = Path(__file__).parent

Forms = Mapping[str, str]
"""Of a text: by the number that it is of."""


def tr(key: str, /, **values: object) -> str:
    """The text of a key in the language of the page, with values in its fields."""
    forms = catalogue(os.environ.get(VARIABLE) or ENGLISH)[key]
    return forms.get(str(values.get("n")), forms[OTHER]).format_map(values)


def hint(key: str) -> str | None:
    """What is said beside the text of a key, if anything is."""
    beside = f"{key}_hint"
    return tr(beside) if beside in catalogue(ENGLISH) else None


def menu(group: str) -> dict[str, str]:
    """The texts of a group of keys, each with the last part of its key."""
    known = (key.rpartition(".") for key in catalogue(ENGLISH))
    return {tr(f"{group}.{name}"): name for of, _, name in known if of == group}


def about(kind: str, topic: str) -> list[str]:
    """What there is to be said of a topic of a kind of machine."""
    parts = [key.split(".") for key in catalogue(ENGLISH) if key.startswith("about.")]
    return [tr(f"about.{of}.{on}") for _, of, on in parts if on == topic and kind in of.split()]


def use(language: str | None = None) -> None:
    """Choose the language of the page, for this process and those that it starts; None leaves that
    to the environment.

    Raises:
        InputError: there is none of that name, or its file cannot be used.
    """
    language = language or os.environ.get(VARIABLE) or ENGLISH
    catalogue(language)
    os.environ[VARIABLE] = language


def own_folder() -> Path:
    """Where a person's own translations stand."""
    return platformdirs.user_config_path("bohemia", appauthor=False) / "languages"


@lru_cache
def catalogue(language: str) -> Mapping[str, Forms]:
    """The texts of a language by their keys, those of English where it has none.

    Raises:
        InputError: there is none of that name, or its file cannot be used.
    """
    files = {f.stem: f for folder in (own_folder(), _HERE) for f in folder.glob("*.toml")}
    if language not in files:
        raise InputError(
            f"there is no language {language!r}; known: {', '.join(sorted(files))}; a translation "
            f"is a file like {_HERE / 'en.toml'}, as {own_folder() / language}.toml"
        )
    try:
        texts = dict(_flat(tomllib.loads(files[language].read_text(encoding="utf-8"))))
    except (OSError, ValueError) as error:
        raise InputError(f"{files[language]}: not a file of texts ({error})") from None
    if language == ENGLISH:
        return texts
    english = catalogue(ENGLISH)
    for key, forms in texts.items():
        if not fields(forms) <= (known := fields(english.get(key, forms))):
            has = ", ".join(sorted(known)) or "none"
            raise InputError(f"{files[language]}: {key}: its fields are {has}")
    return {**english, **texts}


def fields(forms: Forms) -> set[str]:
    """What stands in braces in a text."""
    parts = (part for text in forms.values() for part in string.Formatter().parse(text))
    return {name for _, name, _, _ in parts if name is not None}


def _flat(table: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Forms]]:
    for name, content in table.items():
        key = f"{above}{name}"
        if isinstance(content, str):
            yield key, {OTHER: content}
        elif OTHER in content:
            yield key, content
        else:
            yield from _flat(content, f"{key}.")
