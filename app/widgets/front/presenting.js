/* A presentation in this browser alone: no panel, large type at the foot, keys that step through
what `.bo-steps` lists. The server turns the scene, the text is here at once. */
if (!window.bohemiaPresent) {
  let at = 0, stage = null;
  const behind = () => document.querySelector(".bo-steps");
  const steps = () => JSON.parse(behind() ? behind().dataset.steps : "[]");
  const end = () => {
    if (!stage) return;
    stage.remove();
    stage = null;
    document.documentElement.removeAttribute("data-presenting");
    if (behind()) window.pressing(behind(), "end at 0");
  };
  const go = (to) => {
    const all = steps();
    if (!all.length) return end();
    at = Math.min(Math.max(to, 0), all.length - 1);
    const [kind, text] = all[at], parts = stage.children;
    parts[0].textContent = `${kind} · ${at + 1} / ${all.length}`;
    parts[1].textContent = text;
    window.pressing(behind(), `step at ${at}`);
  };
  window.bohemiaPresent = () => {
    if (stage || !behind()) return;
    stage = document.createElement("div");
    stage.className = "bo-stage";
    stage.append(...["small", "p", "small"].map((tag) => document.createElement(tag)));
    stage.children[1].setAttribute("role", "status");
    stage.children[2].textContent = behind().dataset.keys;
    document.body.append(stage);
    document.documentElement.setAttribute("data-presenting", "");
    if (document.activeElement) document.activeElement.blur();
    go(0);
  };
  const keys = {
    ArrowRight: () => go(at + 1), PageDown: () => go(at + 1), ArrowLeft: () => go(at - 1),
    PageUp: () => go(at - 1), Home: () => go(0), End: () => go(Infinity), Escape: end,
  };
  window.addEventListener("keydown", (event) => {
    if (!stage || !keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopImmediatePropagation(); /* the scene turns by arrow keys, too */
    keys[event.key]();
  }, true);
}
