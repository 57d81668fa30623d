"""What the Map tab tells in words, and how its boxes and its window are laid out."""

from __future__ import annotations

from app.features.map.compute import Charted
from app.language import tr
from app.widgets.svg import BACK, DIM, EDGE, FIELD, RULE, TEXT
from app.widgets.texts import box, esc, red

FOLDED = 420, 420  # px
_MAP, _SPANS = "[data-floating-window]:has(.bo-map)", "div:has(>div>.bo-spans)"
_STRIP = (
    f"{_MAP} :is([data-dock-griphandle],[data-dock-strip]){{display:none!important}}"
    f"{_MAP}>[data-dock-resize]{{display:none}}"
    "div:has(>div>.bo-map){position:relative;padding-top:34px!important}"
    f"div:has(>div>.bo-map)>div:nth-child(2){{position:absolute;right:8px;top:6px;z-index:2;"
    "padding:0!important;margin:0!important}"
    f"div:has(>div>.bo-map)>div:nth-child(2) button{{width:auto;height:24px;padding:0 8px;"
    f"font-size:12px;font-weight:400;color:{TEXT};background:{FIELD};border:1px solid {EDGE}}}"
)
# A table of boxes: a name, from, to, how many.
SPANS = (
    f"<style>{_SPANS},.bo-heads{{display:grid;grid-template-columns:28px 1fr 1fr 76px;gap:0 8px}}"
    f"{_SPANS}{{padding:0 12px!important;align-items:center}}"
    f"{_SPANS}>div{{padding:0 0 4px!important;margin:0}}{_SPANS}>div:first-child{{display:none}}"
    f"{_SPANS}>div:nth-child(2){{grid-column:1/-1}}"
    f".bo-heads i{{font-style:normal;font-size:11px;text-align:right;color:{DIM}}}"
    f".bo-axis{{font-size:12px}}{_SPANS} input{{text-align:right}}"
    f"{_SPANS}>div>.mantine-Flex-root>div:first-child{{position:absolute!important;opacity:0;"
    "width:1px!important;height:1px;overflow:hidden;white-space:nowrap}</style>"
)


def window_html(*, folded: bool) -> str:
    """How large the window is: all of the scene, or a corner of it; shown with its tab alone."""
    tab, inner, view = "[role=tab][title={!r}]", "[data-dock-group] " * 3, tr("map.tab")
    outer, tab_open = tr("workspace.tab"), f"{tab}[aria-selected=true]"
    # viser tells nobody which tab is open, but marks it; the tab may be one of the workspace's.
    elsewhere = (
        f"body:not(:has({tab_open.format(view)})) {_MAP},"
        f"body:has({inner}{tab.format(view)}):not(:has({tab_open.format(outer)})) {_MAP}"
        "{display:none!important}"
    )
    wide, high = f"{FOLDED[0]}px", f"min({FOLDED[1]}px,60vh)"
    if not folded:
        wide, high = "var(--bo-free,calc(100vw - 420px))", "100%"
    return (
        f'<div class="bo-map"></div><style>{elsewhere}{_STRIP}{_MAP}{{left:0!important;'
        f"top:auto!important;bottom:0!important;width:{wide}!important;height:{high}!important;border-radius:0!important;"
        f"box-shadow:none!important;border:1px solid {RULE};background:{BACK}}}</style>"
    )


def state_html(charted: Charted, chosen: str) -> str:
    """What the plot shows, and what is going on; ``chosen`` is the title of what is wanted."""
    if charted.running:
        what = "" if charted.running == chosen else f"{charted.running}, "
        what += f"{100 * charted.share:.0f} %" if charted.share else tr("map.starting")
        told = tr("map.computing", what=what, seconds=charted.seconds)
        return box(" ".join((esc(told), _other(charted, chosen))))
    if charted.trouble:
        return red(charted.trouble)
    if charted.map is None or not charted.map.done.any():
        return box(tr("map.none_yet"))
    share = 100 * charted.map.done.mean()
    if charted.stale:
        part = "" if charted.map.complete else tr("map.was_stopped", share=share)
        return box(f"<b>{tr('map.of_before')}</b> {part} {tr('map.start_present')}")
    if other := _other(charted, chosen):
        return box(f"{other} {tr('map.start_for', what=esc(_lower(chosen)))}")
    if not charted.map.complete:
        return box(tr("map.stopped", share=share))
    return ""


def _other(charted: Charted, chosen: str) -> str:
    """A sentence when the plot shows something else than what is chosen."""
    if charted.map is None or not charted.map.done.any():
        return ""
    shown = charted.map.request.quantities[0].title
    return "" if shown == chosen else f"<b>{tr('map.shown', what=esc(_lower(shown)))}</b>"


def _lower(title: str) -> str:
    return title[0].lower() + title[1:]
